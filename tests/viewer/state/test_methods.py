"""Which methods and views there are, which has something to show, and what is said where one has not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import legend_in
from tests.viewer.fakes import (
    make_frame,
    make_scene,
    with_cell_lights,
    with_certificates,
    with_cuts,
    with_lamps,
    with_voxels,
)
from tracer.experiments.experiment import with_reference
from tracer.frame import Settings
from tracer.method import DEFAULT_METHOD, Method, bases, in_order
from tracer.statistics import CutCounts
from viewer.state import codec
from viewer.state.methods import SHOWN_BY, default_for, groups, missing, remark_on, toggled, with_base
from viewer.state.session import Session
from viewer.state.views import MOST_RECORDED, View, can_draw
from viewer.views import penumbra

BUFFERS = {"certified": with_certificates, "lightcuts": with_cuts, "voxels": with_voxels, "lie": with_cell_lights}


@pytest.mark.parametrize("method", [*(kind.name for kind in bases()), "certified+cache", "paper+rest", "none+cache"])
@pytest.mark.parametrize("view", list(View))
def test_a_view_that_a_method_has_nothing_for_names_a_method_that_has(view: View, method: str):
    frame = make_frame(Settings(16, 8, method=method, modes=True, verify=True))
    for base, with_its_buffers in BUFFERS.items():
        if method.startswith(base):
            frame = with_its_buffers(frame)
    found = missing(view, frame)
    cuts = "lightcuts", "lightcuts-stochastic", "lightcuts-certified"
    wrong = "paper", "cells", "lie", *cuts
    shows = {View.CERTIFICATE: ("certified",), View.DIFFERENCE: wrong, View.WIPE: wrong, View.CUTS: cuts}
    shows |= {View.VOXELS: ("voxels",), View.CELL_LIGHTS: ("lie-exact", "lie")}
    shows |= {View.SLACK: ("certified",), View.REGRET: ("certified",)}
    one_by_one = tuple(kind.name for kind in bases() if kind.name not in cuts)  # rays to single lights
    shows |= {View.FATE: one_by_one, View.MOVING_SHADOW: one_by_one}
    if view not in shows or method.split("+")[0] in shows[view]:
        assert found is None
    else:
        assert found is not None and found.base in shows[view]
        assert Method.parse(method).kind.title in found.text or found.text.startswith("Every shadow ray is traced")


def test_modes_that_were_not_kept_are_missing():
    frame = make_frame(Settings(16, 8, method="none"))
    for view in (View.OCCLUSION, View.SHADOW, View.PIXEL_COUNT):
        assert not can_draw(frame, view) and "no modes" in missing(view, frame).text
        kept = replace(frame, settings=replace(frame.settings, modes=True))
        assert can_draw(kept, view) and missing(view, kept) is None


def test_a_scene_without_lights_has_nothing_to_see_of_them():
    frame = replace(make_frame(), lights=0)
    for view in View:
        found = missing(view, frame)
        assert (found is not None and "no lights" in found.text) == (view.of_light or view in (View.LIGHTS, *SHOWN_BY))


def test_so_many_lights_that_nothing_is_recorded_for_each():
    frame = make_frame(Settings(16, 8, method="none"))
    many = replace(frame, lights=MOST_RECORDED // 128 + 1)
    for view in (View.PENUMBRA, View.LIGHTS):
        assert not can_draw(frame, view) and missing(view, frame) is None, "it is on its way"
    assert missing(View.PENUMBRA, many) is None, "the chosen light is recorded alone"
    assert "2,097,153 lights" in missing(View.LIGHTS, many).text and missing(View.COLOR, many) is None


def test_what_is_recorded_of_one_light_shows_that_light():
    all_of_them = with_lamps(make_frame(Settings(16, 8, method="none")))
    alone = replace(all_of_them, asked=all_of_them.asked[..., 1:2], reached=all_of_them.reached[..., 1:2], only_light=1)
    for light in range(3):
        assert can_draw(all_of_them, View.PENUMBRA, light) and can_draw(alone, View.PENUMBRA, light) == (light == 1)
    assert can_draw(all_of_them, View.LIGHTS) and not can_draw(alone, View.LIGHTS, 1)
    assert np.array_equal(penumbra.VIEW.find(alone, 1), penumbra.VIEW.find(all_of_them, 1))


def test_certificates_that_may_still_come_are_promised():
    frame = make_frame(Settings(16, 8, method="auto"))
    frame.statistics.decision = "Every shadow ray is traced, for a reason."
    assert missing(View.CERTIFICATE, frame).text == "Every shadow ray is traced, for a reason."
    frame.statistics.certificates = 12
    assert "More are made" in missing(View.CERTIFICATE, frame, more=True).text
    assert "More are made" not in missing(View.CERTIFICATE, frame).text, "it has come to rest"


FEW = "Lightcuts is for 16 lights or more, and there are 6 here."
FEW_SAMPLES = "Lightcuts is for 16 light samples or more, and there are 6 here."
LAMPS = {"lamp_radius": 0.1, "lamp_samples": 16}


@pytest.mark.parametrize(
    ("method", "lights", "lamps", "said"),
    [
        ("lightcuts", 6, {}, FEW),
        ("lightcuts", 40, {}, ""),
        ("lightcuts", 6, LAMPS, ""),
        ("certified+voxels", 6, LAMPS, "All lights are lamps of several samples, of which Voxels knows nothing: it "
                                       "answers no ray."),
    ],
)  # fmt: skip
def test_what_a_method_leaves_to_tracing_is_said(method: str, lights: int, lamps: dict, said: str):
    assert remark_on(make_scene(lights).lights, replace(Settings(method=method), **lamps)) == said


def test_a_map_of_clusters_in_which_each_light_is_one_says_so():
    frame = with_cuts(make_frame(Settings(16, 8, method="lightcuts")))
    assert legend_in(frame, View.CUTS).notes == ()
    for cuts, said in (
        (CutCounts(3, 7, 20, 0, 3), f"Nearly every light is a cluster of its own: {FEW.replace('are 6', 'are 3')}"),
        (CutCounts(6, 7, 40, 0, 6), f"Nearly every sample of a light is a cluster of its own: {FEW_SAMPLES}"),
        (CutCounts(100, 7, 700, 0, 100), "Nearly every sample of a light is a cluster of its own."),
    ):
        frame.statistics.cuts = cuts
        (note,) = legend_in(frame, View.CUTS).notes
        assert note.text == said
    assert legend_in(frame, View.CUTS).facts[0].values[0].endswith(" for 100 samples of 3 lights")


def test_one_method_is_the_default_everywhere_that_has_something_to_show():
    assert DEFAULT_METHOD == Settings().method == Session().settings.method == codec.recalled({}).settings.method
    assert Method.parse(DEFAULT_METHOD).uses_modes and Method.parse(DEFAULT_METHOD).culls
    assert {view: default_for(view) for view in View if default_for(view) != DEFAULT_METHOD} == SHOWN_BY


def test_methods_are_named_and_ordered_by_base_then_by_their_additions():
    assert with_base("paper+rest", "certified") == "certified+rest"
    assert with_base("cells+rest+cache", "paper") == "paper+cache+rest", "additions come in their usual order"
    assert toggled("certified+rest", "cache") == "certified+cache+rest"
    assert toggled("certified+cache+rest", "rest") == "certified+cache"
    ordered = ["none", "paper", "paper+rest", "cells", "certified", "certified+cache", "certified+cache+rest"]
    assert in_order(set(ordered)) == ordered == with_reference(in_order(set(ordered)))


def test_the_list_of_methods_has_each_once_among_its_like_and_each_says_whether_it_is_exact():
    (_, exact), (_, wrong) = groups()
    assert sorted(kind.name for kind in exact + wrong) == sorted(kind.name for kind in bases())
    assert {kind.exact for kind in exact} == {True} and {kind.exact for kind in wrong} == {False}
    for kind in bases(measures=True):
        assert kind.summary.startswith(("Trusts ", "Lightcuts ")) and kind.summary.endswith("."), kind.name
        assert ("Exact" in kind.summary) == kind.exact, kind.name
        assert ("Wrong now and then." in kind.summary or "Not exact." in kind.summary) != kind.exact, kind.name

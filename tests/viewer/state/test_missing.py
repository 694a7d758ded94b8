"""What is said over a picture in a view that its method has nothing to show in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.fakes import (
    make_frame,
    with_cell_lights,
    with_certificates,
    with_cuts,
    with_lamps,
    with_tree,
    with_voxels,
)
from tracer.frame import Settings
from tracer.method import bases
from viewer.state.missing import missing
from viewer.state.readings import MOST_RECORDED, can_draw
from viewer.state.views import View
from viewer.views import lights
from viewer.views.penumbra import arrivals


@pytest.mark.parametrize("method", [*(kind.name for kind in bases()), "certified+cache", "paper+rest", "none+cache"])
@pytest.mark.parametrize("view", list(View))
def test_a_view_that_a_method_has_nothing_for_names_a_method_that_has(view: View, method: str):
    frame = make_frame(Settings(16, 8, method=method, modes=True, verify=True))
    if method.startswith("certified"):
        frame = with_certificates(frame)
    if method.startswith("lightcuts"):
        frame = with_cuts(frame)
    if method.startswith("voxels"):
        frame = with_voxels(frame)
    if method.startswith("lie"):
        frame = with_cell_lights(frame)
    found = missing(view, frame)
    cuts = "lightcuts", "lightcuts-stochastic", "lightcuts-certified"
    wrong = "paper", "cells", "lie", *cuts
    shows = {View.CERTIFICATE: ("certified",), View.DIFFERENCE: wrong, View.WIPE: wrong, View.CUTS: cuts}
    shows |= {View.VOXELS: ("voxels",), View.CELL_LIGHTS: ("lie-exact", "lie")}
    one_by_one = tuple(kind.name for kind in bases() if kind.name not in cuts)  # rays to single lights
    shows |= {View.FATE: one_by_one, View.MOVING_SHADOW: one_by_one}
    if view is View.TREE:
        assert (found.base, found.accelerator) == ("", "kdtree-lazy") and "before rays came (bvh8)" in found.text
        assert missing(view, with_tree(frame)) is None
    elif view not in shows or method.split("+")[0] in shows[view]:
        assert found is None
    else:
        assert found is not None and found.base in shows[view] and method.split("+")[0] in found.text


def test_modes_that_were_not_kept_are_missing():
    frame = make_frame(Settings(16, 8, method="none"))
    for view in (View.OCCLUSION, View.SHADOW, View.PIXEL_COUNT):
        assert not can_draw(frame, view) and "no modes" in missing(view, frame).text
        kept = replace(frame, settings=replace(frame.settings, modes=True))
        assert can_draw(kept, view) and missing(view, kept) is None


@pytest.mark.parametrize("view, shares", [(View.SAVED, False), (View.SAVED, True), (View.COST, True)])
def test_a_map_of_one_colour_is_explained(view: View, shares: bool):
    frame = make_frame(Settings(16, 8, method="auto", record_work=True, verify=True))
    frame.due_rays = np.full_like(frame.cost, 3)
    assert frame.saved.any() and missing(view, frame, shares) is None
    flat = replace(frame, saved=np.zeros_like(frame.saved))
    flat.statistics.decision = "Every shadow ray is traced."
    assert missing(view, flat, shares).base == "certified"
    assert missing(view, flat, shares).text.startswith("Every shadow ray is traced. So ")
    flat.statistics.decision = ""
    for method, base in (("none", "certified"), ("paper+rest", "certified"), ("certified", "")):
        found = missing(view, replace(flat, settings=replace(flat.settings, method=method)), shares)
        assert found.base == base and method.split("+")[0] in found.text
    assert missing(View.COST, flat, shares=False) is None, "counts of traced rays differ from pixel to pixel"
    assert missing(view, replace(flat, due_rays=np.zeros_like(flat.cost)), shares) is None, "no ray could be saved"


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
    assert np.array_equal(arrivals(alone, 1), arrivals(all_of_them, 1))
    for lacks in (lambda: arrivals(alone, 0), lambda: lights.VIEW.found(alone)):
        with pytest.raises(ValueError, match="did not record which samples"):
            lacks()


def test_certificates_that_may_still_come_are_promised():
    frame = make_frame(Settings(16, 8, method="auto"))
    frame.statistics.decision = "Every shadow ray is traced, for a reason."
    assert missing(View.CERTIFICATE, frame).text == "Every shadow ray is traced, for a reason."
    frame.statistics.certificates = 12
    assert "More are made" in missing(View.CERTIFICATE, frame, more=True).text
    assert "More are made" not in missing(View.CERTIFICATE, frame).text, "it has come to rest"

"""The view and the method that were chosen elsewhere, in a scene that is opened."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.drawn import legend_in
from tests.viewer.fakes import make_frame, make_scene, with_cuts
from tracer.fit import overview
from tracer.frame import Settings
from tracer.statistics import CutCounts
from viewer.state.methods import fitting_view
from viewer.state.views import View

FEW = "lightcuts is for 16 lights or more, and there are 6 here."
FEW_SAMPLES = "lightcuts is for 16 light samples or more, and there are 6 here."
LAMPS = {"lamp_radius": 0.1, "lamp_samples": 16}


@pytest.mark.parametrize(
    ("view", "method", "lights", "lamps", "shown", "said"),
    [
        (View.CUTS, "lightcuts", 6, {}, View.COLOR, f"The view is Colour, not Clusters of lights, as {FEW}"),
        (View.DEPTH, "lightcuts", 6, {}, View.DEPTH, f"The method {FEW}"),
        (View.CUTS, "lightcuts", 40, {}, View.CUTS, ""),
        (View.CUTS, "lightcuts", 6, LAMPS, View.CUTS, ""),
        (View.VOXELS, "voxels", 6, LAMPS, View.COLOR, "knows nothing of lamps of several samples."),
        (View.CERTIFICATE, "certified+voxels", 6, LAMPS, View.CERTIFICATE, "it answers no ray."),
        (View.VOXELS, "voxels", 40, {}, View.VOXELS, "Of 40 lights, voxels answers for the first 31; rays to the"),
        (View.SHADOW, "paper", 0, {}, View.COLOR, "The view is Colour, not Shadow mode, as there are no lights."),
        (View.SAVED, "paper", 0, {}, View.COLOR, "not Untraced shadow rays, as there are no lights."),
        (View.DIFFERENCE, "paper", 0, {}, View.COLOR, "not Difference, as there are no lights."),
        (View.SAVED, "paper", 6, {}, View.SAVED, ""),
        (View.COST, "paper", 0, {}, View.COST, ""),  # rays that are reflected make it of several colours
        (View.SHADOW, "auto", 6, {}, View.SHADOW, ""),
    ],
)
def test_a_view_with_nothing_to_show_gives_way_to_the_picture(view, method, lights, lamps, shown, said):
    found, told = fitting_view(view, replace(Settings(method=method), **lamps), make_scene(lights).lights)
    assert found is shown and told.endswith(said) if not said.startswith("Of 40") else told.startswith(said)


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


def test_the_overview_names_every_method_that_leaves_lights_to_tracing():
    assert overview(6, 0) == ""
    every = "All lights are taken into account by certified, auto, lightcuts, lightcuts-stochastic and "
    assert overview(4096, 0) == (
        f"{every}lightcuts-certified; the first 31 by paper, cells, voxels and lightbuffer; some by lie-exact and lie."
    )
    assert overview(256, 256) == (
        f"{every}lightcuts-certified; the first 31 by paper and cells; some by lie-exact and lie; none by voxels and "
        "lightbuffer, which leave lamps of several samples to tracing."
    )
    assert overview(6, 3).endswith("; some by lie-exact and lie; voxels and lightbuffer leave the 3 lamps of several "
                                   "samples to tracing.")  # fmt: skip

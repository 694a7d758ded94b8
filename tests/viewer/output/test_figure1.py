"""Figure 1 with a frame's numbers: what it says, where its parts lie, and the SVG."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest

import tracer
from tests.tracing.shades import roof, shadow_scene
from tests.tracing.worlds import moved
from viewer.output.figure1 import Figure, Flow, figure_of
from viewer.output.figure1_drawing import Box, Words, lay_out, svg
from viewer.state.views import View

SETTINGS = tracer.Settings(width=64, height=48, depth=2, threads=1)
LINE = 15.0


def measure(text: str) -> float:
    """About as wide as letters are."""
    return 7.0 * len(text)


def frame_by(method: str, **settings: bool) -> tracer.Frame:
    """The second frame of a scene in which something moves."""
    scene = shadow_scene(dynamic=(moved("kite", roof(5.0, 0.6), np.eye(4)),))
    renderer = tracer.Renderer(scene, replace(SETTINGS, method=method, **settings))
    renderer.render()
    return renderer.render()


def flows_of(figure: Figure) -> dict[str, Flow]:
    return {flow.name: flow for stage in figure.stages for flow in stage.flows}


def names_of(figure: Figure) -> list[str]:
    return [stage.name for stage in figure.stages]


def test_the_stages_are_those_of_the_paper_with_the_frames_numbers():
    frame = frame_by("paper")
    figure, s = figure_of(frame, "a scene"), frame.statistics
    stages = ["Place dynamic objects", "Primary rays", "Occlusion testing", "Shading", "Shadow testing"]
    assert names_of(figure) == [*stages, "Shadow-mode setting", "Occlusion-mode setting"]
    numbers = {name: flow.number for name, flow in flows_of(figure).items()}
    assert s.shadow.culled > 0 and s.mode_changes is not None
    assert numbers == {
        "dynamic primitives": s.mode_changes.units["dynamic"],
        "primary rays": 64 * 48,
        "extra tests": s.occlusion_tests,
        "shadow rays due": s.shadow.due,
        "culled": s.shadow.culled,
        "dynamic only": s.shadow.dynamic_only,
        "traced": s.shadow.traced,
        "→ full shadow": s.mode_changes.full_shadow,
        "→ non-shadow": s.mode_changes.non_shadow,
        "→ partial shadow": s.mode_changes.partial_shadow,
        "→ fully rendered": s.mode_changes.fully_rendered,
        "→ partially occluded": s.mode_changes.partially_occluded,
        "→ examined anew": s.mode_changes.examined_anew,
    }
    assert figure.title.startswith("a scene, Paper, 64 × 48 pixels")
    assert f"{s.mode_changes.units['fully_rendered']:,} of {sum(s.mode_changes.units.values()):,}" in figure.notes[0]


def test_stages_have_their_parts_of_the_time_and_a_part_of_a_picture_is_said():
    frame = frame_by("paper", verify=True)
    phases = {"place": 0.01, "primary": 0.02, "occlusion testing": 0.03, "surfaces": 0.05, "shading": 0.25}
    frame.statistics.phases, frame.statistics.seconds = phases | {"mode setting": 0.04}, 0.5
    figure = figure_of(frame)
    assert [stage.share for stage in figure.stages] == pytest.approx([0.02, 0.04, 0.06, 0.6, 0.0, 0.0, 0.08])
    assert figure.stages[3].time == "300.0 ms, 60.0 %" and len(figure.notes) == 1
    assert flows_of(figure)["wrong answers"].number == frame.statistics.wrong.answers
    frame.statistics.part = 0.38
    assert any("38 % of pixels shaded" in note for note in figure_of(frame).notes)


def test_what_would_be_culled_is_outlined_where_nothing_is():
    frame = frame_by("none", modes=True)
    said, flows = frame.statistics.by_modes_in_all, flows_of(figure_of(frame))
    assert said.full_shadow > 0
    assert (flows["would be culled"].number, flows["would be culled"].hollow) == (said.full_shadow, True)
    assert flows["… dynamic only"].number == said.non_shadow
    assert (flows["traced in any case"].number, flows["traced in any case"].hollow) == (
        said.due - said.full_shadow - said.non_shadow,
        False,
    )
    testing = next(stage for stage in figure_of(frame).stages if stage.name == "Occlusion testing")
    assert testing.time.startswith("(") and testing.share == 0.0
    assert "no part of the frame's time" in testing.rule
    plain = figure_of(frame_by("none"))
    assert not any("mode" in name or "Occlusion" in name for name in names_of(plain))
    assert flows_of(plain)["traced"].share == "100.0 %"


def test_certificates_stand_in_the_place_of_modes():
    frame = frame_by("certified", modes=True)
    figure, shadow = figure_of(frame), frame.statistics.shadow
    assert "Certificates" in names_of(figure) and not any("mode" in name for name in names_of(figure))
    assert flows_of(figure)["certificates made"].number == frame.statistics.certificates
    assert flows_of(figure)["dynamic only"].number == shadow.dynamic_only > 0
    certificates = next(stage for stage in figure.stages if stage.name == "Certificates")
    assert certificates.view is View.CERTIFICATE


@pytest.mark.parametrize("method", ["cells", "cache", "lightcuts", "voxels", "lie-exact", "lightbuffer", "auto"])
def test_every_method_has_a_figure(method):
    method = "paper+cache" if method == "cache" else method
    figure = figure_of(frame_by(method, modes=method != "lightcuts"))
    assert names_of(figure)[0] == "Place dynamic objects" and flows_of(figure)["primary rays"].number == 64 * 48
    ElementTree.fromstring(svg(figure))


@pytest.mark.parametrize(
    "width, height", [(340, 900), (340, 300), (200, 200), (670, 190), (860, 270), (1232, 672), (60, 40)]
)
@pytest.mark.parametrize("method", ["paper", "certified"])
def test_nothing_overlaps_is_cut_or_leaves_the_drawing(width: int, height: int, method: str):
    figure = figure_of(frame_by(method))
    drawing = lay_out(figure, measure, LINE, width, height)
    assert drawing.scale <= 1.0 and drawing.scale * drawing.width <= width + 0.01
    assert drawing.scale * drawing.height <= height + 0.01 or drawing.scale <= 0.6, "it could have been smaller"
    words = [part for part in drawing.parts if isinstance(part, Words)]
    assert {flow.name for stage in figure.stages for flow in stage.flows} <= {one.text for one in words}
    texts = sorted((one.y, one.x - measure(one.text) * one.right, one) for one in words)
    for (y, _, one), (below, left, _) in pairwise(texts):
        assert y != below or one.right or one.x + measure(one.text) <= left + 0.5, one
    for box in (part for part in drawing.parts if isinstance(part, Box)):
        assert min(box.x, box.y) >= 0.0 and box.y + box.height <= drawing.height + 0.01
        assert box.x + box.width <= drawing.width + 0.01
    assert all(left >= 0.0 and left + measure(one.text) <= drawing.width + 0.5 for _, left, one in texts)


def test_the_svg_is_well_formed_and_has_the_numbers():
    frame = frame_by("paper")
    text = svg(figure_of(frame, "<scene> & more"))
    root = ElementTree.fromstring(text)
    said = [element.text or "" for element in root.iter("{http://www.w3.org/2000/svg}text")]
    shadow = frame.statistics.shadow
    for number in (shadow.due, shadow.culled, shadow.dynamic_only, shadow.traced, frame.statistics.occlusion_tests):
        assert f"{number:,}" in said
    assert any("<scene> & more" in line for line in said)
    assert float(root.get("width", 0)) == 1280 and 0 < float(root.get("height", 0)) < 800
    assert len(text) < 60_000

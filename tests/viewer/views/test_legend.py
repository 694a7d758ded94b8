"""Legends say what the colours of a view stand for, keep inside their room, and can be read over any picture."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.scenes import loaded
from tests.tracing.nasty_worlds import nasty_walk
from tests.viewer.drawn import legend_in, luminance, units_in
from tests.viewer.fakes import in_part, make_frame, with_everything
from tracer.culling.fate import MOVING_SHADOW
from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.lights import Light
from tracer.statistics import CutErrors, SaidByModes
from viewer.output.overlays import with_legend
from viewer.state.draw_options import Slice
from viewer.state.palette import DARK, LIGHT, OCCLUSION
from viewer.state.views import View
from viewer.util.numbers import count, percent
from viewer.util.resources import embedded_scenes
from viewer.views.legend import BACKDROP_OPACITY, NOTES, QUIET, Legend, fitting, lay_out

SETTINGS = Settings(width=160, height=96, verify=True, record_work=True)
LINE = 10.0
SAID = Path(__file__).with_name("legends.txt")
LAMPS = tuple(Light("lamp", (0.0, 0.0, 0.0)) for _ in range(3))


def measure(text: str) -> float:
    return 5.0 * len(text)


@pytest.fixture
def frame() -> Frame:
    """One of numbers, with whatever any view shows."""
    return with_everything(make_frame(SETTINGS))


def of(frame: Frame, view: View, **chosen) -> Legend:
    legend = legend_in(frame, view, **chosen)
    assert legend is not None
    return legend


def legends(frame: Frame) -> Iterator[tuple[str, Legend | None]]:
    """The legends of all views, and of what is said otherwise of some frames, each with what it is of."""
    cut, known = Slice(0, 0.3), frame.statistics
    for view in View:
        yield view.label, legend_in(frame, view, 1, LAMPS, slice=cut)
    yield "clipped pixels", legend_in(frame, View.COLOR, clipping=True)
    for view in (View.PENUMBRA, View.LIGHTS, View.FATE, View.SAVED, View.OCCLUSION):
        yield f"{view.label}, shaded in part", legend_in(in_part(frame), view, 2)
    for view in (View.SAVED, View.COST):
        yield f"{view.label}, shares", legend_in(frame, view, shares=True)
    for view in (View.DEPTH, View.CELL_LIGHTS, View.CUTS):
        yield f"{view.label}, in a range", legend_in(frame, view, span=(1.0, 2.5), slice=cut)
    for view in (View.SHADOW, View.VOXELS):
        yield f"{view.label}, of a light that nothing is known of", legend_in(frame, view, 2 if view.has_slice else 20)
    yield "Wipe without marks", legend_in(frame, View.WIPE, mark_wrong=False)

    def by(method: str, view: View, light: int = 0, **statistics: object) -> Legend | None:
        of_it = replace(
            frame, settings=replace(SETTINGS, method=method, modes=True), statistics=replace(known, **statistics)
        )
        return legend_in(of_it, view, light, LAMPS)

    said = [SaidByModes(100, 25, 10), SaidByModes(300, 15, 0)]
    yield "what modes would cull", by("certified", View.SHADOW, 1, by_modes=said)
    yield "fates by certified", by("certified+cache", View.FATE)
    for name, statistics in {
        "errors of clusters": {"cuts": replace(known.cuts, errors=CutErrors(0.002, 0.0137, 0.041, 5))},
        "wrong answers in four samples": {"wrong": replace(known.wrong, samples=4)},
        "wrong answers of a part": {"part": 0.12},
        "no wrong answers": {"cuts": None, "wrong": replace(known.wrong, answers=0, pixels=0)},
        "every ray traced": {"cuts": None, "wrong": replace(known.wrong, answers=0, pixels=0, untraced=0)},
    }.items():
        yield name, by("paper", View.DIFFERENCE, **statistics)
    bright = frame.fates.copy()
    bright[..., 1] &= ~np.uint8(MOVING_SHADOW)
    none = replace(frame, fates=bright & ~np.uint8(MOVING_SHADOW))
    resting = replace(none, statistics=replace(known, resting=20))
    for name, one in ("of another light", replace(frame, fates=bright)), ("none", none), ("at rest", resting):
        yield f"moving shadows: {name}", legend_in(one, View.MOVING_SHADOW, 1, LAMPS)


def in_words(name: str, legend: Legend | None) -> str:
    """A legend as lines of text."""
    if legend is None:
        return f"[{name}]\nnone\n"
    lines = [f"[{name}]", " | ".join((legend.title, *legend.columns))]
    if legend.scale is not None:
        scale = legend.scale
        lines.append(f"map: {scale.low} | {scale.middle} | {scale.high}{', reversed' if scale.reverse else ''}")
    for row in (*legend.entries, *legend.facts):
        mark = "=" if row.stripes else "*" if row.color else "-"
        lines.append(" | ".join((f"{mark} {row.name}", *row.values)) + (f"   ({row.meaning})" if row.meaning else ""))
    return "\n".join([*lines, *(f"{note.kind.value}: {note.text}" for note in legend.notes), ""])


def test_legends_say_what_they_should(frame: Frame):
    """All that legends say, in one file to be read; where something else is meant, it is written anew with
    SHADOWCULL_WRITE_LEGENDS=1, and its changes are reviewed."""
    text = "\n".join(in_words(*one) for one in legends(frame))
    if os.environ.get("SHADOWCULL_WRITE_LEGENDS"):
        SAID.write_text(text, "utf-8")
    assert text == SAID.read_text("utf-8")


@pytest.mark.parametrize("method", ["paper", "none", "auto", "certified", "paper+rest"])
def test_a_scene_has_the_same_dynamic_primitives_by_every_method(method: str):
    """Those that rest, in the second picture of one moment, carry modes where the method says so; none is missed."""
    walk = nasty_walk(7, frames=1)
    time, camera = walk.frames[0]
    dynamic = sum(len(one.triangles) + len(one.quadrics) for one in walk.scene.objects[1:])
    renderer = Renderer(walk.scene, Settings(30, 24, 2, method, modes=True, threads=1))
    renderer.render(time, camera)
    frame = renderer.render(time, camera)
    for view in (View.OCCLUSION, View.SHADOW):
        counts = {name: units_in(frame, view).get(name, 0) for name in ("dynamic", "dynamic, at rest")}
        assert sum(counts.values()) == dynamic > 0, counts
        assert (counts["dynamic"] == 0) == (method not in ("paper", "none"))


def test_work_of_a_picture_in_part_is_counted_where_it_was_done():
    """Pixels that are not shaded yet show what the nearest has, and are no part of the counts."""
    scene = loaded(embedded_scenes()["default"])
    renderer = Renderer(scene, Settings(width=96, height=64, depth=2, record_work=True))
    renderer.render(scene.frame_time(20))
    partly, whole = renderer.refine(scene.frame_time(21), parts=(2, 16))
    for one in (partly, whole):
        rays, shadow = one.statistics.secondary.rays, one.statistics.shadow
        saved, cost = (of(one, view).facts for view in (View.SAVED, View.COST))
        assert saved[0].values == (f"{count(shadow.saved)} ({percent(shadow.saved, shadow.due)} of those due)",)
        shaded = round(one.statistics.part * 96 * 64)
        traced = shaded + rays + shadow.traced
        assert cost[0].values[0].startswith(f"{count(traced)} (")
        assert cost[1].values[0].startswith(f"{traced / shaded:.2f}, ")
    legend = of(partly, View.COST)
    part = percent(partly.statistics.part, 1.0)
    assert legend.facts[0].name == f"in the {part} that is shaded" and "nearest" in legend.notes[0].text
    assert of(whole, View.COST).facts[0].name == "in all" and not of(whole, View.COST).notes
    assert of(partly, View.OCCLUSION).facts[0].name.endswith(f"{part} shaded")
    assert not of(whole, View.OCCLUSION).facts[0].name.endswith("shaded")


@pytest.mark.parametrize("view", [view for view in View if view is not View.COLOR])
def test_all_parts_lie_inside_and_no_two_texts_touch(frame: Frame, view: View):
    layout = lay_out(of(frame, view), measure, LINE)
    boxes = [(w.x, w.y, w.x + measure(w.text), w.y + LINE) for w in layout.words if w.text]
    for left, top, right, bottom in [*boxes, *((s.x, s.y, s.x + s.width, s.y + s.height) for s in layout.boxes)]:
        assert left >= 0.4 * LINE and right <= layout.width - 0.4 * LINE + 1e-6
        assert top >= 0.4 * LINE and bottom <= layout.height - 0.4 * LINE + 1e-6
    for i, one in enumerate(boxes):
        for other in boxes[i + 1 :]:
            assert one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def test_in_little_room_less_is_said_and_in_none_nothing(frame: Frame):
    legend = of(frame, View.SHADOW)
    whole = lay_out(legend, measure, LINE)
    assert fitting(legend, measure, LINE, whole.width, whole.height) == whole
    narrower = fitting(legend, measure, LINE, whole.width - 1.0, whole.height)
    texts = {words.text for words in narrower.words}
    assert "pixels" in texts and "primitives" not in texts and "full shadow" in texts
    bare = fitting(legend, measure, LINE, 150.0, whole.height)
    assert {words.text for words in bare.words} >= {"full shadow"} and len(bare.words) < len(narrower.words)
    assert fitting(legend, measure, LINE, 50.0, whole.height) is None
    assert fitting(legend, measure, LINE, whole.width, 30.0) is None


@pytest.mark.parametrize("picture", [0.0, 0.5, 1.0])
def test_texts_can_be_read_over_any_picture(picture: float):
    """Contrast of 4.5 to 1 (WCAG 2), against the backdrop over black, grey and white."""
    backdrop = tuple(BACKDROP_OPACITY * channel + (1.0 - BACKDROP_OPACITY) * picture for channel in DARK)
    for color in (LIGHT, QUIET, *NOTES.values()):
        assert (luminance(color) + 0.05) / (luminance(backdrop) + 0.05) > 4.5


@pytest.mark.parametrize(
    ("place", "size"), [((0.0, 0.0), (240, 160)), ((1.0, 1.0), (512, 512)), ((0.3, 0.9), (1280, 720))]
)
def test_a_legend_in_a_picture_has_its_colours_and_changes_nothing_around_it(
    frame: Frame, place: tuple[float, float], size: tuple[int, int]
):
    white = np.full((size[1], size[0], 3), 255, np.uint8)
    drawn = with_legend(white, of(frame, View.OCCLUSION), place)
    rows, columns = np.nonzero((drawn != white).any(axis=-1))
    top, bottom, left, right = rows.min(), rows.max(), columns.min(), columns.max()
    assert left > 0 and right < size[0] - 1 and top > 0 and bottom < size[1] - 1, "inside, with a margin"
    near = 3 + 0.05 * max(size)
    for part, first, last, side in ((place[0], left, right, size[0]), (place[1], top, bottom, size[1])):
        assert part > 0.0 or first < near
        assert part < 1.0 or last > side - 1 - near
    for color in (one.color for one in OCCLUSION.values()):
        assert (drawn == np.round(255.0 * np.asarray(color))).all(axis=-1).sum() >= 25
    assert (white == 255).all(), "the picture itself stays as it is"
    assert with_legend(white[:40, :60], of(frame, View.OCCLUSION), place) is None, "it is too small for one"

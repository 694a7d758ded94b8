"""Legends say what the colours of a view stand for, keep inside their room, and can be read over any picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import loaded
from tests.tracing.nasty_worlds import nasty_walk
from tests.viewer.drawn import legend_in, luminance
from tests.viewer.fakes import (
    in_part,
    make_frame,
    with_cell_lights,
    with_certificates,
    with_cuts,
    with_lamps,
    with_tree,
    with_voxels,
)
from tracer.culling.fate import MOVING_SHADOW, Fate
from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.lights import Light, light_in_words
from tracer.statistics import CutErrors, SaidByModes
from viewer.output.overlays import with_legend
from viewer.state.draw_options import Slice
from viewer.state.palette import FATE_NAMES, OCCLUSION_COLORS, WRONG
from viewer.state.views import View, can_draw
from viewer.util.numbers import count, percent
from viewer.util.resources import embedded_scenes
from viewer.views.legend import (
    BACKDROP,
    BACKDROP_OPACITY,
    NOTES,
    QUIET,
    TEXT,
    Legend,
    NoteKind,
    fitting,
    lay_out,
)
from viewer.views.voxels import voxels_of

SETTINGS = Settings(width=160, height=96, verify=True, record_work=True)
LINE = 10.0


LAMPS = tuple(Light("lamp", (0.0, 0.0, 0.0)) for _ in range(3))


def measure(text: str) -> float:
    return 5.0 * len(text)


@pytest.fixture
def frame() -> Frame:
    """One of numbers, with whatever any view shows."""
    return with_tree(with_cell_lights(with_voxels(with_cuts(with_lamps(with_certificates(make_frame(SETTINGS)))))))


def of(frame: Frame, view: View, **chosen) -> Legend:
    legend = legend_in(frame, view, **chosen)
    assert legend is not None
    return legend


def test_every_view_but_the_picture_has_a_legend(frame: Frame):
    assert legend_in(frame, View.COLOR) is None
    for view in View:
        if view is not View.COLOR:
            legend, bare = of(frame, view), make_frame()
            assert legend.title and (legend.entries or legend.scale or legend.facts or legend.notes), view
            assert can_draw(bare, view) or not legend_in(bare, view), view


def test_voxels_are_counted_in_the_slice_and_in_all(frame: Frame):
    states, cut = voxels_of(frame), Slice(0, 0.3)
    modes = (states.words[:-1] >> np.uint32(4) & 3).reshape(states.shape)
    legend = of(frame, View.VOXELS, light=1, lights=LAMPS, slice=cut)
    assert legend.title == "Voxels, light 1 (lamp)" and legend.columns == ("slice", "all")
    for entry, state in zip(legend.entries, (1, 2, 0), strict=True):
        shares = percent(int((modes[4] == state).sum()), 64), percent(int((modes == state).sum()), 1024)
        assert entry.values == shares, entry
    assert [fact.values for fact in legend.facts] == [("-0.875",), ("4 of 16",), ("16 x 8 x 8",)]
    lamp = of(frame, View.VOXELS, light=2)
    assert not lamp.entries and "Nothing is known of this light" in lamp.notes[0].text


def test_maps_of_numbers_have_their_mean_and_their_range(frame: Frame):
    asked, nodes, bound = (frame.layers[name] for name in ("cell lights", "cut nodes", "cut bound"))
    known = (frame.primitive >= 0) & (nodes >= 0)
    expected = {
        View.CELL_LIGHTS: {
            "per pixel": f"{asked[asked >= 0].mean():.4g} of 3 lights",
            "cells in view": str(len(np.unique(frame.cell[asked >= 0]))),
        },
        View.CUTS: {
            "per pixel": f"{nodes[known].mean():.4g} for 100 samples of 3 lights",
            "each may be wrong by": "2.0 % of the light",
            "all of them together": f"{percent(float(np.median(bound[known])), 1.0)} at most",
        },
        View.TREE: {
            "slice at x": "-1.94",
            "built of the slice": "100.0 %",
            "nodes built": "123",
            "primitives in them": "25.0 % of 160",
        },
    }
    cut = Slice(0, 0.01)
    for view, scale in ((View.CELL_LIGHTS, ("0", "3")), (View.CUTS, ("0", "40")), (View.TREE, ("level 0", "8"))):
        legend = of(frame, view, slice=cut)
        said = {fact.name: fact.values[0] for fact in legend.facts}
        assert said | expected[view] == said, view
        assert (legend.scale.low, legend.scale.high) == scale
        assert view is View.TREE or [entry.name for entry in legend.entries] == ["not known yet"]
        assert of(frame, view, span=(1.0, 2.5), slice=cut).scale.high == "2.5"


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
        told = {entry.name: entry.values[1] for entry in of(frame, view).entries}
        counts = {name: int(told.get(name, "0").replace(",", "")) for name in ("dynamic", "dynamic, at rest")}
        assert sum(counts.values()) == dynamic > 0, counts
        assert (counts["dynamic"] == 0) == (method not in ("paper", "none"))


@pytest.mark.parametrize("light", [0, 1, 2])
@pytest.mark.parametrize("method", ["paper+cache", "certified+cache"])
def test_fates_come_with_shares_of_the_rays_that_are_due(frame: Frame, light: int, method: str):
    frame = replace(frame, settings=replace(SETTINGS, method=method))
    legend, fates = of(frame, View.FATE, light=light, lights=LAMPS), frame.fate(light)[frame.primitive >= 0]
    assert legend.title == f"Fate of shadow rays, first hits, light {light} (lamp)"
    due, by_name = (fates >= Fate.CULLED).sum(), {entry.name: entry for entry in legend.entries}
    for fate in set(Fate(one) for one in fates):
        share = percent((fates == fate).sum(), due) if fate is not Fate.FACES_AWAY else ""
        assert by_name.pop(FATE_NAMES[fate]).values[1] == share
    assert all(entry.values[0] == "0.0 %" for entry in by_name.values()), "what is usual is named"
    saved = ((fates == Fate.CULLED) | (fates == Fate.DYNAMIC_ONLY)).sum()
    said = {fact.name: fact.values[1] for fact in legend.facts}
    assert said == {"saved": percent(saved, due), "traced": percent((fates >= Fate.PARTLY_OCCLUDED).sum(), due)}
    assert not legend.notes and "nearest" in of(in_part(frame), View.FATE, light=light).notes[0].text


def test_the_penumbra_has_its_share_of_the_light(frame: Frame):
    hit = frame.primitive >= 0
    for light, samples in enumerate(("16", "1", "64")):
        facts = of(frame, View.PENUMBRA, light=light).facts
        asked, reached = frame.asked[hit][:, light].astype(int), frame.reached[hit][:, light].astype(int)
        between = (reached > 0) & (reached < asked)
        share = [percent(reached[between].sum(), asked[between].sum())] if between.any() else []
        assert [fact.values[0] for fact in facts] == [samples, *share] and bool(share) == (light != 1)


def test_what_no_moving_object_darkens_is_said(frame: Frame):
    bright = frame.fates.copy()
    bright[..., 1] &= ~np.uint8(MOVING_SHADOW)
    most = max((0, 2), key=lambda light: frame.moving_shadow(light).sum())
    none = replace(frame, fates=bright & ~np.uint8(MOVING_SHADOW))
    resting = replace(none, statistics=replace(frame.statistics, resting=20))
    for shown, said in (
        (replace(frame, fates=bright), f"shadow of this light now; light {most} (lamp) has some."),
        (none, ", nor of another light."),
        (resting, "What could move is at rest, and counts as static with paper."),
    ):
        (note,) = of(shown, View.MOVING_SHADOW, light=1, lights=LAMPS).notes
        assert note.text.endswith(said)
    assert not of(frame, View.MOVING_SHADOW, light=1).notes


def test_lights_per_pixel_and_what_is_not_known_yet(frame: Frame):
    hit = frame.primitive >= 0
    due = (frame.asked[hit] > 0).sum(axis=-1)
    legend = of(frame, View.LIGHTS)
    assert legend.facts[0].values == (f"{due.mean():.4g} of 3 lights",) and not legend.entries
    assert (legend.scale.low, legend.scale.high) == ("0", "3")
    part = in_part(frame)
    known = (part.asked[hit & part.shaded] > 0).sum(axis=-1)
    assert of(part, View.LIGHTS).facts[0].values == (f"{known.mean():.4g} of 3 lights",)
    assert [entry.name for entry in of(part, View.LIGHTS).entries] == ["not known yet"]
    unknown = {entry.name: entry.values for entry in of(part, View.PENUMBRA).entries}["not known yet"]
    assert unknown == (percent((hit & ~part.shaded).sum(), hit.sum()),)


def test_pictures_by_clusters_of_lights_tell_their_errors(frame: Frame):
    cuts = replace(frame.statistics.cuts, errors=CutErrors(0.002, 0.0137, 0.041, 5))
    legend = of(replace(frame, statistics=replace(frame.statistics, cuts=cuts)), View.DIFFERENCE)
    assert [fact.values[0] for fact in legend.facts][2:] == ["0.2 % at most", "1.4 % at most", "4.1 % at most"]
    assert not legend.notes, "nothing is said of answers"


def test_a_light_is_called_by_its_number_and_by_a_name_that_says_more(frame: Frame):
    assert light_in_words(2, "light 2") == light_in_words(2, "") == "light 2"
    assert of(frame, View.SHADOW, light=1, lights=LAMPS).title == "Shadow mode, light 1 (lamp)"
    uncovered = of(frame, View.SHADOW, light=20)
    assert not uncovered.entries and uncovered.notes[0].kind is NoteKind.WARNING


def test_heat_maps_say_whether_they_count_or_share(frame: Frame):
    counts, shares = of(frame, View.SAVED), of(frame, View.SAVED, shares=True)
    assert (counts.scale.low, counts.scale.high) == ("0", "7 and more")
    assert (shares.scale.low, shares.scale.high) == ("0 %", "100 %") and "Share" in shares.title
    assert counts.facts == shares.facts
    total = f"{100 * frame.saved.sum() / frame.due_rays.sum():.1f} % of those due"
    assert total in counts.facts[0].values[0]
    assert "without culling" in of(frame, View.COST, shares=True).title


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


def test_the_depths_ends_are_those_of_the_colours():
    depth = np.linspace(1.0, 9.0, 160 * 96, dtype=np.float32).reshape(96, 160)
    scale = of(replace(make_frame(SETTINGS), depth=depth), View.DEPTH).scale
    assert scale.reverse and float(scale.low) == pytest.approx(1.08, abs=0.01) and float(scale.high) > 8.9


def test_the_difference_counts_what_is_wrong_or_says_why_nothing_is(frame: Frame):
    wrong = of(frame, View.DIFFERENCE)
    assert wrong.entries[0].color == WRONG and wrong.entries[0].values == ("2 (0.013 %)",)
    assert wrong.facts[2].values[0].startswith("3 (")
    assert (wrong.entries[0].name, wrong.facts[2].name) == ("wrong pixels", "wrong answers")
    assert of(frame, View.WIPE, mark_wrong=False).entries[0].color is None
    assert [fact.values for fact in wrong.facts[:2]] == [("2",), ("25.5 of 255",)]
    found, known = frame.statistics.wrong, frame.statistics
    known.wrong = replace(found, samples=4)
    assert of(frame, View.DIFFERENCE).entries[0].name == "wrong pixels, 4 samples"
    known.wrong, known.part = found, 0.12
    assert of(frame, View.DIFFERENCE).notes[0].text == "in the 12.0 % of the picture that is shaded"
    right = replace(frame, wrong=np.zeros_like(frame.wrong))
    known.cuts, known.wrong, known.part = None, replace(found, answers=0, pixels=0), 1.0
    assert of(right, View.DIFFERENCE).notes[0].kind is NoteKind.PLAIN
    assert of(right, View.DIFFERENCE).notes[0].text == "None wrong of 15,360 answers known without tracing (25.0 %)."
    known.wrong = replace(known.wrong, untraced=0)
    off = of(right, View.DIFFERENCE).notes[0]
    assert off.kind is NoteKind.WARNING and off.text.startswith("Every shadow ray was traced")


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
    backdrop = tuple(BACKDROP_OPACITY * channel + (1.0 - BACKDROP_OPACITY) * picture for channel in BACKDROP)
    for color in (TEXT, QUIET, *NOTES.values()):
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
    for color in OCCLUSION_COLORS.values():
        assert (drawn == np.round(255.0 * np.asarray(color))).all(axis=-1).sum() >= 25
    assert (white == 255).all(), "the picture itself stays as it is"
    assert with_legend(white[:40, :60], of(frame, View.OCCLUSION), place) is None, "it is too small for one"


def test_modes_say_what_the_papers_method_would_cull(frame: Frame):
    frame.statistics.by_modes = [SaidByModes(100, 25, 10), SaidByModes(300, 15, 0)]
    of_light = of(
        replace(frame, settings=replace(SETTINGS, method="certified", modes=True)), View.SHADOW, light=1
    ).facts
    assert [fact.values for fact in of_light] == [("light 1", "all lights"), ("5.0 %", "10.0 %"), ("0.0 %", "2.5 %")]
    assert of_light[0].quiet and of_light[1].name == "culled"
    assert [fact.values for fact in of(frame, View.OCCLUSION).facts] == [("all lights",), ("10.0 %",), ("2.5 %",)]
    assert of(frame, View.OCCLUSION).facts[1].name == "culled"

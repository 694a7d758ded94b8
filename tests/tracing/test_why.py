"""The reason that is given for a pixel and a light is the one by which the frame decided, and its sentence says so."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.scenes import loaded
from tests.tracing.glassy import SCENE
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.worlds import moved, quad, scene
from tracer.culling.fate import FATE, Fate
from tracer.culling.modes import OcclusionMode, ShadowMode, occlusion_mode, shadow_mode
from tracer.culling.verdicts import Verdict
from tracer.frame import Frame, Settings
from tracer.inspect.occluded_by import OccludedBy, Reference, Seen, occluded_by
from tracer.inspect.ray_tree import ray_tree
from tracer.inspect.reasons import Coverage, Reason, Rule, TaughtBy, Why
from tracer.inspect.why import why
from tracer.inspect.why_in_words import Link, Words, named, plain
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Camera

ASSETS = Path("assets/scenes")
FULLY, PARTLY, INIT, DYNAMIC = (
    OcclusionMode.FULLY_RENDERED, OcclusionMode.PARTIALLY_OCCLUDED, OcclusionMode.INIT, OcclusionMode.DYNAMIC
)  # fmt: skip


def seen_in(renderer: Renderer, frame: Frame) -> Seen:
    work = renderer.work_on(frame)
    return Seen(
        renderer.world.placed, work.rays, frame.primitive, work.units, work.first, frame.settings.symmetric
    )  # fmt: skip


def pixels(frame: Frame, step: int = 1) -> list[tuple[int, int]]:
    return [(x, y) for y in range(0, frame.height, step) for x in range(0, frame.width, step)]


# --- what hides a primitive ----------------------------------------------------------------------


@quickly(6)
@given(walks(), st.booleans(), st.sampled_from(["paper", "cells"]))
def test_what_is_partly_occluded_is_found_so_and_nothing_else(walk: Walk, symmetric: bool, method: str):
    renderer = Renderer(walk.scene, Settings(24, 18, method=method, threads=1, symmetric=symmetric, depth=0))
    before = None
    for time, camera in walk.frames:
        frame = renderer.render(time, camera)
        work = renderer.work_on(frame)
        before, seen = occlusion_mode(work.words), seen_in(renderer, frame)
        for unit in np.unique(work.units[work.units >= 0]).tolist():
            if before[unit] in (FULLY, DYNAMIC):
                continue
            found = occluded_by(seen, unit, (12, 9))
            assert (found is not None) == (occlusion_mode(frame.modes[unit]) == PARTLY)
            if found is not None:
                x, y = found.pixel
                assert frame.primitive[y, x] == found.primitive
                assert found.at_edge == (work.units[y, x] == unit)
                assert not found.at_edge or x in (0, 23) or y in (0, 17)


def test_the_nearest_place_is_named_and_it_is_one_where_the_kernel_has_tested():
    """A square in front of a wall: beside the square, the wall is found to go on behind it, at the square's edge."""
    wall = [(-9, -9, 0), (9, -9, 0), (0, 18, 0)]
    corners = [wall, *quad((-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1))]
    renderer = Renderer(scene(corners, lights=[(0, 0, 20)]), Settings(64, 48, method="paper", threads=1))
    frame = renderer.render()
    y, x = 24, int(np.flatnonzero(frame.primitive[24] > 0)[0]) - 1
    found = occluded_by(seen_in(renderer, frame), 0, (x, y))
    assert found == OccludedBy((x + 1, y), int(frame.primitive[y, x + 1]))
    far = occluded_by(seen_in(renderer, frame), 0, (1, 24))
    assert far is not None and far.at_edge and far.pixel == (0, 24)
    told = why(renderer, frame, x + 1, y)
    assert told.references[0] == Reference((x, y), 0, tested=True, occluded=True)
    assert told.references[1].tested is False and told.references[1].pixel == (x + 1, y - 1)


# --- the fate of each ray ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def scene_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("why") / "scene.aff"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def room() -> tracer.Scene:
    return loaded(ASSETS / "default.aff")


METHODS = (
    *("none", "cells", "auto", "lightbuffer", "voxels", "lie-exact", "paper+cache", "paper+rest", "certified+cache"),
)


@pytest.mark.parametrize("method", METHODS)
def test_the_fates_of_all_pixels_are_what_the_frame_has_counted(scene_file: Path, method: str):
    """Pixel by pixel, too, and those that the view of fates shows."""
    settings = Settings(16, 12, method=method, threads=1, depth=0, record_work=True, record_fates=True, modes=True)
    renderer = Renderer(load_scene(scene_file), settings)
    for time in (5.0, 5.5, 6.0):
        frame = renderer.render(time)
    shown = [frame.fate(light) for light in range(frame.lights)]
    fates: Counter[Fate] = Counter()
    for x, y in pixels(frame):
        found = why(renderer, frame, x, y)
        assert len(found.reasons) == (frame.lights if found.primitive >= 0 else 0)
        assert sum(one.fate.is_due for one in found.reasons) == frame.due_rays[y, x]
        assert sum(one.fate.is_due and not one.fate.is_traced for one in found.reasons) == frame.saved[y, x]
        fates.update(one.fate for one in found.reasons)
        for one in found.reasons:
            assert one.fate is Fate(int(shown[one.light][y, x])), (x, y, one)
            assert plain(Words(renderer.scene, found).reason(one)).endswith(".")
    shadow = frame.statistics.shadow
    assert sum(number for fate, number in fates.items() if fate.is_traced) == shadow.traced
    counted = {Fate.CULLED: shadow.culled, Fate.DYNAMIC_ONLY: shadow.dynamic_only,
               Fate.CANDIDATES: shadow.candidates_only, Fate.CACHED: shadow.cache_hits}  # fmt: skip
    assert {fate: fates[fate] for fate in counted} == counted
    assert fates[Fate.FACES_AWAY] > 0 and fates[Fate.NONE] == 0


@pytest.mark.parametrize("method", ("none", "paper", "certified"))
def test_of_a_lamps_rays_that_which_asked_most_is_in_the_view_of_fates(scene_file: Path, method: str):
    lamps = {"lamp_radius": 0.3, "lamp_samples": 9}
    settings = Settings(32, 24, method=method, accelerator="kdtree", threads=1, depth=0, record_fates=True, **lamps)
    renderer, met = Renderer(load_scene(scene_file), settings), set()
    for time in (5.0, 5.5, 6.0):
        frame = renderer.render(time)
    assert frame.fates is not None
    for x, y in pixels(frame, 3):
        tree = ray_tree(renderer, frame, x, y)
        if (s := tree.rays[0].shadows) is not None:
            for light in range(frame.lights):
                fates = [s.fate(place) for place in np.arange(len(s.light))[s.of_light(light)]]
                assert max(fates) == frame.fates[y, x, light] & FATE, (x, y, light)
                met |= set(fates)
            for one in why(renderer, frame, x, y).reasons:
                assert one.fate <= max(Fate(int(frame.fate(one.light)[y, x])), Fate.FACES_AWAY)
    assert Fate.FACES_AWAY in met and len(met) > 1
    if method == "certified":
        assert Fate.CULLED in met and Fate.DYNAMIC_ONLY not in met, "nothing is left that a lamp's rays would ask"


def expected(word: np.unsignedinteger, light: int) -> Fate:
    """What the paper's method does by a word of modes, as §2.4 has it."""
    occlusion, shadow = OcclusionMode(int(occlusion_mode(word))), ShadowMode(int(shadow_mode(word, light)))
    if occlusion is not FULLY:
        return {PARTLY: Fate.PARTLY_OCCLUDED, INIT: Fate.NOT_SEEN_WHOLE, DYNAMIC: Fate.DYNAMIC}[occlusion]
    return {
        ShadowMode.INIT: Fate.NOT_SEEN_WHOLE,
        ShadowMode.FULL_SHADOW: Fate.CULLED,
        ShadowMode.NON_SHADOW: Fate.DYNAMIC_ONLY,
        ShadowMode.PARTIAL_SHADOW: Fate.PARTIAL_SHADOW,
    }[shadow]


def test_without_culling_it_is_said_what_the_paper_would_have_done(scene_file: Path):
    plain_one = Renderer(load_scene(scene_file), Settings(24, 18, method="none", threads=1, modes=True))
    paper = Renderer(load_scene(scene_file), Settings(24, 18, method="paper", threads=1))
    for time in (5.0, 5.5, 6.0):
        frame, other = plain_one.render(time), paper.render(time)
    for x, y in pixels(frame, 2):
        there = why(paper, other, x, y).reasons
        for one, decided in zip(why(plain_one, frame, x, y).reasons, there, strict=True):
            assert one.fate in (Fate.TRACED, Fate.FACES_AWAY)
            if one.instead is not None:
                assert one.rule is Rule.OFF and one.instead.rule is decided.rule
    bare = Renderer(load_scene(scene_file), Settings(32, 24, method="none", threads=1))
    found = why(bare, bare.render(5.0), 16, 18)
    assert "Traced: culling is off." in [plain(Words(bare.scene, found).reason(one)) for one in found.reasons]
    assert found.coverage is None and found.references == ()


def test_of_a_picture_that_is_shaded_in_part_the_modes_are_told(room: tracer.Scene):
    """Of pixels that have been shaded they have decided; of the others they say what a ray would meet."""
    renderer = Renderer(room, Settings(96, 64, method="paper", threads=1, depth=1))
    renderer.render(room.frame_time(0))
    kinds: Counter[tuple[bool, Rule]] = Counter()
    for part, (frame, found) in enumerate(_each(renderer, room.frame_time(1))):
        assert (frame.statistics.part < 1.0) == (part < 2)
        for x, y, told in found:
            assert (told.tree is None) == (part < 2)
            for one in told.reasons:
                if part < 2 and one.fate is not Fate.FACES_AWAY:
                    decided = one.instead or one
                    fate = expected(frame.modes_before[frame.primitive[y, x]], one.light)
                    assert decided.fate is fate and (one.instead is None) == (one.rule is not Rule.NOT_SHADED)
                    kinds[one.instead is None, decided.rule] += 1
                    assert plain(Words(room, told).reason(one)).startswith("Not shaded yet") == (
                        one.instead is not None
                    )
    for shaded in (False, True):
        assert {rule for known, rule in kinds if known is shaded} >= {Rule.PARTLY_OCCLUDED, Rule.NON_SHADOW}


def test_too_few_pixels_that_have_taught_are_named(room: tracer.Scene):
    renderer = Renderer(room, Settings(96, 64, method="paper", threads=1, depth=0))
    said = set()
    for frame in renderer.refine(room.frame_time(0), parts=(1, 16)):
        if frame.statistics.part < 1.0:
            for x, y in pixels(frame, 7):
                told = why(renderer, frame, x, y)
                if told.coverage is not None and told.coverage.after is INIT:
                    said.add(plain(Words(room, told).coverage(told.coverage)))
    found = [re.match(r"Covers (\d+) pixels?, of which (\d+) have set its shadow modes so far", text) for text in said]
    assert found and all(one is not None and int(one[2]) < int(one[1]) for one in found)


def _each(renderer: Renderer, time: float):
    """The parts of a picture, each with what is told of some of its pixels while it is the newest."""
    for frame in renderer.refine(time, parts=(1, 4, 16)):
        yield frame, [(x, y, why(renderer, frame, x, y)) for x, y in pixels(frame, 6)]


def test_a_frame_that_is_not_the_last_is_not_explained(scene_file: Path):
    renderer = Renderer(load_scene(scene_file), Settings(16, 12, method="paper", threads=1))
    first = renderer.render(5.0)
    renderer.render(5.5)
    with pytest.raises(LookupError, match="another frame has begun"):
        why(renderer, first, 8, 6)


# --- sentences -----------------------------------------------------------------------------------


def said(room: tracer.Scene, one: Reason, after: OcclusionMode = PARTLY, occluded: OccludedBy | None = None) -> str:
    unit = Coverage(INIT, after, 9, 9, 4.0, False, occluded)
    return plain(Words(room, Why(10, 6, 5, (one,), unit)).reason(one))


def test_the_rules_of_the_paper_in_words(room: tracer.Scene):
    by = OccludedBy((9, 6), 812)
    held = Reason(0, Rule.PARTLY_OCCLUDED, Fate.PARTLY_OCCLUDED, Verdict.TRACED, shadow=ShadowMode.FULL_SHADOW)
    table = named(room, 812)
    trusted = "so its shadow mode is not trusted (§2.4)."
    assert said(room, held, occluded=by) == (
        f"Traced although it has been dark so far: partially occluded by {table} at the pixel on its left (§2.3), "
        f"{trusted}"
    )
    lit = replace(held, shadow=ShadowMode.NON_SHADOW)
    assert said(room, lit, occluded=OccludedBy((0, 6), 5, at_edge=True)) == (
        "Traced although nothing static has blocked it so far: clipped by the screen's edge at pixel (0, 6) (§2.3), "
        f"{trusted}"
    )
    gone = replace(held, shadow=ShadowMode.INIT)
    assert said(room, gone, FULLY) == (
        f"Traced: partially occluded in the frame before (§2.3), {trusted[:-1]}; this frame finds it so no more."
    )
    new = replace(gone, rule=Rule.NOT_SEEN_WHOLE)
    assert said(room, new, occluded=by) == (
        f"Traced: not seen whole before this frame (§2.6), and now partially occluded by {table} at the pixel on its "
        "left (§2.3)."
    )
    assert said(room, new, FULLY) == (
        "Traced: not seen whole before this frame (§2.6), which sees it so: its shadow mode counts from the next one "
        "on (§2.4)."
    )
    taught = TaughtBy(3, "frame 3", lit=False), TaughtBy(12, "frame 12", lit=True)
    partial = Reason(0, Rule.PARTIAL_SHADOW, Fate.PARTIAL_SHADOW, taught=taught)
    assert said(room, partial) == "Traced: PARTIAL_SHADOW since frame 12, in which some of it saw the light (§2.5)."
    culled = Reason(0, Rule.FULL_SHADOW, Fate.CULLED)
    assert said(room, culled) == "Culled: fully rendered, and every shadow ray so far was blocked (§2.4)."
    asks = Reason(0, Rule.NON_SHADOW, Fate.DYNAMIC_ONLY, dynamic_objects=5)
    assert said(room, asks) == "Asks the 5 dynamic objects only: nothing static has ever blocked it (§2.4)."
    assert said(room, Reason(0, Rule.DYNAMIC, Fate.DYNAMIC)) == "Traced: dynamic, never culled (§2.2)."
    assert said(room, Reason(0, Rule.FACES_AWAY, Fate.FACES_AWAY)) == "Faces away from this light."
    off = Reason(0, Rule.OFF, Fate.TRACED, instead=culled)
    assert said(room, off) == (
        "Traced: culling is off. The paper's method would have culled it: fully rendered, and every shadow ray so far "
        "was blocked (§2.4)."
    )
    assert said(room, replace(off, instead=asks)) == (
        "Traced: culling is off. The paper's method would have tested it against dynamic objects only: nothing static "
        "has ever blocked it (§2.4)."
    )


def test_links_lead_to_what_is_named(room: tracer.Scene):
    by = OccludedBy((9, 6), 812)
    one = Reason(0, Rule.PARTLY_OCCLUDED, Fate.PARTLY_OCCLUDED, shadow=ShadowMode.FULL_SHADOW)
    found = Why(10, 6, 5, (one,), Coverage(INIT, PARTLY, 9, 9, 4.0, False, by))
    links = [part for part in Words(room, found).reason(one) if isinstance(part, Link)]
    assert [(link.primitive, link.pixel, link.section) for link in links] == [
        (812, None, ""), (None, (9, 6), ""), (None, None, "2.3"), (None, None, "2.4"),
    ]  # fmt: skip
    partial = Reason(0, Rule.PARTIAL_SHADOW, Fate.PARTIAL_SHADOW, taught=(TaughtBy(12, "frame 12", lit=True),))
    frame, _ = [part for part in Words(room, Why(1, 1, 5, ())).reason(partial) if isinstance(part, Link)]
    assert frame.frame == 12 and frame.text == "frame 12"


def test_how_a_primitive_stands_in_words(room: tracer.Scene):
    words = Words(room, Why(10, 6, 5, ()))
    far = Coverage(FULLY, FULLY, 812, 240, 4.0, False, taught=TaughtBy(7, "frame 7"))
    assert plain(words.coverage(far)) == (
        "Covers 812 pixels, 3.4 × the 240 when it was last examined; examined anew above 4 × (§2.6). "
        "Fully rendered since frame 7."
    )
    assert plain(words.coverage(Coverage(FULLY, INIT, 1000, 1000, 4.0, False))) == (
        "Covers 1,000 pixels, more than 4 times as many as when it was last examined: it is examined anew (§2.6)."
    )
    hidden = Coverage(PARTLY, PARTLY, 1, 0, 4.0, True, OccludedBy((10, 7), 812))
    assert plain(words.coverage(hidden)) == (
        f"Its cell covers 1 pixel. Not fully rendered: partially occluded by {named(room, 812)} at the pixel below it "
        "(§2.3)."
    )
    assert "has no modes" in plain(words.coverage(Coverage(DYNAMIC, DYNAMIC, 9, 0, 4.0, False)))


def test_what_is_in_a_lights_way_in_words(room: tracer.Scene):
    words = Words(room, Why(10, 6, 5, ()))
    dark = Reason(0, Rule.FULL_SHADOW, Fate.CULLED, Verdict.FULL_SHADOW, blocker=812)
    assert plain(words.answer(dark)) == f"In shadow: blocked by {named(room, 812)}."
    assert plain(words.answer(replace(dark, blocker=5))).startswith("In shadow: its own surface is in the way")
    assert plain(words.answer(replace(dark, wrong=1, blocker=-1))) == (
        "In shadow in the picture, which is wrong: nothing is in its way."
    )
    assert plain(words.answer(replace(dark, lit=3, rays=12, samples=16))) == (
        "In the penumbra: 3 of 12 samples reach it."
    )


@pytest.mark.parametrize("name", ["figure3", "figure4"])
def test_the_papers_figures_explain_themselves(name: str):
    drawn = load_scene(ASSETS / f"{name}.aff")
    renderer = Renderer(drawn, Settings(96, 64, method="paper", threads=1))
    for i in range(3):
        frame = renderer.render(drawn.frame_time(i))
    sentences: Counter[str] = Counter()
    for x, y in pixels(frame, 6):
        found = why(renderer, frame, x, y)
        words = Words(drawn, found)
        sentences.update(plain(words.reason(one)) for one in found.reasons)
        if found.coverage is not None:
            sentences[plain(words.coverage(found.coverage))] += 1
    text = "\n".join(sentences)
    if name == "figure3":
        assert "partially occluded by figure3 (triangle" in text and "clipped by the screen's edge" in text
    assert "Asks nothing, as nothing moves: nothing static has ever blocked it (§2.4)." in sentences
    assert "; examined anew above 4 × (§2.6)" in text


def test_what_moves_and_what_it_darkens():
    """A square hangs over a floor of small squares: those below it are NON_SHADOW and darkened by it."""
    x = np.linspace(-2.0, 2.0, 9)
    cells = [(a, b, c, d) for a, b in pairwise(x) for c, d in pairwise(x)]
    floor = [t for a, b, c, d in cells for t in quad((a, 0, c), (b, 0, c), (b, 0, d), (a, 0, d))]
    lifted = np.eye(4)
    lifted[1, 3] = 1.0
    square = moved("kite", quad((-0.6, 0, -0.6), (0.6, 0, -0.6), (0.6, 0, 0.6), (-0.6, 0, 0.6)), lifted)
    camera = Camera((0.0, 6.0, 6.0), (0.0, -1.0, -1.0), angle=60.0)
    made = scene(floor, dynamic=(square,), lights=[(0.0, 9.0, 0.5)], camera=camera)
    renderer = Renderer(made, Settings(96, 64, method="paper", threads=1))
    renderer.render()
    frame, sentences = renderer.render(), set()
    for x_, y in pixels(frame, 5):
        found = why(renderer, frame, x_, y)
        words = Words(made, found)
        sentences |= {(plain(words.reason(one)), plain(words.answer(one))) for one in found.reasons}
    asks = "Asks the dynamic object only: nothing static has ever blocked it (§2.4)."
    assert (asks, "Lit.") in sentences and ("Traced: dynamic, never culled (§2.2).", "Lit.") in sentences
    assert any(
        reason == asks and answer.startswith("In shadow: blocked by kite (triangle") for reason, answer in sentences
    )


def test_what_is_examined_anew_as_it_has_grown_was_seen_whole_before():
    """A triangle that the camera comes nearer to, by the zoom rule (§2.6)."""
    made = scene([[(-4, -4, 0), (4, -4, 0), (0, 4, 0)]], lights=[(0.0, 0.0, 99.0)])
    renderer = Renderer(made, Settings(96, 64, method="paper", threads=1, depth=0))
    said = []
    for distance in (80.0, 80.0, 16.0, 16.0, 16.0):
        frame = renderer.render(0.0, Camera((0.0, 0.0, distance), (0.0, 0.0, -1.0), angle=60.0))
        found = why(renderer, frame, 47, 31)
        said.append((found.reasons[0].rule, plain(Words(made, found).reason(found.reasons[0]))))
    asks = (Rule.NON_SHADOW, "Asks nothing, as nothing moves: nothing static has ever blocked it (§2.4).")
    sees = "which sees it so: its shadow mode counts from the next one on (§2.4)."
    assert said == [
        (Rule.NOT_SEEN_WHOLE, f"Traced: not seen whole before this frame (§2.6), {sees}"),
        asks,
        asks,
        (
            Rule.EXAMINED_ANEW,
            "Traced although nothing static has blocked it so far: examined anew, and not seen whole again before this "
            f"frame (§2.6), {sees}",
        ),
        asks,
    ]


def test_lights_past_the_thirty_first_have_no_modes():
    lights = [(0.1 * i, 0.0, 9.0) for i in range(33)]
    made = scene(quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), lights=lights)
    renderer = Renderer(made, Settings(32, 24, method="paper", threads=1))
    renderer.render()
    found = why(renderer, renderer.render(), 16, 12)
    past = [one for one in found.reasons if one.rule is Rule.NO_ROOM]
    assert [one.light for one in past] == [31, 32] and all(one.fate is Fate.TRACED for one in past)
    text = plain(Words(made, found).reason(past[0]))
    assert text == "Traced: modes have room for 31 lights, and this one is past them (§2.2)."

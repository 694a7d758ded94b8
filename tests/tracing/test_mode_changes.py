"""What frames change of modes, against a count one by one, over walks through random worlds and towards a primitive."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.shades import shadow_scene
from tracer.culling import mode_changes as counting
from tracer.culling.mode_changes import ModeChanges, mode_changes
from tracer.culling.modes import MAX_CULLED_LIGHTS, OcclusionMode, ShadowMode, occlusion_mode, shadow_mode
from tracer.scene.model import Camera

FIGURE_4 = Path(__file__).resolve().parents[2] / "assets" / "scenes" / "figure4.aff"
SETTINGS = tracer.Settings(width=40, height=32, depth=1)


def by_one(before: np.ndarray, after: np.ndarray) -> ModeChanges:
    """The same, mode by mode."""
    old, new = occlusion_mode(before), occlusion_mode(after)
    changes = ModeChanges(
        fully_rendered=int(((new == OcclusionMode.FULLY_RENDERED) & (old != OcclusionMode.FULLY_RENDERED)).sum()),
        examined_anew=int(((new == OcclusionMode.INIT) & (old == OcclusionMode.FULLY_RENDERED)).sum()),
        partially_occluded=int(((new == OcclusionMode.PARTIALLY_OCCLUDED) & (old == OcclusionMode.INIT)).sum()),
        units={mode.name.lower(): int((new == mode).sum()) for mode in OcclusionMode},
        shadow_modes={"full_shadow": 0, "non_shadow": 0, "partial_shadow": 0},
    )
    for light in range(min(MAX_CULLED_LIGHTS, 4 * after.itemsize - 1)):
        was, now = shadow_mode(before, light), shadow_mode(after, light)
        changes.full_shadow += int(((was == ShadowMode.INIT) & (now == ShadowMode.FULL_SHADOW)).sum())
        changes.non_shadow += int(((was == ShadowMode.INIT) & (now == ShadowMode.NON_SHADOW)).sum())
        changes.partial_shadow += int(((was != now) & (now == ShadowMode.PARTIAL_SHADOW)).sum())
        for mode in list(ShadowMode)[1:]:
            changes.shadow_modes[mode.name.lower()] += int((now == mode).sum())
    return changes


@quickly(20)
@given(st.integers(0, 300), st.sampled_from([np.uint32, np.uint64]), st.integers(0, 2**32 - 1))
def test_random_words_are_counted_alike_by_any_number_of_threads(count, word, seed):
    rng = np.random.default_rng(seed)
    highest = np.iinfo(word).max
    before, gained = (rng.integers(0, highest, count, word, endpoint=True) for _ in range(2))
    before &= rng.choice(np.array([0, 3, highest], word), count)
    after = before | (gained & ~word(3) & rng.choice(np.array([0, highest], word), count))
    after = (after & ~word(3)) | rng.integers(0, 4, count).astype(word)
    expected = by_one(before, after)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(counting, "CHUNK", 64)  # so that threads share the work
        for threads in (1, 2, 3):
            assert mode_changes(before, after, threads) == expected


@quickly(4)
@given(walks(lights=3), st.sampled_from(["paper", "cells", "paper+rest", "none"]), st.sampled_from([1, 2, 3]))
def test_frames_say_how_their_modes_changed(walk: Walk, method: str, threads: int):
    renderer = tracer.Renderer(walk.scene, replace(SETTINGS, method=method, modes=True, threads=threads))
    for time, camera in walk.frames:
        for frame in renderer.refine(time, camera, parts=(1, 8, 16)):
            assert frame.statistics.mode_changes == by_one(frame.modes_before, frame.modes)


def test_a_first_frame_teaches_and_a_second_of_the_same_changes_nothing():
    renderer = tracer.Renderer(shadow_scene(), SETTINGS)
    first, second = renderer.render().statistics.mode_changes, renderer.render().statistics.mode_changes
    assert first is not None and second is not None
    assert first.fully_rendered == first.units["fully_rendered"] > 0
    assert first.full_shadow == first.shadow_modes["full_shadow"] > 0
    assert first.gained > 0 and first.examined_anew == first.partially_occluded == 0
    assert second == ModeChanges(units=first.units, shadow_modes=first.shadow_modes)


def test_what_the_screen_cuts_off_becomes_partially_occluded_once():
    renderer, close = tracer.Renderer(shadow_scene(), SETTINGS), Camera((0.0, 0.0, 3.0), (0.0, 0.0, -1.0), angle=60.0)
    first, second = (renderer.render(camera=close).statistics.mode_changes for _ in range(2))
    assert first.partially_occluded == first.units["partially_occluded"] > 0
    assert second.partially_occluded == 0 and second.units == first.units


def test_a_picture_that_is_left_says_what_its_part_has_taught():
    """The whole one, refined from it, says at least that; the next one begins with what was known when it was left."""
    renderer = tracer.Renderer(shadow_scene(), replace(SETTINGS, width=128, height=96))
    frames = renderer.refine(parts=(1, 16))
    part = next(frames)
    frames.close()
    assert 0 < part.statistics.part < 1.0 and part.statistics.mode_changes.gained > 0
    whole = renderer.render()
    assert np.array_equal(whole.modes_before, part.modes)
    known = part.statistics.mode_changes.shadow_modes["non_shadow"]
    changes = whole.statistics.mode_changes
    assert changes.shadow_modes["non_shadow"] == known + changes.non_shadow - _became_partial(
        part.modes, whole.modes, 2
    )


def _became_partial(before: np.ndarray, after: np.ndarray, was: int) -> int:
    return int(((shadow_mode(before, 0) == was) & (shadow_mode(after, 0) == ShadowMode.PARTIAL_SHADOW)).sum())


def test_figure_4_examines_primitives_anew():
    """The camera comes nearer: what covers many more pixels than before is INIT again, and seen whole a frame later."""
    world = tracer.load_scene(FIGURE_4)
    renderer = tracer.Renderer(world, replace(SETTINGS, width=96, height=96, zoom_factor=2.0))
    anew, whole = [], []
    for number in range(0, world.frames, 4):
        frame = renderer.render(world.frame_time(number))
        changes = frame.statistics.mode_changes
        assert changes == by_one(frame.modes_before, frame.modes)
        anew.append(changes.examined_anew)
        whole.append(changes.fully_rendered)
    assert sum(anew) > 0
    assert all(later > 0 for now, later in zip(anew[:-1], whole[1:], strict=True) if now)


def test_without_modes_nothing_is_said():
    frame = tracer.Renderer(shadow_scene(), replace(SETTINGS, method="none")).render()
    assert frame.statistics.mode_changes is None

"""Whole frames of random scenes, one after the other, against the naive twin of a frame."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import ACCELERATORS, crossed
from tests.tracing.naive_frame import NaiveFrame, NaiveRenderer
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.same import assert_verified
from tracer.culling import cells


@pytest.fixture(autouse=True)
def few_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many as a twin can count, and some of them larger than a pixel."""
    monkeypatch.setattr(cells, "AIM", 150)


def assert_same(frame: tracer.Frame, twin: NaiveFrame) -> None:
    """Primitives, answers, words, counts and counters exactly; colours as near as float32 goes."""
    assert np.array_equal(frame.primitive, twin.primitive)
    assert np.array_equal(frame.cell, twin.cell)
    shadow, statistics = frame.statistics.shadow, frame.statistics
    counted = {name: getattr(shadow, name) for name in ("rays", "due", "culled", "dynamic_only", "wrong")}
    counted |= {"primary": statistics.primary.rays, "secondary": statistics.secondary.rays}
    counted |= {"occlusion_tests": statistics.occlusion_tests}
    assert counted == {name: twin.counts[name] for name in counted}
    for name in ("due", "lit", "wrong"):
        assert np.array_equal(getattr(frame, name), getattr(twin, name)), name
    assert frame.modes.tolist() == twin.words
    assert frame.pixel_count.tolist() == twin.pixel_count
    assert frame.highest_count.tolist() == twin.highest_count
    assert np.allclose(frame.color, twin.color, rtol=2e-3, atol=2e-4)
    assert np.allclose(frame.reference, twin.reference, rtol=2e-3, atol=2e-4)


SHADOW_TESTED = {"rays", "due", "primary", "secondary"}
CULLED = {"culled", "dynamic_only", "wrong", "occlusion_tests"}


@pytest.mark.parametrize(
    "lights, method, examples, counted",
    [
        (3, "none", 4, SHADOW_TESTED),
        (3, "cells", 5, SHADOW_TESTED | CULLED),
        (17, "cells", 3, SHADOW_TESTED | CULLED),  # words of 64 bits
    ],
)
def test_frames_of_random_scenes_are_what_the_naive_twin_says(
    lights: int, method: str, examples: int, counted: set[str]
):
    """Moving cameras, lights and objects; modes from frame to frame.  `paper` is held against `tracer.reference`."""
    seen: Counter[str] = Counter()

    @quickly(examples)
    @given(walks(lights), st.booleans(), st.sampled_from([1.0, 2.0, 4.0]), st.integers(0, 3))
    def check(walk: Walk, symmetric: bool, zoom_factor: float, depth: int) -> None:
        height = 14 if lights < 10 else 8
        settings = tracer.Settings(
            34, height, depth, method, symmetric, zoom_factor, verify=True, threads=2, record_lights=True
        )
        if method == "cells":  # whose weights of corners are the twin's to the last bit
            settings = replace(settings, accelerator="kdtree")
        renderer, twin = tracer.Renderer(walk.scene, settings), NaiveRenderer(walk.scene, settings)
        for time, camera in walk.frames:
            frame, expected = renderer.render(time, camera), twin.render(time, camera)
            assert_same(frame, expected)
            seen.update(expected.counts)

    check()
    assert set(+seen) == counted  # none of them was never anything but 0


@pytest.mark.parametrize("method", ["paper", "cells"])
def test_frames_that_are_left_teach_what_the_naive_twin_says(method: str):
    """Whole frames and some that are left with a part of their pixels shaded, in any order."""
    seen: Counter[str] = Counter()

    @quickly(8)
    @given(walks(2), st.lists(st.sampled_from([0, 1, 2, 3]), min_size=8, max_size=8), st.integers(0, 2))
    def check(walk: Walk, shown: list[int], depth: int) -> None:
        settings = tracer.Settings(34, 14, depth, method, verify=True, threads=2, accelerator="kdtree")
        renderer, twin = tracer.Renderer(walk.scene, settings), NaiveRenderer(walk.scene, settings)
        for (time, camera), count in zip(2 * walk.frames, shown, strict=False):
            if count == 0:
                frame = renderer.render(time, camera)
            else:
                refining = renderer.refine(time, camera, parts=(2, 6, 12, 16))
                for _ in range(count):
                    frame = next(refining)
                refining.close()
            expected = twin.render(time, camera, frame.shaded)
            assert frame.modes.tolist() == expected.words
            assert frame.highest_count.tolist() == expected.highest_count
            shadow = frame.statistics.shadow
            assert [shadow.due, shadow.culled, shadow.dynamic_only] == [
                expected.counts[name] for name in ("due", "culled", "dynamic_only")
            ]
            seen.update(expected.counts if count else ())

    check()
    assert seen["culled"] and seen["dynamic_only"], "no frame that was left has culled: this shows nothing"


@pytest.mark.parametrize(("method", "accelerator"), crossed(["paper", "cells"], ACCELERATORS))
def test_the_reference_of_random_scenes_is_the_picture_without_culling(method: str, accelerator: str):
    wrong = 0

    @quickly(15)
    @given(walks(), st.integers(0, 4))
    def check(walk: Walk, depth: int) -> None:
        nonlocal wrong
        settings = {"width": 48, "height": 40, "depth": depth, "threads": 2, "verify": True}
        settings["accelerator"] = accelerator
        culling, none = (tracer.Renderer(walk.scene, tracer.Settings(method=m, **settings)) for m in (method, "none"))
        for time, camera in walk.frames:
            frame = culling.render(time, camera)
            assert_verified(frame, none.render(time, camera))
            wrong += int(frame.wrong.sum())

    check()
    assert wrong > 0, "nothing was wrong: this shows nothing"

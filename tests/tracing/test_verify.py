"""What verifying tells: the picture with every answer right, and where answers were wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.scenes import loaded, world_of
from tests.sweeps import ACCELERATORS, cases, crossed
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.same import assert_verified
from tracer.statistics import FrameStatistics

SCENES = Path(__file__).resolve().parents[2] / "assets" / "scenes"
SETTINGS = tracer.Settings(width=96, height=96, depth=10, verify=True)


@pytest.mark.parametrize("accelerator", cases(["bvh8"], ACCELERATORS))
def test_the_reference_of_kitchen_is_the_picture_without_culling(bart: Path, accelerator: str):
    world = world_of(bart / "kitchen" / "kitchen.aff", accelerator)
    scene = world.scene
    settings = replace(SETTINGS, width=72, height=72, accelerator=accelerator)
    paper = tracer.Renderer(scene, settings, world=world)
    none = tracer.Renderer(scene, replace(settings, method="none"), world=world)
    wrong = 0
    for number in range(395, cases(398, 405)):
        time = scene.frame_time(number)
        frame = paper.render(time)
        assert_verified(frame, none.render(time))
        wrong += frame.statistics.shadow.wrong
    assert wrong > 0, "nothing was wrong: this shows nothing"
    assert (frame.color != frame.reference).any()


@pytest.mark.parametrize(("method", "accelerator"), crossed(["paper", "cells"], ACCELERATORS))
def test_the_reference_of_random_scenes_is_the_picture_without_culling(method: str, accelerator: str):
    """And without bounces it is known which answers are wrong."""
    wrong = 0

    @quickly(5)
    @given(walks(), st.integers(0, 4))
    def check(walk: Walk, depth: int) -> None:
        nonlocal wrong
        settings = replace(
            SETTINGS, width=40, height=32, depth=depth, threads=2, accelerator=accelerator, record_lights=True
        )
        culling, none = (tracer.Renderer(walk.scene, replace(settings, method=name)) for name in (method, "none"))
        for time, camera in walk.frames:
            frame, expected = culling.render(time, camera), none.render(time, camera)
            assert_verified(frame, expected)
            assert np.array_equal(frame.due, expected.due)
            if depth == 0:
                assert np.array_equal(frame.wrong, (frame.lit != expected.lit).sum(axis=-1))
            wrong += int(frame.wrong.sum())

    check()
    assert wrong > 0, "nothing was wrong: this shows nothing"


@pytest.mark.parametrize("method", ["none", "paper", "certified+cache"])
def test_the_work_at_pixels_adds_up_to_that_of_the_frame(method: str):
    scene = loaded(SCENES / "default.aff")
    renderer = tracer.Renderer(scene, tracer.Settings(width=96, height=64, depth=3, method=method, record_work=True))
    for number in range(20, 24):
        frame = renderer.render(scene.frame_time(number))
    shadow = frame.statistics.shadow
    assert frame.due_rays.sum() == shadow.due and (frame.saved <= frame.due_rays).all()
    spared = shadow.culled + shadow.dynamic_only + shadow.candidates_only + shadow.cache_hits
    assert frame.saved.sum() == spared and (spared > 0) == (method != "none")
    rays = frame.statistics.primary.rays + frame.statistics.secondary.rays
    assert frame.cost.sum() == rays + shadow.traced, (
        "a traced ray asks the whole scene: no ray to dynamic objects alone"
    )


def test_what_is_wrong_is_counted_in_all_samples_and_is_what_pixels_show():
    scene = loaded(SCENES / "default.aff")
    one, four = (tracer.Renderer(scene, replace(SETTINGS, samples=samples)) for samples in (1, 4))
    for number in range(20, 23):
        first, all_samples = (renderer.render(scene.frame_time(number)) for renderer in (one, four))
    for frame, samples in ((first, 1), (all_samples, 4)):
        found = frame.statistics.wrong
        assert found.answers == frame.wrong.sum() and found.pixels == (frame.wrong > 0).sum() > 0
        assert (found.samples, found.shaded) == (samples, frame.wrong.size)
    shadow = first.statistics.shadow
    found = first.statistics.wrong
    assert (found.answers, found.due, found.untraced) == (shadow.wrong, shadow.due, shadow.saved)
    more, counted = all_samples.statistics.wrong, all_samples.statistics.shadow
    assert counted.wrong == shadow.wrong < more.answers and 3.9 * counted.due < more.due < 4.1 * counted.due
    assert more.untraced < more.due


def test_samples_that_are_added_later_count_what_is_wrong_as_those_at_once():
    scene = loaded(SCENES / "default.aff")
    renderer, whole = (tracer.Renderer(scene, replace(SETTINGS, samples=samples)) for samples in (1, 3))
    for number in range(20, 22):
        *_, refined = renderer.refine(scene.frame_time(number), parts=(2, 16), samples=3)
        expected = whole.render(scene.frame_time(number))
    assert refined.statistics.wrong == expected.statistics.wrong and refined.statistics.wrong.answers > 0


def test_of_a_picture_in_part_what_is_wrong_is_of_the_pixels_that_are_shaded():
    scene = loaded(SCENES / "default.aff")
    renderer = tracer.Renderer(scene, SETTINGS)
    renderer.render(scene.frame_time(20))
    partly, whole = renderer.refine(scene.frame_time(21), parts=(2, 16))
    found = partly.statistics.wrong
    assert found.shaded == partly.shaded.sum() < partly.wrong.size / 6 and whole.shaded is None
    assert not partly.wrong[~partly.shaded].any() and found.pixels == (partly.wrong > 0).sum()
    assert 0 < found.due < whole.statistics.wrong.due


def test_modes_that_are_only_looked_at_cost_a_method_no_tests_and_no_time():
    scene, ticks = loaded(SCENES / "default.aff"), iter(range(1_000_000))

    def second_frame(method: str) -> FrameStatistics:
        settings = replace(SETTINGS, method=method, modes=True, verify=False)
        renderer = tracer.Renderer(scene, settings, clock=lambda: float(next(ticks)))
        return [renderer.render(scene.frame_time(n)) for n in (20, 21)][-1].statistics

    none, paper = second_frame("none"), second_frame("paper")
    assert none.by_modes and none.occlusion_tests == 0 < paper.occlusion_tests
    looked_at = none.phases["occlusion testing"] + none.phases["mode setting"]
    assert looked_at > 0 and paper.seconds - none.seconds == looked_at

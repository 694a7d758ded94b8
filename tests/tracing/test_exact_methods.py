"""Exact methods show the picture of `none`, bit for bit, in nasty worlds, and the same on any number of threads."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.sweeps import ACCELERATORS, EVERY_ACCELERATOR, cases
from tests.tracing.nasty_worlds import NastyWalk, flattened_walk, nasty_walk, with_lamps
from tests.tracing.same import assert_same
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.geometry.accelerators import BVH8
from tracer.neighbours.certified.cost_model import CostModel

# Small pictures are to have many certificates on either structure, and to test candidates.
EAGER = CostModel(2, 4, 3, 48, True, 1)
SETTINGS = tracer.Settings(width=36, height=28, depth=2, threads=1, light_buffer_side=64)
COUNTED = ("due", "culled", "dynamic_only", "candidates_only", "passed_over", "cache_hits")
Seen = dict[str, Counter[str]]


def compare(walks: Iterable[NastyWalk], methods: Callable[[int], Iterable[str]], settings: tracer.Settings) -> Seen:
    """Hold methods, by number of the walk, against `none`, frame by frame; what their frames counted, by each part
    of a method's name.

    Every third walk is verified and its lights recorded: then none is passed over unseen."""
    seen: Seen = {}
    for number, walk in enumerate(walks):
        recorded = number % 3 == 2
        settings = replace(settings, record_lights=recorded, verify=recorded)
        world = tracer.World(walk.scene, walk.scene.time_range[0], settings.accelerator)
        none = tracer.Renderer(walk.scene, replace(settings, method="none", verify=False), world=world)
        expected = [none.render(*at) for at in walk.frames]
        for k, method in enumerate(methods(number)):
            chosen = replace(settings, method=method, threads=1 + k % 3)
            renderer = tracer.Renderer(walk.scene, chosen, world=world, cost_model=EAGER)
            parts = [seen.setdefault(part, Counter()) for part in method.split("+")]
            for (time, camera), right in zip(walk.frames, expected, strict=True):
                frame = renderer.render(time, camera)
                where = f"{method} on {settings.accelerator} at {time} in the walk of seed {walk.seed}"
                for name in ("color", "asked", "reached") if recorded else ("color",):
                    assert getattr(frame, name).tobytes() == getattr(right, name).tobytes(), f"{name} by {where}"
                shadow = frame.statistics.shadow
                assert shadow.wrong == 0, where
                for count in parts:
                    count.update({name: getattr(shadow, name) for name in COUNTED})
    return seen


def every(methods: tuple[str, ...], apart: int) -> Callable[[int], tuple[str, ...]]:
    """Some methods for each walk, so that each method has its turn after so many walks."""
    return lambda number: methods[number % apart :: apart]


METHODS = (
    *("certified", "voxels", "lie-exact", "lightbuffer", "free", "certified+cache", "voxels+rest"),
    *("lie-exact+rest", "certified+lightbuffer", "certified+voxels", "certified+lie-exact", "lie-exact+cache"),
    *("certified+rest", "voxels+cache", "auto"),
)


@pytest.mark.parametrize("accelerator", EVERY_ACCELERATOR)
def test_lights_that_jump_and_objects_that_drift_stop_and_rest(accelerator: str) -> None:
    """By every method; each structure has walks of its own, as what is proved of a walk is by the same code."""
    first, count = cases((15, 15) if accelerator == BVH8 else (0, 15 if accelerator in ACCELERATORS else 5), (0, 400))
    walks = (nasty_walk(seed, frames=4) for seed in range(first, first + count))
    seen = compare(walks, every(METHODS, 5), replace(SETTINGS, accelerator=accelerator))
    assert set(seen) == {part for method in METHODS for part in method.split("+")}
    if count > 5:
        for method, told in {
            "certified": ("culled", "dynamic_only", "candidates_only"),
            "voxels": ("culled", "dynamic_only", "candidates_only"),
            "lie-exact": ("culled", "candidates_only"),
            "lightbuffer": ("culled", "dynamic_only"),
            "cache": ("cache_hits",),
            "free": ("culled",),
        }.items():
            assert min(seen[method][name] for name in told) > 50, (method, seen[method])


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_what_rests_flattened_or_stretched(accelerator: str) -> None:
    """Of seeds 6, 7, 12 and 18 pictures were wrong, on the kd-tree, to whose objects rays are transformed."""
    walks = (flattened_walk(seed) for seed in cases((6, 7, 12, 18, 0), range(200)))
    methods = every(("certified", "voxels+rest", "certified", "lie-exact+rest"), 2)
    seen = compare(walks, methods, replace(SETTINGS, accelerator=accelerator))
    certain = accelerator == "bvh8"  # in the kd-tree, most of it is taken to move
    told = ("dynamic_only", "culled", "candidates_only") if certain else ("due",)
    assert min(seen["certified"][name] for name in told) > 500, seen


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_lamps(accelerator: str) -> None:
    walks = (with_lamps(nasty_walk(seed, frames=4)) for seed in range(200, cases(208, 240)))
    methods = every(("certified", "voxels", "lie-exact", "auto", "free", "certified+cache"), 3)
    seen = compare(walks, methods, replace(SETTINGS, accelerator=accelerator))
    assert min(seen["certified"][name] for name in ("culled", "dynamic_only")) > 1000, seen


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_more_lights_and_lamps_than_words_have_room_for(accelerator: str) -> None:
    walks = [nasty_walk(seed, lights=MAX_CULLED_LIGHTS + 5, frames=2) for seed in range(4, cases(6, 60))]
    walks += [with_lamps(walk) for walk in walks[: cases(1, 2)]]
    methods = every(("certified", "lie-exact", "voxels", "certified+lie-exact"), 2)
    settings = replace(SETTINGS, width=26, height=20, accelerator=accelerator, lamp_samples=20)
    seen = compare(walks, methods, settings)
    assert min(seen[method]["passed_over"] for method in ("certified", "lie-exact")) > 100, seen
    assert seen["certified"]["culled"] > 1000, "samples that recent occluders hide"


EXACT = ("none+cache", "certified", "certified+cache", "voxels", "lie-exact", "lightbuffer", "free")


@pytest.mark.parametrize("method", [*EXACT, "paper+cache", "paper+rest", "cells"])
def test_frames_are_the_same_on_any_number_of_threads(method: str) -> None:
    """Of several tiles; beside an exact method, modes are those beside `none`."""
    settings = replace(SETTINGS, width=66, height=66, method=method, modes=True, verify=True, record_lights=True)
    for walk in (nasty_walk(4, frames=2), with_lamps(nasty_walk(5, lights=MAX_CULLED_LIGHTS + 2, frames=2))):
        one, three = (
            tracer.Renderer(walk.scene, replace(settings, threads=threads), cost_model=EAGER) for threads in (1, 3)
        )
        resting = "none" if method in ("none+cache", "voxels", "lie-exact", "free") else "none+rest"
        none = tracer.Renderer(walk.scene, replace(settings, method=resting, threads=2, verify=False))
        for time, camera in walk.frames:
            frame, plain = one.render(time, camera), none.render(time, camera)
            assert_same(frame, three.render(time, camera), f"of {walk} at {time}")
            assert frame.reference.tobytes() == plain.color.tobytes()
            assert method not in EXACT or np.array_equal(frame.modes, plain.modes)

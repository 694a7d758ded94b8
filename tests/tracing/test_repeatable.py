"""The same bits for every number of threads and on every run: whole frames of the BART scenes."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import pytest

import tracer
from tests.scenes import world_of
from tests.sweeps import ACCELERATORS, cases, crossed
from tests.tracing.same import assert_same


@lru_cache(2)
def worlds(path: Path, accelerator: str) -> tuple[tracer.World, tracer.World]:
    """Of a scene, and of the same scene loaded anew."""
    return world_of(path, accelerator), tracer.World(loaded_anew(path), accelerator=accelerator)


@lru_cache(1)
def loaded_anew(path: Path) -> tracer.Scene:
    return tracer.load_scene(path)


def render(world: tracer.World, settings: tracer.Settings, first: int, count: int) -> list[tracer.Frame]:
    scene = world.scene
    renderer = tracer.Renderer(scene, settings, world=world)
    return [renderer.render(scene.frame_time(number)) for number in range(first, first + count)]


WALKS = (
    ("museum/museum5.aff", 0, 2, 80, "paper+cache", True),
    ("kitchen/kitchen.aff", 395, cases(2, 10), cases(80, 320), "paper", False),
    *cases((), [("robot/Robot.aff", 0, 3, 96, method, True) for method in ("cells", "paper", "paper+cache")]),
)


@pytest.mark.parametrize(
    ("name", "first", "count", "size", "method", "symmetric", "accelerator"),
    [(*walk, accelerator) for walk, accelerator in crossed(WALKS, ACCELERATORS)],
)
def test_frames_are_the_same_for_any_number_of_threads_and_on_every_run(
    bart: Path, name: str, first: int, count: int, size: int, method: str, symmetric: bool, accelerator: str
):
    """Along the scene's own path: pictures, reference pictures, modes, counts and counters, bit for bit."""
    world, anew = worlds(bart / name, accelerator)
    runs = {}
    for run, on, threads in (("1 thread", world, 1), ("2", world, 2), ("4", world, 4), ("2, loaded anew", anew, 2)):
        settings = tracer.Settings(size, size, 10, method, symmetric, verify=True, threads=threads, record_lights=True)
        runs[run] = render(on, settings, first, count)
    expected = runs.pop("1 thread")
    for run, frames in runs.items():
        for number, (one, other) in enumerate(zip(expected, frames, strict=True), first):
            assert_same(one, other, f"of frame {number} on {run} threads")
    # Frames that differ from each other, of which culling left out something.
    assert all((a.primitive != b.primitive).any() for a, b in pairwise(expected))
    assert all(frame.statistics.shadow.culled > 0 for frame in expected[1:])

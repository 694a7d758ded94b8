"""Pictures of method "certified" are those of "none", bit for bit: nasty scenes, and frames along real paths."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import tracer
from tests.scenes import loaded, world_of
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.nasty_worlds import nasty_walk
from tracer.neighbours.certified.cost_model import CostModel

SCENES = Path(__file__).resolve().parents[2] / "assets" / "scenes"
# Small pictures are to have many certificates on either structure, and to test candidates.
EAGER = CostModel(2, 4, 3, 48, True, 1)


def _renderers(
    scene: tracer.Scene, method: str = "certified", cost_model: CostModel = EAGER, **settings: Any
) -> tuple[tracer.Renderer, tracer.Renderer]:
    """One that culls nothing and one that goes by certificates, of one world."""
    accelerator = settings.get("accelerator", "bvh8")
    world = tracer.World(scene, scene.time_range[0], accelerator)
    none, certified = (tracer.Settings(method=name, **settings) for name in ("none", method))
    return tracer.Renderer(scene, none, world=world), tracer.Renderer(
        scene, certified, world=world, cost_model=cost_model
    )


def _count(seen: Counter[str], frame: tracer.Frame) -> None:
    shadow = frame.statistics.shadow
    seen.update({name: getattr(shadow, name) for name in ("due", "culled", "dynamic_only", "candidates_only")})
    seen["certificates"] += frame.statistics.certificates


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_pictures_stay_right_while_lights_are_dragged(accelerator: str):
    """In each frame another light is somewhere else, and then back where it was."""
    for seed in range(100, cases(105, 110)):
        walk = nasty_walk(seed, lights=3, frames=8)
        none, certified = _renderers(walk.scene, width=24, height=24, depth=2, accelerator=accelerator)
        other = nasty_walk(seed + 1000, lights=3).scene.lights
        for number, (_, camera) in enumerate(walk.frames):
            lamps = list(walk.scene.lights)
            if number in (2, 3, 5):
                lamps[number % 3] = replace(lamps[number % 3], position=other[number % 3].position)
            none.scene = certified.scene = replace(walk.scene, lights=tuple(lamps))
            expected, frame = none.render(0.0, camera), certified.render(0.0, camera)
            assert expected.color.tobytes() == frame.color.tobytes(), f"seed {seed}, frame {number}"


def test_settings_of_another_structure_change_nothing_of_a_world_that_is_there():
    """As when a picture that was traced with the kd-tree is opened again: no ray asks what was not made for asking."""
    asks_none = EAGER._replace(max_asked=0)
    for seed in range(3):
        walk = nasty_walk(seed, lights=3)
        settings = {"width": 24, "height": 24, "depth": 2, "accelerator": "bvh8"}
        none, certified = _renderers(walk.scene, cost_model=asks_none, **settings)
        for number, (time, camera) in enumerate(walk.frames):
            if number == 2:
                certified.settings = replace(certified.settings, accelerator="kdtree")
            frame = certified.render(time, camera)
            assert none.render(time, camera).color.tobytes() == frame.color.tobytes(), f"seed {seed}, frame {number}"
            assert frame.statistics.shadow.candidates_only == 0


def test_a_picture_of_many_tiles_requests_and_certifies_the_same_with_any_number_of_threads():
    """Several threads look at its tiles at once, which they do not in small pictures."""

    def counted(threads: int) -> list[tuple[int, ...]]:
        settings = tracer.Settings(width=256, height=192, depth=1, method="certified", threads=threads)
        world = world_of(SCENES / "default.aff", "bvh8")
        renderer = tracer.Renderer(world.scene, settings, world=world)
        frames = [renderer.render(0.0).statistics for _ in range(2)]
        return [(one.certificates, one.certificate_steps, one.certificate_tests, one.shadow.rays) for one in frames]

    alone = counted(1)
    assert alone[0][0] > 1000
    assert counted(4) == alone


def _assert_frames_alike(path: Path, frames: list[int], size: int, depth: int) -> None:
    scene = loaded(path)
    none, certified = _renderers(scene, width=size, height=size, depth=depth, accelerator="bvh8")
    seen: Counter[str] = Counter()
    for number in frames:
        time = scene.frame_time(number)
        expected, frame = none.render(time), certified.render(time)
        assert expected.color.tobytes() == frame.color.tobytes(), f"frame {number}"
        _count(seen, frame)
    assert seen["culled"] > 0 and seen["dynamic_only"] > 0


@pytest.mark.parametrize("name", ["kitchen/kitchen.aff", "robot/Robot.aff", "museum/museum5.aff"])
def test_frames_of_bart_are_those_without_culling(bart: Path, name: str):
    """Neighbours, and cuts from one end of the path to the other."""
    _assert_frames_alike(bart / name, [0, 1, 150, 151], 72, 10)

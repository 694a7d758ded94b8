"""Whole frames along a scene's path: with and without culling, and beside what Embree needs for their rays alone."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.bench.contest import (
    LEAST_AGREEMENT,
    All,
    Ours,
    Spread,
    differing,
    heats,
    oracle,
    race,
    second_core,
    thread_numbers,
)
from tests.bench.embree import MODES, EmbreeRays, EmbreeScene
from tests.bench.frame_rays import FrameRays, frame_rays
from tests.bench.frame_times import METHODS, faults_of_work
from tests.bench.rays import Surfaces
from tracer.experiments.experiment import path_times
from tracer.frame import Frame, Settings
from tracer.geometry.rays import Rays
from tracer.geometry.world import World
from tracer.renderer import Renderer

SAME_COUNT = 1e-3  # relative: how far counts of rays told anew may lie from the renderer's counters
# What Embree traces of a frame, and which part it then leaves out.
ALL_RAYS, ASKED_RAYS = "all rays", "rays not culled"
TRACED = ((ALL_RAYS, "shadow, not culled"), (ASKED_RAYS, "shadow"))


@dataclass
class RaysAlone:
    """Embree's part in one frame: seconds of each round by what was traced and by how many threads."""

    modes: dict[str, str]
    seconds: dict[str, dict[int, list[float]]]
    rays: dict[str, int]
    faults: list[str]


@dataclass
class PathFrame:
    """One moment of the path: seconds of a frame by method and threads, whether the second core was there,
    and what went wrong."""

    time: float
    seconds: dict[str, dict[int, float]] = field(default_factory=lambda: {method: {} for method in METHODS})
    second_core: float = 0.0
    faults: list[str] = field(default_factory=list)
    embree: RaysAlone | None = None

    def ratio(self, method: str, traced: str, threads: int) -> float:
        """Embree's time for the rays alone over the frame's."""
        assert self.embree is not None
        return Spread.of(self.embree.seconds[traced][threads]).median / self.seconds[method][threads]

    def to_json(self) -> dict[str, Any]:
        return vars(self) | {"embree": vars(self.embree) if self.embree else None}


def whole_frames(world: World, settings: Settings, frames: int, beside: int, rounds: int) -> Iterator[PathFrame]:
    """`frames` frames of the whole path of a world of triangles, `beside` of them with Embree's part.

    Both methods render by one thread and by two, each with modes of its own; who begins changes with
    every frame.  A first frame of each is not timed.
    """
    scene = world.scene
    times = path_times(scene, frames)
    chosen = set(np.linspace(0, frames - 1, beside + 2).round().astype(int)[1:-1].tolist()) if beside else set()
    renderers = {
        (method, threads): Renderer(scene, replace(settings, method=method, threads=threads), world=world)
        for method in METHODS
        for threads in thread_numbers()
    }
    for renderer in renderers.values():
        renderer.render(times[0])
        renderer.reset_modes()
    words: NDArray | None = None
    lights_move = any(light.track for light in scene.lights)  # then modes are not what the last frame left
    for number, moment in enumerate(times):
        made, rendered = PathFrame(moment), {}
        core = second_core()
        for key in list(renderers)[:: 1 if number % 2 else -1]:
            before = clock.perf_counter()
            rendered[key] = renderers[key].render(moment)
            made.seconds[key[0]][key[1]] = clock.perf_counter() - before
        made.second_core = min(core, second_core())
        for threads in thread_numbers():
            made.faults += faults_of_work(rendered["none", threads], rendered["paper", threads])
        if number in chosen:
            made.embree = _rays_alone(world, settings, rendered["none", 1], rendered["paper", 1], words, rounds)
            made.faults += made.embree.faults
        words = None if lights_move else rendered["paper", 1].modes
        yield made


def _rays_alone(
    world: World, settings: Settings, none: Frame, paper: Frame, words: NDArray | None, rounds: int
) -> RaysAlone:
    """Time Embree on the rays of a frame: on all of them, and without the shadow rays that culling spares."""
    size = settings.width, settings.height
    told = frame_rays(world, none.time, none.camera, size, settings.depth, words)
    triangles = Surfaces.of(world.scene, none.time).triangles()
    embree = EmbreeScene(triangles)
    asked = Rays(*(np.ascontiguousarray(array[..., ~told.culled]) for array in told.shadow))
    parts = {"primary": told.primary, "secondary": told.secondary, "shadow": told.shadow, "shadow, not culled": asked}
    parts = {name: rays for name, rays in parts.items() if len(rays.t_min)}
    prepared = [mode for mode in MODES if mode.prepared]
    best = {name: next(iter(heats(embree, rays, _closest(name), 1, prepared))) for name, rays in parts.items()}
    seconds: dict[str, dict[int, list[float]]] = {name: {} for name, _ in TRACED}
    for threads in thread_numbers():
        runs = {name: EmbreeRays(embree, parts[name], _closest(name), best[name], threads) for name in parts}
        teams = [All(name, [run for part, run in runs.items() if part != without]) for name, without in TRACED]
        times, _ = race(teams, rounds)
        for team, row in zip(teams, times, strict=True):
            seconds[team.name][threads] = row.tolist()
    counts = {name: len(rays.t_min) for name, rays in parts.items()}
    modes = {name: str(mode) for name, mode in best.items()}
    found = _miscounted(told, none, paper, words) + _differing(world, parts, triangles)
    return RaysAlone(modes, seconds, counts, found)


def _closest(part: str) -> bool:
    return not part.startswith("shadow")


def _miscounted(told: FrameRays, none: Frame, paper: Frame, words: NDArray | None) -> list[str]:
    """Where the rays told anew are not as many as the renderer counted: then they are not that frame's rays."""
    counted = none.statistics
    pairs = [
        ("primary rays", len(told.primary.t_min), counted.primary.rays),
        ("secondary rays", len(told.secondary.t_min), counted.secondary.rays),
        ("shadow rays due", len(told.shadow.t_min), counted.shadow.due),
    ]
    if words is not None:
        pairs.append(("culled shadow rays", int(told.culled.sum()), paper.statistics.shadow.culled))
    return [
        f"{name}: {here:,} told anew, {there:,} counted by the renderer"
        for name, here, there in pairs
        if abs(here - there) > SAME_COUNT * max(there, 1 / SAME_COUNT)
    ]


def _differing(world: World, parts: dict[str, Rays], triangles: NDArray[np.float32]) -> list[str]:
    """Parts of a frame's rays of which our answers are not Embree's."""
    found, robust = [], EmbreeScene(triangles, robust=True)
    for name, rays in parts.items():
        ours = Ours(world, rays, _closest(name))
        ours.run()
        share = 1 - differing(rays, ours.answers(), oracle(robust, rays, _closest(name))) / len(rays.t_min)
        if share < LEAST_AGREEMENT:
            found.append(f"only {share:.4%} of answers to {name} rays of the frame are Embree's")
    return found

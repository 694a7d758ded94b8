"""All certificates of a scene: kept up to date with what moves, and made, most wanted first, within a budget."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified import certify
from tracer.culling.certified.beam import OFFSET
from tracer.culling.certified.cells import HIGHEST, Cells, bytes_of, make_cells, put_receivers, with_room
from tracer.culling.certified.lookup import ROOM, Wanted
from tracer.culling.certified.occluders import BOXES, Occluders, blocks_of, joined, know_light, shape_of
from tracer.culling.certified.work import Points, commit, counters, gather_roots, make_tasks, work_on
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.geometry.bvh8.tree import WIDTH
from tracer.geometry.world import World
from tracer.parallel import for_each_chunk

BATCH, CHUNK = 2048, 16  # tasks between two looks at the budget; tasks that a thread takes at a time


@dataclass(frozen=True)
class Budget:
    """How much may be certified after a frame: so many cells and lights, and so many seconds (inf for any)."""

    certificates: float = np.inf
    seconds: float = np.inf


def _bounds(rows: NDArray[np.float32], boxes: NDArray[np.float32]) -> NDArray[np.float64]:
    """Lower and upper corner (2, 3) of a box around triangles (t, 9) and boxes (q, 6)."""
    corners = rows[:, :3].astype(np.float64)
    points = [corners, corners + rows[:, 3:6], corners + rows[:, 6:], boxes[:, :3], boxes[:, 3:]]
    every = np.concatenate(points) if len(rows) + len(boxes) else np.zeros((1, 3))
    return np.stack([every.min(0), every.max(0)])


class Certificates:
    """The certified cells of the static geometry of a world."""

    def __init__(self, world: World, lights: NDArray[np.float32], threads: int) -> None:
        """lights (n, 3), of which the first MAX_CULLED_LIGHTS are certified."""
        self._threads = threads
        self._world = world
        self._scratch = [certify.scratch() for _ in range(threads)]
        primitives = world.primitives
        count = min(len(lights), MAX_CULLED_LIGHTS)
        self._lights = np.full((count, 3), np.nan, np.float32)
        self.cells: Cells = make_cells(len(primitives.object_of), count)
        triangles, quadrics = primitives.triangles_of(0), primitives.quadrics_of(0)
        boxes = primitives.quadric_boxes(quadrics, primitives.to_object[quadrics])
        numbers = np.concatenate(
            [np.arange(triangles.stop), len(primitives.triangles) + np.arange(quadrics.stop)]
        ).astype(np.int32)
        shape, roots = joined([shape_of(primitives.triangles[triangles], boxes, numbers, threads)])
        rows = primitives.triangles
        self.occluders = Occluders(
            rows,
            np.zeros(len(rows), np.float32),
            boxes,
            shape.children,
            *blocks_of(shape, rows),
            roots,
            np.empty((count, len(shape.children), BOXES), np.float32),
            np.empty((count, len(shape.leaves), WIDTH), np.float32),
            np.zeros((count, len(rows)), np.int32),
            np.zeros(count, np.int32),
        )
        bounds = _bounds(rows[triangles], boxes)
        self._bounds = bounds
        self._largest = float(np.abs(bounds).max())
        self.highest = np.float32(HIGHEST * OFFSET * self._largest)
        put_receivers(rows, triangles.start, triangles.stop, self._largest, self.cells.receivers)
        self.left: list[Wanted] = []  # what the last frame's rays wanted and has not been looked into
        self.still = np.zeros(count, np.bool_)
        self.follow_lights(lights)
        self.still[:] = True

    def follow_lights(self, lights: NDArray[np.float32]) -> None:
        """Drop what is certified of lights (n, 3) that moved, and know where they are once they stand still."""
        lights = lights[: len(self._lights)]
        moved = ~(lights == self._lights).all(axis=1)
        for number in np.flatnonzero(moved):
            words = self.cells.words
            words &= ~words.dtype.type(3 << (2 + 2 * int(number)))
            self.cells.count[:, number] = 0
        settled = ~moved & ~self.still | (moved & np.isnan(self._lights).any(axis=1))
        self._lights[:] = lights
        self.still[:] = ~moved
        numbers = [int(number) for number in np.flatnonzero(settled)]

        def know(chunk: int, worker: int) -> None:
            light = self._lights[numbers[chunk]]
            low, high = self._bounds
            farthest = float(np.linalg.norm(np.maximum(np.abs(light - low), np.abs(light - high)))) * 1.001
            know_light(self.occluders, numbers[chunk], light, farthest, self._largest)

        for_each_chunk(know, len(numbers), self._threads)

    def wanted(self, tiles: int) -> Wanted:
        """Room for what tiles ask for: arrays with a row each."""
        of = np.zeros((tiles, 3), np.int64)
        of[:, 1] = 1
        shape = (tiles, ROOM)
        return Wanted(np.empty(shape, np.int32), np.empty(shape, np.float32), np.empty(shape, np.float32), of)

    def certify(self, lists: list[Wanted], budget: Budget, patience: int, cancel: Callable[[], bool] | None) -> NDArray:
        """Certify what rays wanted, within a budget; counters (COUNTERS,) int64 of what that took."""
        end = clock.perf_counter() + budget.seconds
        counts = counters(self._threads)
        kept = [(wanted, tile, n) for wanted in lists for tile, n in enumerate(wanted.of[:, 0]) if n]
        if not kept:
            return counts.sum(0)
        key, u, v = (np.concatenate([wanted[k][tile, :n] for wanted, tile, n in kept]) for k in range(3))
        points = Points(np.empty_like(key), np.empty_like(u), np.empty_like(v), np.empty((2, len(key)), np.float32))
        self.cells = with_room(self.cells, min(len(key), 2 * len(self.cells.receivers)), 0)
        todo = gather_roots(self.cells, key, u, v, points)
        while len(todo):
            todo = todo[np.argsort(todo[:, 1] - todo[:, 2], kind="stable")]
            following = []
            for first in range(0, len(todo), BATCH):
                if clock.perf_counter() >= end or counts[:, certify.CERTIFICATES].sum() >= budget.certificates:
                    return counts.sum(0)
                following.append(self._certify(todo[first : first + BATCH], points, patience, counts, cancel))
            todo = np.concatenate(following)
        return counts.sum(0)

    def _certify(
        self,
        todo: NDArray[np.int32],
        points: Points,
        patience: int,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> NDArray[np.int32]:
        """Work on tasks (n, 3); those that follow."""
        tasks = make_tasks(*(np.ascontiguousarray(todo[:, k]) for k in range(3)), len(self._lights))
        reach = (float(self.highest), self._largest)

        def work(chunk: int, worker: int) -> None:
            work_on(
                self.cells, self.occluders, self._lights, self.still, reach,
                chunk * CHUNK, min(len(todo), (chunk + 1) * CHUNK),
                tasks, points, patience, self._scratch[worker], counts[worker],
            )  # fmt: skip

        for_each_chunk(work, -(-len(todo) // CHUNK), self._threads, cancel)
        named = tasks.count[(tasks.state != 0xFF) & (tasks.count != certify.TOO_MANY)].sum(dtype=np.int64)
        self.cells = with_room(self.cells, 4 * len(todo), int(named))
        following = np.empty((4 * len(todo), 3), np.int32)
        return following[: commit(self.cells, self.occluders, reach, tasks, following)]

    @property
    def bytes(self) -> int:
        """Memory that the cells take."""
        return bytes_of(self.cells)

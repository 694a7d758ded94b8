"""All certificates of a scene: kept up to date with what moves, and made, most wanted first, within a budget."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracer.culling.certified import certify
from tracer.culling.certified.beam import OFFSET
from tracer.culling.certified.cells import (
    ALONG_U,
    ALONG_V,
    CORNER,
    HIGHEST,
    NORMAL,
    ROOTS,
    Cells,
    bytes_of,
    make_cells,
    put_receivers,
    with_room,
)
from tracer.culling.certified.lookup import ROOM, Wanted
from tracer.culling.certified.margins import LONGEST
from tracer.culling.certified.occluders import BOXES, Occluders, blocks_of, joined, know_light, shape_of
from tracer.culling.certified.work import Points, commit, counters, gather_roots, make_tasks, work_on
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.geometry.bvh8.tree import PADDING, WIDTH
from tracer.geometry.world import World
from tracer.parallel import for_each_chunk

STATES = ("none", "full", "lit", "candidates")
BATCH, CHUNK = 2048, 16  # tasks between two looks at the budget; tasks that a thread takes at a time


@dataclass(frozen=True)
class Budget:
    """How much may be certified after a frame: so many cells and lights, and so many seconds (inf for any)."""

    certificates: float = np.inf
    seconds: float = np.inf


def _bounds(rows: NDArray[np.float32], boxes: NDArray[np.float32]) -> NDArray[np.float64]:
    """Lower and upper corner (2, 3) of a box around triangles (t, 9) and boxes (q, 6)."""
    corner, e1, e2 = (rows[:, k : k + 3].astype(np.float64) for k in (0, 3, 6))
    lower, upper = boxes[:, :3].astype(np.float64), boxes[:, 3:].astype(np.float64)
    every = np.concatenate([corner, corner + e1, corner + e2, lower, upper])
    if not len(every):
        return np.zeros((2, 3))
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
            PADDING * float(np.abs(_bounds(rows[triangles], boxes)).max()) / LONGEST,
        )
        bounds = _bounds(rows[triangles], boxes)
        self._bounds = bounds
        self._largest = float(np.abs(bounds).max())
        self.highest = float(np.float32(HIGHEST * OFFSET * self._largest))
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
            self.cells.amount[:, number] = 0
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

    def certify(
        self, lists: list[Wanted], budget: Budget, patience: tuple[int, int], cancel: Callable[[], bool] | None
    ) -> NDArray:
        """Certify what rays wanted, within a budget; counters (COUNTERS,) int64 of what that took."""
        end = clock.perf_counter() + budget.seconds
        counts = counters(self._threads)
        if not len(self._lights):
            return counts.sum(0)
        kept = [(wanted, tile, n) for wanted in lists for tile, n in enumerate(wanted.of[:, 0]) if n]
        if not kept:
            return counts.sum(0)
        key, u, v = (np.concatenate([wanted[k][tile, :n] for wanted, tile, n in kept]) for k in range(3))
        points = Points(np.empty_like(key), np.empty_like(u), np.empty_like(v), np.empty((2, len(key)), np.float32))
        self.cells = with_room(self.cells, min(len(key), 2 * len(self.cells.receivers)), 0)
        todo = gather_roots(self.cells, key, u, v, patience[0], points)
        pace = 1e-4 * len(self._lights)  # seconds a task takes, at first guessed too high
        while len(todo):
            todo = todo[np.argsort(todo[:, 1] - todo[:, 2], kind="stable")]
            following, first = [], 0
            while first < len(todo):
                start = clock.perf_counter()
                left = budget.certificates - counts[:, certify.CERTIFICATES].sum()
                batch = int(min(BATCH, left // len(self._lights), 0.5 * (end - start) / pace))
                if batch <= 0:
                    return counts.sum(0)
                following.append(self._certify(todo[first : first + batch], points, patience[1], counts, cancel))
                first += batch
                pace = max(1e-6, (clock.perf_counter() - start) / batch)
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
        cell, start, end = (np.ascontiguousarray(todo[:, k]) for k in range(3))
        tasks = make_tasks(cell, start, end, len(self._lights))
        reach = (float(self.highest), self._largest)

        def work(chunk: int, worker: int) -> None:
            work_on(
                self.cells, self.occluders, self._lights, self.still, reach,
                chunk * CHUNK, min(len(todo), (chunk + 1) * CHUNK),
                tasks, points, patience, self._scratch[worker], counts[worker],
            )  # fmt: skip

        for_each_chunk(work, -(-len(todo) // CHUNK), self._threads, cancel)
        named = tasks.amount[(tasks.state != 0xFF) & (tasks.amount != certify.TOO_MANY)].sum(dtype=np.int64)
        self.cells = with_room(self.cells, 4 * len(todo), int(named))
        following = np.empty((4 * len(todo), 3), np.int32)
        return following[: commit(self.cells, self.occluders, reach, tasks, following)]

    def at_pixels(self, cell: NDArray[np.int32]) -> NDArray[np.unsignedinteger]:
        """The words of cells, of any shape."""
        return self.cells.words[cell]

    def describe(self, primitive: int, point: ArrayLike, light: int) -> tuple[str, tuple[int, ...]]:
        """What is certified for a light of the cell in which shadow rays end at a point (3,) above a primitive: "full",
        "lit", "candidates" or "none", and the numbers of the primitives that it names."""
        number = self._cell_at(primitive, np.asarray(point, np.float64))
        state = (int(self.cells.words[number]) >> (2 + 2 * light)) & 3 if light < len(self._lights) else 0
        while number and state and self.cells.amount[number, light] == 0 and state != certify.LIT:
            number = int(self.cells.parent[number])  # taken over from the cell that this one is a part of
        amount = int(self.cells.amount[number, light]) if number else 0
        start = int(self.cells.start[number, light]) if number else 0
        names = self.cells.names[start : start + amount] if amount != certify.TOO_MANY else self.cells.names[:0]
        return STATES[state], tuple(int(name) for name in names)

    def _cell_at(self, primitive: int, point: NDArray[np.float64]) -> int:
        """The leaf in which a point above a primitive lies; 0 for none."""
        row = self.cells.receivers[primitive].astype(np.float64)
        to = point - row[CORNER : CORNER + 3]
        u, v, height = (float(row[at : at + 3] @ to) for at in (ALONG_U, ALONG_V, NORMAL))
        number = int(self.cells.receivers.view(np.int32)[primitive, ROOTS + (height < 0.0)])
        u, v = min(max(u, 0.0), 1.0), min(max(v, 0.0), 1.0)
        while self.cells.child[number] >= 0:
            number = int(self.cells.child[number])
            if u + v <= 0.5:
                u, v = 2 * u, 2 * v
            elif u >= 0.5:
                number, u, v = number + 1, 2 * u - 1, 2 * v
            elif v >= 0.5:
                number, u, v = number + 2, 2 * u, 2 * v - 1
            else:
                number, u, v = number + 3, 1 - 2 * u, 1 - 2 * v
        return number

    @property
    def bytes(self) -> int:
        """Memory that the cells take."""
        return bytes_of(self.cells)

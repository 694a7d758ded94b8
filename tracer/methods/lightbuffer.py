"""The light buffer: what each light sees in each direction is kept, and shadow rays are looked up in it (Haines,
Greenberg 1986).

Around every point light stands a cube of cells (`tracer.culling.lightbuffer`), of all that never moves, kept for as
long as the light stays where it is; a second one of what rests, made again when an object starts or stops; and a small
one of what moves, made for each frame.  Lamps with several samples, and lights that move, are traced.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.culling.lightbuffer.cubes import Cube, CubeMaker, Items, items_of
from tracer.culling.lightbuffer.lookup import (
    CELLS,
    COLUMNS,
    DEPTHS,
    DEPTHS_SIDE,
    KNOWN,
    LISTS,
    MOVING,
    RECORDS,
    RESTING,
    ROWS,
    SIDE,
    STATIC,
    LightBuffers,
    ask_buffers,
)
from tracer.culling.lightbuffer.moving import SIDE as MOVING_SIDE
from tracer.culling.lightbuffer.moving import depths_of
from tracer.culling.lightbuffer.rays import RAY_ROWS, buffer_rays_in
from tracer.culling.rest import nothing_rests
from tracer.culling.shadow_batch import shadow_batch_in
from tracer.culling.stages import call_at, scratch_of
from tracer.geometry.accelerators import KD_TREE
from tracer.geometry.offsets import RAY_OFFSET
from tracer.kernels import entry
from tracer.methods.interface import FrameView, Services, ShadowMethod, Stage
from tracer.shading.points import points_in
from tracer.simd import i64_at
from tracer.simd.records import reading
from tracer.statistics import FrameStatistics

LONGEST = 8  # candidates of a record, at most
STATIC_SIDE, RESTING_SIDE = 256, 128
GROWTH = 4  # times that what moves may grow before boxes of what rests no longer hold (`certified.static_geometry`)

buffers_at = reading(LightBuffers)


@entry
def choose(data, call, light, count, counts):
    """Answer the rays that the light's buffers tell about."""
    given, buffers = call_at(call), buffers_at(data)
    points, batch, position = points_in(given.points), shadow_batch_in(given.shadows), given.samples[given.sample]
    rays = buffer_rays_in(scratch_of(given))
    ask_buffers(buffers, points, position, light, count, rays, batch, i64_at(counts))


@dataclass
class _Buffer:
    """What is kept of a light: where it stands, and its cubes."""

    place: NDArray[np.float32]
    static: Cube | None = None
    resting: Cube | None = None
    depths: NDArray[np.float32] | None = None
    moving: NDArray[np.float32] | None = None


class LightBuffer(ShadowMethod):
    """Keeps a buffer for each light."""

    entries = (choose,)

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self.forget()

    def forget(self) -> None:
        self.buffers: dict[int, _Buffer] = {}
        self._static: Items | None = None
        self._resting: Items | None = None
        self._since = nothing_rests(len(self.services.world.primitives.triangle_starts) - 1).since
        self._allowed = np.inf
        self._last: NDArray[np.float32] | None = None
        self._made = self._steps = self._tests = 0

    def follows_rest(self) -> bool:
        return True

    def follow(self, frame: FrameView) -> None:
        """Drop the buffers of lights that have moved, and what rested otherwise."""
        lamps, before = frame.shading.lamps, self._last
        points = np.diff(lamps.first) == 1
        same = before is None or len(before) != len(points) or (before == lamps.places).all(1)
        still = points & same
        self._last = lamps.places.copy()
        self.buffers = {k: b for k, b in self.buffers.items() if still[k] and (b.place == lamps.places[k]).all()}
        for k in np.flatnonzero(still):
            self.buffers.setdefault(int(k), _Buffer(lamps.places[k].copy()))
        if not np.array_equal(frame.resting.since, self._since) or self.services.world.extent > self._allowed:
            self._since, self._resting = frame.resting.since, None
            for buffer in self.buffers.values():
                buffer.resting = None

    def prepare(self, frame: FrameView) -> None:
        """Make the buffers that are wanting.  Raises Cancelled."""
        start = self.services.clock()
        self._made = self._steps = self._tests = 0
        world, most = self.services.world, 1e6 * 256 / max(1, len(self.buffers))
        outlines = None
        if self._static is None:
            outlines = world.outlines()
            self._static = items_of(world, [0], outlines)
        resting = np.flatnonzero(self._since > 0).tolist()
        if self._resting is None:
            self._allowed = GROWTH * world.extent if resting else np.inf
            self._resting = items_of(world, resting, outlines or world.outlines())
        self._make("static", self._static, STATIC_SIDE, most, frame)
        if resting:
            self._make("resting", self._resting, RESTING_SIDE, most, frame)
        boxes = world.object_boxes()
        there = boxes[:, 0] <= boxes[:, 3]
        moving = boxes[there & (self._since == 0)]
        for buffer in self.buffers.values():
            buffer.depths = depths_of(boxes[there], buffer.place) if there.any() else None
            buffer.moving = depths_of(moving, buffer.place) if len(moving) and resting else None
        self.seconds = self.services.clock() - start

    def _make(self, which: str, items: Items, side: int, most: float, frame: FrameView) -> None:
        wanting = [buffer for buffer in self.buffers.values() if getattr(buffer, which) is None]
        if not wanting:
            return
        maker = CubeMaker(items, self._reach, LONGEST)
        lights = np.stack([buffer.place for buffer in wanting])
        for buffer, cube in zip(wanting, maker.make(lights, side, most, frame.workers, frame.cancel), strict=True):
            setattr(buffer, which, cube)
            self._made += cube is not None
        self._steps += maker.steps
        self._tests += maker.tests

    def _reach(self, light: NDArray[np.float32]) -> float:
        """No less than the length of any ray from a light to what never moves, or rests now."""
        bounds = self.services.world.bounds().astype(np.float64).reshape(2, 3)
        if (bounds[0] > bounds[1]).any():
            return 1.0
        largest = max(float(np.abs(bounds).max()), float(np.abs(light).max()))
        return 1.001 * float(np.linalg.norm(np.abs(light - bounds).max(0))) + 8.0 * RAY_OFFSET * largest

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        count = len(frame.lights)
        table, reach = np.zeros((count, COLUMNS), np.int64), np.zeros((count, 4), np.float32)
        moves = self.services.world.placed.has_dynamic
        for k, buffer in self.buffers.items():
            if buffer.static is None or (buffer.resting is None and (self._since > 0).any()):
                continue
            for first, cube in ((STATIC, buffer.static), (RESTING, buffer.resting)):
                if cube is not None:
                    table[k, first + CELLS] = cube.cells.ctypes.data
                    table[k, first + RECORDS] = cube.records.ctypes.data
                    table[k, first + LISTS] = cube.lists.ctypes.data
                    table[k, first + ROWS] = cube.rows.ctypes.data
                    table[k, first + SIDE] = cube.side
                    at = 0 if first == STATIC else 2
                    reach[k, at : at + 2] = [(0.99999 * min(length, 1e15)) ** 2 for length in (cube.reach, cube.sure)]
            table[k, DEPTHS_SIDE] = MOVING_SIDE
            if buffer.depths is not None:
                table[k, DEPTHS] = buffer.depths.ctypes.data
            if buffer.moving is not None:
                table[k, MOVING] = buffer.moving.ctypes.data
            table[k, KNOWN] = not moves or buffer.depths is not None
        single = self.services.world.accelerator == KD_TREE
        return [Stage(LightBuffers(table, reach, moves, single), choose=choose, rows=RAY_ROWS)]

    def report(self, statistics: FrameStatistics) -> None:
        statistics.certificates += self._made
        statistics.certificate_steps += self._steps
        statistics.certificate_tests += self._tests

    @property
    def memory_bytes(self) -> int:
        cubes = [cube for b in self.buffers.values() for cube in (b.static, b.resting) if cube is not None]
        return sum(cube.bytes for cube in cubes)

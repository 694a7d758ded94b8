"""The light buffer: what each light sees in each direction is kept, and shadow rays are looked up in it (Haines,
Greenberg 1986).

Around every point light stands a cube of cells (`tracer.neighbours.lightbuffer`), of all that never moves, kept for as
long as the light stays where it is; a second one of what rests, made again when an object starts or stops; and a small
one of what moves, made for each frame.  Lamps with several samples, and lights that move, are traced.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.culling.rest import nothing_rests
from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, scratch_of
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.geometry.accelerators import KD_TREE
from tracer.geometry.rays import RAY_OFFSET
from tracer.methods.interface import FrameView, Services, ShadowMethod, Stage
from tracer.neighbours.lightbuffer.candidates import RAY_ROWS, buffer_rays_in
from tracer.neighbours.lightbuffer.cubes import LEAST_SIDE, Cube, CubeMaker, Items, items_of
from tracer.neighbours.lightbuffer.lookup import (
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
from tracer.neighbours.lightbuffer.moving import SIDE as MOVING_SIDE
from tracer.neighbours.lightbuffer.moving import depths_of
from tracer.neighbours.lightbuffer.tell import LightCube, Said, tell
from tracer.runtime.kernels import native_callback
from tracer.shading.points import points_in
from tracer.simd import i64_at
from tracer.simd.records import reading
from tracer.statistics import FrameStatistics
from tracer.visibility.budget import Counts

LONGEST = 8  # candidates of a record, at most
COARSER = 2  # times that the cells of what rests are wider
MOVED = "it moves: a light has one only where it stands still"
GROWTH = 4  # times that what moves may grow before boxes of what rests no longer hold (`certified.static_geometry`)

buffers_at = reading(LightBuffers)


@native_callback
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
    refused: bool = False  # as it takes too much memory


class LightBuffer(ShadowMethod):
    """Keeps a buffer for each light."""

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
        self._counts = Counts()
        self._asked = 0, 0.0
        self._lights = 0
        self._why_not: dict[int, str] = {}

    def follows_rest(self) -> bool:
        return True

    def update(self, frame: FrameView) -> None:
        """Drop the buffers of lights that have moved, and what rested otherwise."""
        lamps, before = frame.shading.lamps, self._last
        points = np.diff(lamps.first) == 1
        same = before is None or len(before) != len(points) or (before == lamps.places).all(1)
        still = points & same
        self._last, self._lights = lamps.places.copy(), len(points)
        self._why_not = {
            int(k): MOVED if points[k] else f"it is a lamp of {lamps.first[k + 1] - lamps.first[k]} samples"
            for k in np.flatnonzero(~still[:MAX_CULLED_LIGHTS])
        }
        self.buffers = {k: b for k, b in self.buffers.items() if still[k] and (b.place == lamps.places[k]).all()}
        for k in np.flatnonzero(still[:MAX_CULLED_LIGHTS]):  # thousands of cubes would take minutes to make
            self.buffers.setdefault(int(k), _Buffer(lamps.places[k].copy()))
        if not np.array_equal(frame.resting.since, self._since) or self.services.world.extent > self._allowed:
            self._since, self._resting = frame.resting.since, None
            for buffer in self.buffers.values():
                buffer.resting, buffer.refused = None, buffer.static is None and buffer.refused

    def prepare(self, frame: FrameView) -> None:
        """Make the buffers that are wanting.  Raises Cancelled, with those that are done kept."""
        self._counts = Counts()
        world = self.services.world
        resting = np.flatnonzero(self._since > 0).tolist()
        if self._static is None:
            self._static = items_of(world, [0], world.outlines())
        if self._resting is None:
            self._allowed = GROWTH * world.extent if resting else np.inf
            self._resting = items_of(world, resting, world.outlines())
        side, most = frame.settings.light_buffer_side, 1e6 * frame.settings.light_buffer_memory
        share = most / max(1, len(self.buffers))
        if (side, most) != self._asked:
            self._asked = side, most
            for buffer in self.buffers.values():
                buffer.static = buffer.resting = None
                buffer.refused = False
        self._make("static", self._static, side, 0.8 * share if resting else share, frame)
        if resting:
            self._make("resting", self._resting, max(LEAST_SIDE, side // COARSER), 0.2 * share, frame)
        boxes = world.object_boxes()
        there = boxes[:, 0] <= boxes[:, 3]
        moving = boxes[there & (self._since == 0)]
        for buffer in self.buffers.values():
            buffer.depths = depths_of(boxes[there], buffer.place) if there.any() else None
            buffer.moving = depths_of(moving, buffer.place) if len(moving) and resting else None

    def _make(self, which: str, items: Items, side: int, most: float, frame: FrameView) -> None:
        """Make the cubes of all lights that have none of `which` kind."""
        wanting = [b for b in self.buffers.values() if getattr(b, which) is None and not b.refused]
        if not wanting:
            return
        maker = CubeMaker(items, self._reach, LONGEST)
        lights = np.stack([buffer.place for buffer in wanting])
        for buffer, cube in zip(wanting, maker.make(lights, side, most, frame.workers, frame.cancel), strict=True):
            setattr(buffer, which, cube)
            buffer.refused = cube is None
        made, before = sum(getattr(buffer, which) is not None for buffer in wanting), self._counts
        self._counts = Counts(before.steps + maker.steps, before.tests + maker.tests, before.certificates + made)

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
            if buffer.static is None or not self._answers(buffer):
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

    def _answers(self, buffer: _Buffer) -> bool:
        """Whether there is all that is asked of a light."""
        return buffer.static is not None and (buffer.resting is not None or not (self._since > 0).any())

    def why_not(self, light: int) -> str:
        """Why a light has no buffer, in words; nothing for one that has."""
        if light >= MAX_CULLED_LIGHTS:
            return f"only the first {MAX_CULLED_LIGHTS} lights have one"
        buffer = self.buffers.get(light)
        if buffer is not None:
            return "there is no memory for it (Settings.light_buffer_memory)" if buffer.refused else ""
        return self._why_not.get(light, "")

    def layers(self, frame: FrameView) -> dict[str, Any]:
        places = frame.shading.lamps.places
        shown = [
            LightCube(places[k], self.buffers[k].static if k in self.buffers else None, self.why_not(k))
            for k in range(min(self._lights, MAX_CULLED_LIGHTS))
        ]
        return {"light cubes": tuple(shown)} if shown else {}

    def report(self, statistics: FrameStatistics) -> None:
        statistics.add_made(self._counts)
        there = {k: b.static.side for k, b in self.buffers.items() if b.static is not None and self._answers(b)}
        statistics.light_buffers = [there.get(k, 0) for k in range(self._lights)]

    def because(self, answered: Answered) -> CullReason:
        buffer, point = self.buffers.get(answered.light), np.array(answered.point, np.float32)
        verdicts = {Said.CANDIDATES: Verdict.BUFFER_TESTED, Said.BEHIND: Verdict.BUFFER_FULL}
        said = Verdict.BUFFER_LIT if answered.lit else Verdict.BUFFER_FULL
        for cube in () if buffer is None else (buffer.static, buffer.resting):
            if cube is not None and buffer is not None:
                told = tell(cube, buffer.place, point)
                verdict = verdicts.get(told.said, said)
                if verdict is not said or (told.named and not answered.lit):
                    return CullReason(verdict, told.named)
        return CullReason(said)

    @property
    def memory_bytes(self) -> int:
        cubes = [cube for b in self.buffers.values() for cube in (b.static, b.resting) if cube is not None]
        rows = sum(0 if items is None else items.rows.nbytes for items in (self._static, self._resting))
        depths = [a for b in self.buffers.values() for a in (b.depths, b.moving) if a is not None]
        return rows + sum(cube.bytes for cube in cubes) + sum(array.nbytes for array in depths)

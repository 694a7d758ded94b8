"""Lightcuts: light of clusters of lights, each by one of them, as many as an error that nobody sees asks for (B. Walter
et al., "Lightcuts: A Scalable Approach to Illumination", SIGGRAPH 2005; `tracer.culling.lightcuts`).

This is a method that shades: its stage takes the place of all lights.  Samples of lamps are lights of their own.  It is
not exact, unless no error is allowed: then every light is looked at, and the picture is that of "none" bit for bit.
"""

from __future__ import annotations

import numpy as np
from numba import carray
from numpy.typing import NDArray

from tracer.culling.counters import SHADOW_COUNTERS
from tracer.culling.lightcuts.block import BLOCK, POINTS, ROOM, Clusters, CutWork
from tracer.culling.lightcuts.drawn import Draws
from tracer.culling.lightcuts.seen import BLOCKS, LIMITED, MOST_NODES, NODES, TALLIES, Seen
from tracer.culling.lightcuts.shade import Cuts, block_at, shade_by_cut
from tracer.culling.lightcuts.tree import CutTree, build_cut_tree
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.stages import call_at, vectors
from tracer.geometry.memory import aligned_rows
from tracer.kernels import Entry, entry
from tracer.methods.interface import FrameView, Services, ShadowMethod, Stage
from tracer.scene.lamps import Lamps
from tracer.shading.points import points_in
from tracer.shading.wave import wave_in
from tracer.simd import i64_at
from tracer.simd.records import reading
from tracer.statistics import CutCounts, FrameStatistics

FEWEST = 3  # lights that are worth a tree
_NONE, _NO_INTS = np.empty(0, np.float32), np.empty(0, np.int32)
NO_DRAWS = Draws(np.empty((0, 2), np.int32), _NO_INTS, _NONE, _NONE, np.empty((0, POINTS), np.float32), 0)


cuts_at = reading(Cuts)


@entry
def shade(data, call, light, count, counts):
    """Add the light of all lights to a wave's points, block by block."""
    given, cuts = call_at(call), cuts_at(data)
    points, wave, counted = points_in(given.points), wave_in(given.rays, count), carray(i64_at(counts), SHADOW_COUNTERS)
    for first in range(0, vectors(count), BLOCK):
        shade_by_cut(cuts, cuts.clusters, points, wave, given, block_at(first, count), counted)


class Lightcuts(ShadowMethod):
    """Shades by cuts of a tree of lights."""

    entries: tuple[Entry, ...] = (shade,)

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self._lamps: Lamps | None = None
        self._tree: CutTree | None = None
        self._work: list[CutWork] = []

    def begin(self, frame: FrameView) -> None:
        pixels = frame.settings.width * frame.settings.height
        self._nodes, self._bound = np.zeros(pixels, np.int32), np.zeros(pixels, np.float32)
        self._tally = np.zeros((frame.workers, TALLIES), np.int64)

    def follow(self, frame: FrameView) -> None:
        lamps, before = frame.shading.lamps, self._lamps
        if before is None or not all(np.array_equal(a, b) for a, b in zip(lamps, before, strict=True)):
            self._lamps = lamps
            self._tree = build_cut_tree(lamps) if len(lamps.samples) >= FEWEST else None

    def _clusters(self, frame: FrameView) -> Clusters:
        tree, lamps, placed = self._tree, frame.shading.lamps, self.services.world.placed
        assert tree is not None, "there are lights"
        seen = tree.boxes, tree.colors, tree.children, tree.reps, tree.falls, tree.owners
        return Clusters(*seen, lamps.samples, lamps.rows, placed.any_hit, placed.data)

    def _shades(self, frame: FrameView) -> bool:
        """Whether cuts take part in this frame."""
        return self._tree is not None and frame.settings.lightcuts_error > 0.0

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        return [Stage(self._cuts(frame, worker, learns), shade=shade)] if self._shades(frame) else []

    def _cuts(self, frame: FrameView, worker: int, learns: bool) -> Cuts:
        settings, buffers = frame.settings, frame.buffers
        limit = min(settings.lightcuts_nodes, len(frame.shading.lamps.samples))
        self._make_room(frame.workers, limit)
        none = np.empty(0, np.int32)
        seen = Seen(none, np.empty(0, np.float32), none, none, np.zeros(TALLIES, np.int64))
        if learns:
            seen = Seen(self._nodes, self._bound, buffers.cost, buffers.saved, self._tally[worker])
        return Cuts(
            self._clusters(frame), self._draws(frame), self._work[worker], seen, settings.lightcuts_error, limit
        )

    def _draws(self, frame: FrameView) -> Draws:
        """How representatives are drawn: they are not."""
        return NO_DRAWS

    def _make_room(self, workers: int, limit: int) -> None:
        """Let each worker have memory for cuts of so many nodes."""
        if len(self._work) < workers or len(self._work[0].nodes) != limit:
            self._work = [self._new_work(limit) for _ in range(workers)]

    def layers(self, frame: FrameView) -> dict[str, NDArray]:
        shape = frame.settings.height, frame.settings.width
        if not self._shades(frame):
            return {}
        return {"cut nodes": self._nodes.reshape(shape), "cut bound": self._bound.reshape(shape)}

    def report(self, statistics: FrameStatistics) -> None:
        lights = 0 if self._lamps is None else len(self._lamps.samples)
        total, most = self._tally.sum(0), int(self._tally[:, MOST_NODES].max())
        cuts = CutCounts(lights, *(int(total[k]) for k in (BLOCKS, NODES, LIMITED)), most)
        statistics.cuts = cuts

    def forget(self) -> None:
        self._lamps = self._tree = None

    @property
    def memory_bytes(self) -> int:
        work = sum(array.nbytes for work in self._work for array in work)
        return work + (0 if self._tree is None else self._tree.bytes)

    def _new_work(self, limit: int) -> CutWork:
        return new_work(limit, 2)


def new_work(limit: int, kept: int) -> CutWork:
    """Memory for cuts of so many nodes, for each of which so many rows of numbers are kept."""
    rows = [np.zeros((3, ROOM), np.float32) for _ in range(2)]
    return CutWork(
        *rows,
        t_min=np.full(ROOM, LIGHT_MARGIN, np.float32),
        t_max=np.ones(ROOM, np.float32),
        blocked=np.zeros(ROOM, np.uint8),
        reached=np.zeros(BLOCK, np.int32),
        asked=np.zeros(POINTS, np.int32),
        kept=aligned_rows(limit, kept * POINTS),
        mirror=np.zeros((3, POINTS), np.float32),
        estimate=np.zeros(POINTS, np.float32),
        bound=np.zeros(POINTS, np.float32),
        nodes=np.zeros(limit, np.int32),
        heap=np.zeros(limit, np.int32),
        keys=np.zeros(limit, np.float32),
        tells=np.zeros(limit, np.int32),
    )

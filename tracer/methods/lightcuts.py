"""Lightcuts: light of clusters of lights, each by one of them, as many as an error that nobody sees asks for (B. Walter
et al., "Lightcuts: A Scalable Approach to Illumination", SIGGRAPH 2005; `tracer.shading.lightcuts`).

This is a method that shades: its stage takes the place of all lights.  Samples of lamps are lights of their own.  It is
not exact, unless no error is allowed: then every light is looked at, and the picture is that of "none" bit for bit.
"""

from __future__ import annotations

import numpy as np
from numba import carray
from numpy.typing import NDArray

from tracer.culling.counters import SHADOW_COUNTERS
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.stages import call_at, vectors
from tracer.geometry.memory import aligned_rows
from tracer.methods.interface import FrameView, Services, ShadowMethod, Stage
from tracer.methods.method_limits import lights_in_words
from tracer.runtime.kernels import native_callback
from tracer.scene.lights import Lamps
from tracer.shading.lightcuts.block import BLOCK, DARK, POINTS, ROOM, Clusters, CutWork
from tracer.shading.lightcuts.drawn import Draws
from tracer.shading.lightcuts.seen import BLOCKS, LIMITED, MOST_NODES, NODES, TALLIES, Seen
from tracer.shading.lightcuts.shade import Cuts, block_at, shade_by_cut
from tracer.shading.lightcuts.tree import CutTree, build_cut_tree
from tracer.shading.points import points_in
from tracer.shading.wave import wave_in
from tracer.simd import i64_at
from tracer.simd.records import reading
from tracer.statistics import CutCounts, CutErrors, FrameStatistics

FEWEST = 3  # lights that are worth a tree
FEW_LEFT = 0.9  # of the lights: cuts of more clusters gain nothing
_NONE, _NO_INTS = np.empty(0, np.float32), np.empty(0, np.int32)
NO_DRAWS = Draws(np.empty((0, 2), np.int32), _NO_INTS, _NONE, _NONE, np.empty((0, POINTS), np.float32), 0)


cuts_at = reading(Cuts)


@native_callback
def shade(data, call, light, count, counts):
    """Add the light of all lights to a wave's points, block by block."""
    given, cuts = call_at(call), cuts_at(data)
    points, wave, counted = points_in(given.points), wave_in(given.rays, count), carray(i64_at(counts), SHADOW_COUNTERS)
    for first in range(0, vectors(count), BLOCK):
        shade_by_cut(cuts, cuts.clusters, points, wave, given, block_at(first, count), counted)


class Lightcuts(ShadowMethod):
    """Shades by cuts of a tree of lights."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self._lamps: Lamps | None = None
        self._tree: CutTree | None = None
        self._work: list[CutWork] = []

    def begin(self, frame: FrameView) -> None:
        pixels = frame.settings.width * frame.settings.height
        self._nodes, self._bound = np.full(pixels, -1, np.int32), np.zeros(pixels, np.float32)
        self._tally = np.zeros((frame.workers, TALLIES), np.int64)
        self._asked = frame.settings.lightcuts_error
        self._errors: CutErrors | None = None

    def update(self, frame: FrameView) -> None:
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
        seen = Seen(_NO_INTS, _NONE, _NO_INTS, _NO_INTS, np.zeros(TALLIES, np.int64))
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
        known = {"cut nodes": self._nodes, "cut bound": self._bound}
        return {name: pixels.reshape(shape).copy() for name, pixels in known.items()}  # more are shaded after this

    def keep(self, frame: FrameView) -> None:
        """A verified picture tells its error, and pixels that are wrong by more than was asked for."""
        buffers, self._errors = frame.buffers, None
        if frame.settings.verify and self._shades(frame):
            wrong = errors_of(buffers.color, buffers.reference)
            seen = buffers.primitive.reshape(-1) >= 0
            buffers.wrong[:] = seen & (wrong > frame.settings.lightcuts_error)
            if seen.any():
                median, most_of, most = np.percentile(wrong[seen], [50, 95, 100]).tolist()
                self._errors = CutErrors(median, most_of, most, int(buffers.wrong.sum()))

    def report(self, statistics: FrameStatistics) -> None:
        cuts = self._counts()
        statistics.decision = self._decided(cuts)
        if cuts.blocks:
            statistics.cuts = cuts

    def _counts(self) -> CutCounts:
        lights = 0 if self._lamps is None else len(self._lamps.samples)
        blocks, nodes, limited = self._tally.sum(0)[[BLOCKS, NODES, LIMITED]].tolist()
        return CutCounts(lights, blocks, nodes, limited, int(self._tally[:, MOST_NODES].max()), self._errors)

    def _decided(self, cuts: CutCounts) -> str:
        """What the method does in this scene, in words."""
        lights = lights_in_words(0 if self._lamps is None else len(self._lamps.places), cuts.lights)
        if self._tree is None:
            return f"{lights}: too few for clusters. Every shadow ray is traced."
        if self._asked == 0.0:
            return "No error is allowed: every shadow ray is traced."
        mean = f"{cuts.mean:,.0f}"
        said = (
            f"Cuts of {mean} cluster{'s' * (mean != '1')} on average, {cuts.most:,} at most, stand for {lights}; "
            f"a cluster may be wrong by {100 * self._asked:.3g} % of the light at a point."
        )
        if cuts.limited:
            larger = "is as large as it may be" if cuts.limited == 1 else "are as large as they may be"
            said += f" {cuts.limited:,} of {cuts.blocks:,} cuts {larger}."
        elif cuts.mean > FEW_LEFT * cuts.lights:
            said += " There are too few lights to gain from it."
        if cuts.errors is not None:
            half, most_of, most = (100 * e for e in (cuts.errors.median, cuts.errors.most_of, cuts.errors.most))
            said += (
                f" Half of the pixels are wrong by less than {half:.2g} %, 95 % by less than {most_of:.2g} %, "
                f"none by more than {most:.2g} %."
            )
        return said

    def forget(self) -> None:
        self._lamps = self._tree = None

    @property
    def tree(self) -> CutTree | None:
        """The tree of lights of the last frame; None where there are too few."""
        return self._tree

    @property
    def memory_bytes(self) -> int:
        work = sum(array.nbytes for work in self._work for array in work)
        return work + (0 if self._tree is None else self._tree.bytes)

    def _new_work(self, limit: int) -> CutWork:
        return new_work(limit, 2)


def errors_of(color: NDArray[np.float32], reference: NDArray[np.float32]) -> NDArray[np.float64]:
    """(n,): by what part pixels (n, 3) differ from what they should be, dark ones as `CutErrors` says."""
    found, true = (picture.astype(np.float64).sum(1) for picture in (color, reference))
    return np.abs(found - true) / np.maximum(true, float(DARK))


def new_work(limit: int, kept: int) -> CutWork:
    """Memory for cuts of so many nodes, for each of which so many rows of numbers are kept."""
    return CutWork(
        origin=np.zeros((3, ROOM), np.float32),
        direction=np.zeros((3, ROOM), np.float32),
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
    )

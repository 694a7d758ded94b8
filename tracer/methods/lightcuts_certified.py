"""Certified lightcuts: cuts of those lights alone that are not proved to be hidden (`tracer.shading.lightcuts.hidden`).

What is proved is what the method `certified` proves of many lights: that a triangle hides them from a whole region.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import carray

from tracer.culling.counters import SHADOW_COUNTERS
from tracer.culling.stages import call_at, selects, vectors
from tracer.methods.certified_lights import CertifiedLights
from tracer.methods.interface import FrameView, Services, Stage
from tracer.methods.lightcuts import Lightcuts
from tracer.methods.spatial_cache import WORDS
from tracer.neighbours.regions.lookup import look
from tracer.neighbours.regions.store import RegionView
from tracer.runtime.kernels import native_callback
from tracer.shading.lightcuts.block import BLOCK, Clusters
from tracer.shading.lightcuts.hidden import leave_out_hidden, see
from tracer.shading.lightcuts.shade import Cuts, block_at, shade_by_cut
from tracer.shading.points import points_in
from tracer.shading.wave import wave_in
from tracer.simd import i64_at
from tracer.simd.records import F32, Bytes, I64x2D, reading
from tracer.statistics import FrameStatistics


class CertifiedCuts(NamedTuple):
    """What a worker is given: its cuts, of a tree that is its own; the whole tree, with chances (n,) float32; what is
    known of regions; and memory: looks (lamps, WORDS) int64, and seen (lamps,) bool."""

    cuts: Cuts
    whole: Clusters
    chances: F32
    regions: RegionView
    looks: I64x2D
    seen: Bytes


certified_cuts_at = reading(CertifiedCuts)


@native_callback
def shade(data, call, light, count, counts):
    """Add the light of all lights to a wave's points, block by block, by cuts of those that may be visible."""
    given, certified = call_at(call), certified_cuts_at(data)
    points, wave, counted = points_in(given.points), wave_in(given.rays, count), carray(i64_at(counts), SHADOW_COUNTERS)
    known = selects(certified.looks, count)
    if known:
        look(certified.regions, points, count, certified.looks)
    for first in range(0, vectors(count), BLOCK):
        block = block_at(first, count)
        if known:
            changed = see(certified.looks, block, certified.seen)
            if changed or first == 0:
                leave_out_hidden(certified.whole, certified.chances, certified.seen, certified.cuts.clusters)
            shade_by_cut(certified.cuts, certified.cuts.clusters, points, wave, given, block, counted)
        else:  # the wave is too large
            shade_by_cut(certified.cuts, certified.whole, points, wave, given, block, counted)


class CertifiedLightcuts(Lightcuts):
    """Shades by cuts of the lights that are not proved to be hidden."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self._certified = CertifiedLights(services)
        self.parts = (self._certified,)

    def begin(self, frame: FrameView) -> None:
        super().begin(frame)
        self._certified.begin(frame)

    def update(self, frame: FrameView) -> None:
        super().update(frame)
        if self._shades(frame):
            self._certified.update(frame)

    def prepare(self, frame: FrameView) -> None:
        if self._shades(frame):
            self._certified.prepare(frame)

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        if not self._shades(frame):
            return []
        store, tree = self._certified.store, self._tree
        assert store is not None and tree is not None, "updated before"
        cuts, lamps = self._cuts(frame, worker, learns), len(frame.lights)
        whole = cuts.clusters
        own = {name: getattr(whole, name).copy() for name in ("boxes", "colors", "children", "reps", "falls")}
        looks, seen = np.zeros((lamps, WORDS), np.int64), np.zeros(lamps, np.bool_)
        cuts = cuts._replace(clusters=whole._replace(**own))
        return [Stage(CertifiedCuts(cuts, whole, tree.chances, store.view(), looks, seen), shade=shade)]

    def keep(self, frame: FrameView) -> None:
        super().keep(frame)
        if self._shades(frame):
            self._certified.keep(frame)

    def discard(self, frame: FrameView, begun: bool) -> None:
        self._certified.discard(frame, begun)

    def report(self, statistics: FrameStatistics) -> None:
        super().report(statistics)
        self._certified.report(statistics)

    def forget(self) -> None:
        super().forget()
        self._certified.forget()

    @property
    def memory_bytes(self) -> int:
        return super().memory_bytes + self._certified.memory_bytes

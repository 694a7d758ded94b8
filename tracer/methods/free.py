"""The method `free`: shadow rays that cost nothing, a measuring stick.

The picture is shaded twice.  The first time every shadow ray is traced and its answer recorded, tile by tile in the
order in which rays are asked about; the second time, which alone is counted and timed, the answers are replayed.  No
method can be faster, so that the speed-up of any other is a part of this one's.

It replays whole pictures with one sample a pixel.  A picture that is refined progressively, and further samples, are
traced as by `none`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import CULLED
from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, vectors
from tracer.methods.interface import FrameView, Services, ShadowMethod, Stage
from tracer.runtime.kernels import native_callback
from tracer.simd import i64_at, ones
from tracer.simd.records import I32x2D, I64x2D, reading
from tracer.statistics import FrameStatistics

ROOM = 1024  # vectors of answers of a tile and a light, to begin with


class Answers(NamedTuple):
    """Of each tile the bits of points that are lit, and of those that static geometry leaves unblocked, vector by
    vector, (tiles, n) int32; and how many vectors have been written, or read, (tiles, 1) int64."""

    lit: I32x2D
    unblocked: I32x2D
    at: I64x2D


answers_at = reading(Answers)


@native_callback
def find(data, call, light, count, counts):
    """A tile's first wave begins at the first of its answers."""
    given, answers = call_at(call), answers_at(data)
    if given.bounce == 0:
        answers.at[given.tile, 0] = 0


@native_callback
def record(data, call, light, count, counts):
    """Write the answers of a wave; where there is no room only their number is kept."""
    given, answers = call_at(call), answers_at(data)
    batch, first = shadow_batch_in(given.shadows), answers.at[given.tile, 0]
    if first + vectors(count) <= answers.lit.shape[1]:
        for v in range(vectors(count)):
            answers.lit[given.tile, first + v] = batch.lit[v]
            answers.unblocked[given.tile, first + v] = batch.unblocked[v]
    answers.at[given.tile, 0] = first + vectors(count)


@native_callback
def replay(data, call, light, count, counts):
    """Answer all rays of a wave, dynamic objects included."""
    given, answers = call_at(call), answers_at(data)
    batch, first = shadow_batch_in(given.shadows), answers.at[given.tile, 0]
    for v in range(vectors(count)):
        i64_at(counts)[CULLED] += ones(np.int64(batch.live[v]))
        batch.live[v] = 0
        batch.settled[v] = batch.due[v]
        batch.lit[v] = answers.lit[given.tile, first + v]
    answers.at[given.tile, 0] = first + vectors(count)


@native_callback
def restore(data, call, light, count, counts):
    """Say what static geometry has answered, for modes that are kept beside; `replay` has moved on by now."""
    given, answers = call_at(call), answers_at(data)
    batch, first = shadow_batch_in(given.shadows), answers.at[given.tile, 0] - vectors(count)
    for v in range(vectors(count)):
        batch.unblocked[v] = answers.unblocked[given.tile, first + v]


class Free(ShadowMethod):
    """Replays the answers of the same frame."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self._make_room(0, 0)
        self._replays, self._seconds = False, 0.0

    def prepare(self, frame: FrameView) -> None:
        """Trace the picture once, and record the answers."""
        self._replays, start = not frame.progressive, self.services.clock()
        if self._replays:
            tiles = len(frame.tiles)
            if len(self._answers.lit) != tiles:
                self._make_room(tiles, ROOM * len(frame.lights))
            while not self._recorded(frame):
                self._make_room(tiles, int(self._answers.at.max()))
        self._seconds = self.services.clock() - start

    def _make_room(self, tiles: int, room: int) -> None:
        lit, unblocked = np.empty((2, tiles, room), np.int32)
        self._answers = Answers(lit, unblocked, np.zeros((tiles, 1), np.int64))

    def _recorded(self, frame: FrameView) -> bool:
        """Whether there was room for all answers."""
        frame.rehearse([Stage(self._answers, find=find, learn=record)])
        return int(self._answers.at.max(initial=0)) <= self._answers.lit.shape[1]

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        replays = self._replays and learns
        return [Stage(self._answers, find=find, choose=replay, learn=restore)] if replays else []

    def report(self, statistics: FrameStatistics) -> None:
        """Leave out the time of recording."""
        statistics.seconds -= self._seconds
        statistics.phases["certification"] = statistics.phases.get("certification", 0.0) - self._seconds

    @property
    def memory_bytes(self) -> int:
        return self._answers.lit.nbytes + self._answers.unblocked.nbytes

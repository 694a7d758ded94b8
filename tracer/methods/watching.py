"""Watching what becomes of one pixel's shadow rays: stages that stand between those of a method, and change nothing.

A ray that was open before a stage and is not open after it has been answered by that stage.  So a tile is shaded once
more with a watcher before the first stage and one after each: what they see is what culling does, whatever the method.
The last of them takes every ray out of those that are to be traced, of which nobody needs the answer.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.shadow_batch import shadow_batch_in
from tracer.culling.stages import call_at, vectors
from tracer.kernels import entry
from tracer.methods.interface import Stage
from tracer.shading.wave import wave_in
from tracer.simd.records import I32, I64, F32x2D, I32x2D, reading

# Of what is noted for a ray: bits, and how many stages had been watched when it was answered, from 1 on; 0 for a ray
# that no stage answers.
DUE, LIT, SETTLED = 1, 2, 4
ANSWERED = 8  # bits to the left
FIRST, END = range(2)  # of `state`: the rows of the wave


class Watch(NamedTuple):
    """What all watchers of a pixel share, but for the first three: how many stages come before this one; the row of the
    stages' memory in which the last of them keeps a number for each point, or -1; and whether this is the last watcher.

    place is where the pixel is in the picture.  Of its rays, in the order of waves: lane (rows,) in its wave, ray
    (rows, 6) origin and direction, noted (rows, samples) what became of each shadow ray, and kept (rows, samples) what
    the stage that answered it keeps for the point."""

    number: int
    row: int
    last: bool
    place: int
    state: I64
    lane: I32
    ray: F32x2D
    noted: I32x2D
    kept: I32x2D


watch_at = reading(Watch)


@entry
def find(data, call, light, count, counts):
    """Which points of the wave are the pixel's?"""
    given, watch = call_at(call), watch_at(data)
    wave, row = wave_in(given.rays, count), watch.state[END]
    watch.state[FIRST] = row
    for i in range(count):
        if given.place[wave.pixel[i]] == watch.place and row < len(watch.lane):
            watch.lane[row] = i
            for axis in range(3):
                watch.ray[row, axis] = wave.origin[axis, i]
                watch.ray[row, 3 + axis] = wave.direction[axis, i]
            row += 1
    watch.state[END] = row


@entry
def choose(data, call, light, count, counts):
    """Note which of the pixel's rays have been answered."""
    given, watch = call_at(call), watch_at(data)
    batch, sample = shadow_batch_in(given.shadows), given.sample
    for row in range(watch.state[FIRST], watch.state[END]):
        v, bit = watch.lane[row] >> 4, watch.lane[row] & 15
        noted = watch.noted[row, sample]
        if watch.number == 0:
            noted = (batch.due[v] >> bit) & 1
        if noted & DUE != 0 and noted >> ANSWERED == 0 and (batch.live[v] >> bit) & 1 == 0:
            noted |= ((batch.lit[v] >> bit) & 1) * LIT | ((batch.settled[v] >> bit) & 1) * SETTLED
            noted |= (watch.number + 1) << ANSWERED
            if watch.row >= 0:
                watch.kept[row, sample] = given.scratch[watch.row].view(np.int32)[watch.lane[row]]
        watch.noted[row, sample] = noted
    if watch.last:
        for v in range(vectors(count)):
            batch.live[v] = 0
            batch.settled[v] |= batch.lit[v]


class Watched(NamedTuple):
    """What watchers have seen of `rows` rays: see `Watch`."""

    rows: int
    ray: F32x2D
    noted: I32x2D
    kept: I32x2D


class Watchers:
    """Watches the pixel at a place, of at most so many rays, and shadow rays to so many samples."""

    def __init__(self, place: int, rays: int, samples: int) -> None:
        self._shared = (
            place,
            np.zeros(2, np.int64),
            np.zeros(rays, np.int32),
            np.zeros((rays, 6), np.float32),
            np.zeros((rays, samples), np.int32),
            np.full((rays, samples), -1, np.int32),
        )

    def between(self, stages: list[Stage]) -> list[Stage]:
        """The stages with a watcher before the first, and after each."""
        found, row = [Stage(Watch(0, -1, not stages, *self._shared), find=find, choose=choose)], 0
        for number, stage in enumerate(stages, 1):
            watch = Watch(number, row if stage.rows else -1, number == len(stages), *self._shared)
            found += [stage, Stage(watch, choose=choose)]
            row += stage.rows
        return found

    @property
    def seen(self) -> Watched:
        _, state, _, ray, noted, kept = self._shared
        return Watched(int(state[END]), ray, noted, kept)

"""Stages: how a method takes part in shadow testing, as kernels that are called by address.

Shading knows no method.  It is given a table of stages, and calls up to seven kernels of each:

    find(data, call, 0, count, counts)          once for a wave: what is known of these points?
    select(data, call, 0, count, counts)        once for a wave, after that: which lights must they look at?
    approach(data, call, light, count, counts)  once for each light that is looked at, before its samples
    choose(data, call, light, count, counts)    for each sample of a light: answers rays, which are not traced then
    learn(data, call, light, count, counts)     for each sample of a light: learns from all answers
    finish(data, call, 0, count, counts)        once for a wave, after all lights
    shade(data, call, 0, count, counts)         once for a wave, in the place of all lights: adds what they send

`data` is the address of the stage's own block, and `call` that of a `Call`; `count` is the number of points, and
`counts` the address of the shadow counters (`tracer.culling.counters`).  A kernel that chooses takes points out of
`live` and, where static geometry leaves them lit, puts them into `lit`; dynamic objects are asked about those
unless it puts them into `settled` too.

Where a stage shades, it adds the light of all lights to that of the points, by whatever rays it traces and counts
itself.  Lights are then gone through one by one only as far as somebody wants to know all rays: these are traced, one
and all, and neither counted nor added to the light.

Stages run in the order of the table: a later one chooses among what an earlier one left live.  So methods compose,
shading is compiled once for all of them, and kernels of methods that nobody chose are never compiled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined
from tracer.simd import address_of, call_native, load_i64, store
from tracer.simd.records import I32, F32x2D, block_size, reading, writing

# Columns of the table: addresses of the seven kernels, 0 for none, and of the stage's data, and the first of its rows
# in the memory that stages work in.
FIND, SELECT, APPROACH, CHOOSE, LEARN, FINISH, SHADE, DATA, FIRST_ROW = range(9)
COLUMNS = 9


class Stages(NamedTuple):
    """table (k, COLUMNS) int64; how many rows of memory all stages need; whether one wants to know what blocks the rays
    that are traced; and whether answers are verified.

    Where a stage selects, looks (lights, words) int64 has a bit for each vector of a wave that must look at a light; it
    has no rows where all do, and larger waves look at all lights.  Of the first `everything` lights somebody wants to
    know all rays: those to which points need not look then count as due and culled.  `shades` says whether a stage
    shades in the place of all lights."""

    table: NDArray[np.int64]
    rows: int
    occluders: bool
    verify: bool
    everything: int
    looks: NDArray[np.int64]
    shades: bool


class Call(NamedTuple):
    """What a stage is given: the stage's first row in `scratch`; which of the samples it is asked about, and which of
    its light's that is, 0 for the first; the number of the tile; the bounce, 0 for
    primary hits; the memory of the surface points, of the rays that hit them, of the shadow batch, and of the stages,
    (rows, n) float32 each; the positions of all lights' samples (s, 3) float32; and place (n,) int32, where in the
    picture the pixels of the tile are, by their numbers in the wave.

    All of this is memory of whoever calls, who keeps it until the wave is done."""

    first_row: int
    sample: int
    nth: int
    tile: int
    bounce: int
    points: F32x2D
    rays: F32x2D
    shadows: F32x2D
    scratch: F32x2D
    samples: F32x2D
    place: I32


call_at = reading(Call)
write_call = writing(Call)
CALL = block_size(Call)


@inlined
def run_stages(stages, which, call, light, count, counts):
    """Call one of the seven kernels of every stage that has it."""
    for k in range(len(stages.table)):
        callback = stages.table[k, which]
        if callback != 0:
            store(call, stages.table[k, FIRST_ROW])
            call_native(callback, stages.table[k, DATA], call, np.int64(light), np.int64(count), address_of(counts))


@inlined
def write_sample(call, sample, nth):
    """Say which sample the stages are asked about next."""
    store(call + 8, np.int64(sample))
    store(call + 16, np.int64(nth))


@inlined
def selects(looks, count):
    """Whether there is a bit for every vector of a wave of `count` points."""
    return len(looks) > 0 and vectors(count) <= 64 * looks.shape[1]


@inlined
def looked_at(looks, light, count):
    """The address of the bits of the vectors, of `count` points, that must look at a light; 0 where all must."""
    return address_of(looks[light]) if selects(looks, count) else np.int64(0)


@inlined
def looks_at(looked, v):
    """Whether a vector must look at the light whose bits are at an address."""
    return looked == 0 or (load_i64(looked + 8 * (v >> 6)) >> (v & 63)) & 1 != 0


@inlined
def scratch_of(given):
    """A stage's own rows of memory."""
    return given.scratch[given.first_row :]


@inlined
def vectors(count):
    """Vectors of sixteen that hold so many points."""
    return (count + 15) // 16

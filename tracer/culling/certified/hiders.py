"""Hiders: the triangles that hid a lamp from a wave's points are asked about their neighbours first.

Where rays to a lamp are blocked, the same few triangles block those of many points.  So for each lamp and each vector
of sixteen points the triangles that hid others are asked, for all samples at once (`hidden_samples`).  Where they
leave some of the lamp, the rays to one of the points are traced, and what blocks these is asked as well.  What is
certainly hidden by them needs no rays, and all else is traced.

It costs no more than a part of what the rays would: nothing is searched for, and a lamp that is seen costs the
rays to one point of a vector, or of every fourth or sixteenth where that keeps being so.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.certified.error_bounds import LANES, SureHitLength
from tracer.culling.certified.hidden_samples import BITS, hide_samples, keep_bits
from tracer.culling.certified.prepared_triangles import PREPARED, Lamp, prepare
from tracer.culling.certified.seen_by_lamp import KEPT, SAMPLES, ask_points, ask_triangles, put_samples
from tracer.culling.counters import RAYS, TESTS
from tracer.culling.shadow_testing import LIGHT_MARGIN, shadow_rays
from tracer.culling.stages import looks_at, vectors
from tracer.geometry.queries import STATIC_GEOMETRY, any_hits_by
from tracer.kernels import inlined, subkernel
from tracer.simd import bits_of, i32_at, i32x16, lanes_below, load_i32, load_three, local_memory, lowest_bit, ones, store
from tracer.simd.records import F32, I32, F32x2D

TRIES = 4  # points of a vector whose rays are traced to find what blocks them, at most
NUMBERS = 4 * LANES
ONE = np.float32(1)


class Hiders(NamedTuple):
    """What kernels are given of lamps, and of the triangles that may hide them.

    Attributes:
        rows: (t, ROW) float32, triangles that never move, as in `Occluders`.
        farthest: how long rays may be to be certain of a hit.
        places, radii: (lights, 3) and (lights,) float32, the balls in which lamps' samples lie.
        samples, first: (s, 3) float32 and (lights + 1,) int32, as in `Lamps`.
        least: a lamp with fewer samples is traced.
        any_hit, data: the query of the structure (`tracer.geometry.queries`).
    """

    rows: F32x2D
    farthest: SureHitLength
    places: F32x2D
    radii: F32
    samples: F32x2D
    first: I32
    least: int
    any_hit: int
    data: int


class _Room(NamedTuple):
    """Addresses of memory: a lamp's samples; the numbers of hiders, NONE for none; these prepared; what is kept of one and a
    vector of points, or of all and one point; and bits of sixteen points for each sample."""

    samples: int
    numbers: int
    prepared: int
    kept: int
    bits: int


@inlined
def is_lamp(hiders, light):
    """Whether a light has so many samples that asking is worth it."""
    return len(hiders.rows) > 0 and hiders.first[light + 1] - hiders.first[light] >= hiders.least


@subkernel
def find_hidden(hiders, points, batch, hidden, number, looked, count, counts):
    """Find from which of `count` points samples of lamp `number` are hidden, where vectors must look at it (`looks_at`)."""
    place, radius, first = hiders.places[number], hiders.radii[number], np.int64(hiders.first[number])
    light, many = (place[0], place[1], place[2]), np.int64(hiders.first[number + 1]) - first
    room = _Room(
        local_memory(SAMPLES), local_memory(NUMBERS), local_memory(PREPARED), local_memory(KEPT), local_memory(BITS)
    )
    lamp = Lamp(np.int64(number), light, radius, put_samples(hiders.samples, first, many, light, room.samples))
    for k in range(LANES):
        i32_at(room.numbers)[k] = 0
    known, oldest, in_vain, traced = 0, 0, 0, np.zeros(RAYS + 1, np.int64)
    for v in range(vectors(count)):
        hidden.some[v] = 0
        if not looks_at(looked, v):
            continue
        open_ = _facing(points, light, radius, v) & lanes_below(count, v)
        if open_ == 0:
            hidden.some[v] = -1
            continue
        tries = TRIES
        if in_vain > 1 and v % (4 if in_vain < 8 else 16) != 0:
            tries = 0
        if known == 0 and tries == 0:
            continue
        end = load_three(points.lifted, v)
        for k in range(0, many, LANES):
            store(room.bits + 4 * k, i32x16(0))
        full, every, asked, found = np.int64(0), np.int64(0), np.int64(0), False
        while open_ & ~(full | every) != 0:
            lane = lowest_bit(open_ & ~(full | every))
            new = np.int64(0)
            if known > 0:
                i = 16 * v + lane
                point = points.lifted[0, i], points.lifted[1, i], points.lifted[2, i]
                whole, missed, can = ask_triangles(room.prepared, point, light, radius, room.kept)
                new = (np.int64(whole) | (np.int64(can) & ~np.int64(missed))) & ((np.int64(1) << known) - 1) & ~asked
                if new & np.int64(whole) != 0:
                    new &= np.int64(whole)
            if new == 0:
                if tries == 0:
                    break
                tries -= 1
                new = _trace_point(hiders, points, batch, 16 * v + lane, lane, first, many, known, oldest, room, traced)
                if new == 0:
                    in_vain = in_vain if found else in_vain + 1
                    break
                found, in_vain = True, 0
                oldest = (oldest + ones(new)) % LANES
                known = min(LANES, known + ones(new))
                prepare(hiders.rows, hiders.farthest, lamp, room.numbers, room.prepared)
            while new != 0 and open_ & ~(full | every) != 0:
                k = lowest_bit(new)
                new &= new - 1
                asked |= np.int64(1) << k
                counts[TESTS] += 1
                triangle = room.prepared + 4 * k
                whole, missed, can = ask_points(triangle, end, light, radius, room.kept)
                full |= np.int64(whole)
                some = np.int64(can) & ~(np.int64(whole) | np.int64(missed)) & open_
                if some != 0:
                    every |= hide_samples(triangle, room.kept, some, room.samples, many, room.bits)
        if asked != 0:
            keep_bits(hidden, v, full, room.bits, many)
            if open_ & ~(full | every) == 0:
                hidden.some[v] = -1
    for k in range(RAYS + 1):
        counts[k] += traced[k]


@inlined
def _facing(points, light, radius, v):
    """Bits of the points of a vector that may be due to some sample of a lamp."""
    px, py, pz = load_three(points.position, v)
    gx, gy, gz = load_three(points.geometric, v)
    x, y, z = light[0] - px, light[1] - py, light[2] - pz
    room = np.float32(1.001) * radius + np.float32(1e-5) * (abs(light[0]) + abs(light[1]) + abs(light[2]))
    return bits_of(gx * x + gy * y + gz * z > -room)


@subkernel
def _trace_point(hiders, points, batch, i, lane, first, many, known, oldest, room, counts):
    """Trace rays to point i, in a lane, from up to sixteen samples that are not known to be hidden; bits of the hiders that
    are new, which take the place of the oldest."""
    step, k, n = (many + LANES - 1) // LANES, np.int64(0), 0
    while k < many:
        if (load_i32(room.bits + 4 * k) >> lane) & 1 == 0:
            for axis in range(3):
                start = hiders.samples[first + k, axis]
                batch.origin[axis, n] = start
                batch.direction[axis, n] = points.lifted[axis, i] - start
            batch.t_min[n], batch.t_max[n] = LIGHT_MARGIN, ONE
            n += 1
        k += step
    any_hits_by(hiders, shadow_rays(batch), STATIC_GEOMETRY, batch.blocked, batch.occluders, 0, n, counts)
    counts[RAYS] += n
    numbers, new = i32_at(room.numbers), np.int64(0)
    for ray in range(n):
        which, there = batch.occluders[ray], False
        if which < 0 or which >= len(hiders.rows):
            continue
        for k in range(known):
            there |= numbers[k] == which
        if not there:
            numbers[oldest] = which
            new |= np.int64(1) << oldest
            oldest, known = (oldest + 1) % LANES, min(LANES, known + 1)
    return new

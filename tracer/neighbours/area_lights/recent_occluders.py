"""Ask the triangles that have just hidden a lamp from some points of a wave about their neighbours first.

Where rays to a lamp are blocked, the same few triangles block those of many points.  So for each lamp and each vector
of sixteen points the triangles that hid others are asked, for all samples at once (`hide_samples`).  Where they
leave some of the lamp, the rays to one of the points are traced, and what blocks these is asked as well.  What is
certainly hidden by them needs no rays, and all else is traced.

It costs no more than a part of what the rays would: nothing is searched for, and a lamp that is seen costs the
rays to one point of a vector, or of every fourth or sixteenth where that keeps being so.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import RAYS, TESTS
from tracer.culling.shadow_testing import LIGHT_MARGIN, may_face, shadow_rays
from tracer.culling.stages import looks_at, vectors
from tracer.geometry.queries import STATIC_GEOMETRY, any_hits_by
from tracer.neighbours.area_lights.lamp_answers import ALL, BITS, NOTHING, SOME, keep_bits
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    i32_at,
    i32x16,
    i64_at,
    lanes_below,
    load_i32,
    load_three,
    local_memory,
    lowest_bit,
    store,
)
from tracer.simd.records import F32, I32, F32x2D
from tracer.visibility.area_light_tests import KEPT, SAMPLES, ask_points, ask_triangles, hide_samples, put_samples
from tracer.visibility.error_bounds import LANES, SureHitLength
from tracer.visibility.prepared_triangles import PREPARED, Lamp, prepare

TRIES = 4  # points of a vector whose rays are traced to find what blocks them, at most
NUMBERS, STATE = 4 * LANES, 24  # bytes
# Of a lamp's state: how many occluders are known; which is replaced next; and how many vectors in a row had no new one.
KNOWN, NEXT, IN_VAIN = range(3)
ONE = np.float32(1)


class RecentOccluders(NamedTuple):
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
    """Addresses of memory: of a lamp's samples; of the numbers of recent occluders, int32; of these prepared; of what
    is kept of one and a vector of points, or of all and one point; of bits of sixteen points for each sample; and of a
    lamp's state, int64."""

    samples: int
    numbers: int
    prepared: int
    kept: int
    bits: int
    state: int


@inlined
def is_lamp(recent, light):
    """Whether a light has so many samples that asking is worth it."""
    return len(recent.rows) > 0 and recent.first[light + 1] - recent.first[light] >= recent.least


@subkernel
def find_hidden(recent, points, batch, hidden, number, looked, count, counts):
    """Find from which of `count` points samples of lamp `number` are hidden, into `HiddenSamples`.

    Only vectors that must look at it are asked about, by bits at the address `looked` (`looks_at`).  The rays that are
    traced have their place in batch, a `ShadowBatch`."""
    place, first = recent.places[number], np.int64(recent.first[number])
    light, many = (place[0], place[1], place[2]), np.int64(recent.first[number + 1]) - first
    room = _Room(
        local_memory(SAMPLES), local_memory(NUMBERS), local_memory(PREPARED), local_memory(KEPT), local_memory(BITS),
        local_memory(STATE),
    )  # fmt: skip
    groups = put_samples(recent.samples, first, many, light, room.samples)
    lamp, state = Lamp(number, light, recent.radii[number], groups), i64_at(room.state)
    state[KNOWN], state[NEXT], state[IN_VAIN] = 0, 0, 0
    store(room.numbers, i32x16(0))
    made = np.zeros(RAYS + 1, np.int64)  # steps, tests and rays: queries count into arrays
    for v in range(vectors(count)):
        hidden.some[v] = NOTHING
        if not looks_at(looked, v):
            continue
        facing = may_face(points, light, lamp.radius, v) & lanes_below(count, v)
        if facing == 0:
            hidden.some[v] = ALL
            continue
        often = 1 if state[IN_VAIN] < 2 else (4 if state[IN_VAIN] < 8 else 16)
        tries = TRIES if v % often == 0 else 0
        if state[KNOWN] > 0 or tries > 0:
            _ask_vector(recent, points, batch, hidden, v, lamp, first, many, facing, tries, room, made)
    for k in range(RAYS + 1):
        counts[k] += made[k]


@subkernel
def _ask_vector(recent, points, batch, hidden, v, lamp, first, many, facing, tries, room, counts):
    """Ask recent occluders about those points of a vector that face the lamp, tracing rays to no more than so many of
    them."""
    state, asked, found = i64_at(room.state), np.int64(0), False
    for k in range(0, many, LANES):
        store(room.bits + 4 * k, i32x16(0))
    gone = np.int64(0)  # points from which all of the lamp is hidden
    while facing & ~gone != 0:
        lane = lowest_bit(facing & ~gone)
        new = _that_may_hide(points, lamp, 16 * v + lane, room) & ~asked if state[KNOWN] > 0 else np.int64(0)
        if new == 0:
            if tries == 0:
                break
            tries -= 1
            new = _trace_point(recent, points, batch, 16 * v + lane, lane, first, many, room, counts)
            if new == 0:
                state[IN_VAIN] += 0 if found else 1
                break
            found, state[IN_VAIN] = True, 0
            prepare(recent.rows, recent.farthest, lamp, room.numbers, room.prepared)
        asked |= new
        gone = _hide(load_three(points.lifted, v), lamp, new, facing, gone, many, room, counts)
    if asked != 0:
        keep_bits(hidden, v, gone, room.bits, many)
        hidden.some[v] = SOME if facing & ~gone != 0 else ALL


@inlined
def _that_may_hide(points, lamp, i, room):
    """Bits of the recent occluders that may hide the lamp from point i; if any hide all of it, of these alone."""
    known = (np.int64(1) << i64_at(room.state)[KNOWN]) - 1
    point = points.lifted[0, i], points.lifted[1, i], points.lifted[2, i]
    whole, missed, can = ask_triangles(room.prepared, point, lamp.light, lamp.radius, room.kept)
    whole = np.int64(whole) & known
    return whole if whole != 0 else np.int64(can) & ~np.int64(missed) & known


@subkernel
def _hide(end, lamp, new, facing, gone, many, room, counts):
    """Ask recent occluders, by their bits, about sixteen points `end`; the points from which the lamp is hidden as a
    whole, with those for which that was known."""
    while new != 0 and facing & ~gone != 0:
        triangle = room.prepared + 4 * lowest_bit(new)
        new &= new - 1
        counts[TESTS] += 1
        whole, missed, can = ask_points(triangle, end, lamp.light, lamp.radius, room.kept)
        gone |= np.int64(whole)
        some = np.int64(can) & ~np.int64(missed) & facing & ~gone
        if some != 0:
            gone |= hide_samples(triangle, room.kept, some, room.samples, many, room.bits)
    return gone


@subkernel
def _trace_point(recent, points, batch, i, lane, first, many, room, counts):
    """Trace rays to point i, in a lane, from up to sixteen samples that are not known to be hidden; bits of the
    occluders that are new, which take the place of the oldest."""
    step, k, n = (many + LANES - 1) // LANES, 0, 0
    while k < many:
        if (np.int64(load_i32(room.bits + 4 * k)) >> lane) & 1 == 0:
            for axis in range(3):
                start = recent.samples[first + k, axis]
                batch.origin[axis, n] = start
                batch.direction[axis, n] = points.lifted[axis, i] - start
            batch.t_min[n], batch.t_max[n] = LIGHT_MARGIN, ONE
            n += 1
        k += step
    any_hits_by(recent, shadow_rays(batch), STATIC_GEOMETRY, batch.blocked, batch.occluders, 0, n, counts)
    counts[RAYS] += n
    numbers, state, new = i32_at(room.numbers), i64_at(room.state), np.int64(0)
    for ray in range(n):
        which, there = batch.occluders[ray], False
        for k in range(state[KNOWN]):
            there |= numbers[k] == which
        if there or which < 0 or which >= len(recent.rows):  # or nothing, or no triangle, or one that rests
            continue
        numbers[state[NEXT]] = which
        new |= np.int64(1) << state[NEXT]
        state[NEXT], state[KNOWN] = (state[NEXT] + 1) % LANES, min(LANES, state[KNOWN] + 1)
    return new

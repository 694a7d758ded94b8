"""Asking what comes between a lamp and points: sixteen points at a time with one beam, or one point with its own.

Both find the primitives that come into the beam, prepare them, and ask them (`area_light_tests`), first about all of
the lamp and then, where that cannot tell, about its samples."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import TESTS
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    bits_of,
    i32_at,
    i32x16,
    i64_at,
    lanes_below,
    load_f32x16,
    load_i32,
    load_three,
    lowest_bit,
    mask16,
    ones,
    select,
    store,
)
from tracer.visibility.area_light_tests import KEPT, MOST_SAMPLES, ask_points, ask_samples, ask_triangles
from tracer.visibility.beams import make_beam, passes_by, primitives_met, put_cone
from tracer.visibility.error_bounds import LANES
from tracer.visibility.prepared_triangles import PREPARED, prepare_in_tree, prepared_met

# Primitives that may come between, at most: a group of vectors', or else each of these goes through the tree by itself;
# a vector's, or else each of its points does; and a point's, or else its rays are traced.
OF_GROUP, OF_VECTOR, OF_POINT = 96, 256, 240
MOST_UNSURE = 64  # primitives about which a vector, or vectors of primitives about which a point, remains unsure
GROUPS = MOST_SAMPLES // LANES
ALL_FOUND = max(OF_VECTOR, OF_POINT)
NUMBERS, ALL_PREPARED = 4 * (ALL_FOUND + LANES + WIDTH), PREPARED * (ALL_FOUND // LANES)  # bytes
MARKS = 4 * LANES * GROUPS  # bytes: a bit for each sample of each point of a vector
ENTRY = 24  # bytes
ALL_KEPT, UNSURE = KEPT * MOST_UNSURE, ENTRY * MOST_UNSURE  # bytes
STATE = 24  # bytes
# Nanoseconds, about, without vectors of 512 bits: a beam and its way to the first leaf; sixteen primitives found and
# prepared; one asked about a vector of points, or sixteen about one; and about one point, and sixteen of its samples.
FOR_BEAM, FOR_SIXTEEN, FOR_POINTS, FOR_POINT, FOR_SAMPLES = 250, 400, 100, 8, 16
# Of a lamp's state: nanoseconds since the last account; which prepared triangle hid a point of the group last, -1 for
# none; and whether those that hid a point with a beam of its own are kept.
EFFORT, LATEST, HIDING = range(3)
# Of an entry: where the prepared triangle is, the points about which it is unsure, and those from which it can hide.
TRIANGLE, POINTS, CAN = range(3)
HIDDEN, SEEN, PARTLY = range(3)  # what a point sees of a lamp


class Scratch(NamedTuple):
    """Addresses of memory that the kernel which asks has: of samples, of primitives' numbers and these prepared, of
    what is kept of those that remain unsure, and of entries about these; of bits of samples, 16 points one after the
    other, that are blocked and of which nothing is certain; of a lamp's state, int64; and of those prepared primitives
    of which one hid a point with a beam of its own last."""

    samples: int
    numbers: int
    prepared: int
    kept: int
    entries: int
    blocked: int
    unsure: int
    state: int
    hiding: int


@inlined
def start_lamp(scratch):
    """Nothing has been asked about a lamp."""
    state = i64_at(scratch.state)
    state[EFFORT], state[LATEST], state[HIDING] = 0, -1, 0


@inlined
def batches_of(count):
    """How many vectors of sixteen so many primitives make, none where they are too many."""
    return (count + LANES - 1) // LANES


@subkernel
def find_primitives(o, number, beam, most, scratch, counts):
    """Find the primitives that may come into a beam, whole vectors of them; how many, or -1 for more than `most`."""
    found = primitives_met(o, number, beam, most, scratch.numbers, counts)
    i64_at(scratch.state)[EFFORT] += FOR_BEAM + FOR_SIXTEEN * batches_of(found if found >= 0 else most)
    for k in range(max(found, 0), LANES * batches_of(found)):
        store(scratch.numbers + 4 * k, i32_at(scratch.numbers)[0])
    return found


@subkernel
def ask_vector(o, points, answers, v, lamp, beam, found, prepared, cost, scratch, counts):
    """Ask the primitives that come into a beam about the points of a vector: so many as were found, and perhaps
    `prepared`.  The rays of each point cost so many nanoseconds."""
    end, every, state = load_three(points.lifted, v), np.int64(answers.open[v]), i64_at(scratch.state)
    # Points that may see some sample, those of which some primitive is unsure, and those that are asked about no more.
    live, begun, left, entries, often = every, np.int64(0), np.int64(0), np.int64(0), i32x16(0)
    most = np.int32(worth_asking(lamp, cost))
    before = state[LATEST] if prepared else np.int64(-1)
    batch, met = np.int64(-1), np.int64(0)
    if before >= 0:  # what hid the neighbours may hide these
        batch, met = before // LANES, np.int64(1) << (before % LANES)
    first = before >= 0
    while live & ~left != 0:
        if met == 0:
            batch = np.int64(0) if first else batch + 1
            first = False
            if batch >= batches_of(found):
                break
            made = scratch.prepared + PREPARED * batch
            if not prepared:
                prepare_in_tree(o, lamp, scratch.numbers + 64 * batch, made)
            met = np.int64(prepared_met(made, beam)) & lanes_below(found, batch)
            if before >= 0 and before // LANES == batch:
                met &= ~(np.int64(1) << (before % LANES))
            continue
        lane = lowest_bit(met)
        met &= met - 1
        triangle, kept = scratch.prepared + PREPARED * batch + 4 * lane, scratch.kept + KEPT * entries
        open_ = live
        counts[TESTS] += ones(open_)
        state[EFFORT] += FOR_POINTS
        hidden, missed, can = ask_points(triangle, end, lamp.light, lamp.radius, kept)
        if open_ & hidden != 0:
            live &= ~hidden
            state[LATEST] = LANES * batch + lane
        unsure = open_ & ~(hidden | missed)
        if unsure == 0:
            continue
        begun |= unsure
        often = select(mask16(unsure), often + np.int32(1), often)
        left |= bits_of(often > most)
        if entries + 1 < MOST_UNSURE:
            entry = i64_at(scratch.entries + ENTRY * entries)
            entry[TRIANGLE], entry[POINTS], entry[CAN] = triangle, unsure, can
            entries += 1
        else:
            left |= unsure
    some = live & begun
    while some != 0:
        lane = lowest_bit(some)
        some &= some - 1
        if _all_hidden(lane, left, entries, lamp, scratch):
            live &= ~(np.int64(1) << lane)
    answers.full[v] = every & ~live
    answers.lit[v] = live & ~begun
    answers.partly[v] = live & begun
    _write_bits(answers, v, live & begun, lamp.groups, scratch)


@inlined
def _all_hidden(lane, left, entries, lamp, scratch):
    """Ask what is unsure of a point about its samples, but for points that are `left`; whether all are hidden."""
    bit = np.int64(1) << lane
    _put_bits(scratch.blocked, lane, lamp.groups, 0)
    _put_bits(scratch.unsure, lane, lamp.groups, -1 if left & bit != 0 else 0)
    for k in range(entries if left & bit == 0 else 0):
        entry = i64_at(scratch.entries + ENTRY * k)
        if entry[POINTS] & bit == 0:
            continue
        kept = scratch.kept + KEPT * k
        if _ask_samples(entry[TRIANGLE], kept, lane, entry[CAN] & bit != 0, lamp, lane, scratch):
            return True
    return False


@subkernel
def ask_each(o, points, answers, v, lamp, lamps, cost, scratch, counts):
    """Ask about the points of a vector, which lie far apart, one by one: each has a beam of its own.

    Group and vector have no primitives in common then: what was found of these is overwritten."""
    beam, every, state, partly = make_beam(), np.int64(answers.open[v]), i64_at(scratch.state), np.int64(0)
    some = every
    while some != 0:
        lane = lowest_bit(some)
        i, bit = 16 * v + lane, np.int64(1) << lane
        some &= some - 1
        end = points.lifted[0, i], points.lifted[1, i], points.lifted[2, i]
        normal = points.geometric[0, i], points.geometric[1, i], points.geometric[2, i]
        if not put_cone(beam, end, normal, lamp.light, lamp.radius, lamps.within):
            continue
        if state[HIDING] != 0:  # what hid another may hide this one
            hidden, _, _ = ask_triangles(scratch.hiding, end, lamp.light, lamp.radius, scratch.kept)
            state[EFFORT] += FOR_POINTS
            if hidden != 0:
                answers.full[v] |= bit
                continue
        found = find_primitives(o, lamp.number, beam, OF_POINT, scratch, counts)
        if found < 0:
            continue
        if passes_by(beam, lamps.moving):
            answers.alone[v] |= bit
        sees = _ask_point(o, lamp, end, lane, found, cost, scratch, counts)
        if sees == HIDDEN:
            answers.full[v] |= bit
        elif sees == SEEN:
            answers.lit[v] |= bit
        else:
            partly |= bit
    answers.partly[v] = partly
    _write_bits(answers, v, partly, lamp.groups, scratch)


@subkernel
def _ask_point(o, lamp, end, lane, found, cost, scratch, counts):
    """Ask the primitives that were found about one point, whose rays cost so many nanoseconds: HIDDEN, SEEN, or PARTLY
    with bits in its lane."""
    state, unsure = i64_at(scratch.state), 0
    for batch in range(batches_of(found)):
        made, kept = scratch.prepared + PREPARED * batch, scratch.kept + KEPT * batch
        prepare_in_tree(o, lamp, scratch.numbers + 64 * batch, made)
        counts[TESTS] += ones(lanes_below(found, batch))
        state[EFFORT] += FOR_POINTS
        hidden, missed, can = ask_triangles(made, end, lamp.light, lamp.radius, kept)
        if hidden != 0:
            for at in range(0, PREPARED, 64):
                store(scratch.hiding + at, load_f32x16(made + at))
            state[HIDING] = 1
            return HIDDEN
        entry = i64_at(scratch.entries + ENTRY * batch)
        entry[TRIANGLE], entry[POINTS], entry[CAN] = made, lanes_below(found, batch) & ~missed, can
        unsure += ones(entry[POINTS])
    if unsure == 0:
        return SEEN
    leave = unsure > worth_asking(lamp, cost)
    _put_bits(scratch.blocked, lane, lamp.groups, 0)
    _put_bits(scratch.unsure, lane, lamp.groups, -1 if leave else 0)
    if leave:
        return PARTLY
    for batch in range(batches_of(found)):
        entry = i64_at(scratch.entries + ENTRY * batch)
        some = entry[POINTS]
        while some != 0:
            k = lowest_bit(some)
            some &= some - 1
            triangle, kept = entry[TRIANGLE] + 4 * k, scratch.kept + KEPT * batch
            if _ask_samples(triangle, kept, k, (entry[CAN] >> k) & 1 != 0, lamp, lane, scratch):
                return HIDDEN
    return PARTLY


@inlined
def worth_asking(lamp, cost):
    """How many triangles may be asked about a point's samples before its rays, of which each costs so many nanoseconds,
    take less: those of which nothing is certain by then are traced."""
    return 3 * cost // (2 * (FOR_POINT + FOR_SAMPLES * lamp.groups))


@inlined
def _put_bits(bits, lane, groups, value):
    """Put a value, 0 for none or -1 for all of a lamp's samples, into bits at an address, of the point in a lane."""
    for at in range(4 * GROUPS * lane, 4 * GROUPS * lane + 4 * groups, 64):
        store(bits + at, i32x16(value))


@inlined
def _ask_samples(triangle, kept, kept_lane, can, lamp, lane, scratch):
    """Ask a triangle about the samples of the point in a lane, of which `kept` has a lane; whether all are hidden."""
    i64_at(scratch.state)[EFFORT] += FOR_POINT + FOR_SAMPLES * lamp.groups
    at = 4 * GROUPS * lane
    return ask_samples(
        triangle, kept, kept_lane, can, scratch.samples, lamp.groups, scratch.blocked + at, scratch.unsure + at
    )


@subkernel
def _write_bits(answers, v, lanes, groups, scratch):
    """Write the bits of samples of some of a vector's points into their rows."""
    for word in range((groups + 1) // 2):
        blocked, unblocked = answers.blocked[word], answers.unblocked[word]
        some = lanes
        while some != 0:
            lane = lowest_bit(some)
            some &= some - 1
            at = 4 * (GROUPS * lane + 2 * word)
            hidden, doubt = np.int64(load_i32(scratch.blocked + at)), np.int64(load_i32(scratch.unsure + at))
            if 2 * word + 1 < groups:
                hidden |= np.int64(load_i32(scratch.blocked + at + 4)) << 16
                doubt |= np.int64(load_i32(scratch.unsure + at + 4)) << 16
            blocked[16 * v + lane] = np.int32(hidden)
            unblocked[16 * v + lane] = np.int32(~(hidden | doubt))

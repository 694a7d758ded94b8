"""Asking what comes between a lamp and points: sixteen points at a time with one beam, or one point with its own.

Both find the primitives that come into the beam, prepare them, and ask them (`area_light_tests`), first about all of
the lamp and then, where that cannot tell, about its samples."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import TESTS
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import i32_at, i32x16, i64_at, lanes_below, load_f32x16, load_i32, load_three, lowest_bit, ones, store
from tracer.visibility.area_light_tests import MOST_SAMPLES, ask_points, ask_samples, ask_triangles
from tracer.visibility.beams import make_beam, passes_by, primitives_met, put_cone
from tracer.visibility.error_bounds import LANES
from tracer.visibility.prepared_triangles import PREPARED, prepare_in_tree, prepared_met

# Primitives that may come between, at most: a group of vectors', or else each of these goes through the tree by itself;
# a vector's, or else each of its points does; and a point's, or else its rays are traced.
OF_GROUP, OF_VECTOR, OF_POINT = 96, 256, 240
GROUPS = MOST_SAMPLES // LANES
NUMBERS, ALL_PREPARED = 4 * (max(OF_VECTOR, OF_POINT) + LANES + WIDTH), PREPARED * (OF_GROUP // LANES)  # bytes
MARKS = 4 * LANES * GROUPS  # bytes: a bit for each sample of each point of a vector
ASKED, STATE = 4 * LANES, 24  # bytes
# Nanoseconds, about: a beam and its way to the first leaf; sixteen primitives found and prepared; one asked about a
# vector of points, or sixteen about one; and about one point, and sixteen of its samples.
FOR_BEAM, FOR_SIXTEEN, FOR_POINTS, FOR_POINT, FOR_SAMPLES = 250, 400, 50, 8, 6
# Of a lamp's state: nanoseconds since the last account; which prepared triangle hid a point of the group last, -1 for
# none; and whether those that hid a point with a beam of its own are kept.
EFFORT, LATEST, HIDING = range(3)
HIDDEN, SEEN, PARTLY = range(3)  # what a point sees of a lamp


class Scratch(NamedTuple):
    """Addresses of memory that the kernel which asks has: of samples, of primitives' numbers and these prepared, of
    what is kept of one and a vector's points, and of bits of samples, 16 points one after the other, that are blocked
    and of which nothing is certain; of int32 for each point, how many primitives were asked about its samples; of a
    lamp's state, int64; and of those prepared primitives of which one hid a point with a beam of its own last."""

    samples: int
    numbers: int
    prepared: int
    kept: int
    blocked: int
    unsure: int
    asked: int
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
    # Points that may see some sample, those that have bits of samples, and those that are asked about no more.
    live, begun, left = every, np.int64(0), np.int64(0)
    before = state[LATEST] if prepared else np.int64(-1)
    if before >= 0:  # what hid the neighbours may hide these
        triangle = _prepared_at(scratch, before)
        live, begun, left = _ask(triangle, end, lamp, live, begun, left, cost, scratch, counts)
    for batch in range(batches_of(found)):
        if live & ~left == 0:
            break
        made = scratch.prepared + PREPARED * batch * prepared
        if not prepared:
            prepare_in_tree(o, lamp, scratch.numbers + 64 * batch, made)
        met = np.int64(prepared_met(made, beam)) & lanes_below(found, batch)
        while met != 0 and live & ~left != 0:
            lane = lowest_bit(met)
            met &= met - 1
            if LANES * batch + lane == before:
                continue
            many = ones(live)
            live, begun, left = _ask(made + 4 * lane, end, lamp, live, begun, left, cost, scratch, counts)
            if ones(live) < many:
                state[LATEST] = LANES * batch + lane
    answers.full[v] = every & ~live
    answers.lit[v] = live & ~begun
    answers.partly[v] = live & begun
    _write_bits(answers, v, live & begun, lamp.groups, scratch)


@inlined
def _prepared_at(scratch, k):
    """Where the numbers of the k-th prepared primitive are."""
    return scratch.prepared + PREPARED * (k // LANES) + 4 * (k % LANES)


@subkernel
def _ask(triangle, end, lamp, live, begun, left, cost, scratch, counts):
    """Ask a prepared triangle about sixteen points, `end`, and perhaps their samples: which of them are live, begun and
    left (`ask_vector`) from now on."""
    asked, state, open_ = i32_at(scratch.asked), i64_at(scratch.state), live & ~left
    counts[TESTS] += ones(open_)
    state[EFFORT] += FOR_POINTS
    hidden, missed, can = ask_points(triangle, end, lamp.light, lamp.radius, scratch.kept)
    live &= ~hidden
    unsure = open_ & ~(hidden | missed)
    while unsure != 0:
        lane = lowest_bit(unsure)
        bit = np.int64(1) << lane
        unsure &= unsure - 1
        if begun & bit == 0:
            begun |= bit
            asked[lane] = 0
            _put_bits(scratch.blocked, lane, lamp.groups, 0)
            _put_bits(scratch.unsure, lane, lamp.groups, 0)
        asked[lane] += 1
        if asked[lane] > worth_asking(lamp, cost):
            left |= bit
            _put_bits(scratch.unsure, lane, lamp.groups, -1)  # but for those that are known to be hidden
        elif _ask_samples(triangle, lane, can & bit != 0, lamp, lane, scratch):
            live &= ~bit
    return live, begun, left


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
    state, asked = i64_at(scratch.state), 0
    for batch in range(batches_of(found)):
        made = scratch.prepared
        prepare_in_tree(o, lamp, scratch.numbers + 64 * batch, made)
        counts[TESTS] += ones(lanes_below(found, batch))
        state[EFFORT] += FOR_POINTS
        hidden, missed, can = ask_triangles(made, end, lamp.light, lamp.radius, scratch.kept)
        if hidden != 0:
            for at in range(0, PREPARED, 64):
                store(scratch.hiding + at, load_f32x16(made + at))
            state[HIDING] = 1
            return HIDDEN
        unsure = lanes_below(found, batch) & ~missed
        while unsure != 0:
            k = lowest_bit(unsure)
            unsure &= unsure - 1
            if asked == 0:
                _put_bits(scratch.blocked, lane, lamp.groups, 0)
                _put_bits(scratch.unsure, lane, lamp.groups, 0)
            asked += 1
            if asked > worth_asking(lamp, cost):
                _put_bits(scratch.unsure, lane, lamp.groups, -1)  # but for those that are known to be hidden
                return PARTLY
            if _ask_samples(made + 4 * k, k, (can >> k) & 1 != 0, lamp, lane, scratch):
                return HIDDEN
    return PARTLY if asked > 0 else SEEN


@inlined
def worth_asking(lamp, cost):
    """How many triangles may be asked about a point's samples before its rays, of which each costs so many nanoseconds,
    take less: those of which nothing is certain by then are traced."""
    return cost // (FOR_POINT + FOR_SAMPLES * lamp.groups)


@inlined
def _put_bits(bits, lane, groups, value):
    """Put a value, 0 for none or -1 for all of a lamp's samples, into bits at an address, of the point in a lane."""
    for at in range(4 * GROUPS * lane, 4 * GROUPS * lane + 4 * groups, 64):
        store(bits + at, i32x16(value))


@inlined
def _ask_samples(triangle, kept_lane, can, lamp, lane, scratch):
    """Ask a triangle about the samples of the point in a lane, of which `scratch.kept` has a lane; whether all are
    hidden."""
    i64_at(scratch.state)[EFFORT] += FOR_POINT + FOR_SAMPLES * lamp.groups
    at = 4 * GROUPS * lane
    return ask_samples(
        triangle, scratch.kept, kept_lane, can, scratch.samples, lamp.groups, scratch.blocked + at, scratch.unsure + at
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

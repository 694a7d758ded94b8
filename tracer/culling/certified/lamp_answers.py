"""Answer the shadow rays of lamps: for all samples of a lamp at once, before any of them is traced.

Points that are shaded together are neighbours, and a lamp's samples are, too.  So what may come between is looked for
only once for all of their rays: in the tree for a group of vectors, with a beam around it (`beams`), and then vector by
vector in what was found.  Where nothing is left the lamp is seen as a whole; where all of it is hidden it is dark.
Of the points in between, in the penumbra, each has a bit for each sample (`seen_by_lamp`).  Only rays to samples of
which nothing is certain are traced.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.beams import make_beam, passes_by, primitives_met, put_beam, put_cone
from tracer.culling.certified.error_bounds import LANES
from tracer.culling.certified.seen_by_lamp import (
    KEPT,
    MOST_SAMPLES,
    PREPARED,
    SAMPLES,
    Lamp,
    ask_points,
    ask_samples,
    ask_triangles,
    prepare,
    prepared_met,
    put_samples,
)
from tracer.culling.counters import TESTS
from tracer.culling.shadow_modes import answer
from tracer.culling.stages import vectors
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    i32_at,
    i32x16,
    i64_at,
    lanes_below,
    load_f32x16,
    load_i32,
    load_i32x16,
    load_three,
    local_memory,
    lowest_bit,
    ones,
    store,
)
from tracer.simd.records import IntRow, Memory, Rows, row_count, rows_of

GROUP = 8  # vectors of points with one way through the tree
# Primitives that may come between, at most: a group's, or else each of its vectors goes through the tree by itself; and
# a vector's, or else its rays are traced.
OF_GROUP, OF_VECTOR = 96, 256
OF_CONE, OF_POINT = 240, 128
HIDDEN, SEEN, PARTLY = range(3)
WORDS = MOST_SAMPLES // 32  # with a bit for each sample
GROUPS = MOST_SAMPLES // LANES
NUMBERS, ALL_PREPARED = 4 * (OF_VECTOR + LANES + WIDTH), PREPARED * (OF_GROUP // LANES)  # bytes
MARKS = 4 * LANES * GROUPS  # bytes: a bit for each sample of each point of a vector
ASKED, STATE = 4 * LANES, 24  # bytes
# Nanoseconds, about: a beam and its way to the first leaf; sixteen primitives found and prepared; one asked about a
# vector of points; and about one point, and sixteen of its samples.
FOR_BEAM, FOR_SIXTEEN, FOR_POINTS, FOR_POINT, FOR_SAMPLES = 250, 400, 50, 8, 6
WORTH = 1  # as much as this, times what asking takes, is what rays must take for a point or a vector to be asked about
# Of a vector's rays: what beams may take before they have saved anything, at most what counts of what they have saved,
# and what a group that is passed over counts as saved.
ADVANCE, SAVINGS, PARDON = 2, 8, 1
EFFORT, LATEST, HIDING = range(3)  # of a lamp's state: nanoseconds since the last account; which triangle hid a point last


class LampAnswers(NamedTuple):
    """What is known of n points of a wave and a lamp, in rows.

    Attributes:
        open: bits of the points of which some ray may be due and nothing is known, sixteen points a number.
        full, lit: bits of those from which the lamp is hidden as a whole, and not at all.
        partly: bits of those with a bit for each sample.
        alone: bits of those between which and the lamp nothing comes that moves.
        blocked, unblocked: WORDS rows of these bits: samples that are hidden, and that are not.
    """

    memory: Memory
    open: IntRow
    full: IntRow
    lit: IntRow
    partly: IntRow
    alone: IntRow
    blocked: Annotated[NDArray[np.int32], Rows(WORDS, "int32")]
    unblocked: Annotated[NDArray[np.int32], Rows(WORDS, "int32")]


lamp_answers_in = rows_of(LampAnswers)
LAMP_ANSWER_ROWS = row_count(LampAnswers)


class Room(NamedTuple):
    """Addresses of memory: of samples, of primitives' numbers and these prepared, of what is kept of one and a vector's
    points, and of bits of samples, 16 points one after the other, that are blocked and of which nothing is certain; of
    int32 for each point, how many primitives were asked about its samples; and of a lamp's state, int64."""

    samples: int
    numbers: int
    prepared: int
    kept: int
    blocked: int
    unsure: int
    asked: int
    state: int
    hiding: int


@subkernel
def answer_sample(answers, sample, count, batch, counts):
    """Answer the rays of `count` points to a lamp's sample, by what is known.  batch is a `ShadowBatch`."""
    blocked, unblocked = address_of(answers.blocked[sample >> 5]), address_of(answers.unblocked[sample >> 5])
    bit = np.int32(np.int64(1) << (sample & 31))
    for v in range(vectors(count)):
        if batch.live[v] == 0:
            continue
        full, lit, partly = np.int64(answers.full[v]), np.int64(answers.lit[v]), np.int64(answers.partly[v])
        if partly != 0:
            full |= partly & bits_of((load_i32x16(blocked + 64 * v) & bit) == bit)
            lit |= partly & bits_of((load_i32x16(unblocked + 64 * v) & bit) == bit)
        answer(batch, v, full, lit, counts)
        batch.settled[v] |= np.int64(batch.lit[v]) & np.int64(answers.alone[v])


@subkernel
def find_answers(certified, points, answers, samples, first, number, count, counts):
    """Find what is known of `count` points and lamp `number`, whose samples are those of (any, 3) from the first on."""
    lamps, o, beam = certified.lamps, certified.occluders, make_beam()
    place, radius = lamps.places[number], lamps.radii[number]
    light, many = (place[0], place[1], place[2]), np.int64(lamps.samples[number])
    room = Room(
        local_memory(SAMPLES),
        local_memory(NUMBERS),
        local_memory(ALL_PREPARED),
        local_memory(KEPT),
        local_memory(MARKS),
        local_memory(MARKS),
        local_memory(ASKED),
        local_memory(STATE),
        local_memory(PREPARED),
    )
    groups = put_samples(samples, first, many, light, room.samples)
    lamp = Lamp(number, light, radius, groups)
    state, cost = i64_at(room.state), many * lamps.ray_cost  # of a point's rays
    most = min(OF_VECTOR, LANES * cost // (WORTH * FOR_POINTS))
    state[EFFORT], state[LATEST], state[HIDING] = 0, -1, 0
    balance = ADVANCE * LANES * cost
    for start in range(0, vectors(count), GROUP):
        end = min(start + GROUP, vectors(count))
        some = _open_points(points, answers, light, radius, start, end, count)
        if some == 0:
            continue
        if balance < 0:  # beams do not pay here
            balance += PARDON * LANES * cost
            continue
        found = np.int64(-1)
        if some > 1 and put_beam(beam, points, answers.open, start, end, light, radius, lamps.within):
            found = _find_primitives(o, number, beam, min(OF_GROUP, most), room, counts)
            for batch in range(batches_of(found)):
                prepare(o, lamp, room.numbers + 64 * batch, room.prepared + PREPARED * batch)
        state[LATEST] = -1
        away = found >= 0 and passes_by(beam, lamps.moving)
        for v in range(start, end):
            if answers.open[v] == 0 or balance < 0:
                continue
            if away and found == 0:
                answers.lit[v] = answers.alone[v] = answers.open[v]
            elif put_beam(beam, points, answers.open, v, v + 1, light, radius, lamps.within):
                state[EFFORT] += FOR_BEAM
                known = found if found >= 0 else _find_primitives(o, number, beam, most, room, counts)
                if known >= 0:
                    if away or passes_by(beam, lamps.moving):
                        answers.alone[v] = answers.open[v]
                    _ask_vector(o, points, answers, v, lamp, beam, known, found > 0, cost, room, counts)
                else:
                    _ask_each(o, points, answers, v, lamp, beam, lamps, cost, room, counts)
            else:
                _ask_each(o, points, answers, v, lamp, beam, lamps, cost, room, counts)
            saved = lamps.ray_cost * _decided(answers, v, many)
            balance = min(balance + saved - state[EFFORT], SAVINGS * LANES * cost)
            state[EFFORT] = 0


@inlined
def batches_of(count):
    """How many vectors of sixteen so many primitives make, none where they are too many."""
    return (count + LANES - 1) // LANES


@inlined
def _open_points(points, answers, light, radius, start, end, count):
    """Find the points of vectors that may be due to some sample of a lamp; how many vectors have any."""
    some = 0
    for v in range(start, end):
        answers.open[v] = answers.full[v] = answers.lit[v] = answers.partly[v] = answers.alone[v] = 0
        px, py, pz = load_three(points.position, v)
        gx, gy, gz = load_three(points.geometric, v)
        x, y, z = light[0] - px, light[1] - py, light[2] - pz
        room = np.float32(1.001) * radius + np.float32(1e-5) * (abs(light[0]) + abs(light[1]) + abs(light[2]))
        answers.open[v] = bits_of(gx * x + gy * y + gz * z > -room) & lanes_below(count, v)
        some += answers.open[v] != 0
    return some


@subkernel
def _find_primitives(o, number, beam, most, room, counts):
    """Find the primitives that may come into a beam, whole vectors of them; how many, or -1 for more than `most`."""
    found = primitives_met(o, number, beam, most, room.numbers, counts)
    i64_at(room.state)[EFFORT] += FOR_BEAM + FOR_SIXTEEN * batches_of(found if found >= 0 else most)
    for k in range(max(found, 0), LANES * batches_of(found)):
        store(room.numbers + 4 * k, i32_at(room.numbers)[0])
    return found


@subkernel
def _decided(answers, v, samples):
    """How many rays of a vector of points to a lamp's samples are known."""
    decided, partly = samples * ones(np.int64(answers.full[v] | answers.lit[v])), np.int64(answers.partly[v])
    while partly != 0:
        i = 16 * v + lowest_bit(partly)
        partly &= partly - 1
        for word in range((samples + 31) // 32):
            known = np.int64(answers.blocked[word, i] | answers.unblocked[word, i]) & 0xFFFFFFFF
            decided += ones(known & ((np.int64(1) << min(32, samples - 32 * word)) - 1))
    return decided


@subkernel
def _ask_vector(o, points, answers, v, lamp, beam, found, prepared, cost, room, counts):
    """Ask the primitives that come into a beam about the points of a vector: so many as were found, and perhaps
    `prepared`.  The rays of each point cost so many nanoseconds."""
    end, every, state = load_three(points.lifted, v), np.int64(answers.open[v]), i64_at(room.state)
    # Points that may see some sample, those that have bits of samples, and those that are asked about no more.
    live, begun, left = every, np.int64(0), np.int64(0)
    before = state[LATEST] if prepared else np.int64(-1)
    if before >= 0:  # what hid the neighbours may hide these
        triangle = _prepared_at(room, before)
        live, begun, left = _ask(triangle, end, lamp, live, begun, left, cost, room, counts)
    for batch in range(batches_of(found)):
        if live & ~left == 0:
            break
        made = room.prepared + PREPARED * batch * prepared
        if not prepared:
            prepare(o, lamp, room.numbers + 64 * batch, made)
        met = np.int64(prepared_met(made, beam)) & lanes_below(found, batch)
        while met != 0 and live & ~left != 0:
            lane = lowest_bit(met)
            met &= met - 1
            if LANES * batch + lane == before:
                continue
            many = ones(live)
            live, begun, left = _ask(made + 4 * lane, end, lamp, live, begun, left, cost, room, counts)
            if ones(live) < many:
                state[LATEST] = LANES * batch + lane
    answers.full[v] = every & ~live
    answers.lit[v] = live & ~begun
    answers.partly[v] = live & begun
    if live & begun != 0:
        _write_bits(answers, v, live & begun, lamp.groups, room)


@subkernel
def _ask_each(o, points, answers, v, lamp, beam, lamps, cost, room, counts):
    """Ask about the points of a vector one by one: each has a beam of its own."""
    every, state, partly = np.int64(answers.open[v]), i64_at(room.state), np.int64(0)
    for_samples = FOR_SAMPLES * lamp.groups + FOR_POINT
    most, some = min(OF_POINT, cost // (WORTH * for_samples)), every
    while some != 0:
        lane = lowest_bit(some)
        i, bit = 16 * v + lane, np.int64(1) << lane
        some &= some - 1
        end = points.lifted[0, i], points.lifted[1, i], points.lifted[2, i]
        normal = points.geometric[0, i], points.geometric[1, i], points.geometric[2, i]
        if state[HIDING] != 0:  # what hid another may hide this one
            hidden, _, _ = ask_triangles(room.hiding, end, lamp.light, lamp.radius, room.kept)
            state[EFFORT] += FOR_POINTS
            if hidden != 0 and _within(end, lamps.within):
                answers.full[v] |= bit
                continue
        if not put_cone(beam, end, normal, lamp.light, lamp.radius, lamps.within):
            continue
        found = _find_primitives(o, lamp.number, beam, OF_CONE, room, counts)
        if found < 0:
            continue
        if passes_by(beam, lamps.moving):
            answers.alone[v] |= bit
        said = _ask_point(o, lamp, beam, end, found, most, lane, room, counts)
        if said == HIDDEN:
            answers.full[v] |= bit
        elif said == SEEN:
            answers.lit[v] |= bit
        else:
            partly |= bit
    if partly != 0:
        answers.partly[v] |= partly
        _write_bits(answers, v, partly, lamp.groups, room)


@inlined
def store_block(to, made):
    """Copy sixteen prepared primitives."""
    for at in range(0, PREPARED, 64):
        store(to + at, load_f32x16(made + at))


@inlined
def _within(end, box):
    """Whether a point lies in a box (6,)."""
    inside = True
    for axis in range(3):
        inside &= end[axis] >= box[axis] and end[axis] <= box[3 + axis]
    return inside


@subkernel
def _ask_point(o, lamp, beam, end, found, most, lane, room, counts):
    """Ask the primitives that were found about one point: HIDDEN, SEEN, or PARTLY with bits in the lane."""
    blocked, doubt, begun, asked = room.blocked + 4 * GROUPS * lane, room.unsure + 4 * GROUPS * lane, False, 0
    state = i64_at(room.state)
    for batch in range(batches_of(found)):
        made = room.prepared
        prepare(o, lamp, room.numbers + 64 * batch, made)
        hidden, missed, able = ask_triangles(made, end, lamp.light, lamp.radius, room.kept)
        counts[TESTS] += 1
        state[EFFORT] += FOR_POINTS
        if hidden != 0:
            store_block(room.hiding, made)
            state[HIDING] = 1
            return HIDDEN
        met = lanes_below(found, batch) & ~missed
        while met != 0:
            k = lowest_bit(met)
            met &= met - 1
            if not begun:
                begun = True
                for at in range(0, 4 * lamp.groups, 64):
                    store(blocked + at, i32x16(0))
                    store(doubt + at, i32x16(0))
            asked += 1
            if asked > most:
                for at in range(0, 4 * lamp.groups, 64):
                    store(doubt + at, i32x16(-1))
                return PARTLY
            state[EFFORT] += FOR_SAMPLES * lamp.groups
            able_to = able & (np.int64(1) << k) != 0
            if ask_samples(made + 4 * k, room.kept, k, able_to, room.samples, lamp.groups, blocked, doubt):
                return HIDDEN
    return PARTLY if begun else SEEN


@inlined
def _prepared_at(room, k):
    """Where the numbers of the k-th prepared primitive are."""
    return room.prepared + PREPARED * (k // LANES) + 4 * (k % LANES)


@subkernel
def _ask(triangle, end, lamp, live, begun, left, cost, room, counts):
    """Ask a prepared triangle about sixteen points, `end`, and perhaps their samples: which of them are live, begun and
    left (`_ask_vector`) from now on."""
    asked, state, open_ = i32_at(room.asked), i64_at(room.state), live & ~left
    for_point = FOR_POINT + FOR_SAMPLES * lamp.groups
    most = cost // (WORTH * for_point)
    counts[TESTS] += ones(open_)
    state[EFFORT] += FOR_POINTS
    hidden, missed, can = ask_points(triangle, end, lamp.light, lamp.radius, room.kept)
    live &= ~hidden
    unsure = open_ & ~(hidden | missed)
    while unsure != 0:
        lane = lowest_bit(unsure)
        bit = np.int64(1) << lane
        unsure &= unsure - 1
        blocked, doubt = room.blocked + 4 * GROUPS * lane, room.unsure + 4 * GROUPS * lane
        if begun & bit == 0:
            begun |= bit
            asked[lane] = 0
            for at in range(0, 4 * lamp.groups, 64):
                store(blocked + at, i32x16(0))
                store(doubt + at, i32x16(0))
        asked[lane] += 1
        if asked[lane] > most:  # its rays cost less: those of which nothing is certain by now are traced
            left |= bit
            for at in range(0, 4 * lamp.groups, 64):
                store(doubt + at, i32x16(-1))
            continue
        state[EFFORT] += for_point
        if ask_samples(triangle, room.kept, lane, can & bit != 0, room.samples, lamp.groups, blocked, doubt):
            live &= ~bit
    return live, begun, left


@subkernel
def _write_bits(answers, v, lanes, groups, room):
    """Write the bits of samples of some of a vector's points into their rows."""
    for word in range((groups + 1) // 2):
        blocked, unblocked = answers.blocked[word], answers.unblocked[word]
        some = lanes
        while some != 0:
            lane = lowest_bit(some)
            some &= some - 1
            at = 4 * (GROUPS * lane + 2 * word)
            hidden, doubt = np.int64(load_i32(room.blocked + at)), np.int64(load_i32(room.unsure + at))
            if 2 * word + 1 < groups:
                hidden |= np.int64(load_i32(room.blocked + at + 4)) << 16
                doubt |= np.int64(load_i32(room.unsure + at + 4)) << 16
            blocked[16 * v + lane] = np.int32(hidden)
            unblocked[16 * v + lane] = np.int32(~(hidden | doubt))

"""Test candidates instead of the tree: rays that end in a cell with few of them, sixteen at a time.

Each candidate's answer is taken where it is certain (`light_space.verdicts`).  One certain hit blocks the ray.  Where
all are certain to be missed nothing static does.  Any other ray is traced as if nothing were known.

All rays test their first candidate, then those that are still open their second, and so on.  Open rays are packed anew
each time, so that sixteen are always tested together, however many candidates each has; and as the next candidates are
known early, memory has the time of a round to bring them.
"""

from __future__ import annotations

import numpy as np

from tracer.neighbours.certified.cells import SETTLED
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    gather_f32x16,
    gather_i32x16,
    i32_at,
    i32x16,
    lanes_below,
    load_columns,
    load_f32x16,
    load_i32x16,
    lowest_bit,
    mask16,
    ones,
    pack,
    pack_three,
    prefetch,
    select,
    store,
    store_three,
)
from tracer.visibility.light_space import LIGHT_ROW, verdicts

# Rows of open questions: the point's number, where in names its next candidate is, how many remain to be tested, the
# candidate's number, and where the ray ends.
POINT, NEXT, REMAINING, NAME, END = range(5)
QUESTION_ROWS = 7
UNSURE = 64  # added to how many remain where one that was tested could not tell


@inlined
def _prefetch_lanes(table, size, numbers):
    """Prefetch the rows, of so many bytes each, of sixteen int32 numbers that lie at an address."""
    for lane in range(16):
        prefetch(table + size * np.int64(i32_at(numbers)[lane]))


@subkernel
def _open(certified, points, found, number, count, room, stride):
    """Put a question, at an address, for each of `count` points with a few candidates; how many there are."""
    lists, names, asked = address_of(certified.lists), address_of(certified.names), address_of(found.asked)
    light_space = address_of(certified.occluders.light_space[number])
    lights, at, step = np.int32(certified.lists.shape[1]), address_of(points.lifted), 4 * points.lifted.shape[1]

    # Find the list of each point's cell.
    for k in range((count + 15) // 16):
        which = select(mask16(lanes_below(count, k)), load_i32x16(asked + 64 * k), i32x16(0))
        cell = gather_i32x16(address_of(found.unit), which)
        store(room + NEXT * stride + 64 * k, gather_i32x16(lists, cell * lights + np.int32(number)))
        _prefetch_lanes(names, 4, room + NEXT * stride + 64 * k)

    # Keep the points whose lists are short.
    n = 0
    for k in range((count + 15) // 16):
        first = load_i32x16(room + NEXT * stride + 64 * k)
        remaining = gather_i32x16(names, first) & np.int32(SETTLED - 1)  # TOO_MANY stays more than a few
        few = (remaining > np.int32(0)) & (remaining <= np.int32(certified.max_asked)) & mask16(lanes_below(count, k))
        if bits_of(few) == 0:
            continue
        which = select(few, load_i32x16(asked + 64 * k), i32x16(0))
        name = gather_i32x16(names, select(few, first + np.int32(1), i32x16(0)))
        end = gather_f32x16(at, which), gather_f32x16(at + step, which), gather_f32x16(at + 2 * step, which)
        _keep(room + 4 * n, stride, few, which, first + np.int32(1), remaining, name, end)
        _prefetch_lanes(light_space, 4 * LIGHT_ROW, room + NAME * stride + 4 * n)
        n += ones(bits_of(few))
    store(room + NAME * stride + 4 * n, i32x16(0))  # the lanes beyond the last name a primitive that there is
    return n


@inlined
def _keep(at, stride, mask, which, following, remaining, name, end):
    """Pack questions that are still open to an address."""
    store(at + POINT * stride, pack(which, mask))
    store(at + NEXT * stride, pack(following, mask))
    store(at + REMAINING * stride, pack(remaining, mask))
    store(at + NAME * stride, pack(name, mask))
    store_three(at + END * stride, stride, pack_three(end, mask))


@subkernel
def _ask_next(names, light_space, light, count, room, stride, live, lit):
    """Test the next candidate of `count` open questions, and keep those that are still open.

    (how many, how many rays became known)."""
    n, known = 0, np.int64(0)
    for k in range((count + 15) // 16):
        at, there = room + 64 * k, lanes_below(count, k)
        which, following, remaining = (
            load_i32x16(at + POINT * stride),
            load_i32x16(at + NEXT * stride),
            load_i32x16(at + REMAINING * stride),
        )
        x, y, z = (
            load_f32x16(at + END * stride),
            load_f32x16(at + (END + 1) * stride),
            load_f32x16(at + (END + 2) * stride),
        )
        direction = x - light[0], y - light[1], z - light[2]

        # Test one candidate of each.
        hit, missed = verdicts(load_columns(light_space, at + NAME * stride, LIGHT_ROW), light, direction, (x, y, z))
        unsure = ~(hit | missed)
        remaining = select(mask16(unsure), remaining | np.int32(UNSURE), remaining) - np.int32(1)

        # Answer those that are known now.
        hit &= there
        last = there & bits_of((remaining & np.int32(UNSURE - 1)) == np.int32(0))
        free = last & ~hit & bits_of(remaining == np.int32(0))
        known += ones(hit | free)
        _answer(at + POINT * stride, hit, free, live, lit)

        # Keep the others, with their next candidates.
        more = mask16(there & ~hit & ~last)
        if bits_of(more) != 0:
            following = following + np.int32(1)
            name = gather_i32x16(names, select(more, following, i32x16(0)))
            _keep(room + 4 * n, stride, more, which, following, remaining, name, (x, y, z))
            _prefetch_lanes(light_space, 4 * LIGHT_ROW, room + NAME * stride + 4 * n)
            n += ones(bits_of(more))
    store(room + NAME * stride + 4 * n, i32x16(0))  # the lanes beyond the last name a primitive that there is
    return n, known


@inlined
def _answer(points, hit, free, live, lit):
    """Take points, sixteen numbers at an address, out of the bits `live`, and put those that are `free` into `lit`."""
    known = hit | free
    while known != 0:
        lane = lowest_bit(known)
        known &= known - 1
        i = np.int64(i32_at(points)[lane])
        bit = np.int32(1) << np.int32(i & 15)
        live[i >> 4] &= ~bit
        if (free >> lane) & 1:
            lit[i >> 4] |= bit


@subkernel
def ask_candidates(certified, points, found, light, number, count, live, lit):
    """Test the candidates of `count` points, whose numbers are `found.asked`, for light `number` at light (3,).

    certified is a `CertificateView`, found are `lookup.CellPoints`.  Points of which candidates are certain are taken
    out of the bits `live`, sixteen to an int32, and put into the bits `lit` where nothing static blocks the light.
    (how many points are known now, tests made)."""
    room, stride = address_of(found.questions), 4 * found.questions.shape[1]
    names, light_space = address_of(certified.names), address_of(certified.occluders.light_space[number])
    tests, known = np.int64(0), np.int64(0)
    count = _open(certified, points, found, number, count, room, stride)
    while count > 0:
        tests += count
        count, answered = _ask_next(names, light_space, light, count, room, stride, live, lit)
        known += answered
    return known, tests

"""Ask the primitives of a list about sixteen rays that one light sends: which of them are blocked for certain?

Few primitives are asked one by one.  Of more, sixteen at a time are asked about a box around the ends of all rays, and
those that this leaves in doubt about each ray.  One certain hit blocks a ray; where any primitive cannot tell, nobody
can.
"""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    bits_of,
    f32x16,
    i32_at,
    i64_at,
    lanes_below,
    largest,
    load_columns,
    lowest_bit,
    mask16,
    ones,
    select,
    smallest,
)
from tracer.visibility.budget import TESTS
from tracer.visibility.light_space import LIGHT_ROW, in_all_lanes, judge, load_row, verdicts

FEW = 4  # primitives are asked one by one, more of them together first
SEEN = 16  # primitives that were tested last are known, and not tested again
KNOWN, ASKED = 4 * SEEN, 8 * SEEN  # bytes
HUGE, ROUNDED_UP = np.float32(3e38), np.float32(1.000001)


@inlined
def _range(x, there):
    """The middle and half the width, rounded up, of what lies between the least and the greatest of some lanes."""
    low, high = smallest(select(there, x, HUGE)), largest(select(there, x, -HUGE))
    middle = np.float32(0.5) * (low + high)
    return middle, ROUNDED_UP * max(high - middle, middle - low)


@subkernel
def ask_list(rows, names, count, light, end, direction, here, seen, masks, by_ray, counts):
    """Ask `count` primitives, whose numbers are at the address `names`, with room for fifteen more, of the rays whose
    bits are `here`: those that are blocked for certain, and those of which nobody can tell.

    rows is the address of their rows in light space.  seen and masks are addresses of SEEN int32 and int64: primitives
    and the rays that have asked them."""
    blocked = unsure = np.int64(0)
    if count <= FEW:
        left = lanes_below(count, 0)
        free, unclear = _ask_each(rows, names, left, light, end, direction, here, seen, masks, by_ray, counts)
        return here & ~(free | unclear), unclear
    there = mask16(here)
    (mx, hx), (my, hy), (mz, hz) = _range(end[0], there), _range(end[1], there), _range(end[2], there)
    longest = abs(mx - light[0]) + abs(my - light[1]) + abs(mz - light[2]) + hx + hy + hz
    middle, half, longest = in_all_lanes((mx, my, mz)), in_all_lanes((hx, hy, hz)), f32x16(ROUNDED_UP * longest)
    for k in range(0, count, 16):
        # Sixteen primitives and all of these rays at once.
        those, left = names + 4 * np.int64(k), lanes_below(count - k, 0)
        counts[TESTS] += ones(left) if by_ray else 1
        hit, missed = judge(load_columns(rows, those, LIGHT_ROW), light, middle, half, longest)
        if bits_of(hit) & left != 0:
            return blocked | here, unsure
        left &= ~bits_of(missed)
        free, unclear = _ask_each(rows, those, left, light, end, direction, here, seen, masks, by_ray, counts)
        blocked |= here & ~(free | unclear)
        unsure |= unclear
        here = free
        if here == 0:
            break
    return blocked, unsure


@inlined
def _ask_each(rows, names, left, light, end, direction, here, seen, masks, by_ray, counts):
    """Ask those of sixteen primitives, their numbers at an address, whose bits are `left` of the rays `here`: which of
    these none blocks, and of which one cannot tell; any other is blocked."""
    known, asked, unclear = i32_at(seen), i64_at(masks), np.int64(0)
    while left != 0 and here != 0:
        name = i32_at(names)[lowest_bit(left)]
        left &= left - 1
        at = name & (SEEN - 1)
        if known[at] == name and here & ~asked[at] == 0:
            continue
        asked[at] = asked[at] | here if known[at] == name else here
        known[at] = name
        counts[TESTS] += ones(here) if by_ray else 1
        hit, missed = verdicts(load_row(rows + 4 * LIGHT_ROW * np.int64(name)), light, direction, end)
        unclear |= here & ~(hit | missed)
        here &= missed
    return here, unclear

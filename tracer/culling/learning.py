"""Modes of the points that are shaded, sixteen at a time: looking them up, and teaching them what rays have met (§2.5).

Modes may be kept beside a method that does not cull by them.  Then a ray teaches them what static geometry answers,
whoever gave that answer, if the paper's method would have traced it, and nothing otherwise: so modes are those that
the paper's method would have, whichever exact method culls.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.modes import DYNAMIC, FULL_SHADOW, FULLY_RENDERED, NON_SHADOW, add_shadow
from tracer.kernels import inlined, subkernel
from tracer.simd import address_of, bits_of, gather_i32x16, load_i32x16, lowest_bit, ones, store


@inlined
def look_up(words, units, v, found):
    """Put the words of the v-th vector of points, whose units are given, side by side, once for all lights."""
    if found.looked_up[v]:
        return
    found.looked_up[v] = 1
    start, at = address_of(words), 64 * v
    unit = load_i32x16(address_of(units) + at)
    if words.itemsize == 4:
        store(address_of(found.low) + at, gather_i32x16(start, unit))
    else:
        store(address_of(found.low) + at, gather_i32x16(start, unit << np.int32(1)))
        store(address_of(found.high) + at, gather_i32x16(start + 4, unit << np.int32(1)))


@inlined
def with_modes(points, knowledge):
    """What carries modes at each point: where its unit is a certified cell, its primitive."""
    return points.primitive if knowledge.certify else points.unit


@inlined
def words_of(found, number, v):
    """Words of the v-th vector of points, the halves of them that hold a light's modes, and by how many bits in."""
    word = load_i32x16(address_of(found.low) + 64 * v)
    field = word if 2 + 2 * number < 32 else load_i32x16(address_of(found.high) + 64 * v)
    shift = (2 + 2 * number) % 32
    return word, field, shift


@inlined
def trusted(found, number, v):
    """Bits of the points that are known to be in full shadow, and of those known to be in none."""
    word, field, shift = words_of(found, number, v)
    whole = (word & 3) == FULLY_RENDERED
    field = field & np.int32(3 << shift)
    return (
        bits_of(whole & (field == np.int32(FULL_SHADOW << shift))),
        bits_of(whole & (field == np.int32(NON_SHADOW << shift))),
    )


@subkernel
def learn(gained, units, found, v, number, asked, blocked):
    """OR what rays have met into the shadow modes of their units, where it is news, and unless the paper's method would
    not have asked."""
    word, field, shift = words_of(found, number, v)
    full, non = trusted(found, number, v)
    untold = bits_of((word & 3) == DYNAMIC) | full | non
    seen_blocked = bits_of((field & np.int32(FULL_SHADOW << shift)) == 0)
    seen_free = bits_of((field & np.int32(NON_SHADOW << shift)) == 0)
    news = asked & ~untold & ((blocked & seen_blocked) | (~blocked & seen_free))
    while news != 0:
        lane = lowest_bit(news)
        news &= news - 1
        mode = FULL_SHADOW if (blocked >> lane) & 1 else NON_SHADOW
        add_shadow(gained, units[16 * v + lane], number, mode)


@subkernel
def consult_modes(points, number, knowledge, vectors, answers, said):
    """Look modes up, count in said (3,) what they say of due rays, and tell them what certificates have answered."""
    modes, gained, units, found = knowledge.modes, knowledge.gained, with_modes(points, knowledge), answers.modes
    dues, live, lit, certify = answers.due, answers.live, answers.lit, knowledge.certify
    for v in range(vectors):
        due = np.int64(dues[v])
        if due == 0:
            continue
        look_up(modes, units, v, found)
        full, non = trusted(found, number, v)
        said[0] += ones(due)
        said[1] += ones(due & full)
        said[2] += ones(due & non)
        told = due & ~np.int64(live[v])
        if certify and told != 0:
            learn(gained, units, found, v, number, told, told & ~np.int64(lit[v]))

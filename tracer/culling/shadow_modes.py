"""Shadow modes of the points that are shaded, sixteen at a time: reading them (§2.4) and setting them (§2.5).

A word is trusted where its unit has been seen whole: FULLY_RENDERED and FULL_SHADOW mean that the point is in shadow,
FULLY_RENDERED and NON_SHADOW that dynamic objects alone can block the light.  Everything else is traced.

Modes are set by what static geometry answers, whoever gave the answer, if the paper's method would have traced the ray,
and by nothing else.  So the modes that are kept beside a method which does not cull by them are those that the paper's
method would have.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.counters import BY_LIGHT, CULLED, DYNAMIC_ONLY
from tracer.culling.modes import DYNAMIC, FULL_SHADOW, FULLY_RENDERED, MAX_CULLED_LIGHTS, NON_SHADOW, add_shadow
from tracer.culling.stages import vectors
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, bits_of, gather_i32x16, load_i32x16, lowest_bit, ones, store
from tracer.simd.records import IntRow, Memory, row_count, rows_of


class Words(NamedTuple):
    """The packed words of all units, in memory: their address, and the bytes of one, 4 or 8."""

    address: int
    size: int


def words_at(words: NDArray[np.unsignedinteger]) -> Words:
    """Words (units,) as kernels get them; whoever asks keeps the array."""
    return Words(words.ctypes.data, words.itemsize)


class PointWords(NamedTuple):
    """What is looked up for n points of a wave, in rows of int32: the unit of each; its word's low and high half; and
    whether these have been looked up yet, a number for sixteen points."""

    memory: Memory
    unit: IntRow
    low: IntRow
    high: IntRow
    looked_up: IntRow


point_words_in = rows_of(PointWords)
POINT_WORD_ROWS = row_count(PointWords)


@inlined
def start_wave(found, count):
    """Nothing has been looked up for the points of a new wave."""
    for v in range(vectors(count)):
        found.looked_up[v] = 0


@inlined
def look_up(words, v, found):
    """Put the words of the v-th vector of points side by side, once for all lights."""
    if found.looked_up[v]:
        return
    found.looked_up[v] = 1
    at = 64 * v
    unit = load_i32x16(address_of(found.unit) + at)
    if words.size == 4:
        store(address_of(found.low) + at, gather_i32x16(words.address, unit))
    else:
        store(address_of(found.low) + at, gather_i32x16(words.address, unit << np.int32(1)))
        store(address_of(found.high) + at, gather_i32x16(words.address + 4, unit << np.int32(1)))


@inlined
def words_of(found, light, v):
    """Words of the v-th vector of points, the halves of them that hold a light's modes, and by how many bits in."""
    word = load_i32x16(address_of(found.low) + 64 * v)
    field = word if 2 + 2 * light < 32 else load_i32x16(address_of(found.high) + 64 * v)
    shift = (2 + 2 * light) % 32
    return word, field, shift


@inlined
def trusted(found, light, v):
    """Bits of the points that are known to be in full shadow, and of those known to be in none."""
    word, field, shift = words_of(found, light, v)
    whole = (word & 3) == FULLY_RENDERED
    field = field & np.int32(3 << shift)
    return (
        bits_of(whole & (field == np.int32(FULL_SHADOW << shift))),
        bits_of(whole & (field == np.int32(NON_SHADOW << shift))),
    )


@inlined
def answer(batch, v, full, non, counts):
    """Take points that are known to be in full shadow, or in none, out of those that are to be traced, and count
    them."""
    live = np.int64(batch.live[v])
    batch.live[v] = live & ~(full | non)
    batch.lit[v] |= live & non
    counts[CULLED] += ones(live & full)
    counts[DYNAMIC_ONLY] += ones(live & non)


@subkernel
def cull(words, found, light, count, batch, counts):
    """Shadow testing (§2.4): answer the rays whose words are trusted."""
    if light >= MAX_CULLED_LIGHTS:
        return
    for v in range(vectors(count)):
        if batch.live[v] == 0:
            continue
        look_up(words, v, found)
        full, non = trusted(found, light, v)
        answer(batch, v, full, non, counts)


@subkernel
def set_shadow_modes(words, gained, found, light, count, batch, counts):
    """Shadow-mode setting (§2.5): OR what rays have met into what units gain, and count what modes say of due rays."""
    if light >= MAX_CULLED_LIGHTS:
        return
    said = BY_LIGHT + 3 * light
    for v in range(vectors(count)):
        due = np.int64(batch.due[v])
        if due == 0:
            continue
        look_up(words, v, found)
        full, non = trusted(found, light, v)
        counts[said] += ones(due)
        counts[said + 1] += ones(due & full)
        counts[said + 2] += ones(due & non)

        # Learn where it is news, and unless the paper's method would not have asked.
        word, field, shift = words_of(found, light, v)
        asked = due & ~(bits_of((word & 3) == DYNAMIC) | full | non)
        unblocked = np.int64(batch.unblocked[v])
        seen_blocked = bits_of((field & np.int32(FULL_SHADOW << shift)) == 0)
        seen_unblocked = bits_of((field & np.int32(NON_SHADOW << shift)) == 0)
        news = asked & ((~unblocked & seen_blocked) | (unblocked & seen_unblocked))
        while news != 0:
            lane = lowest_bit(news)
            news &= news - 1
            mode = NON_SHADOW if (unblocked >> lane) & 1 else FULL_SHADOW
            add_shadow(gained, found.unit[16 * v + lane], light, mode)

"""Occlusion mode and shadow modes of a primitive, packed into one word (§2.2 of the paper).

Bits 0 and 1 hold the occlusion mode, bits 2 + 2 l and 3 + 2 l the shadow mode of light l.  Up to 15
lights a word has 32 bits, up to 31 it has 64; lights past that are traced without culling.

A shadow mode is set by OR: a blocked shadow ray adds 01, an unblocked one 10, and so a primitive
that has seen both is PARTIAL_SHADOW.  It speaks of static occluders alone.

Kernels read the modes of a wave's points sixteen at a time.  How wide a word is, only `look_up` and `add_shadow` know.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined, kernel
from tracer.simd import address_of, gather_i32x16, i32_at, i64_at, load_i32x16, store
from tracer.simd.records import IntRow, Memory, row_count, rows_of

MAX_CULLED_LIGHTS = 31


class OcclusionMode(IntEnum):
    """What is known of a primitive's visibility."""

    INIT = 0
    PARTIALLY_OCCLUDED = 1
    FULLY_RENDERED = 2
    DYNAMIC = 3


class ShadowMode(IntEnum):
    """What shadow rays from a primitive to one light have met."""

    INIT = 0
    FULL_SHADOW = 1
    NON_SHADOW = 2
    PARTIAL_SHADOW = 3


# numba takes plain numbers as constants
INIT, PARTIALLY_OCCLUDED, FULLY_RENDERED, DYNAMIC = (int(m) for m in OcclusionMode)
FULL_SHADOW, NON_SHADOW = int(ShadowMode.FULL_SHADOW), int(ShadowMode.NON_SHADOW)


def word_type(lights: int) -> type[np.unsignedinteger]:
    """Type of the packed word for so many lights."""
    return np.uint32 if lights <= 15 else np.uint64


def has_shadow_mode(words: np.ndarray, light: int) -> bool:
    """Whether these words hold modes of a light; those that do not are traced without culling."""
    return 0 <= light < MAX_CULLED_LIGHTS and 2 + 2 * light < 8 * words.itemsize


def occlusion_mode(word):
    """Occlusion mode of a word or of an array of them, as uint8."""
    return (np.asarray(word) & np.asarray(word).dtype.type(3)).astype(np.uint8)


def shadow_mode(word, light):
    """Shadow mode of a light, of a word or of an array of them, as uint8; INIT for lights that have none."""
    word = np.asarray(word)
    if light >= MAX_CULLED_LIGHTS:
        return np.zeros(word.shape, np.uint8)
    return ((word >> word.dtype.type(2 + 2 * light)) & word.dtype.type(3)).astype(np.uint8)


@inlined
def occlusion_bits(word):
    return np.int64(word) & 3


@inlined
def add_shadow(words, unit, light, mode):
    """OR a shadow mode into a unit's word; words are `Words`."""
    bits = np.uint64(mode) << np.uint64(2 + 2 * light)
    if words.size == 4:
        word = i32_at(words.address)
        word[unit] |= np.int32(bits)
    else:
        wide = i64_at(words.address)
        wide[unit] |= np.int64(bits)


class Words(NamedTuple):
    """The packed words of all units, in memory: their address, and the bytes of one, 4 or 8."""

    address: int
    size: int


def words_at(words: NDArray[np.unsignedinteger]) -> Words:
    """Return words (units,) as kernels get them; whoever asks keeps the array."""
    return Words(words.ctypes.data, words.itemsize)


class PointModes(NamedTuple):
    """The modes of n points of a wave, in rows of int32: the unit of each; its word's low and high half; and whether
    these have been looked up yet, a number for sixteen points."""

    memory: Memory
    unit: IntRow
    low: IntRow
    high: IntRow
    looked_up: IntRow


point_modes_in = rows_of(PointModes)
POINT_MODE_ROWS = row_count(PointModes)


@inlined
def look_up(words, v, found):
    """Read the words of the units of the v-th vector of points, once for all lights."""
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
def occlusion_modes(found, v):
    """Return the occlusion modes (16,) int32 of the v-th vector of points, which have been looked up."""
    return load_i32x16(address_of(found.low) + 64 * v) & np.int32(3)


@inlined
def shadow_modes(found, light, v):
    """Return the shadow modes (16,) int32 of the v-th vector of points, which have been looked up, for a light."""
    half = address_of(found.low) if 2 + 2 * light < 32 else address_of(found.high)
    return (load_i32x16(half + 64 * v) >> np.int32((2 + 2 * light) % 32)) & np.int32(3)


@kernel
def merge_words(words, gained):
    """OR what each worker has gained, (workers, units), into the words."""
    for worker in range(len(gained)):
        for unit in range(len(words)):
            words[unit] |= gained[worker, unit]


def forget_lights(words: np.ndarray, lights: list[int]) -> None:
    """Drop the shadow modes of lights that moved; FULLY_RENDERED goes back to INIT, to be seen whole anew."""
    with_modes = [light for light in lights if light < MAX_CULLED_LIGHTS]
    if not with_modes:
        return
    for light in with_modes:
        words &= ~words.dtype.type(3 << (2 + 2 * light))
    words[occlusion_mode(words) == FULLY_RENDERED] &= ~words.dtype.type(3)

"""Points that are numbered by where they lie, a part of them after the other: files repeat the corners that triangles
share, and only one of each is kept."""

from __future__ import annotations

import secrets

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import kernel
from tracer.scene.arrays import Float32, Float64, Int32

_FEWEST = 1 << 10


@kernel
def number_places(words, begin, places, count, table, seed, numbers):
    """Number the points that are words (n, 3) uint32 from `begin` on by the places (m, 3) that they lie at, `count` of
    which are there; new ones are added.  The table (a power of two,) int32 holds their numbers, and -1 elsewhere.

    Returns how many points are numbered, and how many places there are now: fewer than all where the places or half of
    the table are full."""
    mask = np.uint64(len(table) - 1)
    for i in range(begin, len(words)):
        if count == len(places) or 2 * count >= len(table):
            return i, count
        a, b, c = words[i, 0], words[i, 1], words[i, 2]
        mixed = (seed ^ np.uint64(a)) * np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(29)) ^ np.uint64(b)) * np.uint64(0xC2B2AE3D27D4EB4F)
        mixed = (mixed ^ (mixed >> np.uint64(31)) ^ np.uint64(c)) * np.uint64(0x165667B19E3779F9)
        slot = (mixed ^ (mixed >> np.uint64(32))) & mask
        while True:
            number = table[slot]
            if number < 0:
                number = count
                table[slot] = number
                places[number, 0], places[number, 1], places[number, 2] = a, b, c
                count += 1
                break
            if places[number, 0] == a and places[number, 1] == b and places[number, 2] == c:
                break
            slot = (slot + np.uint64(1)) & mask
        numbers[i] = number
    return len(words), count


class DistinctPoints:
    """Different places, in the order in which they were met.  Zeros of both signs are one."""

    def __init__(self, expected: int = 0) -> None:
        self._seed = np.uint64(secrets.randbits(64))  # so that no file can be made for points that collide
        self._places = np.empty((max(expected, _FEWEST), 3), np.uint32)
        self._table = self._empty_table(2 * len(self._places))
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def points(self) -> Float32:
        """(m, 3) where they are."""
        return self._places[: self._count].view(np.float32)

    def numbered(self, points: Float32 | Float64) -> Int32:
        """(n,) the numbers of the places that points (n, 3) lie at, as they are rounded to float32."""
        with np.errstate(all="ignore"):  # what float32 cannot hold is found, and named, later
            own = np.ascontiguousarray(points, np.float32) + np.float32(0)  # -0 becomes 0
        numbers = np.empty(len(own), np.int32)
        done = self._number(own.view(np.uint32), 0, numbers)
        while done < len(own):
            self._grow()
            done = self._number(own.view(np.uint32), done, numbers)
        return numbers

    def _number(self, words: NDArray[np.uint32], begin: int, numbers: Int32) -> int:
        done, self._count = number_places(words, begin, self._places, self._count, self._table, self._seed, numbers)
        return int(done)

    def _grow(self) -> None:
        known, count = self._places, self._count
        if count == len(known):
            self._places = np.empty((2 * count, 3), np.uint32)
            self._places[:count] = known
        else:
            self._table = self._empty_table(len(self._table) + 1)
            self._count = 0
            self._number(self._places[:count], 0, np.empty(count, np.int32))

    @staticmethod
    def _empty_table(least: int) -> Int32:
        return np.full(1 << (least - 1).bit_length(), -1, np.int32)

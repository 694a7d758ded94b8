"""Which frame set a mode: when each unit was first seen to be blocked from a light, first seen lit, and seen whole.

The words of modes before and after a frame are compared, so that nothing is recorded while tracing.  Only units whose
modes were set take room."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULL_SHADOW, FULLY_RENDERED, MAX_CULLED_LIGHTS, NON_SHADOW, occlusion_mode

NEVER = -1
MOST_BYTES = 64 << 20
"""That the frame numbers of all units take, at most; units beyond that are not recorded."""
_FIRST_ROWS = 256


class Origin(NamedTuple):
    """Numbers of the frames in which a unit was first seen blocked from a light, and first seen lit by it; NEVER where
    it was not."""

    blocked: int = NEVER
    lit: int = NEVER

    def met(self) -> list[tuple[bool, int]]:
        """Return whether it was lit, and the number of the frame, for each of the two that is known."""
        return [(lit, number) for lit, number in ((False, self.blocked), (True, self.lit)) if number != NEVER]


class Origins(NamedTuple):
    """What is known of a unit: the frame since which it is fully rendered, NEVER while it is not, and the origin of its
    shadow mode for each light that has one."""

    whole: int
    lights: tuple[Origin, ...]


class ModeOrigins:
    """The units of one mode history, at one resolution.

    A mode that was forgotten and learnt again within one and the same frame counts as learnt when it first was, unless
    its light has moved."""

    def __init__(self, lights: int, most_bytes: int = MOST_BYTES, blank: bool = True) -> None:
        """`blank`: nothing was known before the first frame that is added; else nobody knows where the modes come from
        that this one leaves."""
        self._blank = blank
        self.lights = min(lights, MAX_CULLED_LIGHTS)
        self._words: NDArray[np.unsignedinteger] | None = None
        self._row_of = np.empty(0, np.int32)
        self._table = np.full((_FIRST_ROWS, 1 + 2 * self.lights), NEVER, np.int32)
        self._rows = 0
        self._most_rows = max(1, most_bytes // (4 * self._table.shape[1]))

    @property
    def full(self) -> bool:
        """Whether there was no room for some unit."""
        return self._rows >= self._most_rows

    def add(self, number: int, words: NDArray[np.unsignedinteger], moved: NDArray[np.bool_] | None = None) -> None:
        """Take up the modes (units,) as frame `number` leaves them; nobody changes that array afterwards.

        `moved` (lights,) says which lights are elsewhere than in the frame before: their modes were forgotten."""
        before = self._words
        if before is None or len(before) != len(words):
            before = np.zeros_like(words) if self._blank else words
            self._row_of, self._rows = np.full(len(words), NEVER, np.int32), 0
        self._words = words
        kept = before & ~_lost_bits(moved, words.dtype.type) if moved is not None and moved.any() else before
        changed = np.flatnonzero((words != kept) | (kept != before))
        if not len(changed):
            return
        now, then = words[changed], kept[changed]
        set_now = ((now & ~then) & ~words.dtype.type(3)) != 0
        whole, was_whole = occlusion_mode(now) == FULLY_RENDERED, occlusion_mode(then) == FULLY_RENDERED
        self._add_rows(changed[set_now | (whole & ~was_whole)])
        rows = self._row_of[changed]
        there = rows != NEVER
        rows, now, then, whole, was_whole = (part[there] for part in (rows, now, then, whole, was_whole))

        def note(column: int, has: NDArray[np.bool_], had: NDArray[np.bool_]) -> None:
            self._table[rows[~has], column] = NEVER
            self._table[rows[has & ~had], column] = number

        note(0, whole, was_whole)
        for light in range(self.lights):
            for column, mode in ((0, FULL_SHADOW), (1, NON_SHADOW)):
                bit = words.dtype.type(mode << (2 + 2 * light))
                note(1 + 2 * light + column, (now & bit) != 0, (then & bit) != 0)

    def of(self, unit: int) -> Origins | None:
        """Return what is known of a unit; None where none of its modes was set, or there was no room for it."""
        row = int(self._row_of[unit]) if 0 <= unit < len(self._row_of) else NEVER
        if row == NEVER:
            return None
        whole, *lights = self._table[row].tolist()
        return Origins(whole, tuple(Origin(*pair) for pair in zip(lights[::2], lights[1::2])))

    def _add_rows(self, units: NDArray[np.int64]) -> None:
        """Add rows for those of the units that have none, as long as there is room."""
        units = units[self._row_of[units] == NEVER][: self._most_rows - self._rows]
        needed = self._rows + len(units)
        if needed > len(self._table):
            shape = min(max(2 * len(self._table), needed), self._most_rows), self._table.shape[1]
            grown = np.full(shape, NEVER, np.int32)
            grown[: self._rows] = self._table[: self._rows]
            self._table = grown
        self._row_of[units] = np.arange(self._rows, needed, dtype=np.int32)
        self._table[self._rows : needed] = NEVER
        self._rows = needed


def _lost_bits(moved: NDArray[np.bool_], word: type[np.unsignedinteger]) -> np.unsignedinteger:
    """Return the bits of a word that are lost when these lights move: theirs, and FULLY_RENDERED is to be seen anew."""
    bits = 3
    for light in np.flatnonzero(moved[:MAX_CULLED_LIGHTS]).tolist():
        bits |= 3 << (2 + 2 * light)
    return word(bits)

"""Which frame taught a mode: when each unit was first seen to be blocked from a light, first seen lit, and seen whole.

The words of modes before and after a frame are compared, so that nothing is recorded while tracing.  Only units that
were taught anything take room."""

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


class Taught(NamedTuple):
    """What is known of a unit: the frame since which it is fully rendered, NEVER while it is not, and a lesson for each
    light that has modes."""

    whole: int
    lights: tuple[Origin, ...]


class ModeOrigins:
    """The units of one mode history, at one resolution.

    A mode that was forgotten and learnt again within one and the same frame counts as learnt when it first was, unless
    its light has moved."""

    def __init__(self, lights: int, most_bytes: int = MOST_BYTES, blank: bool = True) -> None:
        """`blank`: nothing was known before the first frame that is added; else nobody knows who taught what that one
        leaves."""
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
        kept = before & ~_modes_of(moved, words.dtype.type) if moved is not None and moved.any() else before
        changed = np.flatnonzero((words != kept) | (kept != before))
        if not len(changed):
            return
        now, then = words[changed], kept[changed]
        shadows = words.dtype.type(3)
        taught = ((now & ~then) & ~shadows) != 0
        whole, was_whole = occlusion_mode(now) == FULLY_RENDERED, occlusion_mode(then) == FULLY_RENDERED
        self._make_rows(changed[taught | (whole & ~was_whole)])
        rows = self._row_of[changed]
        there = rows != NEVER
        rows, now, then, whole, was_whole = (part[there] for part in (rows, now, then, whole, was_whole))
        self._note(rows, 0, number, whole & ~was_whole, ~whole)
        for light in range(self.lights):
            for column, mode in ((0, FULL_SHADOW), (1, NON_SHADOW)):
                bit = words.dtype.type(mode << (2 + 2 * light))
                has, had = (now & bit) != 0, (then & bit) != 0
                self._note(rows, 1 + 2 * light + column, number, has & ~had, ~has)

    def of(self, unit: int) -> Taught | None:
        """What is known of a unit; None where it was taught nothing, or there was no room for it."""
        row = int(self._row_of[unit]) if 0 <= unit < len(self._row_of) else NEVER
        if row == NEVER:
            return None
        whole, *lessons = self._table[row].tolist()
        return Taught(whole, tuple(Origin(*pair) for pair in zip(lessons[::2], lessons[1::2])))

    def _note(
        self, rows: NDArray[np.int32], column: int, number: int, new: NDArray[np.bool_], gone: NDArray[np.bool_]
    ) -> None:
        self._table[rows[gone], column] = NEVER
        self._table[rows[new], column] = number

    def _make_rows(self, units: NDArray[np.int64]) -> None:
        """Rows for those of the units that have none, as long as there is room."""
        units = units[self._row_of[units] == NEVER][: self._most_rows - self._rows]
        needed = self._rows + len(units)
        if needed > len(self._table):
            grown = np.full((min(max(2 * len(self._table), needed), self._most_rows), self._table.shape[1]), NEVER)
            grown[: self._rows] = self._table[: self._rows]
            self._table = grown.astype(np.int32)
        self._row_of[units] = np.arange(self._rows, needed, dtype=np.int32)
        self._table[self._rows : needed] = NEVER
        self._rows = needed


def _modes_of(moved: NDArray[np.bool_], word: type[np.unsignedinteger]) -> np.unsignedinteger:
    """The bits of a word that are lost when these lights move: theirs, and FULLY_RENDERED is to be seen anew."""
    bits = 3
    for light in np.flatnonzero(moved[:MAX_CULLED_LIGHTS]).tolist():
        bits |= 3 << (2 + 2 * light)
    return word(bits)

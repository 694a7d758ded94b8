"""Which frame taught a mode, against a record kept mode by mode."""

from __future__ import annotations

import numpy as np
import pytest

from tracer.culling.modes import FULLY_RENDERED
from tracer.inspect.mode_origins import NEVER, ModeOrigins

UNITS = 600


@pytest.mark.parametrize(("lights", "word"), [(3, np.uint32), (20, np.uint64)])
def test_the_first_frame_of_each_answer_is_known(lights: int, word: type) -> None:
    """Words drawn by lot, which gain and lose modes; and lights that move, so that what they had was forgotten."""
    lots, origins = np.random.default_rng(3), ModeOrigins(lights)
    first: dict[tuple[int, int], int] = {}  # by unit and bit
    whole: dict[int, int] = {}
    words = np.zeros(UNITS, word)
    for number in range(12):
        moved = lots.random(lights) < 0.2
        gained = lots.integers(0, 1 << 62, UNITS).astype(word) & lots.integers(0, 1 << 62, UNITS).astype(word)
        lost = np.where(lots.random(UNITS) < 0.1, lots.integers(0, 1 << 62, UNITS), 0).astype(word)
        gained &= word(4 ** (lights + 1) - 1)
        before, words = words, (words | np.where(lots.random(UNITS) < 0.3, gained, word(0))) & ~lost
        origins.add(number, words, moved)
        for unit in range(UNITS):
            for bit in range(2, 2 + 2 * lights):
                has, had = int(words[unit]) >> bit & 1, int(before[unit]) >> bit & 1 and not moved[(bit - 2) // 2]
                if has and not had:
                    first[unit, bit] = number
                elif not has:
                    first.pop((unit, bit), None)
            is_whole = int(words[unit]) & 3 == FULLY_RENDERED
            if is_whole and (int(before[unit]) & 3 != FULLY_RENDERED or moved.any()):
                whole[unit] = number
            elif not is_whole:
                whole.pop(unit, None)
    assert len(first) > UNITS and whole
    for unit in range(UNITS):
        known = origins.of(unit)
        for light in range(lights):
            expected = tuple(first.get((unit, 2 + 2 * light + bit), NEVER) for bit in (0, 1))
            assert expected == (NEVER, NEVER) if known is None else known.lights[light] == expected
        assert (NEVER if known is None else known.whole) == whole.get(unit, NEVER)


def test_memory_is_bounded() -> None:
    origins = ModeOrigins(3, most_bytes=100 * 4 * 7)
    origins.add(0, np.full(UNITS, 4, np.uint32))
    assert origins.full and origins.of(99) is not None and origins.of(100) is None
    origins.add(1, np.full(UNITS, 4 | 8, np.uint32))
    assert origins.of(7).lights[0] == (0, 1) and origins.of(-1) is None and origins.of(UNITS) is None

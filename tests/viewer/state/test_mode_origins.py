"""Which frame set which mode, against a record that is kept mode by mode; and frames to come back to."""

from __future__ import annotations

import numpy as np
import pytest

from tracer.culling.modes import FULLY_RENDERED
from tracer.experiments import warmup_frames
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Settings
from tracer.mode_origins import NEVER, ModeOrigins
from tracer.scene.model import Camera
from viewer.state.history import FrameRecord, FrameRecords
from viewer.state.view_state import ViewState

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


def test_what_was_known_before_the_record_began_has_no_teacher() -> None:
    origins = ModeOrigins(1, blank=False)
    origins.add(5, np.array([4, 0], np.uint32))
    origins.add(6, np.array([4, 4], np.uint32))
    assert origins.of(0) is None and origins.of(1).lights == ((6, NEVER),)


def test_frames_are_kept_by_their_numbers() -> None:
    records, camera = FrameRecords(5), Camera((0, 0, 0), (0, 0, 1))

    def put(number: int, time: float = 0.0) -> None:
        records.put(FrameRecord(number, ViewState(time=time), camera, Settings(), (8, 8), True))

    for number in range(8):
        put(number)
    assert records.get(2) is None and records.get(8) is None
    assert [records.get(number).number for number in range(3, 8)] == [3, 4, 5, 6, 7]
    put(7, 1.5)
    assert records.get(7).state.time == 1.5 and records.get(3).number == 3
    put(9)
    assert records.get(9).number == 9 and records.get(8) is None and records.get(7).number == 7
    put(0)
    assert records.get(0).number == 0 and records.get(7) is None


def test_frames_before_a_picture_are_json() -> None:
    frames = (WarmupFrame(0.1), WarmupFrame(1 / 3, Camera((1, 2, 3), (0, 0, -1), angle=33.0)))
    data = warmup_frames.to_json(frames)
    assert warmup_frames.from_json(data) == frames == warmup_frames.from_json({"before": data})
    for wrong in ("x", {}, [[1]], [["a", None]], [[float("nan"), None]], [[0.0, {"position": 1}]]):
        with pytest.raises(ValueError) as raised:
            warmup_frames.from_json(wrong)
        assert "\n" not in str(raised.value)

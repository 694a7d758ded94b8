"""What verifying has found in a frame, in words: said alike by legend, panels, status bar and command line.

All of it is of all samples of all pixels that are shaded (`tracer.statistics.WrongCounts`), while other counters are of
the first sample: numbers that grow as samples are added say of how many they are.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from tracer.frame import Frame
from tracer.notebook import pixels_of
from tracer.statistics import FrameStatistics, WrongCounts
from viewer.state import terms
from viewer.util.numbers import count, percent, several

ALL_TRACED = "Every shadow ray was traced, so that no answer can be wrong"
NOT_YET = "How wrong clusters are is known once the picture is whole"
_LEAST_SEEN = 1.0 / 255.0
_Found = TypeVar("_Found")


def known(found: _Found | None) -> _Found:
    """What only verified frames have; raises ValueError where the frame was not verified."""
    if found is None:
        raise ValueError("the frame was not verified")
    return found


def in_short(statistics: FrameStatistics) -> str:
    """How much is wrong, in a few words; nothing where that is not known."""
    found = statistics.wrong
    if found is None:
        return ""
    if statistics.cuts is not None:
        return f"{count(found.pixels)} {terms.BEYOND}" if statistics.cuts.errors is not None else ""
    return f"{several(found.answers, 'wrong answer')}{_in_samples(found)}"


def named(term: str, found: WrongCounts) -> str:
    """A term of what was found, with the samples that it is of where these are several."""
    return f"{term}, {found.samples} samples" if found.samples > 1 else term


def share(found: WrongCounts) -> str:
    """Of how many answers those that are wrong are, and which part: 0.015 % of 49,121,744 due in 16 samples."""
    return f"{percent(found.answers, found.due)} of {count(found.due)} due{_in_samples(found)}"


def _in_samples(found: WrongCounts) -> str:
    return f" in {found.samples} samples" if found.samples > 1 else ""


def is_wrong(statistics: FrameStatistics) -> bool:
    """Whether anything is known to be."""
    return statistics.wrong is not None and statistics.wrong.pixels > 0


def in_words(statistics: FrameStatistics) -> str:
    """What is wrong, of how many answers; where nothing is, of how many that is said."""
    found = known(statistics.wrong)
    if statistics.cuts is not None:
        return f"{in_short(statistics)}{_of_what(statistics)}" if statistics.cuts.errors is not None else NOT_YET
    if found.answers:
        pixels = several(found.pixels, "pixel")
        answers = several(found.answers, "wrong answer")
        return f"{answers} ({percent(found.answers, found.due)}) at {pixels}{_of_what(statistics)}"
    if not found.untraced:
        return ALL_TRACED
    without = f"{several(found.untraced, 'answer')} known without tracing ({percent(found.untraced, found.due)})"
    return f"None wrong of {without}{_of_what(statistics)}"


def of_what(statistics: FrameStatistics) -> str:
    """Of which samples and pixels that is, where these are not one of each; else nothing."""
    samples = known(statistics.wrong).samples
    words = [f"in {samples} samples"] if samples > 1 else []
    if statistics.part < 1.0:
        words.append(f"in the {percent(statistics.part, 1.0)} of the picture that is shaded")
    return ", ".join(words)


def _of_what(statistics: FrameStatistics) -> str:
    words = of_what(statistics)
    return f", {words}" if words else ""


def largest_difference(frame: Frame) -> tuple[float, int]:
    """Between a wrong pixel and the right one, of a channel of the colour as it is, 1 for white; and how many of them a
    screen shows otherwise.  Raises ValueError where nothing was verified."""
    wrong = known(frame.wrong) > 0
    shown, right = frame.color[wrong], known(frame.reference)[wrong]
    seen = (pixels_of(shown[None]) != pixels_of(right[None])).any(axis=-1)
    return float(np.abs(shown - right).max(initial=0.0)), int(np.count_nonzero(seen))


def difference_in_words(largest: float) -> str:
    """As parts of what a screen shows: 160 of 255; of less than one of them, how much less."""
    return f"{255.0 * largest:.0f} of 255" if largest >= _LEAST_SEEN else f"{255.0 * largest:.2g} of 255"

"""What verifying has found in a frame, in words: said alike by legend, panels, status bar and command line.

All of it is of all samples of all pixels that are shaded (`tracer.statistics.WrongCounts`), while other counters are of
the first sample: numbers that grow as samples are added say of how many they are."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from tracer.frame import Frame, pixels_of
from tracer.statistics import FrameStatistics, WrongCounts
from viewer.state import terms
from viewer.util.numbers import count, percent, several

ALL_TRACED = "Every shadow ray was traced, so that no answer can be wrong"
NOT_YET = "The error of clusters is known once the picture is whole"
_Found = TypeVar("_Found")


def known(found: _Found | None) -> _Found:
    """Return what only verified frames have; raises ValueError where the frame was not verified."""
    if found is None:
        raise ValueError("the frame was not verified")
    return found


def is_wrong(statistics: FrameStatistics) -> bool:
    """Return whether anything is known to be wrong."""
    return statistics.wrong is not None and statistics.wrong.pixels > 0


def named(term: str, found: WrongCounts) -> str:
    """Return a term of what was found, with the samples that it is of where these are several."""
    return f"{term}, {found.samples} samples" if found.samples > 1 else term


def share(found: WrongCounts) -> str:
    """Return which part of how many answers is wrong: 0.015 % of 49,121,744 due in 16 samples."""
    return f"{percent(found.answers, found.due)} of {count(found.due)} due{_in_samples(found)}"


def _in_samples(found: WrongCounts) -> str:
    return f" in {found.samples} samples" if found.samples > 1 else ""


def of_what(statistics: FrameStatistics) -> str:
    """Return of which samples and pixels that is, where these are not one of each; else nothing."""
    shaded = f"in the {percent(statistics.part, 1.0)} of the picture that is shaded"
    words = _in_samples(known(statistics.wrong)).strip(), shaded if statistics.part < 1.0 else ""
    return ", ".join(filter(None, words))


def in_short(statistics: FrameStatistics) -> str:
    """Return how much is wrong, in a few words; nothing where that is not known."""
    found, cuts = statistics.wrong, statistics.cuts
    if found is None or (cuts is not None and cuts.errors is None):
        return ""
    if cuts is not None:
        return f"{count(found.pixels)} {terms.BEYOND}"
    return f"{several(found.answers, 'wrong answer')}{_in_samples(found)}"


def in_words(statistics: FrameStatistics) -> str:
    """Return what is wrong, of how many answers; where nothing is, of how many that is said."""
    found = known(statistics.wrong)
    if statistics.cuts is not None:
        said = in_short(statistics)
        if not said:
            return NOT_YET
    elif found.answers:
        answers, pixels = several(found.answers, "wrong answer"), several(found.pixels, "pixel")
        said = f"{answers} ({percent(found.answers, found.due)}) at {pixels}"
    elif found.untraced:
        answers = several(found.untraced, "answer")
        said = f"None wrong of {answers} known without tracing ({percent(found.untraced, found.due)})"
    else:
        return ALL_TRACED
    return ", ".join(filter(None, (said, of_what(statistics))))


def largest_difference(frame: Frame) -> tuple[float, int]:
    """Return the largest difference between a wrong pixel and the right one, of a channel of the colour as it is, 1 for
    white; and how many of them a screen shows otherwise.  Raises ValueError where nothing was verified."""
    wrong = known(frame.wrong) > 0
    shown, right = frame.color[wrong], known(frame.reference)[wrong]
    seen = (pixels_of(shown[None]) != pixels_of(right[None])).any(axis=-1)
    return float(np.abs(shown - right).max(initial=0.0)), int(np.count_nonzero(seen))

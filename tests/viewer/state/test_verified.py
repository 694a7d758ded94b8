"""What is wrong is said alike everywhere, of all samples, and praised nowhere."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from tracer.statistics import CutCounts, CutErrors, FrameStatistics, WrongCounts
from viewer.state import verified


def statistics(part: float = 1.0, **found: int) -> FrameStatistics:
    counts = {"due": 1000, "untraced": 200, "shaded": 400} | found
    return FrameStatistics(part=part, wrong=WrongCounts(**counts))


def test_wrong_answers_have_their_share_their_pixels_and_their_samples() -> None:
    assert verified.in_words(statistics(answers=3, pixels=2)) == "3 wrong answers (0.3 %) at 2 pixels"
    assert verified.in_words(statistics(answers=1, pixels=1, samples=4)) == (
        "1 wrong answer (0.1 %) at 1 pixel, in 4 samples"
    )
    several = statistics(answers=1, pixels=1, samples=4)
    assert verified.in_short(several) == "1 wrong answer in 4 samples", "a number that grows with the samples says so"
    assert verified.named("wrong", several.wrong) == "wrong, 4 samples"
    assert verified.share(several.wrong) == "0.1 % of 1,000 due in 4 samples"
    assert verified.in_short(statistics(answers=3, pixels=2)) == "3 wrong answers"
    assert verified.is_wrong(statistics(answers=3, pixels=2)) and not verified.is_wrong(statistics())


def test_where_nothing_is_wrong_it_is_said_of_how_much_that_holds() -> None:
    assert verified.in_words(statistics()) == "None wrong of 200 answers known without tracing (20.0 %)"
    assert verified.in_words(statistics(part=0.12, untraced=2)) == (
        "None wrong of 2 answers known without tracing (0.2 %), in the 12.0 % of the picture that is shaded"
    )
    assert verified.in_words(statistics(untraced=0)) == verified.ALL_TRACED


def test_clusters_have_pixels_beyond_the_error_and_no_wrong_answers() -> None:
    of_cuts = replace(statistics(answers=5, pixels=4), cuts=CutCounts(errors=CutErrors()))
    assert verified.in_words(of_cuts) == "4 pixels beyond the error" == verified.in_short(of_cuts)
    partly = replace(of_cuts, cuts=CutCounts(), part=0.5)
    assert verified.in_words(partly) == verified.NOT_YET and verified.in_short(partly) == ""


def test_a_frame_that_was_not_verified_says_nothing_and_is_refused() -> None:
    plain = make_frame()
    assert verified.in_short(plain.statistics) == "" and not verified.is_wrong(plain.statistics)
    for read in (lambda: verified.in_words(plain.statistics), lambda: verified.largest_difference(plain)):
        with pytest.raises(ValueError, match="not verified"):
            read()


def test_the_largest_difference_is_that_of_wrong_pixels() -> None:
    largest, seen = verified.largest_difference(make_frame(Settings(width=16, height=8, verify=True)))
    assert largest == pytest.approx(0.1) and seen == 2
    assert verified.difference_in_words(largest) == "26 of 255"
    assert verified.difference_in_words(0.001) == "0.26 of 255" and verified.difference_in_words(0.0) == "0 of 255"

"""What is said of a frame: the sentence's figures, and the parts of the bar."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.fakes import make_frame, with_cuts
from tracer.culling.fate import Fate
from tracer.frame import Frame, Settings
from tracer.statistics import CutErrors, FrameStatistics, RayCounts, SaidByModes, ShadowCounts, WrongCounts
from viewer.state.in_turn import LEAST, InTurn
from viewer.state.savings import Standing, Tone, bar_of, in_words, sentence


def frame_by(method: str, verify: bool = False, part: float = 1.0, **counts: int) -> Frame:
    frame = make_frame(Settings(width=16, height=8, method=method, verify=verify))
    shadow = ShadowCounts(**({"due": 1000} | counts))
    found = WrongCounts(shadow.wrong, shadow.due, shadow.due - shadow.traced, shadow.wrong, frame.width * frame.height)
    return replace(frame, statistics=FrameStatistics(shadow=shadow, part=part, wrong=found if verify else None))


def in_turn(method: str, speed: float, steps: tuple[int, int] = (850, 1000), noise: float = 0.0) -> InTurn:
    """So many rounds as tell something, of which half are that much slower by the method, half that much faster."""

    def took(seconds: float, steps: int) -> FrameStatistics:
        return FrameStatistics(primary=RayCounts(traversal_steps=steps), seconds=seconds)

    sides = [1.0 + noise * (-1) ** i for i in range(LEAST)]
    rounds = tuple((took(speed, steps[1]), took(side, steps[0])) for side in sides)
    return InTurn(("none", method), rounds, settled=True, prepares=False)


def said(frame: Frame, **standing) -> str:
    return in_words(sentence(frame, Standing(**standing)))


def test_the_sentence_in_full():
    frame = frame_by("paper", verify=True, culled=180, dynamic_only=116, wrong=1)
    words = said(frame, measured=in_turn("paper", 1.08))
    assert words == (
        "paper: 29.6 % of shadow rays saved, 15 % fewer steps, 0.1 % wrong, 1.08 × as fast as none (± 0.01)"
    )


@pytest.mark.parametrize(
    ("speed", "steps", "noise", "expected"),
    [
        (0.75, (1030, 1000), 0.0, "3 % more steps, not verified, 0.75 × as fast as none (± 0.01)"),
        (1.0, (1001, 1000), 0.0, "as many steps, not verified, as fast as none (within noise)"),
        (1.05, (500, 1000), 0.2, "50 % fewer steps, not verified, as fast as none (within noise)"),
        (0.2, (3000, 1000), 0.0, "3.0 × as many steps, not verified, 0.20 × as fast as none (± 0.01)"),
    ],
)
def test_more_work_and_noise_are_no_gains(speed, steps, noise, expected):
    words = said(frame_by("paper", culled=100), measured=in_turn("paper", speed, steps, noise))
    assert words == f"paper: 10.0 % of shadow rays saved, {expected}"


def test_what_is_not_known_is_said_and_no_figure_is_given():
    frame = frame_by("paper", culled=100)
    assert said(frame, moving=True).endswith("not verified, speed not measurable while moving")
    measured = in_turn("paper", 1.5)
    few = replace(measured, rounds=measured.rounds[: LEAST - 1], settled=False)
    words = said(frame, measured=few)
    assert "15 % fewer steps" in words and words.endswith("measuring speed ..."), "counters need one frame only"
    assert "fast" not in said(frame, measured=InTurn(("none", "paper"))) and "steps" not in said(frame, moving=True)
    proving = said(frame_by("certified", culled=1), proves="certificates still being proved", measured=measured)
    assert proving.endswith("certificates still being proved") and "fast" not in proving
    assert said(frame, why_not="no").endswith("speed not measured")


def test_what_a_figure_leaves_out_stands_beside_it():
    certified = said(frame_by("certified", culled=250), measured=in_turn("certified", 0.84))
    assert certified.endswith("exact, 0.84 × as fast as none (± 0.01, proofs not counted)")
    frame = frame_by("paper", culled=100)
    frame = replace(frame, settings=replace(frame.settings, accelerator="kdtree"))
    assert said(frame, measured=in_turn("paper", 1.2)).endswith("1.20 × as fast as none in the kdtree (± 0.01)")
    assert said(frame_by("paper", part=0.25, culled=100)).startswith("paper: 10.0 % of shadow rays saved (of the 25 %")


def test_nothing_is_praised_that_culls_nothing():
    words = said(frame_by("auto"), measured=in_turn("auto", 1.0, (1000, 1000)))
    assert words == "auto: culls nothing here, as fast as none (within noise)"
    assert said(frame_by("paper"), learns=True).startswith("paper: nothing saved yet")
    assert said(frame_by("paper", due=0)) == "paper: no shadow ray is due here"


def test_without_culling_the_bar_is_what_would_be_culled():
    frame = frame_by("none")
    frame.statistics.by_modes = [SaidByModes(600, 200, 50), SaidByModes(400, 0, 46)]
    assert said(frame) == "none: every shadow ray is traced; paper would save 29.6 %"
    bar = bar_of(frame)
    assert bar.would and [(p.fate, p.rays) for p in bar.parts] == [
        (Fate.CULLED, 200), (Fate.DYNAMIC_ONLY, 96), (Fate.TRACED, 704),
    ]  # fmt: skip
    frame.statistics.by_modes = []
    assert said(frame) == "none: every shadow ray is traced"
    assert [part.fate for part in bar_of(frame).parts] == [Fate.TRACED]


def test_the_parts_of_the_bar_are_all_rays_that_are_due():
    frame = frame_by("certified+cache", culled=100, dynamic_only=50, candidates_only=300, cache_hits=20)
    bar = bar_of(frame)
    assert not bar.would and sum(part.rays for part in bar.parts) == 1000
    assert [(part.name, part.share) for part in bar.parts] == [
        ("culled", "10.0 %"), ("dynamic only", "5.0 %"), ("candidates", "30.0 %"), ("cache hits", "2.0 %"),
        ("traced", "53.0 %"),
    ]  # fmt: skip
    assert "(§2.4)" in bar.parts[0].in_words(would=False)
    assert bar_of(frame_by("paper", due=0)).parts == ()


def test_wrong_answers_stand_out_and_clusters_have_their_own_words():
    wrong = sentence(frame_by("paper", verify=True, culled=10, wrong=3), Standing())
    assert [clause.text for clause in wrong if clause.tone is Tone.WRONG] == ["0.3 % wrong"]
    right = sentence(frame_by("paper", verify=True, culled=10), Standing())
    assert "none wrong" in in_words(right) and all(clause.tone is not Tone.WRONG for clause in right)
    frame = with_cuts(frame_by("lightcuts", verify=True, wrong=7))
    frame.statistics.cuts.errors = CutErrors(beyond=7)
    assert said(frame).startswith("lightcuts: 10 clusters for 100 lights, 7 pixels beyond the error")
    assert bar_of(frame).parts == ()

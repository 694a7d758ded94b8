"""What is said of a frame: the sentence's figures, the parts of the bar, and what is wrong, alike everywhere."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.fakes import make_frame, with_cuts
from tracer.culling.fate import Fate
from tracer.frame import Frame, Settings
from tracer.statistics import CutCounts, CutErrors, FrameStatistics, RayCounts, SaidByModes, ShadowCounts, WrongCounts
from viewer.state import verified
from viewer.state.savings import LEAST, InTurn, Standing, Tone, bar_of, in_words, placed, sentence


def frame_by(method: str, verify: bool = False, part: float = 1.0, **counts: int) -> Frame:
    frame = make_frame(Settings(width=16, height=8, method=method, verify=verify))
    shadow = ShadowCounts(**({"due": 1000} | counts))
    found = WrongCounts(shadow.wrong, shadow.due, shadow.due - shadow.traced, shadow.wrong, frame.width * frame.height)
    return replace(frame, statistics=FrameStatistics(shadow=shadow, part=part, wrong=found if verify else None))


def in_turn(
    method: str, speed: float, steps: tuple[int, int] = (850, 1000), noise: float = 0.0, saved: int = 100
) -> InTurn:
    """So many rounds as tell something, of which half are that much slower by the method, half that much faster."""

    def took(seconds: float, steps: int) -> FrameStatistics:
        shadow = ShadowCounts(due=1000, culled=saved)
        return FrameStatistics(primary=RayCounts(traversal_steps=steps), shadow=shadow, seconds=seconds)

    sides = [1.0 + noise * (-1) ** i for i in range(LEAST)]
    rounds = tuple((took(speed, steps[1]), took(side, steps[0])) for side in sides)
    return InTurn(("none", method), rounds, settled=True)


def said(frame: Frame, **standing) -> str:
    return in_words(sentence(frame, Standing(**standing)))


PAPER, CERTIFIED = frame_by("paper", culled=100), frame_by("certified", culled=340)
IN_KDTREE = replace(PAPER, settings=replace(PAPER.settings, accelerator="kdtree"))
FEW = InTurn(("none", "paper"), in_turn("paper", 1.5).rounds[: LEAST - 1])
SAVED = "Paper: 10.0 % of shadow rays saved, not verified, "


@pytest.mark.parametrize(
    ("frame", "standing", "told"),
    [
        (frame_by("paper", verify=True, culled=180, dynamic_only=116, wrong=1), {"measured": in_turn("paper", 1.08)},
         "Paper: 29.6 % of shadow rays saved, 0.1 % wrong, 15 % fewer steps, 1.08 × as fast as tracing all (± 0.01)"),
        (PAPER, {"measured": in_turn("paper", 0.75, (1030, 1000))},
         f"{SAVED}3 % more steps, 0.75 × as fast as tracing all (± 0.01)"),
        (PAPER, {"measured": in_turn("paper", 1.0, (1001, 1000))},
         f"{SAVED}as many steps, as fast as tracing all (within noise)"),
        (PAPER, {"measured": in_turn("paper", 1.05, (500, 1000), noise=0.2)},
         f"{SAVED}50 % fewer steps, as fast as tracing all (within noise)"),
        (PAPER, {"measured": FEW}, f"{SAVED}measuring speed ..."),
        (PAPER, {}, f"{SAVED}speed is measured once the picture rests"),
        (PAPER, {"why_not": "no"}, f"{SAVED}speed not measured"),
        (IN_KDTREE, {"measured": in_turn("paper", 1.2)},
         f"{SAVED}15 % fewer steps, 1.20 × as fast as tracing all in the kdtree (± 0.01)"),
        (frame_by("paper", part=0.25, culled=100), {},
         "Paper: 10.0 % of shadow rays saved (of the 25 % shaded), not verified, speed is measured once the picture "
         "rests"),
        (CERTIFIED, {"proves": True, "measured": in_turn("certified", 1.5, saved=340)},
         "Certified: 34.0 % of shadow rays saved, exact, proving: 0 made in the last picture"),
        (CERTIFIED, {"measured": in_turn("certified", 1.0, saved=400)},
         "Certified: 34.0 % of shadow rays saved, exact, 15 % fewer steps, as fast as tracing all (within noise, "
         "proofs not counted)"),
        (CERTIFIED, {"run": "experiment"}, "Experiment, Certified: 34.0 % of shadow rays saved, exact"),
        (frame_by("paper"), {}, "Paper: nothing saved yet, speed is measured once the picture rests"),
        (frame_by("paper", due=0), {}, "Paper: no shadow ray is due here"),
    ],
)  # fmt: skip
def test_the_sentence(frame: Frame, standing: dict[str, object], told: str):
    assert said(frame, **standing) == told


def test_tips_say_what_a_figure_leaves_out():
    steps = sentence(CERTIFIED, Standing(measured=in_turn("certified", 1.0, saved=400)))[2]
    assert "40.0 % of shadow rays" in steps.tip, "of which frames the steps are"
    tip = sentence(PAPER, Standing())[-1].tip
    assert "Experiment" in tip and "bench" in tip, "where there is a figure"
    frame = frame_by("auto")
    frame.statistics.decision = "none: few lights"
    first = sentence(frame, Standing(measured=in_turn("auto", 1.0, (1000, 1000))))[0]
    assert (first.text, first.tip) == ("Automatic: culls nothing here", "none: few lights")


def test_without_culling_the_bar_is_what_would_be_culled():
    frame = frame_by("none")
    frame.statistics.by_modes = [SaidByModes(600, 200, 50), SaidByModes(400, 0, 46)]
    told = "Every shadow ray is traced; the paper's modes would save 29.6 %"
    assert said(frame) == told
    bar = bar_of(frame)
    assert [(part.fate, part.rays, part.name) for part in bar] == [
        (Fate.CULLED, 200, "would be culled"), (Fate.DYNAMIC_ONLY, 96, "… dynamic only"),
        (Fate.TRACED, 704, "traced in any case"),
    ]  # fmt: skip
    frame.statistics.by_modes = []
    assert said(frame) == "Every shadow ray is traced"
    assert [part.fate for part in bar_of(frame)] == [Fate.TRACED]


def test_the_parts_of_the_bar_are_all_rays_that_are_due():
    frame = frame_by("certified+cache", culled=100, dynamic_only=50, candidates_only=300, cache_hits=20)
    bar = bar_of(frame)
    assert sum(part.rays for part in bar) == 1000
    assert [(part.name, part.share) for part in bar] == [
        ("culled", "10.0 %"), ("dynamic only", "5.0 %"), ("candidates", "30.0 %"), ("cache hits", "2.0 %"),
        ("traced", "53.0 %"),
    ]  # fmt: skip
    assert "(§2.4)" in bar[0].in_words()
    assert bar_of(frame_by("paper", due=0)) == ()


@pytest.mark.parametrize("width", [520.0, 680.0, 980.0, 1400.0])
@pytest.mark.parametrize("rays", [{"culled": 150, "dynamic_only": 120}, {"culled": 300, "dynamic_only": 4}])
def test_every_part_of_the_bar_is_named_however_narrow(rays: dict[str, int], width: float) -> None:
    bar = bar_of(frame_by("paper", **rays))
    pieces = list(placed(bar, 10.0, width, lambda text: 7.0 * len(text), 5.0))
    labels = [(at, at + 7 * len(part.label), end, beside) for part, _, end, at, beside in pieces if at is not None]
    assert len(labels) == len(bar) and all(beside or right <= end for _, right, end, beside in labels)
    edges = [10.0, *(edge for left, right, *_ in labels for edge in (left, right)), 10.0 + width]
    assert edges == sorted(edges), "none lies over another"


def test_wrong_answers_stand_out_and_clusters_have_their_own_words():
    wrong = sentence(frame_by("paper", verify=True, culled=10, wrong=3), Standing())
    assert [clause.text for clause in wrong if clause.tone is Tone.WRONG] == ["0.3 % wrong"]
    right = sentence(frame_by("paper", verify=True, culled=10), Standing())
    assert "none wrong" in in_words(right) and all(clause.tone is not Tone.WRONG for clause in right)
    frame = with_cuts(frame_by("lightcuts", verify=True, wrong=7))
    frame.statistics.cuts.errors = CutErrors(beyond=7)
    assert said(frame).startswith("Lightcuts: 10 clusters for 100 lights, 7 pixels beyond the error")
    assert bar_of(frame) == ()


def statistics(part: float = 1.0, **found: int) -> FrameStatistics:
    counts = {"due": 1000, "untraced": 200, "shaded": 400} | found
    return FrameStatistics(part=part, wrong=WrongCounts(**counts))


OF_CUTS = replace(statistics(answers=5, pixels=4), cuts=CutCounts(errors=CutErrors()))


@pytest.mark.parametrize(
    ("found", "words", "short"),
    [
        (statistics(answers=3, pixels=2), "3 wrong answers (0.3 %) at 2 pixels", "3 wrong answers"),
        (statistics(answers=1, pixels=1, samples=4), "1 wrong answer (0.1 %) at 1 pixel, in 4 samples",
         "1 wrong answer in 4 samples"),
        (statistics(), "None wrong of 200 answers known without tracing (20.0 %)", "0 wrong answers"),
        (statistics(part=0.12, untraced=2),
         "None wrong of 2 answers known without tracing (0.2 %), in the 12.0 % of the picture that is shaded",
         "0 wrong answers"),
        (statistics(untraced=0), verified.ALL_TRACED, "0 wrong answers"),
        (OF_CUTS, "4 pixels beyond the error", "4 pixels beyond the error"),
        (replace(OF_CUTS, cuts=CutCounts(), part=0.5), verified.NOT_YET, ""),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_with_of_how_much_that_holds(found: FrameStatistics, words: str, short: str) -> None:
    assert (verified.in_words(found), verified.in_short(found)) == (words, short)
    assert verified.is_wrong(found) is (found.wrong.pixels > 0)


def test_numbers_that_grow_with_the_samples_say_so() -> None:
    several = statistics(answers=1, pixels=1, samples=4).wrong
    assert (verified.named("wrong", several), verified.share(several)) == (
        "wrong, 4 samples", "0.1 % of 1,000 due in 4 samples",
    )  # fmt: skip


def test_a_frame_that_was_not_verified_says_nothing_and_is_refused() -> None:
    plain = make_frame()
    assert verified.in_short(plain.statistics) == "" and not verified.is_wrong(plain.statistics)
    for read in (lambda: verified.in_words(plain.statistics), lambda: verified.largest_difference(plain)):
        with pytest.raises(ValueError, match="not verified"):
            read()


def test_the_largest_difference_is_that_of_wrong_pixels() -> None:
    largest, seen = verified.largest_difference(make_frame(Settings(width=16, height=8, verify=True)))
    assert largest == pytest.approx(0.1) and seen == 2

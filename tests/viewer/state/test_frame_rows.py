"""The numbers of frames as rows: exact, of one frame and of two beside each other."""

from __future__ import annotations

from dataclasses import replace

from tests.viewer.fakes import make_frame, with_cuts
from tracer.frame import Frame, Settings
from tracer.statistics import FrameStatistics, RayCounts, ShadowCounts, WrongCounts
from viewer.state.frame_rows import NO_TIME, Row, beside, change, rows
from viewer.state.savings import LEAST, InTurn


def frame_by(method: str, **statistics: object) -> Frame:
    return replace(make_frame(Settings(16, 8, method=method)), statistics=FrameStatistics(**statistics))


def pairs(a: Frame, b: Frame, timed: InTurn | None = None) -> dict[str, tuple[Row, Row]]:
    return {one.name or other.name: (one, other) for one, other in beside(a, b, timed)}


def test_counts_are_exact_and_say_of_what_they_are_a_part():
    primary = RayCounts(rays=335_920, traversal_steps=1_434_217)
    found = rows(frame_by("paper", primary=primary, shadow=ShadowCounts(due=2_000_000, culled=1_433_001)))
    said = {row.name.strip(): (row.text(row.number), row.share) for row in found}
    assert said["Culled"] == ("1,433,001", "71.7 %") and said["Due"] == ("2,000,000", "")
    assert said["All steps"] == ("1,434,217", "") and said["per pixel"] == ("15,625.00", "")
    assert not {"Candidates", "Cache hits", "Wrong answers", "Certificates made"} & set(said), "what it has none of"
    wrong = WrongCounts(answers=3, due=4_000, untraced=9, pixels=2, shaded=128, samples=2)
    said = {row.name: (row.text(row.number), row.share) for row in rows(frame_by("paper", wrong=wrong))}
    assert said["Wrong answers"] == ("3", "0.1 %") and said["Wrong pixels"] == ("2", "1.6 %")
    of_clusters = with_cuts(frame_by("lightcuts", wrong=wrong))
    assert [row.name for row in rows(of_clusters) if "wrong" in row.name.lower()] == []


def test_two_frames_have_differences_and_shares():
    a = frame_by("none", shadow=ShadowCounts(due=1000, rays=1000))
    b = frame_by("paper", shadow=ShadowCounts(due=1000, culled=250, rays=750), wrong=WrongCounts(answers=3, due=1000))
    found = pairs(a, b)
    assert change(*found["Culled"]) == ("+250", "-") and change(*found["Traced"]) == ("-250", "-25.0 %")
    assert change(*found["Due"]) == ("0", "0 %")
    one, other = found["Wrong answers"]
    assert (one.text(one.number), other.text(other.number), change(one, other)) == ("-", "3", ("-", "-"))
    b.statistics.part = 0.25
    assert [row.number for row in pairs(a, b)["Shaded pixels"]] == [None, 32]


def test_times_of_two_are_those_of_many_frames_in_turn_or_none():
    def took(seconds: float) -> FrameStatistics:
        return FrameStatistics(seconds=seconds, phases={"shading": seconds / 2.0})

    a, b = (frame_by(method, seconds=9.0, phases={"shading": 9.0}) for method in ("none", "paper"))
    assert {row.name: row.number for row in rows(a)}["Frame"] == 9000.0
    rounds = tuple((took(0.2 + 0.001 * i), took(0.1)) for i in range(LEAST))
    timed = InTurn(("none", "paper"), rounds)
    found = pairs(a, b, timed)
    assert [row.text(row.number) for row in found["Frame"]] == ["203.5 ms", "100.0 ms"]
    assert found["  shading"][1].text(found["  shading"][1].number) == "50.0 ms" and "2.0" in found["Frame"][0].tip
    other = replace(b, settings=Settings(method="certified"))
    for frames, known in (((a, b), None), ((a, b), replace(timed, rounds=rounds[1:])), ((a, other), timed)):
        frame = pairs(*frames, known)["Frame"]
        assert [row.number for row in frame] == [None, None] and frame[0].tip == NO_TIME

"""Renderers beside the window's: a second method live, and two in turn; what is traced, when, and what comes of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.commands import ROOM
from tests.tracing.same import assert_same
from tests.viewer.fakes import Clock, FakeRenderer, make_frame
from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Camera, Scene
from viewer.services.beside import FIRST, MOST_ROUNDS, STILL, Baseline, Pair, Rounds, Subject, subject_of
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.savings import LEAST, Spread

CAMERA = Camera((0.0, 1.0, 4.0), (0.0, -0.25, -1.0))
SIZE = Settings(width=16, height=8)


def never() -> bool:
    return False


class Timed:
    """A renderer whose frames take, in turn, the seconds that were given for the method; `made` are certificates.

    Those beside it note in the same `order` who traced, and in `taught` whose modes they were given."""

    settings = SIZE

    def __init__(self, seconds: dict[str, list[float]], made: tuple[int, ...] = (), failing: Exception | None = None):
        self.seconds, self.made, self.failing = seconds, made, failing
        self.order: list[str] = []
        self.taught: list[object] = []

    def beside(self) -> Timed:
        other = Timed(self.seconds, self.made, self.failing)
        other.order, other.taught = self.order, self.taught
        return other

    def take_modes(self, other: object) -> None:
        self.taught.append(other)

    def render(self, time=0.0, camera=None, cancel=None) -> Frame:
        if self.failing is not None:
            raise self.failing
        method = self.settings.method
        number, times = self.order.count(method), self.seconds[method]
        self.order.append(method)
        frame = make_frame(self.settings, time, camera)
        frame.statistics.seconds = times[number % len(times)]
        frame.statistics.certificates = self.made[number] if method == "certified" and number < len(self.made) else 0
        return frame


def rounds_of(method: str) -> Rounds:
    return Rounds(Subject(1.0, CAMERA, replace(SIZE, method="none"), ("none", method)))


def step(rounds: Rounds, renderer: Timed, most: int = 10_000) -> int:
    """Go so many steps at most; returns how many there were."""
    return next((n for n in range(1, most + 1) if not rounds.step(renderer, never)), most)


def test_medians_quartiles_and_the_margin():
    spread = Spread.of([1.0, 9.0, 2.0, 3.0, 4.0])
    assert (spread.low, spread.median, spread.high, spread.count) == (2.0, 3.0, 4.0, 5)
    assert spread.margin == pytest.approx(1.858 * 2.0 / 5**0.5, rel=1e-3)
    lots = np.random.default_rng(7).normal(1.0, 0.1, (400, 25))
    near = [abs(one.median - 1.0) <= one.margin for one in map(Spread.of, lots)]
    assert 0.9 < np.mean(near) < 0.99, "the margin is that of about 19 in 20"
    assert Spread(1.03, 0.9, 1.1, 4).is_one and not Spread(1.03, 1.025, 1.035, 16).is_one
    assert Spread(1.004, 1.004, 1.004, 40).is_one, "written as 1.00"


def test_methods_take_turns_after_frames_that_do_not_count_and_stop_once_it_is_known():
    renderer = Timed({"none": [9.0] * FIRST + [0.2] * 60, "paper": [9.0] * FIRST + [0.1] * 60})
    rounds = rounds_of("paper")
    assert step(rounds, renderer) == 2 * (FIRST + LEAST) and not rounds.step(renderer, never)
    counted = ["none", "paper", "paper", "none"] * (LEAST // 2)  # who is first changes
    assert renderer.order == ["none"] * FIRST + ["paper"] * FIRST + counted
    assert rounds.so_far.settled and rounds.so_far.speed("paper", "none").median == pytest.approx(2.0)
    assert renderer.taught == [renderer] * 2, "each begins with the modes that the window has"
    rounds = rounds_of("paper")
    step(rounds, Timed({"none": [0.1, 0.3, 0.2], "paper": [0.25, 0.1, 0.15, 0.3]}))
    assert rounds.so_far.settled and rounds.so_far.count == MOST_ROUNDS, "numbers that go up and down"


def test_nothing_counts_before_the_method_has_made_what_it_makes():
    rounds, renderer = rounds_of("certified"), Timed({"none": [0.1], "certified": [0.1]}, made=(90, 50, 20, 3))
    step(rounds, renderer, FIRST + 5 + 1)
    assert rounds.so_far.count == 0
    step(rounds, renderer, 1)
    assert rounds.so_far.count == 1


def traced(method: str = "paper", at: float = 1.0, **more) -> Traced:
    settings = replace(SIZE, method=method, modes=True, **more)
    frame = make_frame(settings, at, CAMERA)
    return Traced(RenderRequest(at, CAMERA, settings), frame, frame.statistics)


def test_none_keeps_no_modes_and_nobody_records_or_verifies():
    found = subject_of(traced(verify=True, record_work=True, record_lights=True))
    s = found.settings
    assert not any((s.verify, s.record_work, s.record_lights, s.modes)) and s.samples == 1
    assert not s.keeps_modes and replace(s, method="paper").keeps_modes
    assert found.methods == subject_of(traced("paper"), "none").methods == ("none", "paper")
    assert subject_of(traced("none")) is None
    assert subject_of(traced("none"), "certified").methods == ("none", "certified")


class Spare:
    """A baseline, and what it has given the thread to do in spare time."""

    def __init__(self, clock: Clock) -> None:
        self.clock, self.works = clock, list[Rounds | None]()
        self.baseline = Baseline(lambda step: self.works.append(step and step.__self__))

    def see(self, newest: Traced, moving: bool = False, busy: bool = False) -> Rounds | None:
        """Show a picture for one of the window's frames; returns what the thread does then."""
        self.baseline.update(newest, "", moving, busy)
        return self.works[-1] if self.works else None

    def rest(self, newest: Traced) -> Rounds | None:
        """Show a picture for long."""
        self.see(newest)
        self.clock.now += 2.0 * STILL
        return self.see(newest)


@pytest.fixture
def spare(clock: Clock) -> Spare:
    return Spare(clock)


def test_it_begins_at_rest_stops_at_once_and_keeps_what_is_known_of_a_picture(spare: Spare):
    paper = traced("paper")
    baseline, renderer = spare.baseline, Timed({name: [0.1] for name in ("none", "paper", "certified")})
    assert spare.see(paper) is None and baseline.measured is None
    first = spare.rest(paper)
    assert first.subject.methods == ("none", "paper") and baseline.measured is first.so_far
    assert spare.see(paper, busy=True) is None and baseline.measured is first.so_far, "what is known stays"
    assert spare.rest(paper) is first
    step(first, renderer, 2 * FIRST + 2)
    assert spare.see(paper, moving=True) is None and baseline.measured is None
    again = spare.rest(paper)
    assert again is not first, "renderers, with all they have learnt, are not kept while pictures change"
    step(again, renderer)
    second = spare.rest(traced("certified"))
    assert second.subject.methods == ("none", "certified")
    spare.see(paper, moving=True)
    assert spare.rest(paper) is None and baseline.measured is again.so_far, "what was measured to the end is known"
    spare.rest(traced("paper", at=2.0))
    assert spare.rest(paper) not in (None, again, second), "after another picture it is not"
    baseline.forget()
    assert spare.works[-1] is None and baseline.measured is None


def test_no_tree_is_built_for_a_figure(spare: Spare):
    assert spare.rest(traced(accelerator="kdtree-lazy")) is None and "built" in spare.baseline.why_not


def test_what_fails_is_said_and_not_tried_again_for_the_same_picture(spare: Spare):
    renderer = Timed({}, failing=MemoryError())
    begun = spare.rest(traced())
    with pytest.raises(MemoryError):
        begun.step(renderer, never)
    assert not begun.step(renderer, never)
    for moving in (False, True):
        spare.see(traced(), moving=moving)
        spare.rest(traced())
        assert "out of memory" in spare.baseline.why_not
    assert [work for work in spare.works if work is not None] == [begun]
    assert spare.rest(traced(at=2.0)) is not None and not spare.baseline.why_not, "another picture is tried"


def flyer(folder: Path) -> Scene:
    (folder / "scene.aff").write_text(ROOM)
    return load_scene(folder / "scene.aff")


def test_a_renderer_beside_knows_the_modes_and_leaves_them_alone(tmp_path):
    scene = flyer(tmp_path)
    settings = Settings(width=48, height=32, threads=1, method="paper+rest")
    window, alone = Renderer(scene, settings), Renderer(scene, settings)
    for at in (0.0, 1.0, 1.0):
        window.render(at), alone.render(at)
    known = window.render(1.0)
    alone.render(1.0)
    rounds = Rounds(Subject(1.0, scene.camera_at(1.0), replace(settings, method="none"), ("none", "paper+rest")))
    for _ in range(2 * FIRST + 2):
        rounds.step(window, never)
        window.take_turn(1.0)
    ((none, paper),) = rounds.so_far.rounds
    assert paper.shadow.saved == known.statistics.shadow.saved > 0
    assert none.shadow.rays > paper.shadow.rays and none.occlusion_tests == 0
    after, expected = window.render(1.0), alone.render(1.0)
    assert np.array_equal(after.modes, expected.modes) and after.statistics.shadow == expected.statistics.shadow


@pytest.mark.parametrize("keeps_modes", [True, False])
def test_neither_knows_what_the_other_has_found_out(tmp_path, keeps_modes):
    """While an object moves, and when it rests, which counts as static for one of the methods alone."""
    scene = flyer(tmp_path)
    settings = Settings(width=48, height=32, threads=1, modes=keeps_modes, record_work=True)
    methods = "paper", "certified"
    alone = [Renderer(scene, replace(settings, method=method)) for method in methods]
    first = Renderer(scene, replace(settings, method=methods[0]))
    pair = Pair(first)
    for moment in (1.0, 2.0, 2.0, 2.0, 4.0):
        asked = RenderRequest(moment, CAMERA, settings, samples=2, second=methods[1], parts=(1, 8, 16))
        steps = list(pair.refine(asked, never))
        expected = [[frame for frame, _ in asked.refine(renderer, never)] for renderer in alone]
        assert len(steps) == len(expected[0]) == 4
        for both, *each in zip(steps, *expected, strict=True):
            assert [frame.settings.method for frame in both] == list(methods)
            for one, other in zip(both, each, strict=True):
                assert_same(other, one, f"at {moment} s by {one.settings.method}")
    saved = [step.statistics.shadow.dynamic_only for step in steps[-1]]
    assert saved[0] != saved[1], "both cull the same, so this shows nothing"
    assert pair.is_of(first) and not pair.is_of(alone[0])


def test_the_world_is_left_to_the_first_whatever_becomes_of_the_picture():
    first = FakeRenderer()
    pair = Pair(first)
    asked = RenderRequest(3.0, CAMERA, Settings(), second="none", parts=(1, 16))
    pictures = pair.refine(asked, never)
    one, other = next(pictures)
    assert (one.settings.method, other.settings.method, one.time, other.time) == ("paper", "none", 3.0, 3.0)
    pictures.close()
    assert first.turns == ["paper"], "a picture that nobody wants any more"
    list(pair.refine(asked, never))
    assert first.turns == ["paper", "paper", "none", "paper"], "and between its parts, when questions are answered"
    first.other.failing = ValueError("no")
    with pytest.raises(ValueError, match="no"):
        list(pair.refine(asked, never))
    assert first.turns[-1] == "paper"

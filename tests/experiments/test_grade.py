"""A report card says of a method what is wrong with it, and only that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest

import tracer
from tests.commands import ROOM
from tracer.culling.modes import words_at
from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, vectors
from tracer.experiments.grade import Card, Grade
from tracer.experiments.trials import LIGHTS, NOTHING, OBJECTS, RESTS
from tracer.method import Kind, register, unregister
from tracer.methods.cells import Cells
from tracer.methods.interface import FrameView, ShadowMethod, Stage
from tracer.methods.paper import Modes
from tracer.runtime.kernels import native_callback
from tracer.scene.model import Scene
from viewer.output.report_card import as_markdown, verdict

SETTINGS = tracer.Settings(width=72, height=48, depth=0)


@native_callback
def all_lit(data, call, light, count, counts):
    batch = shadow_batch_in(call_at(call).shadows)
    for v in range(vectors(count)):
        batch.lit[v], batch.live[v] = batch.live[v], 0


class Daylight(ShadowMethod):
    """Takes every point for lit."""

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        return [Stage(choose=all_lit)]


class DaylightOfMany(Daylight):
    """Does so on several threads only."""

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        return super().stages(frame, worker, learns) if frame.workers > 1 else []


class Stubborn(Cells):
    """Goes by the modes of the second frame for good, wherever the lights go."""

    frames = 0

    def begin(self, frame: FrameView) -> None:
        if self.frames in (0, 2):
            self.kept = frame.words.copy()

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        modes = Modes(words_at(self.kept), words_at(frame.history.gained[worker]), frame.first)
        return [replace(stage, data=modes) for stage in super().stages(frame, worker, learns)]

    def finish(self, frame: FrameView, statistics: tracer.FrameStatistics) -> None:
        self.frames += 1


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    path = tmp_path_factory.mktemp("room") / "room.aff"
    path.write_text(f"{ROOM}p 3 -1.8 -0.7 -1 -1.8 -0.7 1 -0.8 -0.7 0\n")  # a shelf, whose shadow is certified
    return tracer.load_scene(path)


@pytest.fixture
def named(request: pytest.FixtureRequest) -> Iterator[str]:
    """A method by the name "mine", of the class that a test asks for."""
    by_cells = issubclass(request.param, Cells)
    register(Kind("mine", "A test's.", request.param, uses_modes=by_cells, uses_cells=by_cells))
    yield "mine"
    unregister("mine")


def graded(method: str, scene: Scene, frames: int = 4) -> Card:
    run = Grade(method, [(scene, 0)], SETTINGS, frames)
    *_, card = run.each()
    assert run.whole and [row.change for row in card.rows] == [NOTHING, LIGHTS, OBJECTS, RESTS]
    assert all(row.frames == frames and row.due > 1000 for row in card.rows)
    return card


def wrong(card: Card) -> set[str]:
    return {row.change for row in card.rows if row.counted.wrong}


@pytest.mark.parametrize("named", [Daylight], indirect=True)
def test_what_is_always_wrong_is_found_and_shrunk(named: str, scene: Scene) -> None:
    card = graded(named, scene)
    assert wrong(card) == {NOTHING, LIGHTS, OBJECTS, RESTS} and sum(row.refuted for row in card.rows) > 0
    assert verdict(card).startswith("Wrong, though it claims to be exact: ")
    assert card.worst.left == "2 primitives, 1 light, 0 frames" and "blocked by" in card.worst.words
    assert "\n```\n" in as_markdown(card)


@pytest.mark.parametrize("named", [Stubborn], indirect=True)
def test_what_is_wrong_once_lights_move_is_right_while_they_stand(named: str, scene: Scene) -> None:
    card = graded(named, scene)
    assert wrong(card) == {LIGHTS} and LIGHTS in card.worst.where
    assert f"none while {NOTHING}" in verdict(card)


@pytest.mark.parametrize("named", [DaylightOfMany], indirect=True)
def test_what_depends_on_threads_is_said_to(named: str, scene: Scene) -> None:
    card = graded(named, scene)
    assert not wrong(card) and card.worst is None
    assert card.other_pictures > 0 and "shadow" in card.other_counters
    assert verdict(card).startswith("Wrong, though it claims to be exact: 16 other pictures by 3 threads; none while ")


@pytest.mark.parametrize("method", ["certified", "paper"])
def test_a_method_of_the_program_is_graded_by_its_name(method: str, scene: Scene) -> None:
    card = graded(method, scene)
    assert card.claims_exact == (method == "certified")
    assert card.other_pictures == 0 == len(card.other_counters)
    assert all(row.counted.average_steps > 0.0 and row.timed.speed_up > 0.0 for row in card.rows)
    if method == "certified":
        assert card.right and card.worst is None
        assert all(row.proved > 1000 and row.timed.memory_bytes > 0 for row in card.rows)
        assert verdict(card).startswith("Nothing wrong was found, as it claims to be exact: all of ")

"""What the inspector shows is explained on the render thread, for as long as it is what the picture shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from tests.viewer.desk import Desk
from tracer.culling.fate import Fate
from tracer.inspect.explanation import explain
from tracer.inspect.path_records import RayTree
from tracer.inspect.reasons import Reason, Rule, Why
from tracer.inspect.why_in_words import Link
from tracer.renderer import Renderer
from viewer.output.ray_rows import RayFilter
from viewer.services import inspector as module
from viewer.state import navigation
from viewer.window.panels.inspector import summary, unanswered, wrong_beyond
from viewer.window.panels.links import go_to
from viewer.window.panels.rays import ray_lines
from viewer.window.ui import Ui


class PixelDesk(Desk):
    """A desk that knows a pixel in shadow and one that is lit."""

    def __init__(self, path: Path, folder: Path) -> None:
        super().__init__(path, folder)
        self.renderer = cast(Renderer, self.c.renderer._renderer)
        self.shadow, self.lit = self._place(False), self._place(True)

    def until(self, happens: Callable[[], object], ticks: int = 5) -> None:
        """Tick until it happens, and has for some ticks."""
        held = 0

        def holds() -> bool:
            nonlocal held
            held = held + 1 if happens() else 0
            return held >= ticks

        super().until(holds)

    def answered(self) -> Why:
        """The reasons for the picture that is shown."""
        self.until(lambda: self.why is not None and self.why.tree.frame.primitive is self.c.frame.primitive)
        return self.why

    @property
    def why(self) -> Why | None:
        return self.c.inspector.why

    def turn(self, by: float) -> None:
        self.c.motion.move(navigation.look(self.c.session.camera, by, 0.0, self.c.motion.world_up))

    def _place(self, lit: bool) -> tuple[float, float]:
        """Where the square is seen and lit by all lights, or not by one."""
        settings = replace(self.c.frame.settings, method="none", record_lights=True)
        frame = Renderer(self.renderer.scene, settings).render()
        here = (frame.primitive >= 0) & (frame.primitive < 2)
        here &= frame.lit.all(-1) if lit else (frame.due & ~frame.lit).any(-1)
        here &= np.roll(here, 2, 0) & np.roll(here, -2, 0) & np.roll(here, 2, 1) & np.roll(here, -2, 1)
        y, x = np.argwhere(here)[here.sum() // 2]
        return (x + 0.5) / frame.width, (y + 0.5) / frame.height


@pytest.fixture
def desk(tiny_scene_file: Path, tmp_path: Path):
    desk = PixelDesk(tiny_scene_file, tmp_path)
    yield desk
    assert desk.c.close()


def blocked(answer: Why) -> bool:
    return any(one.blocker >= 0 for one in answer.reasons)


def test_the_pointer_is_followed_and_nothing_is_traced_for_it(desk: PixelDesk):
    assert desk.why is None
    traced, selection = desk.c.history.frames, desk.c.selection
    selection.hovered = desk.shadow
    answer, frame = desk.answered(), desk.c.frame
    assert (answer.x, answer.y) == (int(desk.shadow[0] * frame.width), int(desk.shadow[1] * frame.height))
    assert blocked(answer)
    selection.hovered = desk.lit
    desk.until(lambda: not blocked(desk.why))
    selection.hovered = (0.5, 0.01)  # background
    desk.until(lambda: desk.why is None)
    selection.hovered = desk.lit
    desk.answered()
    selection.hovered = None
    desk.until(lambda: desk.why is None)
    assert desk.c.history.frames == traced


def test_reasons_say_what_the_frame_did(desk: PixelDesk):
    desk.c.settings.change(method="paper")
    desk.until(lambda: not desk.c.active)
    desk.c.selection.select(desk.shadow)
    answer, truth = desk.answered(), explain(desk.renderer, desk.c.frame, *desk.c.selection.pixel)
    assert answer.tree is desk.c.inspector.tree and (answer.tree.x, answer.tree.y) == desk.c.selection.pixel
    assert [one.lit for one in answer.reasons] == [one.reached for one in truth] and wrong_beyond(answer) == 0
    assert [one.fate is not Fate.FACES_AWAY for one in answer.reasons] == [one.due for one in truth]
    assert [one.blocker for one in answer.reasons] == [-1 if one.blocker is None else one.blocker for one in truth]
    desk.c.selection.clear()
    desk.until(lambda: desk.why is None)


def test_another_time_is_another_answer_and_nothing_is_said_of_what_is_out_of_view(desk: PixelDesk):
    desk.c.selection.select(desk.shadow)
    first = desk.answered()
    desk.c.motion.step(3)
    desk.until(lambda: not desk.c.active and desk.c.frame.time > first.tree.frame.time)
    assert desk.answered().tree.frame.time == desk.c.frame.time
    desk.turn(2.5)
    desk.until(lambda: not desk.c.active and desk.why is desk.c.inspector.tree is None)
    desk.turn(-2.5)
    desk.until(lambda: not desk.c.active)
    assert blocked(desk.answered())


def test_nothing_is_proven_by_a_method_that_is_not_chosen_any_more(desk: PixelDesk):
    """Certificates that are no longer followed may be untrue by now."""
    desk.c.settings.change(method="certified")
    desk.until(lambda: not desk.c.active, ticks=20)
    desk.c.selection.select(desk.shadow)
    old = desk.answered()
    assert {one.method for one in old.reasons} == {"certified"}
    desk.c.settings.change(method="paper")
    desk.until(lambda: desk.why not in (None, old))
    assert {one.method for one in desk.why.reasons} == {"paper"}


def test_a_run_has_the_world_to_itself(desk: PixelDesk):
    desk.c.selection.select(desk.shadow)
    desk.answered()
    desk.c.runs.experiment_plan = replace(desk.c.runs.experiment_plan, frames=400, size=(32, 24), depth=1)
    desk.c.runs.start_experiment()
    desk.until(lambda: desk.why is None)
    desk.c.runs.stop()
    desk.until(lambda: desk.c.runs.current is None and not desk.c.active)
    assert blocked(desk.answered())


def test_pixels_of_reasons_are_those_of_their_picture_alone(desk: PixelDesk):
    """In motion the reasons stay until the next come, but their pixels are elsewhere by then."""
    selection = desk.c.selection
    selection.select(desk.shadow)
    answer, first, ui = desk.answered(), desk.c.frame, Ui(desk.c)
    neighbour = Link("the right neighbour", pixel=(answer.x + 1, answer.y))
    desk.turn(0.02)
    desk.until(lambda: desk.c.frame is not first, ticks=1)
    before = selection.picked
    assert desk.why is answer and not desk.c.inspector.names_pixels_of(desk.c.frame)
    go_to(ui, neighbour)
    assert selection.picked is before, "it would be another pixel"
    desk.until(lambda: not desk.c.active)
    desk.answered()
    go_to(ui, neighbour)
    assert (selection.picked.x, selection.picked.y) == neighbour.pixel


def test_lights_are_summed_up_by_the_samples_that_arrive():
    samples = ((16, 16), (16, 3), (16, 0), (4, 0))
    lights = [Reason(0, Rule.OFF, Fate.TRACED, samples=many, lit=lit) for many, lit in samples]
    assert summary([*lights, Reason(4, Rule.FACES_AWAY, Fate.FACES_AWAY)]) == (
        "1 lit, 1 in part, 2 in shadow, 1 facing away"
    )


def test_an_answer_that_fails_is_one_line_and_a_failed_edit_leaves_answers(
    desk: PixelDesk, monkeypatch: pytest.MonkeyPatch
):
    def fail(*_: object) -> None:
        raise ValueError("made to fail")

    with monkeypatch.context() as patched:
        patched.setattr(module, "why", fail)
        desk.c.selection.select(desk.shadow)
        desk.until(lambda: desk.c.inspector.problem == "made to fail")
        assert unanswered(Ui(desk.c)) == "No answer: made to fail."
        desk.c.selection.clear()
        desk.tick()
        patched.setattr("viewer.services.editing.edited", fail)
        desk.c.editing.change(desk.c.editing.now.with_light(0, False))
        desk.until(lambda: desk.c.notices.message is not None and "made to fail" in desk.said)
        desk.until(lambda: not desk.c.editing.under_way)
    desk.c.selection.select(desk.shadow)
    assert blocked(desk.answered())


def test_rays_follow_the_camera_and_an_edit_of_the_scene(desk: PixelDesk):
    """The picture before an edit and the one after are of the same time, camera and settings."""
    c = desk.c

    def tree(before: RayTree | None = None) -> RayTree:
        def newest() -> bool:
            found = c.inspector.tree
            return found not in (None, before) and found.frame.primitive is c.frame.primitive and not c.active

        desk.until(newest)
        return c.inspector.tree

    def lines_of(one: RayTree) -> int:
        return len(ray_lines(one.frame, one, RayFilter()))

    c.selection.select(desk.shadow)
    first = tree()
    desk.turn(0.02)
    moved = tree(first)
    assert (moved.x, moved.y) == c.selection.pixel != (first.x, first.y)
    c.editing.change(c.editing.now.with_light(0, False))
    edited = tree(moved)
    assert lines_of(edited) < lines_of(moved), "a light less shines on it"
    c.undo.undo()
    assert lines_of(tree(edited)) == lines_of(moved)

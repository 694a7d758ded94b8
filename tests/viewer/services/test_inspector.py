"""What the inspector shows is explained on the render thread, for as long as it is what the picture shows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.viewer.desk import Desk, place_of
from tracer.culling.fate import Fate
from tracer.editing.edits import NO_EDITS
from tracer.inspect.path_records import AWAY, RayTree
from tracer.inspect.ray_tree import unculled_shadow_rays
from tracer.inspect.reasons import Reason, Rule, Why
from tracer.inspect.why_in_words import Link
from viewer.output.ray_rows import RayFilter
from viewer.services import inspector as module
from viewer.state import navigation
from viewer.window.panels.inspector import summary, telling, unanswered, wrong_beyond
from viewer.window.panels.links import go_to
from viewer.window.panels.rays import ray_lines
from viewer.window.ui import Ui


class PixelDesk(Desk):
    """A desk that knows a pixel in shadow."""

    def __init__(self, path: Path, folder: Path) -> None:
        super().__init__(path, folder)
        self.shadow = place_of(self.c, lit=False, near=2)

    def answered(self) -> Why:
        """The reasons for the picture that is shown."""
        self.until(lambda: self.why is not None and self.why.tree.frame.primitive is self.c.frame.primitive, ticks=5)
        return self.why

    @property
    def why(self) -> Why | None:
        return self.c.inspector.why

    def turn(self, by: float) -> None:
        self.c.motion.move(navigation.look(self.c.session.camera, by, 0.0, self.c.motion.world_up))


@pytest.fixture
def desk(tiny_scene_file: Path, tmp_path: Path):
    desk = PixelDesk(tiny_scene_file, tmp_path)
    yield desk
    assert desk.c.close()


def blocked(answer: Why) -> bool:
    return any(one.blocker >= 0 for one in answer.reasons)


def test_reasons_say_what_the_frame_did(desk: PixelDesk):
    desk.c.settings.change(method="paper")
    desk.rest()
    desk.c.selection.select(desk.shadow)
    answer, asked = desk.answered(), (desk.c.frame, *desk.c.selection.pixel)
    truth = unculled_shadow_rays(desk.c.renderer._renderer, *asked)
    assert answer.tree is desk.c.inspector.tree and (answer.tree.x, answer.tree.y) == desk.c.selection.pixel
    assert [one.lit for one in answer.reasons] == truth.lit.tolist() and wrong_beyond(answer) == 0
    assert [one.fate is Fate.FACES_AWAY for one in answer.reasons] == (truth.verdict == AWAY).tolist()
    assert [one.blocker for one in answer.reasons] == truth.blocker.tolist()


def test_nothing_is_proven_by_a_method_that_is_not_chosen_any_more(desk: PixelDesk):
    """Certificates that are no longer followed may be untrue by now."""
    desk.c.settings.change(method="certified")
    desk.rest()
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
    desk.run_to_its_end()
    assert blocked(desk.answered())


def test_pixels_of_reasons_are_those_of_their_picture_alone(desk: PixelDesk):
    """In motion the reasons stay until the next come, but their pixels are elsewhere by then."""
    selection = desk.c.selection
    selection.select(desk.shadow)
    answer, first, ui = desk.answered(), desk.c.frame, Ui(desk.c)
    neighbour = Link("the right neighbour", pixel=(answer.x + 1, answer.y))
    desk.turn(0.02)
    desk.until(lambda: desk.c.frame is not first)
    before = selection.picked
    assert desk.why is answer and not desk.c.inspector.names_pixels_of(desk.c.frame)
    go_to(ui, neighbour)
    assert selection.picked is before, "it would be another pixel"
    desk.rest()
    desk.answered()
    go_to(ui, neighbour)
    assert (selection.picked.x, selection.picked.y) == neighbour.pixel


def test_lights_are_summed_up_by_the_samples_that_arrive():
    samples = ((16, 16), (16, 3), (16, 0), (4, 0))
    lights = [Reason(0, Rule.OFF, Fate.TRACED, samples=many, lit=lit) for many, lit in samples]
    summed_up = summary([*lights, Reason(4, Rule.FACES_AWAY, Fate.FACES_AWAY)])
    assert summed_up == "1 lit, 1 in part, 2 in shadow, 1 facing away"
    wrong, culled = Reason(5, Rule.OFF, Fate.TRACED, lit=1, wrong=1), Reason(6, Rule.FULL_SHADOW, Fate.CULLED)
    assert [one.light for one in sorted([lights[0], lights[3], culled, wrong], key=telling)] == [5, 6, 0, 0]


def test_a_failed_answer_stops_nothing_a_failed_edit_leaves_answers_and_a_failed_frame_stops_what_plays(
    desk: PixelDesk, monkeypatch: pytest.MonkeyPatch
):
    def fail(*_: object, **__: object) -> None:
        raise ValueError("made to fail")

    with monkeypatch.context() as patched:
        patched.setattr(module, "why", fail)
        desk.c.session.playing = True
        desk.c.selection.select(desk.shadow)
        desk.until(lambda: desk.c.inspector.problem == "made to fail")
        assert unanswered(Ui(desk.c)) == "No answer: made to fail."
        desk.until(lambda: desk.c.notices.message is not None and "made to fail" in desk.said)
        count = len(desk.came)
        desk.until(lambda: len(desk.came) > count + 2)
        assert desk.c.session.playing
        desk.c.session.playing = False
        desk.c.selection.clear()
        desk.tick()
        patched.setattr("viewer.services.editing.edited", fail)
        desk.c.notices.message = None
        desk.edit(NO_EDITS.with_light(0, False))
        assert "made to fail" in desk.said and not desk.c.session.edits
    desk.c.selection.select(desk.shadow)
    assert blocked(desk.answered())
    desk.c.session.playing = True
    monkeypatch.setattr(desk.c.renderer._renderer, "refine", fail)
    desk.until(lambda: not desk.c.session.playing)
    assert "frame not traced" in desk.said and "made to fail" in desk.said


def test_rays_follow_the_time_the_camera_and_an_edit_of_the_scene(desk: PixelDesk):
    """The picture before an edit and the one after are of the same time, camera and settings; of what is out of view
    nothing is said."""
    c = desk.c

    def tree() -> RayTree:
        desk.rest()
        desk.answered()
        return c.inspector.tree

    def lines_of(one: RayTree) -> int:
        return len(ray_lines(one.frame, one, RayFilter()))

    c.selection.select(desk.shadow)
    c.motion.step(3)
    first = tree()
    assert first.frame.time == c.frame.time > 0.0
    desk.turn(2.5)
    desk.rest()
    assert desk.why is c.inspector.tree is None
    desk.turn(-2.48)
    moved = tree()
    assert (moved.x, moved.y) == c.selection.pixel != (first.x, first.y)
    c.editing.change(NO_EDITS.with_light(0, False))
    edited = tree()
    assert lines_of(edited) < lines_of(moved), "a light less shines on it"
    c.undo.undo()
    assert lines_of(tree()) == lines_of(moved)

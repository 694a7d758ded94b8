"""The paper's text in the window: on and back, to changes of modes, and over frames of the same view."""

from __future__ import annotations

from pathlib import Path
from threading import Event

import pytest

from tests.viewer.desk import Desk, place_of
from tests.viewer.fakes import until
from tracer.scene.model import Cancelled
from viewer.services import stepping as module
from viewer.state import navigation


class SteppingDesk(Desk):
    """A desk at which somebody looks at the steps of a pixel."""

    looks = False

    def __init__(self, path: Path, folder: Path) -> None:
        super().__init__(path, folder)
        self.looks, self.s = True, self.c.stepping
        self.c.settings.change(method="paper")
        self.c.reset_modes()
        self.rest()

    def tick(self) -> None:
        if self.looks:
            self.c.stepping.watch()
        super().tick()

    def click(self, lit: bool = False) -> None:
        self.c.selection.select(place_of(self.c, lit=lit, near=2))
        self.tick()
        self.until(lambda: self.s.now is not None)

    def to_end(self) -> None:
        self.s.place = len(self.s.now.steps) - 1


@pytest.fixture
def desk(tiny_scene_file: Path, tmp_path: Path):
    desk = SteppingDesk(tiny_scene_file, tmp_path)
    yield desk
    assert desk.c.close()


def test_steps_go_on_and_back_over_frames(desk: SteppingDesk) -> None:
    s, c = desk.s, desk.c
    desk.click()
    first, traced = s.now, len(desk.came)
    assert (first.x, first.y) == c.selection.pixel and s.place == 0 and s.step_in(c.frame) is first.steps[0]
    s.go(-1)
    assert (s.frame, s.place) == (0, 0), "there is nothing before"
    s.go(1)
    assert s.place == 1 and len(desk.came) == traced
    desk.to_end()
    s.go(1)
    s.go(-1)
    assert s.wanted is None and s.place == len(first.steps) - 2, "who goes back waits for no frame"
    s.go(1)
    s.go(1)
    assert s.wanted is not None and s.now is first
    desk.until(lambda: s.frame == 1)
    assert len(desk.came) > traced and s.place == 0 and s.wanted is None and s.now is not first
    s.go(-1)
    assert s.now is first and s.place == len(first.steps) - 1
    s.go(1)
    assert (s.frame, s.place) == (1, 0), "it is there already"
    desk.click(lit=True)
    assert (s.now.x, s.now.y) == c.selection.pixel and len(s.runs) == 1 and s.frame == s.place == 0, "another pixel"
    c.selection.clear()
    desk.tick()
    assert s.now is None


def test_nothing_is_run_while_nobody_looks(desk: SteppingDesk) -> None:
    desk.looks = False
    desk.c.selection.select(place_of(desk.c, lit=False, near=2))
    desk.rest()
    assert desk.s.now is None and not desk.s.shown
    desk.looks = True
    desk.until(lambda: desk.s.now is not None)
    desk.looks = False
    desk.tick()
    desk.tick()
    assert desk.s.step_in(desk.c.frame) is None, "marks of a panel that is not seen"


def test_changes_of_modes_are_gone_to_from_the_first_frame_on(desk: SteppingDesk) -> None:
    """After modes are forgotten, that frame's steps are shown; those that follow at rest join it, and wait."""
    s, c = desk.s, desk.c
    desk.click()
    desk.to_end()
    c.reset_modes()
    desk.until(lambda: s.place == 0)
    desk.rest()
    here, changes = s.now, []
    assert here is not s.runs[0][1] and here.steps[0].part.section == "2.3"
    while s.now is here and s.wanted is None:
        s.go_to_change()
        changes.append(s.now.steps[s.place])
    of_this = [step for step in changes if step.changes]
    assert {step.part.section for step in of_this} == {"2.5", "2.6"}
    assert all(value.before for step in of_this for value in step.values if value.name.startswith("modes.occlusion"))
    desk.until(lambda: s.wanted is None)
    assert s.now is not here and s.place > 0, "the next frame's first change, or its end"


def test_another_view_is_gone_to_and_of_the_old_one_nothing_is_marked(desk: SteppingDesk) -> None:
    s, c = desk.s, desk.c
    desk.click()
    desk.to_end()
    c.motion.move(navigation.look(c.session.camera, 0.01, 0.0, c.motion.world_up))
    desk.rest()
    desk.until(lambda: s.frame > 0)
    assert s.place == 0 and s.step_in(c.frame) is s.now.steps[0]
    s.go(-1)
    assert s.step_in(c.frame) is None


def test_no_more_frames_are_kept_than_there_is_room_for(desk: SteppingDesk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_KEPT", 3)
    s = desk.s
    desk.click()
    for _ in range(4):
        desk.to_end()
        s.frame, newest = len(s.runs) - 1, s.runs[-1][1]
        s.go(1)
        desk.until(lambda newest=newest: s.now is not newest and s.wanted is None)
    assert len(s.runs) == 3 and s.frame == 2


def test_why_there_are_no_steps_is_said(desk: SteppingDesk, monkeypatch: pytest.MonkeyPatch) -> None:
    s, c = desk.s, desk.c
    desk.click()
    c.settings.change(method="cells")
    desk.until(lambda: bool(s.problem))
    assert (
        s.problem
        == "No steps: Cells keeps modes of cells, and the text speaks of primitives, as the method paper does."
    )
    assert s.now is None
    c.settings.change(method="certified")
    desk.until(lambda: s.now is not None)
    assert not s.problem and "Paper would take" in s.now.remark
    monkeypatch.setattr(module, "paper_steps", lambda *_: 1 // 0)
    c.reset_modes()
    desk.until(lambda: s.problem.startswith("No steps: ") and s.now is None)


def test_a_run_ends_when_another_pixel_is_clicked(desk: SteppingDesk, monkeypatch: pytest.MonkeyPatch) -> None:
    began, ended = Event(), Event()

    def endless(*arguments: object) -> None:
        began.set()
        until(arguments[-1])
        ended.set()
        raise Cancelled

    with monkeypatch.context() as patched:
        patched.setattr(module, "paper_steps", endless)
        desk.c.selection.select(place_of(desk.c, lit=False, near=2))
        desk.until(began.is_set)
        desk.c.selection.clear()
        desk.until(ended.is_set)
    desk.click()

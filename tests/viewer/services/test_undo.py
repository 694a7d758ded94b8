"""Undo and redo: what is a step, what it is called, and what comes back."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.fakes import Clock
from tracer.scene.mesh_options import IN_STUDIO
from tracer.scene.model import Camera
from viewer.services.controller import Controller
from viewer.services.motion import IDLE_AFTER
from viewer.state.comparison import CompareMode
from viewer.state.draw_options import Tone
from viewer.state.navigation import LONGEST_FLIGHT
from viewer.state.pixels import Zoom
from viewer.state.session import Session
from viewer.state.views import View

AWAY = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))


class Desk:
    """A controller of which nothing is traced, and its clock."""

    def __init__(self, clock: Clock, c: Controller) -> None:
        self.clock, self.session, self.motion, self.undo, self.notices = clock, c.session, c.motion, c.undo, c.notices
        self.frame()

    def frame(self, seconds: float = 0.02) -> None:
        """One of the window's frames."""
        self.clock.now += seconds
        self.motion.advance(None)
        self.undo.note_changes()

    def rest(self) -> None:
        self.frame(IDLE_AFTER + LONGEST_FLIGHT)
        self.frame()

    @property
    def depth(self) -> int:
        return self.session.settings.depth

    @property
    def said(self) -> str:
        return self.notices.message.text


@pytest.fixture
def desk(clock: Clock, c: Controller) -> Desk:
    return Desk(clock, c)


def compare(session: Session, **fields: object) -> None:
    session.change(compare=replace(session.state.compare, **fields))


CHANGES = {
    "method Certified": lambda session: session.set_settings(method="certified"),
    "view Depth": lambda session: session.set_draw(view=View.DEPTH),
    "light 1": lambda session: session.set_draw(light=1),
    "range changed": lambda session: session.change(draw=session.draw.with_span((1.0, 2.0), View.DEPTH)),
    "mark clipped pixels on": lambda session: session.set_draw(clipping=True),
    "exposure +0.5 EV": lambda session: session.set_draw(tone=Tone(0.5)),
    "zoom to 2 x": lambda session: session.set_draw(zoom=Zoom(2.0)),
    "comparison: side by side": lambda session: compare(session, on=True, mode=CompareMode.SIDE),
    "A by Certified": lambda session: compare(session, second="certified"),
}


def test_each_change_is_a_step_with_a_name_and_comes_back(desk: Desk):
    held = []
    for name, change in CHANGES.items():
        held.append(desk.session.state)
        change(desk.session)
        desk.frame()
        assert (desk.undo.undoes, desk.undo.redoes) == (name, "")
    held.append(desk.session.state)
    for before, name in zip(reversed(held[:-1]), reversed(CHANGES), strict=True):
        desk.undo.undo()
        assert desk.said == f"undone: {name}" and desk.session.state == before
    assert desk.undo.undoes == ""
    for after, name in zip(held[1:], CHANGES, strict=True):
        desk.undo.redo()
        assert desk.said == f"redone: {name}" and desk.session.state == after
    desk.undo.undo()
    desk.session.set_settings(depth=3)
    desk.frame()
    desk.undo.redo()
    assert desk.undo.redoes == "" and desk.said == "there is nothing to redo", "another way was taken"


def test_many_changes_at_once_are_counted_and_listed(desk: Desk):
    desk.session.set_settings(depth=3, method="none", zoom_factor=2.0)
    desk.frame()
    listed = "bounces 3, method None (trace all), zoom factor 2"
    assert (desk.undo.undoes, desk.undo.details(0)) == ("3 changes", listed)
    desk.undo.undo()
    assert desk.said == f"undone: {listed}" and desk.undo.details(1) == listed


@pytest.mark.parametrize(("depths", "name"), [((9, 8, 4, 2), "bounces 2"), ((9, 10), "")])
def test_a_drag_is_one_step_whatever_it_passes_and_none_if_it_comes_back(
    desk: Desk, depths: tuple[int, ...], name: str
):
    desk.undo.held = True
    for depth in depths:
        desk.session.set_settings(depth=depth)
        desk.frame(1.0)
    desk.undo.held = False
    desk.frame()
    assert desk.undo.undoes == name
    desk.undo.undo()
    assert desk.depth == 10 and desk.undo.undoes == ""


def test_a_view_chosen_in_flight_is_a_step_of_its_own_and_a_step_is_undone_while_it_goes_on(desk: Desk):
    desk.motion.move(AWAY)
    desk.frame()
    desk.session.set_draw(view=View.NORMAL)
    desk.frame()
    desk.rest()
    assert desk.undo.undoes == "view Normals"
    desk.undo.undo()
    assert desk.undo.undoes == "camera"
    desk.undo.undo()
    desk.motion.move(AWAY)
    desk.undo.undo()
    assert desk.session.on_path and desk.undo.redoes == "camera"


def test_time_is_no_step_and_stays_unless_a_step_has_gone_to_another(desk: Desk):
    desk.session.set_draw(light=1)
    desk.frame()
    desk.session.change(time=5.0)
    desk.frame()
    desk.undo.begin_step("going there", with_time=True)
    desk.session.change(time=7.0)
    desk.frame()
    for name, time_then in (("going there", 5.0), ("light 1", 5.0)):
        assert desk.undo.undoes == name
        desk.undo.undo()
        assert desk.session.time == time_then
    desk.undo.redo()
    desk.undo.redo()
    assert desk.session.time == 7.0


def test_what_is_named_is_one_step_and_a_name_for_nothing_names_nothing_else(desk: Desk):
    for change in ({"method": "certified", "depth": 2}, {}):
        desk.undo.begin_step("preset mine")
        desk.session.set_settings(**change)
        desk.frame()
        assert desk.undo.undoes == ("preset mine" if change else "")
        desk.undo.undo()
        assert (desk.session.settings.method, desk.depth) == ("paper", 10)
    desk.session.set_settings(depth=2)
    desk.frame()
    assert desk.undo.undoes == "bounces 2"


def test_so_many_steps_are_kept_and_another_scene_forgets_all(desk: Desk, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("viewer.services.undo.MOST_STEPS", 2)
    for depth in (4, 3, 2):
        desk.session.set_settings(depth=depth)
        desk.frame()
    for depth in (3, 4, 4):
        desk.undo.undo()
        assert desk.depth == depth, "two steps are kept"
    desk.session.change(meshes=IN_STUDIO)
    desk.frame()
    desk.undo.redo()
    assert desk.said == "there is nothing to redo" and desk.undo.undoes == "", "a mesh read anew is another scene"


def test_turns_of_the_wheel_are_one_step_and_a_rest_begins_another(desk: Desk):
    for scale in (2.0, 4.0, 8.0):
        desk.session.set_draw(zoom=Zoom(scale))
        desk.frame(0.2)
    desk.frame(1.0)
    desk.session.set_draw(zoom=Zoom(16.0))
    desk.frame(1.0)
    assert desk.undo.undoes == "zoom to 16 x"
    desk.undo.undo()
    assert desk.session.draw.zoom == Zoom(8.0) and desk.undo.undoes == "zoom to 8 x"
    desk.undo.undo()
    assert desk.session.draw.zoom.fits and desk.undo.undoes == ""

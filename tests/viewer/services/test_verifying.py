"""Views of what is wrong have frames verified for as long as they are chosen, and change no setting of the user's."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest
from PIL import Image

from tests.viewer.fakes import FakeRenderer, make_frame, make_scene
from tracer.experiments import experiment
from tracer.scene.model import Camera
from viewer.services.controller import Controller
from viewer.services.render_request import RenderRequest, Traced
from viewer.state import codec
from viewer.state.preferences import Preferences
from viewer.state.views import View
from viewer.window.app import advance

SIZE = (16, 8)


class Desk:
    """A controller at work on a renderer that traces nothing."""

    def __init__(self, controller: Controller) -> None:
        self.c, self.renderer = controller, FakeRenderer()
        controller.show(make_scene(), self.renderer, {})
        assert self.rest() == [False, False]  # one that teaches the modes, and one that shows what they save

    def rest(self) -> list[bool]:
        """Tick until all has been traced; for each frame asked for meanwhile, whether it was to be verified."""
        before, quiet, end = len(self.renderer.asked), 0, time.monotonic() + 20.0
        while quiet < 10:
            assert time.monotonic() < end, "it does not come to rest"
            advance(self.c, SIZE)
            quiet = 0 if self.c.active else quiet + 1
            time.sleep(0.002)
        return [settings.verify for _, settings in self.renderer.asked[before:]]


@pytest.fixture
def desk():
    controller = Controller(Preferences(state={"pace": {"progressive": False}, "settings": {"samples": 1}}))
    yield Desk(controller)
    assert controller.close()


@pytest.mark.parametrize("view", [View.SAVED, View.COST])
def test_a_view_of_work_has_it_counted_once_and_other_views_trace_nothing(desk: Desk, view: View):
    desk.c.session.set_draw(view=view)
    assert desk.c.scheduler.drawn_view is View.COLOR and desk.c.scheduler.outdated, "nothing has been counted yet"
    assert "counting" in desk.c.scheduler.title
    assert desk.rest() == [False]
    assert desk.c.frame.settings.record_work and desk.c.scheduler.drawn_view is view and not desk.c.scheduler.outdated
    for other in (View.COLOR, View.COST, View.SAVED, View.CERTIFICATE):
        desk.c.session.set_draw(view=other)
        assert not desk.c.scheduler.outdated
        assert desk.rest() == []
    desk.c.motion.step(1)
    desk.rest()
    assert not desk.c.frame.settings.record_work, "only frames of such a view"
    assert not desk.c.session.settings.record_work


def test_what_was_verified_is_counted_and_verified_again_when_both_are_wanted(desk: Desk):
    desk.c.settings.change(verify=True)
    assert desk.rest() == [True]
    desk.c.session.set_draw(view=View.SAVED)
    assert desk.rest() == [True] and desk.c.frame.settings.record_work
    desk.c.session.set_draw(view=View.DIFFERENCE)
    assert desk.rest() == []


@pytest.mark.parametrize("view", [View.DIFFERENCE, View.WIPE])
def test_a_view_of_what_is_wrong_verifies_once_and_other_views_trace_nothing(desk: Desk, view: View):
    desk.c.session.set_draw(view=view)
    assert desk.c.scheduler.drawn_view is View.COLOR and desk.c.scheduler.outdated, "nothing has been verified yet"
    assert "verifying" in desk.c.scheduler.title
    assert desk.rest() == [True]
    assert desk.c.frame.wrong is not None and desk.c.scheduler.drawn_view is view and not desk.c.scheduler.outdated
    for other in (View.COLOR, View.WIPE, View.DIFFERENCE, View.DEPTH):
        desk.c.session.set_draw(view=other)
        assert not desk.c.scheduler.outdated
        assert desk.rest() == []
    assert not desk.c.session.settings.verify


def test_only_frames_of_such_a_view_are_verified(desk: Desk):
    desk.c.session.set_draw(view=View.DIFFERENCE)
    assert set(desk.rest()) == {True}
    desk.c.motion.step(1)
    assert set(desk.rest()) == {True}
    desk.c.session.set_draw(view=View.COLOR)
    assert desk.rest() == []
    desk.c.motion.step(1)
    assert set(desk.rest()) == {False}


def test_the_users_own_setting_counts_in_every_view(desk: Desk):
    desk.c.settings.change(verify=True)
    assert desk.rest() == [True]
    desk.c.session.set_draw(view=View.DIFFERENCE)
    desk.c.settings.change(verify=False)
    assert desk.rest() == [], "verified it is already"
    desk.c.session.set_draw(view=View.COLOR)
    desk.c.settings.change(verify=True)
    desk.c.settings.change(verify=False)
    desk.c.scheduler.trace_again()
    assert desk.rest() == [False]


def test_switched_off_by_the_user_it_is_traced_without(desk: Desk):
    desk.c.settings.change(verify=True)
    desk.rest()
    desk.c.settings.change(verify=False)
    assert desk.rest() == [False]


def test_what_a_run_cut_short_is_traced_after_it_though_it_showed_no_frame(desk: Desk, monkeypatch):
    def fail(*arguments, **options):
        raise AttributeError("no world")

    monkeypatch.setattr(experiment, "run", fail)
    desk.renderer.go.clear()
    desk.renderer.started.clear()
    desk.c.scheduler.trace_again()
    advance(desk.c, SIZE)
    assert desk.renderer.started.wait(10.0)
    desk.c.runs.start_experiment()
    end = time.monotonic() + 10.0
    while desk.c.runs.current is not None:
        assert time.monotonic() < end
        advance(desk.c, SIZE)
    assert desk.c.notices.newest_fault is not None, "the run fails at once"
    assert desk.renderer.cancelled, "the run came before the frame"
    desk.renderer.go.set()
    assert desk.rest() == [False], "the frame that was cut short has not come"


def test_a_capture_of_a_runs_frame_is_named_and_restored_as_what_it_shows(desk: Desk, tmp_path):
    own = desk.c.session.scene.camera
    elsewhere = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))
    assert desk.c.session.on_path and desk.c.session.frame == 0
    desk.c.preferences.screenshot_folder, desk.c.preferences.screenshot_template = str(tmp_path), "{frame:04d}.png"
    for camera, follow in ((elsewhere, False), (own, True)):
        frame = make_frame(time=7.0, camera=camera)
        desk.c.scheduler.show(Traced(RenderRequest(7.0, camera, frame.settings), frame, frame.statistics))
        desk.c.captures.capture(desk.c.frame, np.zeros((8, 16, 3), np.uint8))
        name = "0007.png" if camera == elsewhere else "0007-2.png"
        assert desk.c.captures.saving.pop().join(10.0)
        with Image.open(tmp_path / name) as image:
            kept = json.loads(image.text["shadowcull"])
        state = codec.picture_from_json(kept)
        assert (kept["frame"], state.time, state.camera is None) == (7, 7.0, follow)
        desk.c.restore(state)
        assert (desk.c.session.camera, desk.c.session.frame) == (camera, 7)
        desk.c.motion.reset_camera()


def test_a_capture_keeps_the_users_setting_and_the_line(desk: Desk, tmp_path):
    desk.c.session.set_draw(view=View.WIPE)
    desk.c.session.set_draw(wipe=0.25)
    desk.rest()
    desk.c.preferences.screenshot_folder, desk.c.preferences.screenshot_template = str(tmp_path), "wipe.png"
    desk.c.captures.capture(desk.c.frame, np.zeros((8, 16, 3), np.uint8))
    assert desk.c.captures.saving[0].join(10.0)
    with Image.open(tmp_path / "wipe.png") as image:
        kept = json.loads(image.text["shadowcull"])
    assert kept["statistics"]["shadow"]["wrong"] == 3
    state = codec.picture_from_json(kept)
    assert (state.draw.view, state.draw.wipe, state.settings.verify) == (View.WIPE, 0.25, False)

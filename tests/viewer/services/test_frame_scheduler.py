"""What the render thread is asked for, at rest and in motion: in which order, with which modes, and verified when."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Future
from dataclasses import replace
from threading import Event, Thread
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.viewer.fakes import make_frame, make_scene, with_certificates
from tracer.culling.mode_changes import ModeChanges
from tracer.frame import Settings
from tracer.scene.lights import Light
from tracer.scene.model import Scene
from tracer.statistics import FrameStatistics
from viewer.services.frame_inputs import FrameInputs
from viewer.services.frame_scheduler import Activity, FrameScheduler
from viewer.services.jobs import Wake
from viewer.services.refinement import MOST_FRAMES, MOST_LEARNING
from viewer.services.render_request import RenderRequest, Traced
from viewer.state import views
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import View

SIZE = (16, 8)


class Renders:
    """A render thread that traces at once what it is asked for, with its lamps as they were asked for; its next frames
    make so many `certificates`, and change modes so."""

    busy = False

    def __init__(self) -> None:
        self.asked: list[RenderRequest] = []
        self.certificates, self.changes = iter(()), iter(())
        self._made: Traced | None = None

    def submit(self, request: RenderRequest) -> None:
        self.asked.append(request)
        frame = make_frame(replace(request.settings, samples=request.samples))
        frame.statistics.certificates = next(self.certificates, 0)
        frame.statistics.mode_changes = next(self.changes, None)
        self._made = Traced(request, frame, FrameStatistics())

    def take(self) -> Traced | None:
        made, self._made = self._made, None
        return made


class Window:
    """A scheduler as the window drives it."""

    def __init__(self, scene: Scene | None = None, **settings: Any) -> None:
        state = ViewState(settings=Settings(**{"method": "none", "samples": 2} | settings))
        self.session, self.renders = Session(state=state), Renders()
        self.session.open(scene or make_scene())
        self.scheduler = FrameScheduler(self.renders)

    def request(self, **inputs: Any) -> None:
        session = self.session
        self.scheduler.request(FrameInputs(session.state, session.scene, session.camera, SIZE, **inputs))

    def asked_for(self, frames: int = 12, **inputs: Any) -> list[RenderRequest]:
        """What is asked for in so many frames of the window."""
        before = len(self.renders.asked)
        for _ in range(frames):
            self.scheduler.take()
            self.request(**inputs)
        return self.renders.asked[before:]

    def rest(self, frames: int = 12, **inputs: Any) -> list[tuple[int | None, int]]:
        """Samples of lamps, and of pixels, that are asked for meanwhile."""
        return [(one.settings.lamp_samples, one.samples) for one in self.asked_for(frames, **inputs)]

    def frames(self, certificates: Iterable[int] = (), changes: Iterable[ModeChanges] = ()) -> int:
        """How many are asked for until all is known, where they make so many certificates, and change modes so."""
        self.renders.certificates, self.renders.changes = iter(certificates), iter(changes)
        return len(self.asked_for(2 * MOST_FRAMES))

    def see(self, view: View) -> list[RenderRequest]:
        self.session.set_draw(view=view)
        return self.asked_for()

    def move(self) -> None:
        camera = self.session.camera
        x, y, z = camera.position
        self.session.change(camera=replace(camera, position=(x + 1.0, y, z)))


# --- which frames are asked for ----------------------------------------------------------------------


def test_pictures_are_asked_for_once_and_again_after_a_run():
    """A run drops what was asked for, and leaves the world at its own last frame."""
    window = Window(samples=1)
    window.session.set_pace(progressive=False)
    for _ in range(3):
        window.request()
    (request,) = window.renders.asked
    assert (request.settings.width, request.settings.height, request.parts) == (*SIZE, (16,))
    window.request(run=SimpleNamespace(label_shown="frame 3", is_shown=True, name="experiment", verifies=True))
    assert window.scheduler.title == f"showing frame 3   {View.COLOR.label}"
    window.request()
    assert window.renders.asked == [request, request]


def test_the_next_frame_of_a_film_waits_until_this_one_can_be_asked_about():
    window = Window(samples=1)
    film = {"moving": True, "playing": True, "inspected": True}
    window.rest(2, **film)
    for at in (1.0, 2.0, 3.0):
        window.session.change(time=at)
        window.request(**film)
    assert [one.time for one in window.renders.asked] == [0.0, 1.0]
    window.session.set_settings(method="paper")
    window.request(**film)
    assert [one.time for one in window.renders.asked] == [0.0, 1.0, 3.0], "but what is worthless does not delay it"
    window.session.change(time=4.0)
    window.scheduler.forget_modes()
    window.request(**film)
    assert window.renders.asked[-1].time == 4.0, "nor what has been cut short"


@pytest.mark.parametrize(("ready", "method", "traced"), [
    (True, "certified+rest", "certified+rest"), (False, "certified+rest", "none"), (False, "paper", "paper"),
])  # fmt: skip
def test_until_all_kernels_are_there_a_first_picture_comes_by_those_that_are(ready: bool, method: str, traced: str):
    window = Window(method=method)
    window.request(ready=ready)
    assert window.scheduler.inputs.settings.method == traced


def test_at_rest_lamps_get_more_samples_before_pixels_do_and_nothing_is_asked_for_twice():
    window = Window(lamp_radius=0.5, lamp_samples=64)
    assert window.rest() == [(4, 1), (64, 2), (64, 2)], "the last knows more about shadows"
    assert window.rest() == []
    assert window.scheduler.activity is Activity.RESTING and window.scheduler.lamp_samples_shown == 64
    window.session.set_settings(lamp_samples=256)
    assert window.rest(1) == [(256, 2)] and window.scheduler.activity is Activity.SAMPLING_LAMPS
    assert window.rest() == [(256, 2)], "what there is goes on"
    window.session.set_settings(lamp_samples=1)
    assert window.rest() == [(1, 2), (1, 2)]
    window.session.set_settings(lamp_samples=16, lamp_radius=0.25)
    assert window.rest() == [(4, 1), (16, 2), (16, 2)], "lamps of another size"
    for _ in range(5):
        window.move()
        assert window.rest(1, moving=True) == [(4, 1)], "all pictures of a motion have as many"
    assert window.rest() == [(16, 2), (16, 2)], "the last of them is the first at rest"


def test_points_have_one_sample_and_whole_pictures_all_of_them():
    window = Window(lamp_samples=64)
    assert set(window.rest()) == {(64, 2)}, "which changes nothing"
    assert window.scheduler.lamps.wanted == 1 and not window.scheduler.lamps.any
    sphere = Light("lamp", (0.0, 5.0, 0.0), kind="sphere", radius=1.0, samples=16)
    window = Window(replace(make_scene(), lights=(sphere,)))
    assert window.rest() == [(4, 1), (None, 2), (None, 2)], "as the scene says"
    window.session.set_pace(progressive=False)
    window.move()
    assert set(window.rest(3, moving=True)) == {(None, 2)}


def test_what_reaches_pixels_is_recorded_where_it_is_shown_and_there_is_memory_for_it(monkeypatch: pytest.MonkeyPatch):
    window = Window(lamp_radius=0.5, lamp_samples=16)
    window.rest()
    window.session.set_draw(view=View.PENUMBRA)
    assert window.rest() == [(16, 2)] and window.renders.asked[-1].settings.record_lights
    window.session.set_draw(view=View.COLOR)
    assert window.rest() == [], "there is more than the picture needs"
    window.session.set_draw(view=View.REGRET)
    window.rest()
    assert window.scheduler.title == "Regret: not available here, colour shown", "by a method without certificates"
    monkeypatch.setattr(views, "MOST_RECORDED", 128)
    window = Window()
    for view, title in (
        (View.PENUMBRA, "Penumbra: counting ..."),
        (View.LIGHTS, "Lights due: not available here, colour shown"),
        (View.FATE, "Fate of shadow rays: not available here, colour shown"),
    ):
        window.session.set_draw(view=view)
        window.rest()
        asked = window.renders.asked[-1].settings
        assert not asked.record_lights and not asked.record_fates and window.scheduler.title == title


def test_what_the_renderer_is_asked_for_is_shown_till_the_next_frame_has_its_own(monkeypatch: pytest.MonkeyPatch):
    window, futures = Window(method="certified"), {}
    scheduler, shown = window.scheduler, lambda: window.scheduler.frame.layers["slack 0"][0, 0]

    def query(function, frame, *rest):
        return futures.setdefault(id(frame.primitive), (Future(), function, frame, rest))[0]

    window.renders.query = query
    monkeypatch.setattr(type(View.SLACK.declared), "asks", staticmethod(lambda number, *rest: {"slack 0": number}))

    def trace(**elsewhere: Any) -> None:
        scheduler.trace_once_more()
        window.request()
        scheduler.take()
        scheduler.traced = replace(scheduler.traced, frame=with_certificates(replace(scheduler.frame, **elsewhere)))
        scheduler.record_light()

    def answer(number: float) -> None:
        future, function, *asked = list(futures.values())[-1]
        future.set_result(function(np.full((8, 16), number), asked[0], *asked[1], lambda: False))
        scheduler.record_light()

    window.session.set_draw(view=View.SLACK)
    trace()
    assert scheduler.drawn_view is View.COLOR and scheduler.title == "Slack: counting ..."
    list(futures.values())[-1][3][-1](0.345)
    assert scheduler.title == "Slack: counting 34 % ..."
    answer(1.0)
    assert scheduler.drawn_view is View.SLACK and shown() == 1.0
    trace()
    assert scheduler.drawn_view is View.SLACK and shown() == 1.0
    answer(2.0)
    assert shown() == 2.0 and len(futures) == 2
    trace(time=9.0)
    assert scheduler.drawn_view is View.COLOR, "of another moment nothing is known"


def test_between_steps_it_is_known_that_more_is_to_come():
    """Whatever the thread is at: it may be between two pictures."""
    window = Window(lamp_radius=0.5, lamp_samples=64)
    scheduler, activities = window.scheduler, []
    for _ in range(12):
        window.request()
        activities.append(scheduler.activity)
        scheduler.take()
    assert activities[:4] == [Activity.TRACING, Activity.SAMPLING_LAMPS, Activity.TRACING, Activity.RESTING]
    for change, activity in (
        (lambda: window.session.set_settings(lamp_samples=256), Activity.SAMPLING_LAMPS),
        (window.move, Activity.TRACING),
    ):
        change()
        window.request()
        assert scheduler.activity is activity
        scheduler.give_up()
        assert scheduler.activity is Activity.RESTING, "a failure ends it"


# --- what views need ---------------------------------------------------------------------------------


COUNTED, VERIFIED = (View.COLOR, View.COST, View.SAVED, View.CERTIFICATE), (View.WIPE, View.DIFFERENCE, View.DEPTH)


@pytest.mark.parametrize(("view", "verifies"), [
    (View.SAVED, False), (View.COST, False), (View.DIFFERENCE, True), (View.WIPE, True),
])  # fmt: skip
def test_what_a_view_needs_is_traced_once_and_for_such_views_alone(view: View, verifies: bool):
    window = Window(method="paper", samples=1)
    session, scheduler = window.session, window.scheduler
    window.rest()
    session.set_draw(view=view)
    window.request()
    assert scheduler.drawn_view is View.COLOR and scheduler.outdated, "it is not there yet"
    assert ("verifying" if verifies else "counting") in scheduler.title
    window.rest()
    assert scheduler.frame.settings.record_work is not verifies and (scheduler.frame.wrong is not None) is verifies
    assert scheduler.drawn_view is view and not scheduler.outdated
    for other in VERIFIED if verifies else COUNTED:
        assert window.see(other) == [] and not scheduler.outdated
    for shown, wanted in ((view, True), (View.COLOR, False)):
        window.see(shown)
        session.change(time=session.time + 1.0)
        asked = window.asked_for()
        assert {one.settings.verify for one in asked} == {verifies and wanted}
        assert {one.settings.record_work for one in asked} == {wanted and not verifies}
    assert not session.settings.verify and not session.settings.record_work


def test_the_users_own_setting_counts_in_every_view():
    window = Window(method="paper", samples=1)
    window.rest()
    window.session.set_settings(verify=True)
    assert [one.settings.verify for one in window.asked_for()] == [True]
    window.session.set_settings(verify=False)
    assert window.see(View.DIFFERENCE) == [], "verified it is already"
    assert window.see(View.COLOR) == [], "that is more than is asked for"
    window.scheduler.trace_again()
    assert [one.settings.verify for one in window.asked_for()] == [False]


# --- further frames that know more -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "made", "expected"),
    [
        ("none", [], 2),
        ("paper", [], 2),
        ("certified", [], 2),
        ("certified", [9, 9, 9], 4),
        ("auto", [9] * 20, 2),
        ("certified+cache", [9] * 2 * MOST_FRAMES, 1 + MOST_FRAMES),
    ],
)
def test_frames_follow_as_long_as_they_know_more(method: str, made: list[int], expected: int):
    window = Window(method=method, samples=1)
    assert window.frames(made) == expected
    assert window.frames(made) == 0, "nothing is refined twice"
    window.move()
    assert window.frames(made) == expected, "another view"
    window.scheduler.forget_modes()
    assert window.frames(made) >= expected - 1, "what was known is lost"


def test_frames_follow_until_modes_no_longer_change():
    """As where many primitives are examined anew: one frame says so, one learns, and one shows what that saves."""
    learning = [ModeChanges(fully_rendered=9), ModeChanges(examined_anew=3), ModeChanges(fully_rendered=3)]
    window = Window(method="paper", samples=1)
    assert window.frames(changes=[*learning, ModeChanges()]) == 4
    window.move()
    assert window.frames(changes=[ModeChanges(full_shadow=1)] * 20) == MOST_LEARNING + 1


def test_the_view_of_certificates_asks_for_more_of_them():
    for method, more in (("auto", 6), ("paper", 0)):
        window = Window(method=method, samples=1)
        assert window.frames([9] * 20) == 2
        window.session.set_draw(view=View.CERTIFICATE)
        assert window.frames([9] * 5) == more


# --- waking the window -------------------------------------------------------------------------------


def test_a_window_stays_until_nobody_is_just_waking_it():
    """A thread that refreshed a window which has gone would call into what is no more."""
    wake, waking, go_on = Wake(), Event(), Event()

    def refresh() -> None:
        waking.set()
        assert go_on.wait(20.0)

    wake.connect(refresh)
    waker, closer = Thread(target=wake), Thread(target=wake.connect, args=[None])
    waker.start()
    assert waking.wait(20.0)
    closer.start()
    closer.join(0.05)
    assert closer.is_alive(), "the window has gone while a thread was waking it"
    go_on.set()
    for thread in (waker, closer):
        thread.join(20.0)
    assert not closer.is_alive()
    wake()  # does nothing

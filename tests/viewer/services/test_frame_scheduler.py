"""What the render thread is asked for, at idle and in motion: in which order, with which modes, and verified when."""

from __future__ import annotations

import time
from dataclasses import replace
from threading import Event, Thread
from types import SimpleNamespace
from typing import Any

import pytest

from tests.viewer.fakes import FakeRenderer, make_scene
from tracer.culling.mode_changes import ModeChanges
from tracer.frame import Settings
from tracer.scene.model import Camera
from tracer.statistics import FrameStatistics
from viewer.services.controller import Controller
from viewer.services.frame_scheduler import FrameInputs, FrameScheduler
from viewer.services.jobs import Wake
from viewer.services.refinement import MOST_FRAMES, MOST_LEARNING, Refinement
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import View
from viewer.window.app import advance

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Pictures:
    """A render thread that traces nothing: what it was asked, and what it has next."""

    busy = False

    def __init__(self) -> None:
        self.asked: list[RenderRequest] = []
        self.next: Traced | None = None
        self.resets = 0

    def submit(self, request: RenderRequest) -> None:
        self.asked.append(request)

    def take(self) -> Traced | None:
        return self.next

    def reset_modes(self) -> None:
        self.resets += 1


def test_pictures_are_asked_for_once_and_again_after_a_run():
    """A run drops what was asked for, and leaves the world at its own last frame."""
    pictures, session = Pictures(), Session(state=ViewState(settings=Settings(method="none", samples=1)))
    session.set_pace(progressive=False)
    session.open(make_scene())
    scheduler = FrameScheduler(pictures)
    here = FrameInputs(session.state, session.scene, session.camera, (16, 8))
    for _ in range(3):
        scheduler.request(here)
    (request,) = pictures.asked[1:] if len(pictures.asked) > 1 else pictures.asked
    assert (request.settings.width, request.settings.height, request.parts) == (16, 8, (16,))
    run = SimpleNamespace(label_shown="frame 3", name="experiment", verifies=True)
    scheduler.request(replace(here, run=run))
    assert scheduler.title == f"showing frame 3   {View.COLOR.label}"
    count = len(pictures.asked)
    scheduler.request(here)
    assert len(pictures.asked) == count + 1 and pictures.asked[-1] == request


@pytest.mark.parametrize(("ready", "method", "traced"), [
    (True, "certified+rest", "certified+rest"), (False, "certified+rest", "none+rest"), (False, "paper", "paper"),
])  # fmt: skip
def test_until_certificates_can_be_made_pictures_come_without(ready: bool, method: str, traced: str):
    scheduler = FrameScheduler(Pictures())
    scheduler.request(FrameInputs(ViewState(settings=Settings(method=method)), ready=ready))
    assert scheduler.settings.method == traced


def test_a_window_stays_until_nobody_is_just_waking_it():
    """A thread that refreshed a window which has gone would call into what is no more."""
    wake, waking, go_on, gone = Wake(), Event(), Event(), Event()

    def refresh() -> None:
        waking.set()
        assert go_on.wait(20.0) and not gone.is_set()

    wake.connect(refresh)
    thread = Thread(target=wake)
    thread.start()
    assert waking.wait(20.0)

    def close() -> None:
        wake.connect(None)
        gone.set()

    closing = Thread(target=close)
    closing.start()
    assert not gone.wait(0.05), "the window has gone while a thread was waking it"
    go_on.set()
    thread.join(20.0)
    closing.join(20.0)
    assert gone.is_set()
    wake()  # does nothing


SIZE = (16, 8)


class Desk:
    """A controller at work on a renderer that traces nothing."""

    def __init__(self, controller: Controller) -> None:
        self.c, self.renderer = controller, FakeRenderer()
        controller.show(self.renderer, {})
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


@pytest.mark.parametrize(
    ("view", "doing", "others"),
    [
        (View.SAVED, "counting", (View.COLOR, View.COST, View.SAVED, View.CERTIFICATE)),
        (View.COST, "counting", (View.COLOR, View.COST, View.SAVED, View.CERTIFICATE)),
        (View.DIFFERENCE, "verifying", (View.COLOR, View.WIPE, View.DIFFERENCE, View.DEPTH)),
        (View.WIPE, "verifying", (View.COLOR, View.WIPE, View.DIFFERENCE, View.DEPTH)),
    ],
)
def test_what_a_view_needs_is_traced_once_and_for_such_views_alone(
    desk: Desk, view: View, doing: str, others: tuple[View, ...]
):
    verifies = doing == "verifying"
    desk.c.session.set_draw(view=view)
    before = len(desk.renderer.asked)
    advance(desk.c, SIZE)
    assert desk.c.scheduler.drawn_view is View.COLOR and desk.c.scheduler.outdated, "it is not there yet"
    assert doing in desk.c.scheduler.title
    desk.rest()
    assert [settings.verify for _, settings in desk.renderer.asked[before:]] == [verifies]
    assert desk.c.frame.settings.record_work is not verifies and (desk.c.frame.wrong is not None) is verifies
    assert desk.c.scheduler.drawn_view is view and not desk.c.scheduler.outdated
    for other in others:
        desk.c.session.set_draw(view=other)
        assert desk.rest() == []
        assert not desk.c.scheduler.outdated
    for shown, wanted in ((view, True), (View.COLOR, False)):
        desk.c.session.set_draw(view=shown)
        desk.rest()
        desk.c.motion.step(1)
        assert set(desk.rest()) == {verifies and wanted}
        assert desk.c.frame.settings.record_work is (wanted and not verifies)
    assert not desk.c.session.settings.verify and not desk.c.session.settings.record_work


def test_the_users_own_setting_counts_in_every_view(desk: Desk):
    desk.c.settings.change(verify=True)
    assert desk.rest() == [True]
    desk.c.session.set_draw(view=View.DIFFERENCE)
    desk.c.settings.change(verify=False)
    assert desk.rest() == [], "verified it is already"
    desk.c.session.set_draw(view=View.COLOR)
    assert desk.rest() == [], "that is more than is asked for"
    desk.c.scheduler.trace_again()
    assert desk.rest() == [False]


ELSEWHERE = Camera((1.0, 0.0, 0.0), CAMERA.direction, CAMERA.up)


def traced(request: RenderRequest, certificates: int, part: float = 1.0) -> Traced:
    """A frame, or a part of one, that made so many certificates."""
    statistics = FrameStatistics(certificates=certificates, part=part)
    frame: Any = SimpleNamespace(statistics=statistics, width=8, height=8)
    return Traced(request, frame, statistics)


def frames(
    refinement: Refinement, made: list[int], camera: Camera = CAMERA, view: View = View.COLOR, **settings: Any
) -> int:
    """How many frames of a view are traced, the k-th of which makes so many certificates."""
    for k, certificates in enumerate(made):
        request = RenderRequest(0.0, camera, Settings(8, 8, **settings), 1, k)
        assert not refinement.wants_another(traced(request, certificates, 0.25), view, False), "not whole yet"
        whole = traced(request, certificates)
        if not refinement.wants_another(whole, view, False):
            return k + 1
        assert not refinement.wants_another(whole, view, False), "once for each frame"
    return len(made)


@pytest.mark.parametrize(
    ("method", "made", "expected"),
    [
        ("none", [0] * 20, 2),
        ("paper", [0] * 20, 2),
        ("certified", [0] * 20, 2),
        ("certified", [9, 9, 9, 0, 0, 0], 4),
        ("auto", [9] * 20, 2),
        ("certified+cache", [9] * 2 * MOST_FRAMES, 1 + MOST_FRAMES),
    ],
)
def test_frames_follow_as_long_as_they_know_more(method: str, made: list[int], expected: int):
    refinement = Refinement()
    assert frames(refinement, made, method=method) == expected
    assert frames(refinement, made, method=method) == 1, "nothing is refined twice"
    assert frames(refinement, made, ELSEWHERE, method=method) == expected, "another view"
    refinement.forget()
    assert frames(refinement, made, ELSEWHERE, method=method) == expected, "what was known is lost"


def test_frames_follow_until_modes_no_longer_change():
    """As where many primitives are examined anew: one frame says so, one learns, and one shows what that saves."""
    changes = [ModeChanges(examined_anew=3), ModeChanges(fully_rendered=3, full_shadow=2), ModeChanges(), ModeChanges()]
    refinement, count = Refinement(), 0
    for k, changed in enumerate([ModeChanges(fully_rendered=9), *changes]):
        whole = traced(RenderRequest(0.0, CAMERA, Settings(8, 8, method="paper"), 1, k), 0)
        whole.frame.statistics.mode_changes = changed
        count += 1
        if not refinement.wants_another(whole, View.COLOR, False):
            break
    assert count == 4
    for k in range(20):  # however often they change
        whole = traced(RenderRequest(0.0, ELSEWHERE, Settings(8, 8, method="paper"), 1, k), 0)
        whole.frame.statistics.mode_changes = ModeChanges(full_shadow=1)
        if not refinement.wants_another(whole, View.COLOR, False):
            break
    assert k == MOST_LEARNING


def test_the_view_of_certificates_asks_for_more_of_them():
    refinement = Refinement()
    assert frames(refinement, [9] * 20, method="auto") == 2
    assert frames(refinement, [9] * 5 + [0] * 3, view=View.CERTIFICATE, method="auto") == 6
    assert frames(refinement, [0] * 5, view=View.CERTIFICATE, method="paper") == 2

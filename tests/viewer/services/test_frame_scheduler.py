"""What the render thread is asked for, at idle and in motion: in which order, and with which modes."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import count
from threading import Event, Thread
from types import SimpleNamespace
from typing import Any

from tests.viewer.fakes import FakeRenderer, make_scene
from tracer.frame import Settings
from tracer.scene.model import Camera, Cancelled
from viewer.services.controller import Controller
from viewer.services.frame_scheduler import FrameInputs, FrameScheduler
from viewer.services.jobs import Wake
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

    hurry = submit

    def take(self) -> Traced | None:
        return self.next

    def reset_modes(self) -> None:
        self.resets += 1


def test_pictures_are_asked_for_once_and_again_after_a_run():
    """A run drops what was asked for, and leaves the world at its own last frame."""
    pictures, session = Pictures(), Session(state=ViewState(settings=Settings(method="none", samples=1)))
    session.set_pace(progressive=False)
    session.open(make_scene())
    scheduler = FrameScheduler(session, Preferences(), pictures)
    here = FrameInputs(size=(16, 8))
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


def test_until_certificates_can_be_made_pictures_come_without():
    session = Session(state=ViewState(settings=Settings(method="certified+rest")))
    scheduler = FrameScheduler(session, Preferences(), Pictures())
    assert scheduler.settings.method == "certified+rest"
    scheduler.request(FrameInputs(ready=False))
    assert scheduler.settings.method == "none+rest"
    session.change(settings=replace(session.settings, method="paper"))
    assert scheduler.settings.method == "paper"


def test_a_hand_that_falters_starves_no_picture():
    """While something moves, each picture that has begun is shown, however often the camera stands still in between."""
    preferences = Preferences(state={"pace": {"progressive": False}, "settings": {"samples": 1}})
    controller, renderer = Controller(preferences), FakeRenderer()
    controller.show(make_scene(), renderer, {})
    trace, size = renderer.refine, (16, 8)

    def slow(time_: float, camera: Camera | None = None, cancel: Any = None, *rest: Any) -> Any:
        end = time.monotonic() + 0.06
        while time.monotonic() < end:
            if cancel():
                raise Cancelled
            time.sleep(0.002)
        yield from trace(time_, camera, cancel, *rest)

    renderer.refine = slow  # type: ignore[method-assign]
    shown, end = set(), time.monotonic() + 1.0
    try:
        for step in count():
            if time.monotonic() > end:
                break
            if step % 2:
                x = 0.001 * step
                controller.motion.move(replace(controller.session.camera, position=(x, 0.0, 0.0)))
            advance(controller, size)
            if controller.traced is not None:
                shown.add(controller.traced.request.camera)
            time.sleep(0.016)
        assert len(shown) >= 5
    finally:
        assert controller.close()


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

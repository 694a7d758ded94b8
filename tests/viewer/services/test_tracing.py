"""What is asked of the render thread, at rest and in motion: how many frames more, in which order, with which modes."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.viewer.fakes import FakeRenderer, make_frame, make_scene
from tracer.frame import Settings
from tracer.scene.model import Camera, Cancelled
from tracer.statistics import FrameStatistics
from viewer.services.controller import Controller
from viewer.services.render_thread import RenderRequest, Traced
from viewer.services.tracing import LESSONS, Tracing
from viewer.state.preferences import Preferences
from viewer.state.views import View

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Desk:
    """A controller at rest, whose frames come at once: what `Tracing` asks of it."""

    def __init__(self) -> None:
        self.preferences = SimpleNamespace(keep_tracing=False)
        self.session, self.moving, self.render = SimpleNamespace(playing=False, view=View.COLOR), False, self
        self.tracing = Tracing(self)  # type: ignore[arg-type]
        self._next: Traced | None = None

    def take(self) -> Traced | None:
        return self._next

    def frames(self, made: list[int], camera: Camera = CAMERA, **settings: Any) -> int:
        """How many frames of a view are traced, the k-th of which makes so many certificates."""
        for k, certificates in enumerate(made):
            request = RenderRequest(0.0, camera, Settings(8, 8, **settings), 1, k)
            before = self.tracing._serial
            for part in (0.25, 1.0):
                statistics = FrameStatistics(certificates=certificates, seconds=0.1, part=part)
                frame = SimpleNamespace(statistics=statistics, width=8, height=8)
                self._next = Traced(request, frame, statistics)  # type: ignore[arg-type]
                self.tracing.take()
                self.tracing._settle()
                assert part == 1.0 or self.tracing._serial == before, "a part of a picture teaches nothing"
            if self.tracing._serial == before:
                return k + 1
        return len(made)


@pytest.mark.parametrize(
    ("method", "made", "frames"),
    [
        ("none", [0] * 20, 2),
        ("paper", [0] * 20, 2),
        ("certified", [0] * 20, 2),
        ("certified", [9, 9, 9, 0, 0, 0], 4),
        ("auto", [9] * 20, 2),
        ("certified+cache", [9] * 2 * LESSONS, 1 + LESSONS),
    ],
)
def test_at_rest_frames_follow_as_long_as_there_is_something_to_learn(method: str, made: list[int], frames: int):
    desk = Desk()
    assert desk.frames(made, method=method) == frames
    assert desk.frames(made, method=method) == 1, "nothing is learnt twice"
    elsewhere = Camera((1.0, 0.0, 0.0), CAMERA.direction, CAMERA.up)
    assert desk.frames(made, elsewhere, method=method) == frames, "another view"


def _traced(divisor: int, modes: list[int], part: float = 1.0) -> Traced:
    frame = make_frame(Settings(16 // divisor, 8 // divisor))
    statistics = replace(frame.statistics, part=part)
    frame = replace(frame, modes=np.array(modes, np.uint32), settings=replace(frame.settings, modes=True))
    settings = replace(frame.settings, width=frame.width, height=frame.height)
    return Traced(RenderRequest(0.0, CAMERA, settings, divisor), replace(frame, statistics=statistics), statistics)


def test_a_coarser_picture_shows_the_modes_of_the_last_whole_one():
    """Those of its own resolution know little of what the user has been looking at."""
    desk = Desk()
    for traced, shown in (
        (_traced(2, [0, 0, 1]), [0, 0, 1]),
        (_traced(1, [5, 6, 7]), [5, 6, 7]),
        (_traced(1, [5, 6, 9], part=0.25), [5, 6, 9]),
        (_traced(2, [0, 0, 1], part=0.25), [5, 6, 7]),
        (_traced(2, [0, 0]), [0, 0]),
    ):
        desk._next = traced
        assert desk.tracing.take().frame.modes.tolist() == shown
        assert desk.tracing.frame.modes.tolist() == shown
    desk.tracing.again(modes_are_lost=True)
    desk._next = _traced(2, [0, 0, 1])
    assert desk.tracing.take().frame.modes.tolist() == [0, 0, 1]


def test_a_hand_that_falters_starves_no_picture():
    """While something moves, each picture that has begun is shown, however often the camera stands still in between."""
    controller, renderer = Controller(Preferences(dynamic_resolution=False, samples=1)), FakeRenderer()
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
                controller.move(replace(controller.session.camera, position=(x, 0.0, 0.0)))
            controller.tick(size)
            if controller.traced is not None:
                shown.add(controller.traced.request.camera)
            time.sleep(0.016)
        assert len(shown) >= 5
    finally:
        assert controller.close()

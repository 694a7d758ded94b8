"""What is asked of the render thread at rest: how many frames more, and when no more."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from tracer.frame import Settings
from tracer.scene.model import Camera
from tracer.statistics import FrameStatistics
from viewer.render_thread import RenderRequest, Traced
from viewer.tracing import LESSONS, Tracing
from viewer.views import View

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

"""How many frames follow a whole picture at idle."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from tracer.culling.mode_changes import ModeChanges
from tracer.frame import Settings
from tracer.scene.model import Camera
from tracer.statistics import FrameStatistics
from viewer.services.refinement import MOST_FRAMES, MOST_LEARNING, Refinement
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.views import View

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
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


def test_progress_is_that_of_certificates_alone():
    refinement = Refinement()
    for method, expected in (("auto", (0, 0)), ("paper", (0, 0)), ("certified", (1, MOST_FRAMES))):
        assert refinement.progress == (0, 0) and not refinement.proves
        whole = traced(RenderRequest(0.0, CAMERA, Settings(8, 8, method=method), 1), 9)
        assert refinement.wants_another(whole, View.COLOR, False)
        assert refinement.progress == expected and refinement.proves == bool(expected[0]), method
    assert not refinement.wants_another(traced(whole.request, 9, 0.5), View.COLOR, False)
    refinement.forget()
    assert refinement.progress == (0, 0) and not refinement.proves


def test_the_view_of_certificates_asks_for_more_of_them():
    refinement = Refinement()
    assert frames(refinement, [9] * 20, method="auto") == 2
    assert frames(refinement, [9] * 5 + [0] * 3, view=View.CERTIFICATE, method="auto") == 6
    assert frames(refinement, [0] * 5, view=View.CERTIFICATE, method="paper") == 2


def test_frames_go_on_where_the_user_says_so_and_coarse_ones_teach_nothing():
    refinement = Refinement()
    for k in range(10):
        request = RenderRequest(0.0, CAMERA, Settings(8, 8, method="none"), 1, k)
        assert refinement.wants_another(traced(request, 0), View.COLOR, keep_tracing=True)
    coarse = RenderRequest(0.0, ELSEWHERE, Settings(8, 8, method="paper"), 2)
    assert not refinement.wants_another(traced(coarse, 0), View.COLOR, keep_tracing=False)
    assert not refinement.wants_another(None, View.COLOR, keep_tracing=True)


def test_it_is_known_that_certificates_are_left_to_make():
    refinement = Refinement()
    frames(refinement, [9] * 2 * MOST_FRAMES, method="certified")
    assert refinement.ended_early
    assert frames(refinement, [9] * 2 * MOST_FRAMES, view=View.CERTIFICATE, method="certified") == 1, "seen otherwise"
    assert refinement.ended_early
    for made, method in (([9, 0], "certified"), ([9] * 9, "auto"), ([0] * 9, "paper")):
        frames(refinement, made, ELSEWHERE, method=method)
        assert not refinement.ended_early

"""Pictures a second are those that come, whatever the window draws meanwhile."""

from __future__ import annotations

import pytest

from tests.viewer.fakes import make_frame, make_scene
from viewer.services.frame_history import FrameHistory
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.history import FrameRate, rate_in_words
from viewer.state.session import Session


def test_as_many_as_came_within_the_last_second() -> None:
    rate = FrameRate()
    assert rate.per_second(0.0) is None
    for n in range(50):
        rate.count(5.0 + 0.04 * n)
        assert n == 0 or rate.per_second(5.0 + 0.04 * n) == pytest.approx(25.0)
    for n in range(20):
        rate.count(7.0 + 0.1 * n)
    assert rate.per_second(9.0) == pytest.approx(10.0), "what came before that second does not count"


def test_a_picture_counts_once_however_often_more_of_it_comes() -> None:
    now = iter(0.1 * n for n in range(1000))
    history = FrameHistory(Session(make_scene()), clock=lambda: next(now))
    for n in range(6):
        frame = make_frame(time=float(n))
        request = RenderRequest(frame.time, frame.camera, frame.settings)
        for _ in range(3):
            history.take([], Traced(request, frame, frame.statistics), 0.01)
    assert history.frames_per_second == pytest.approx(10.0), "the clock ticks at each picture, not at its parts"


def test_no_rate_reads_as_none_at_all() -> None:
    assert [rate_in_words(rate) for rate in (27.4, 9.4, 0.06, 0.04)] == [
        "27 frames/s",
        "9.4 frames/s",
        "0.1 frames/s",
        "",
    ]


def test_slow_pictures_count_by_their_distance_and_none_that_have_ended() -> None:
    rate = FrameRate()
    for now in (0.0, 4.0, 8.0):
        rate.count(now)
    assert rate.per_second(12.0) == pytest.approx(0.25)
    assert rate.per_second(16.5) is None, "nothing comes any more"
    rate.count(17.0)
    rate.clear()
    assert rate.per_second(17.0) is None

"""Queries are answered between frames, once, and never keep anybody waiting: not a picture, and not for ever."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from threading import Event

import pytest

from tests.viewer.fakes import FakeRenderer
from tracer.scene.model import Camera, Cancelled
from tracer.settings import Settings
from viewer.services import render_thread
from viewer.services.render_request import RenderRequest
from viewer.services.render_thread import RenderThread

CAMERA = Camera((0.0, 0.0, 5.0), (0.0, 0.0, -1.0))


def request(at: float, **more) -> RenderRequest:
    return RenderRequest(at, CAMERA, Settings(width=8, height=8), **more)


@pytest.fixture
def thread() -> Iterator[RenderThread]:
    thread = RenderThread()
    yield thread
    assert thread.close(5.0)


def shown(thread: RenderThread, at: float, **more):
    """Trace a frame and return it."""
    thread.submit(request(at, **more))
    end = time.monotonic() + 5.0
    while True:
        assert time.monotonic() < end, "no frame"
        traced = thread.take()
        if traced is not None and traced.frame.time == at:
            return traced.frame
        time.sleep(0.001)


def column(renderer, frame, x, cancelled):
    return renderer, frame, x


def row(renderer, frame, y, cancelled):
    return y


def failing(renderer, frame, cancelled):
    raise ValueError("no such light")


def traced_so_far(renderer, frame, cancelled):
    return len(renderer.asked)


BEGUN = Event()


def endless(renderer, frame, number, cancelled):
    BEGUN.set()
    while not cancelled():
        time.sleep(0.001)
    raise Cancelled()


def begun() -> None:
    assert BEGUN.wait(5.0)
    BEGUN.clear()


def test_the_same_query_has_the_same_future_however_many_samples_come(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    answer = thread.query(column, frame, 3)
    assert answer.result(5.0) == (renderer, frame, 3)
    sampled = replace(frame, color=frame.color + 1.0)
    assert thread.query(column, sampled, 3) is answer
    other = thread.query(column, frame, 4)
    assert other.result(5.0)[2] == 4 and thread.query(column, frame, 3) is answer, "both are known"
    assert thread.query(column, replace(frame, primitive=frame.primitive.copy()), 3) is not answer, "another picture"


def test_of_each_function_the_newest_query_alone_is_answered_and_between_frames(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    renderer.go.clear()
    renderer.started.clear()
    thread.submit(request(1.0, serial=1))
    assert renderer.started.wait(5.0)
    older, other, newer = thread.query(column, frame, 1), thread.query(row, frame, 1), thread.query(column, frame, 2)
    assert older.cancelled() and not newer.done()
    renderer.go.set()
    assert newer.result(5.0)[2] == 2 and other.result(5.0) == 1
    assert len(renderer.asked) == 2, "and no frame was traced for it"


def test_a_query_about_a_moment_that_has_passed_is_cancelled_and_can_be_asked_anew(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    renderer.go.clear()
    renderer.started.clear()
    thread.submit(request(2.0))
    assert renderer.started.wait(5.0)
    left = thread.query(column, frame, 1)
    renderer.go.set()
    newest = shown(thread, 2.0)
    assert left.cancelled()
    assert thread.query(column, newest, 1).result(5.0)[1] is newest


def test_what_is_shown_can_be_asked_about_though_a_later_frame_has_failed(thread):
    """Else it would be looked into for ever."""
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    renderer.failing = OSError("the disk is full")
    thread.submit(request(2.0))
    end = time.monotonic() + 5.0
    while thread.take_failure() is None:
        assert time.monotonic() < end
    turns = len(renderer.turns)
    assert thread.query(column, frame, 1).result(5.0)[1] is frame
    assert len(renderer.turns) == turns + 1, "the world was put back for it"


def test_another_scene_cancels_what_was_asked(thread):
    thread.use(FakeRenderer())
    frame = shown(thread, 1.0)
    running = thread.query(endless, frame, 1)
    begun()
    waiting = thread.query(column, frame, 1)
    thread.use(FakeRenderer())
    assert running.cancelled() and waiting.cancelled()
    shown(thread, 1.0)


def test_an_error_is_in_the_future_and_told_in_one_line_but_is_no_failed_frame(thread):
    thread.use(FakeRenderer())
    frame = shown(thread, 1.0)
    assert isinstance(thread.query(failing, frame).exception(5.0), ValueError)
    end = time.monotonic() + 5.0
    while not (told := thread.take_complaints()):
        assert time.monotonic() < end
    assert [one.text for one in told] == ["no answer: no such light"]
    assert thread.take_failure() is None
    shown(thread, 3.0)


def test_a_query_that_takes_long_gives_way_to_a_picture_and_to_a_newer_query(thread, monkeypatch):
    monkeypatch.setattr(render_thread, "QUERY_SECONDS", 0.01)
    thread.use(FakeRenderer())
    frame = shown(thread, 1.0)
    first = thread.query(endless, frame, 1)
    begun()
    second = thread.query(endless, frame, 2)
    begun()
    assert first.cancelled() and not second.done()
    shown(thread, 2.0)
    assert second.cancelled()


def test_a_picture_is_asked_about_before_its_next_sample(thread):
    renderer, asked, sampled = FakeRenderer(), Event(), Event()
    thread.use(renderer)
    render = renderer.render

    def slowly(time, camera, cancel):
        if len(renderer.asked) == 3:
            sampled.set()
            assert asked.wait(5.0)
        return render(time, camera, cancel)

    renderer.render = slowly
    frame = shown(thread, 1.0, samples=50)
    assert sampled.wait(5.0)
    assert not thread.busy, "more samples are nothing to wait for"
    answer = thread.query(traced_so_far, frame)
    asked.set()
    assert answer.result(5.0) == 4


def test_a_query_is_answered_though_the_next_picture_makes_the_window_ask_anew(thread, monkeypatch):
    """Where a sample takes seconds and the window milliseconds, nothing would be answered before the last sample."""
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    renderer.go.clear()
    renderer.started.clear()
    thread.submit(request(1.0, serial=1))
    assert renderer.started.wait(5.0)
    asked, anew, deliver = thread.query(column, frame, 1), [], thread._deliver

    def seen_at_once(renderer, traced) -> bool:
        on = deliver(renderer, traced)
        anew.append(thread.query(column, traced.frame, 1))
        return on

    monkeypatch.setattr(thread, "_deliver", seen_at_once)
    renderer.go.set()
    assert asked.result(5.0)[1] is frame
    shown(thread, 1.0)
    assert anew[0].result(5.0)[1] is not frame

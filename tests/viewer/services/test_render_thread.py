"""The newest request wins, what is worthless is cancelled, queries are answered between frames, and nothing blocks."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from threading import Event
from typing import Any

import pytest

from tests.viewer.fakes import PATIENCE, FakeRenderer, until
from tracer.frame import Frame, Settings
from tracer.scene.model import Camera, Cancelled
from viewer.services import render_thread
from viewer.services.render_request import RenderRequest, Traced
from viewer.services.render_thread import RenderThread


def request(at: float, **kinds: Any) -> RenderRequest:
    return RenderRequest(at, Camera((0, 0, 5), (0, 0, -1)), Settings(width=8, height=8), **kinds)


class Thread(RenderThread):
    """A render thread with a renderer that traces nothing."""

    def __init__(self) -> None:
        super().__init__()
        self.fake = FakeRenderer()
        self.use(self.fake)

    def next(self) -> Traced:
        came: list[Traced] = []
        until(lambda: came.extend(filter(None, [self.take()])) or came)
        return came[0]

    def until(self, wanted: Callable[[Traced], bool]) -> Traced:
        while not wanted(traced := self.next()):
            pass
        return traced

    def shown(self, at: float, **kinds: Any) -> Frame:
        """The frame of a request, once it has come."""
        self.submit(request(at, **kinds))
        return self.until(lambda traced: traced.frame.time == at).frame

    def idle(self) -> None:
        until(lambda: not self.busy)

    def held_at(self, first: RenderRequest) -> None:
        """At work on this, until the renderer is let go."""
        self.fake.go.clear()
        self.fake.started.clear()
        self.submit(first)
        assert self.fake.started.wait(PATIENCE)


@pytest.fixture
def thread() -> Iterator[Thread]:
    thread = Thread()
    yield thread
    assert thread.close(PATIENCE)


# --- frames ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("quick", "method", "cut_short"), [
    (True, "paper", []), (False, "paper", [0.0]), (True, "none", [0.0]),
])  # fmt: skip
def test_the_newest_request_wins_and_a_fine_frame_is_cut_short_for_it(
    thread: Thread, quick: bool, method: str, cut_short: list[float]
):
    """A coarse frame in motion is let finish, else none would ever be seen, unless settings are others; and what is
    asked for twice goes on."""
    thread.held_at(request(0.0, quick=quick))
    thread.submit(request(0.0, quick=quick))
    assert thread.fake.cancelled == []
    for at in (1.0, 2.0, 3.0):
        newer = request(at, quick=True)
        thread.submit(replace(newer, settings=replace(newer.settings, width=4, method=method)))
    if cut_short:
        until(lambda: thread.fake.cancelled)
    else:
        time.sleep(0.05)
    assert thread.fake.cancelled == cut_short
    thread.fake.go.set()
    thread.until(lambda traced: traced.frame.time == 3.0)
    thread.idle()
    assert [at for at, _ in thread.fake.asked] == [0.0, 3.0]


def test_what_has_set_modes_is_handed_out_once_and_in_order(thread: Thread):
    """A picture that was left, as it was shown last, and one that became whole; one that nothing was shown of is not
    among them."""
    thread.fake.pause_after = 0.25
    assert thread.shown(1.0, parts=(4, 16), quick=True).time == 1.0
    thread.submit(request(2.0, parts=(8, 16), samples=2))
    until(lambda: thread.fake.cancelled)
    thread.fake.go.set()
    thread.idle()
    learnt = [(one.frame.time, one.frame.statistics.part, one.fresh) for one in thread.take_learnt()]
    assert learnt == [(1.0, 0.25, True), (2.0, 1.0, False)] and thread.take_learnt() == []


def test_errors_are_one_line_and_the_thread_lives_on(thread: Thread):
    thread.fake.failing = RuntimeError("first line\nsecond line")
    thread.submit(request(0.0))
    thread.idle()
    (failed,), of_frame = thread.take_problems()
    assert of_frame and "first line second line" in failed.text and "\n" not in failed.text
    assert not failed.expected and "Traceback" in failed.details
    assert thread.take_problems() == ([], False)
    thread.fake.failing = None
    thread.shown(1.0)


def test_of_a_scene_that_was_left_nothing_is_delivered(thread: Thread):
    frame, old = thread.shown(1.0), thread.fake
    thread.held_at(request(0.0))
    asked = thread.query(column, frame, 1)
    thread.use(FakeRenderer())
    assert asked.cancelled()
    old.go.set()
    thread.idle()
    assert thread.take() is None
    thread.shown(5.0)


def test_a_task_has_the_thread_to_itself_and_the_newest_request_waits(thread: Thread):
    started, go, got = Event(), Event(), []

    def task(renderer: object, cancelled: Callable[[], bool]) -> None:
        got.append(renderer)
        started.set()
        while not go.wait(0.002):
            assert not cancelled()

    thread.held_at(request(0.0))
    thread.perform(task)
    assert started.wait(PATIENCE)
    assert thread.fake.cancelled == [0.0], "what was under way is cut short"
    thread.fake.go.set()
    for at in (1.0, 2.0):
        thread.submit(request(at))
    thread.reset_modes()
    time.sleep(0.05)
    assert thread.busy and len(thread.fake.asked) == 1
    go.set()
    assert thread.next().frame.time == 2.0
    assert got == [thread.fake] and thread.fake.resets == 1
    thread.idle()


def test_a_picture_becomes_whole_and_gets_samples_as_long_as_nothing_else_is_wanted(thread: Thread):
    thread.submit(request(1.0, parts=(4, 8, 16), samples=3))
    last = thread.until(lambda traced: traced.frame.settings.samples == 3)
    thread.idle()
    assert len(thread.fake.asked) == 5 and last.whole
    assert last.first.part == 0.25, "what the first part cost is told with each"


def test_a_picture_of_which_a_part_was_shown_is_left_for_a_newer_one(thread: Thread):
    whole = thread.fake.render

    def with_news(time, camera, cancel):  # while the first part is traced the camera moves on
        if time == 1.0:
            thread.submit(request(2.0, quick=True, parts=(4, 16)))
        return whole(time, camera, cancel)

    thread.fake.render = with_news
    thread.submit(request(1.0, quick=True, parts=(4, 16)))
    assert thread.until(lambda traced: traced.whole).request.time == 2.0
    thread.idle()
    assert [at for at, _ in thread.fake.asked] == [1.0, 2.0, 2.0]


# --- queries -----------------------------------------------------------------------------------------


def column(renderer, frame, x, cancelled):
    return renderer, frame, x


def row(renderer, frame, y, cancelled):
    return y


def test_the_same_query_has_the_same_future_however_many_samples_come(thread: Thread):
    frame = thread.shown(1.0)
    answer = thread.query(column, frame, 3)
    assert answer.result(PATIENCE) == (thread.fake, frame, 3)
    assert thread.query(column, replace(frame, color=frame.color + 1.0), 3) is answer
    assert thread.query(column, frame, 4).result(PATIENCE)[2] == 4
    assert thread.query(column, replace(frame, primitive=frame.primitive.copy()), 3) is not answer, "another picture"


def test_of_each_function_the_newest_query_alone_is_answered_and_between_frames(thread: Thread):
    frame = thread.shown(1.0)
    thread.held_at(request(1.0, serial=1))
    older, other, newer = thread.query(column, frame, 1), thread.query(row, frame, 1), thread.query(column, frame, 2)
    assert older.cancelled() and not newer.done()
    thread.fake.go.set()
    assert newer.result(PATIENCE)[2] == 2 and other.result(PATIENCE) == 1
    assert len(thread.fake.asked) == 2, "and no frame was traced for it"


def test_a_query_about_a_moment_that_has_passed_is_cancelled_and_can_be_asked_anew(thread: Thread):
    frame = thread.shown(1.0)
    thread.held_at(request(2.0))
    left = thread.query(column, frame, 1)
    thread.fake.go.set()
    newest = thread.shown(2.0)
    assert left.cancelled() and thread.query(column, newest, 1).result(PATIENCE)[1] is newest


def test_what_is_shown_can_be_asked_about_though_a_later_frame_has_failed(thread: Thread):
    """Else it would be looked into for ever."""
    frame = thread.shown(1.0)
    thread.fake.failing = OSError("the disk is full")
    thread.submit(request(2.0))
    until(lambda: thread.take_problems()[1])
    turns = len(thread.fake.turns)
    assert thread.query(column, frame, 1).result(PATIENCE)[1] is frame
    assert len(thread.fake.turns) == turns + 1, "the world was put back for it"


def test_a_query_that_takes_long_gives_way_to_a_picture_and_to_a_newer_query(thread: Thread, monkeypatch):
    monkeypatch.setattr(render_thread, "QUERY_SECONDS", 0.01)
    begun = [Event(), Event()]

    def endless(renderer, frame, number, cancelled):
        begun[number].set()
        while not cancelled():
            time.sleep(0.001)
        raise Cancelled()

    frame = thread.shown(1.0)
    first = thread.query(endless, frame, 0)
    assert begun[0].wait(PATIENCE)
    second = thread.query(endless, frame, 1)
    assert begun[1].wait(PATIENCE) and first.cancelled() and not second.done()
    thread.shown(2.0)
    assert second.cancelled()


def test_a_picture_is_asked_about_before_its_next_sample(thread: Thread):
    asked, sampled, render = Event(), Event(), thread.fake.render

    def slowly(time, camera, cancel):
        if len(thread.fake.asked) == 3:
            sampled.set()
            assert asked.wait(PATIENCE)
        return render(time, camera, cancel)

    thread.fake.render = slowly
    frame = thread.shown(1.0, samples=50)
    assert sampled.wait(PATIENCE)
    assert not thread.busy, "more samples are nothing to wait for"
    answer = thread.query(lambda renderer, frame, cancelled: len(renderer.asked), frame)
    asked.set()
    assert answer.result(PATIENCE) == 4


def test_spare_work_gives_way_to_anything_and_the_world_is_put_back(thread: Thread):
    begun, ended = [], []

    def work(renderer, cancelled) -> bool:
        begun.append(renderer)
        while not cancelled():
            time.sleep(0.001)
        ended.append(renderer)
        raise Cancelled()

    thread.in_spare_time(work)
    for number, at in enumerate((1.0, 2.0)):
        assert len(begun) == number, "not before a picture is there"
        frame = thread.shown(at)
        until(lambda number=number: len(begun) == number + 1)
        assert not thread.busy and len(thread.fake.turns) == number, "put back after a step"
    assert thread.query(row, frame, 1).result(PATIENCE) == 1
    until(lambda: len(begun) == 3)
    thread.in_spare_time(None)
    until(lambda: len(ended) == len(thread.fake.turns) == 3)
    thread.in_spare_time(work)
    until(lambda: len(begun) == 4)

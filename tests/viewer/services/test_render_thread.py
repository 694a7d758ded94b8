"""The newest request wins, what is worthless is cancelled, queries are answered between frames, and nothing blocks."""

from __future__ import annotations

import time
from dataclasses import replace
from threading import Event

import pytest

from tests.viewer.fakes import PATIENCE, FakeRenderer, until
from tracer.frame import Settings
from tracer.scene.model import Camera, Cancelled
from viewer.services import render_thread
from viewer.services.render_request import RenderRequest, Traced
from viewer.services.render_thread import RenderThread
from viewer.util.messages import Failure

CAMERA = Camera((0, 0, 5), (0, 0, -1))


def request(at: float, **kinds) -> RenderRequest:
    return RenderRequest(at, CAMERA, Settings(width=8, height=8), **kinds)


@pytest.fixture
def thread():
    thread = RenderThread()
    yield thread
    assert thread.close(PATIENCE)


def taken(thread: RenderThread) -> Traced:
    came: list[Traced] = []
    until(lambda: came.extend(filter(None, [thread.take()])) or came)
    return came[0]


def shown(thread: RenderThread, at: float, **kinds):
    """The frame of a request, once it has come."""
    thread.submit(request(at, **kinds))
    while (traced := taken(thread)).frame.time != at:
        pass
    return traced.frame


def idle(thread: RenderThread) -> None:
    until(lambda: not thread.busy)


def held_at(thread: RenderThread, first: RenderRequest, renderer: FakeRenderer | None = None) -> FakeRenderer:
    """A renderer that is at work on this, and goes on when it is let go."""
    if renderer is None:
        renderer = FakeRenderer()
        thread.use(renderer)
    renderer.go.clear()
    renderer.started.clear()
    thread.submit(first)
    assert renderer.started.wait(PATIENCE)
    return renderer


@pytest.mark.parametrize(("quick", "cut_short"), [(True, []), (False, [0.0])])
def test_the_newest_request_wins_and_a_fine_frame_is_cut_short_for_it(thread, quick: bool, cut_short: list[float]):
    """A coarse frame in motion is let finish: else none would ever be seen."""
    renderer = held_at(thread, request(0.0, quick=quick))
    for at in (1.0, 2.0, 3.0):
        thread.submit(request(at, quick=True))
    if quick:
        time.sleep(0.05)
    else:
        until(lambda: renderer.cancelled)
    assert renderer.cancelled == cut_short
    renderer.go.set()
    while taken(thread).frame.time != 3.0:
        pass
    idle(thread)
    assert [at for at, _ in renderer.asked] == [0.0, 3.0]


def test_what_has_set_modes_is_handed_out_once_and_in_order(thread):
    """A picture that was left, as it was shown last, and one that became whole; one that nothing was shown of is not
    among them."""
    renderer = FakeRenderer()
    thread.use(renderer)
    renderer.pause_after = 0.25
    left = request(1.0, parts=(4, 16), quick=True)
    thread.submit(left)
    assert taken(thread).frame.time == 1.0
    thread.submit(request(2.0, parts=(8, 16), samples=2))
    until(lambda: renderer.cancelled)
    renderer.go.set()
    idle(thread)
    learnt = thread.take_learnt()
    assert [(one.frame.time, one.frame.statistics.part, one.fresh) for one in learnt] == [
        (1.0, 0.25, True),
        (2.0, 1.0, False),
    ]
    assert thread.take_learnt() == []


def test_the_same_request_again_does_not_cancel_itself():
    running = request(0.0)
    assert not request(0.0).supersedes(running)
    coarse = request(0.0, quick=True)
    assert not replace(coarse, settings=Settings(width=4, height=4)).supersedes(coarse)
    assert replace(coarse, settings=replace(coarse.settings, method="none")).supersedes(coarse)


def test_errors_are_one_line_and_the_thread_lives_on(thread):
    renderer = FakeRenderer()
    renderer.failing = RuntimeError("first line\nsecond line")
    thread.use(renderer)
    thread.submit(request(0.0))
    idle(thread)
    (failed,), of_frame = thread.take_problems()
    assert of_frame and "first line second line" in failed.text and "\n" not in failed.text
    assert not failed.expected and "Traceback" in failed.details
    assert thread.take_problems() == ([], False)
    renderer.failing = None
    thread.submit(request(1.0))
    assert taken(thread).frame.time == 1.0


def test_of_a_scene_that_was_left_nothing_is_delivered(thread):
    thread.use(FakeRenderer())
    frame = shown(thread, 1.0)
    old = held_at(thread, request(0.0))
    asked = thread.query(column, frame, 1)
    thread.use(FakeRenderer())
    assert asked.cancelled()
    old.go.set()
    idle(thread)
    assert thread.take() is None
    thread.submit(request(5.0))
    assert taken(thread).frame.time == 5.0


class FakeTask:
    """Works until `go` is set or it is cancelled."""

    def __init__(self) -> None:
        self.started, self.go = Event(), Event()
        self.renderer: object = None
        self.cancelled = False

    def work(self, renderer, cancelled) -> None:
        self.renderer = renderer
        self.started.set()
        while not self.go.wait(0.002):
            if cancelled():
                self.cancelled = True
                return


def test_a_task_has_the_thread_to_itself_and_the_newest_request_waits(thread):
    renderer, task = held_at(thread, request(0.0)), FakeTask()
    thread.perform(task.work)
    assert task.started.wait(PATIENCE)
    assert renderer.cancelled == [0.0], "what was under way is cut short"
    renderer.go.set()
    for at in (1.0, 2.0):
        thread.submit(request(at))
    thread.reset_modes()
    time.sleep(0.05)
    assert thread.busy and not task.cancelled and len(renderer.asked) == 1
    task.go.set()
    assert taken(thread).frame.time == 2.0
    assert task.renderer is renderer and renderer.resets == 1
    idle(thread)


def test_closing_cuts_a_trace_short():
    thread = RenderThread()
    thread.submit(request(0.0))
    assert not thread.busy, "nothing is traced without a scene"
    renderer = held_at(thread, request(0.0))
    assert thread.close(PATIENCE), "it hangs"
    assert renderer.cancelled == [0.0]
    thread.submit(request(1.0))
    assert not thread.busy


def test_a_picture_becomes_whole_and_gets_samples_as_long_as_nothing_else_is_wanted(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    thread.submit(request(1.0, parts=(4, 8, 16), samples=3))
    came = []
    while not came or came[-1].frame.settings.samples < 3:
        came.append(taken(thread))
    idle(thread)
    assert len(renderer.asked) == 5 and came[-1].whole
    assert came[-1].first.part == 0.25, "what the first part cost is told with each"


def test_a_picture_of_which_a_part_was_shown_is_left_for_a_newer_one(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    whole = renderer.render

    def with_news(time, camera, cancel):  # while the first part is traced the camera moves on
        if time == 1.0:
            thread.submit(request(2.0, quick=True, parts=(4, 16)))
        return whole(time, camera, cancel)

    renderer.render = with_news  # type: ignore[method-assign]
    thread.submit(request(1.0, quick=True, parts=(4, 16)))
    while not (traced := taken(thread)).whole:
        pass
    idle(thread)
    assert [at for at, _ in renderer.asked] == [1.0, 2.0, 2.0]
    assert traced.request.time == 2.0


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
    assert BEGUN.wait(PATIENCE)
    BEGUN.clear()


def test_the_same_query_has_the_same_future_however_many_samples_come(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    answer = thread.query(column, frame, 3)
    assert answer.result(PATIENCE) == (renderer, frame, 3)
    sampled = replace(frame, color=frame.color + 1.0)
    assert thread.query(column, sampled, 3) is answer
    other = thread.query(column, frame, 4)
    assert other.result(PATIENCE)[2] == 4
    assert thread.query(column, replace(frame, primitive=frame.primitive.copy()), 3) is not answer, "another picture"


def test_of_each_function_the_newest_query_alone_is_answered_and_between_frames(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    held_at(thread, request(1.0, serial=1), renderer)
    older, other, newer = thread.query(column, frame, 1), thread.query(row, frame, 1), thread.query(column, frame, 2)
    assert older.cancelled() and not newer.done()
    renderer.go.set()
    assert newer.result(PATIENCE)[2] == 2 and other.result(PATIENCE) == 1
    assert len(renderer.asked) == 2, "and no frame was traced for it"


def test_a_query_about_a_moment_that_has_passed_is_cancelled_and_can_be_asked_anew(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    held_at(thread, request(2.0), renderer)
    left = thread.query(column, frame, 1)
    renderer.go.set()
    newest = shown(thread, 2.0)
    assert left.cancelled()
    assert thread.query(column, newest, 1).result(PATIENCE)[1] is newest


def test_what_is_shown_can_be_asked_about_though_a_later_frame_has_failed(thread):
    """Else it would be looked into for ever."""
    renderer = FakeRenderer()
    thread.use(renderer)
    frame = shown(thread, 1.0)
    renderer.failing = OSError("the disk is full")
    thread.submit(request(2.0))
    until(lambda: thread.take_problems()[1])
    turns = len(renderer.turns)
    assert thread.query(column, frame, 1).result(PATIENCE)[1] is frame
    assert len(renderer.turns) == turns + 1, "the world was put back for it"


def test_an_error_is_in_the_future_and_told_in_one_line_but_is_no_failed_frame(thread):
    thread.use(FakeRenderer())
    frame = shown(thread, 1.0)
    assert isinstance(thread.query(failing, frame).exception(PATIENCE), ValueError)
    told: list[Failure] = []
    of_frame = False

    def tells() -> bool:
        nonlocal of_frame
        problems, of_frame = thread.take_problems()
        told.extend(problems)
        return bool(told)

    until(tells)
    assert [one.text for one in told] == ["no answer: no such light"]
    assert not of_frame
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
            assert asked.wait(PATIENCE)
        return render(time, camera, cancel)

    renderer.render = slowly
    frame = shown(thread, 1.0, samples=50)
    assert sampled.wait(PATIENCE)
    assert not thread.busy, "more samples are nothing to wait for"
    answer = thread.query(traced_so_far, frame)
    asked.set()
    assert answer.result(PATIENCE) == 4

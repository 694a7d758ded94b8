"""The newest request wins, what is worthless is cancelled, and nothing blocks or dies."""

from __future__ import annotations

import time
from dataclasses import replace
from threading import Event

import pytest

from tests.viewer.fakes import FakeRenderer
from tracer.frame import Settings
from tracer.scene.model import Camera
from viewer.services.render_request import RenderRequest, Traced
from viewer.services.render_thread import RenderThread

CAMERA = Camera((0, 0, 5), (0, 0, -1))


def request(at: float, **kinds) -> RenderRequest:
    return RenderRequest(at, CAMERA, Settings(width=8, height=8), **kinds)


@pytest.fixture
def thread():
    thread = RenderThread()
    yield thread
    assert thread.close(5.0)


def taken(thread: RenderThread, timeout: float = 5.0) -> Traced:
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        if (traced := thread.take()) is not None:
            return traced
        time.sleep(0.002)
    raise AssertionError("no frame came")


def idle(thread: RenderThread, timeout: float = 5.0) -> None:
    end = time.monotonic() + timeout
    while thread.busy and time.monotonic() < end:
        time.sleep(0.002)
    assert not thread.busy


def held_at(thread: RenderThread, first: RenderRequest) -> FakeRenderer:
    """A renderer that is at work on this, and goes on when it is let go."""
    renderer = FakeRenderer()
    renderer.go.clear()
    thread.use(renderer)
    thread.submit(first)
    assert renderer.started.wait(5.0)
    return renderer


def wait_until_cancelled(renderer: FakeRenderer) -> None:
    end = time.monotonic() + 5.0
    while not renderer.cancelled and time.monotonic() < end:
        time.sleep(0.002)


def test_a_request_becomes_a_frame_once(thread):
    thread.use(FakeRenderer())
    thread.submit(request(1.0))
    assert taken(thread).frame.time == 1.0
    assert thread.take() is None


def test_of_those_that_wait_only_the_newest_is_traced(thread):
    renderer = held_at(thread, request(0.0, quick=True))
    for at in (1.0, 2.0, 3.0):
        thread.submit(request(at, quick=True))
    renderer.go.set()
    idle(thread)
    assert [at for at, _ in renderer.asked] == [0.0, 3.0]


def test_a_fine_frame_is_cut_short_by_a_newer_request(thread):
    renderer = held_at(thread, request(0.0))
    thread.submit(request(1.0, quick=True))
    wait_until_cancelled(renderer)
    renderer.go.set()
    assert taken(thread).frame.time == 1.0
    assert renderer.cancelled == [0.0]


def test_a_coarse_frame_in_motion_is_let_finish(thread):
    renderer = held_at(thread, request(0.0, quick=True))
    thread.submit(request(1.0, quick=True))
    time.sleep(0.05)
    assert renderer.cancelled == []
    renderer.go.set()
    idle(thread)
    assert [at for at, _ in renderer.asked] == [0.0, 1.0]


def test_where_a_motion_ended_comes_before_what_is_under_way_and_once(thread):
    renderer = held_at(thread, request(0.0, quick=True))
    thread.submit(request(1.0, quick=True))
    thread.hurry(request(2.0, final=True))
    assert renderer.cancelled == [], "it is not what waits"
    thread.hurry(request(1.0, final=True))
    wait_until_cancelled(renderer)
    renderer.go.set()
    assert taken(thread).frame.time == 1.0
    thread.hurry(request(1.0, final=True))
    idle(thread)
    assert [at for at, _ in renderer.asked] == [0.0, 1.0]


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
    wait_until_cancelled(renderer)
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
    assert request(1.0, quick=True, final=True).supersedes(coarse), "what was before the end of a motion"
    assert not request(1.0, quick=True).supersedes(replace(coarse, final=True))
    assert not request(1.0, quick=True, final=True).supersedes(replace(coarse, final=True)), "one of them is shown"
    assert not replace(coarse, settings=Settings(width=4, height=4)).supersedes(coarse)
    assert replace(coarse, settings=replace(coarse.settings, method="none")).supersedes(coarse)


def test_errors_are_one_line_and_the_thread_lives_on(thread):
    renderer = FakeRenderer()
    renderer.failing = RuntimeError("first line\nsecond line")
    thread.use(renderer)
    thread.submit(request(0.0))
    idle(thread)
    failed = thread.take_failure()
    assert failed is not None and "first line second line" in failed.text and "\n" not in failed.text
    assert not failed.expected and "Traceback" in failed.details
    assert thread.take_failure() is None
    renderer.failing = None
    thread.submit(request(1.0))
    assert taken(thread).frame.time == 1.0


def test_a_frame_of_a_scene_that_was_left_is_not_delivered(thread):
    old, new = FakeRenderer(), FakeRenderer()
    old.go.clear()
    thread.use(old)
    thread.submit(request(0.0))
    assert old.started.wait(5.0)
    thread.use(new)
    old.go.set()
    idle(thread)
    assert thread.take() is None
    thread.submit(request(5.0))
    assert taken(thread).frame.time == 5.0


def test_modes_are_reset_on_the_threads_own_time(thread):
    renderer = FakeRenderer()
    thread.use(renderer)
    thread.reset_modes()
    assert renderer.resets == 0
    thread.submit(request(0.0))
    taken(thread)
    assert renderer.resets == 1


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
    renderer, task = FakeRenderer(), FakeTask()
    renderer.go.clear()
    thread.use(renderer)
    thread.submit(request(0.0))
    assert renderer.started.wait(5.0)
    thread.perform(task)
    assert task.started.wait(5.0)
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


def test_another_renderer_ends_a_task(thread):
    task = FakeTask()
    thread.use(FakeRenderer())
    thread.perform(task)
    assert task.started.wait(5.0)
    thread.use(FakeRenderer())
    idle(thread)
    assert task.cancelled


def test_a_task_that_waits_while_the_scene_changes_gets_its_own_renderer_and_ends(thread):
    old, new, first, task = FakeRenderer(), FakeRenderer(), FakeTask(), FakeTask()
    held = Event()
    first.work = lambda renderer, cancelled: (first.started.set(), held.wait(5.0))
    thread.use(old)
    thread.perform(first)
    assert first.started.wait(5.0)
    thread.perform(task)
    thread.use(new)
    held.set()
    assert task.started.wait(5.0)
    idle(thread)
    assert task.renderer is old and task.cancelled, "what was asked of the old scene is over"
    thread.submit(request(1.0))
    assert taken(thread).frame.time == 1.0 and [at for at, _ in new.asked] == [1.0]


def test_closing_ends_a_task():
    thread, task = RenderThread(), FakeTask()
    thread.use(FakeRenderer())
    thread.perform(task)
    assert task.started.wait(5.0)
    assert thread.close(5.0)
    assert task.cancelled


def test_nothing_is_traced_without_a_scene_and_nothing_waits_for_it(thread):
    thread.submit(request(0.0))
    assert not thread.busy
    thread.use(FakeRenderer())
    assert thread.take() is None


def test_closing_cuts_a_trace_short():
    thread, renderer = RenderThread(), FakeRenderer()
    renderer.go.clear()
    thread.use(renderer)
    thread.submit(request(0.0))
    assert renderer.started.wait(5.0)
    began = time.monotonic()
    assert thread.close(5.0)
    assert time.monotonic() - began < 1.0
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
    end = time.monotonic() + 5.0
    while not (traced := taken(thread)).whole:
        assert time.monotonic() < end
    idle(thread)
    assert [at for at, _ in renderer.asked] == [1.0, 2.0, 2.0]
    assert traced.request.time == 2.0

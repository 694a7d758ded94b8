"""How long a piece of work will still take."""

from __future__ import annotations

import sys

import pytest

from tracer.experiments.runner import TimeLeft


class Clock:
    now = 1000.0

    def __call__(self) -> float:
        return self.now


def after(durations: list[float], total: int) -> tuple[TimeLeft, Clock]:
    """The estimate once steps of these durations, of so many, are done."""
    clock = Clock()
    left = TimeLeft(clock)
    left.mark(0, total)
    for done, seconds in enumerate(durations, 1):
        clock.now += seconds
        left.mark(done, total)
    return left, clock


def test_nothing_is_said_before_the_first_step_is_done() -> None:
    assert after([], 5)[0].seconds() is None


def test_even_steps() -> None:
    assert after([2.0] * 3, 10)[0].seconds() == pytest.approx(14.0)
    assert after([2.0] * 10, 10)[0].seconds() == 0.0


def test_late_steps_tell_of_the_last_ones_and_all_of_them_of_many() -> None:
    """Where the second half of a path is ten times as dear, the first half is forgotten once it is under way."""
    path = [1.0] * 50 + [10.0] * 50
    for done in (75, 90, 99):
        assert after(path[:done], 100)[0].seconds() == pytest.approx(10.0 * (100 - done))
    assert after([5.0, *[1.0] * 9], 20)[0].seconds() == pytest.approx(14.0)


def test_methods_that_take_turns_are_averaged() -> None:
    left, _ = after([1.0, 3.0] * 9, 20)
    assert left.seconds() == pytest.approx(4.0)


def test_it_counts_down_within_a_step_but_not_past_it() -> None:
    left, clock = after([2.0] * 3, 10)
    clock.now += 1.5
    assert left.seconds() == pytest.approx(12.5)
    clock.now += 60.0
    assert left.seconds() == pytest.approx(12.0)


def test_a_machine_that_slept_does_not_make_the_rest_long() -> None:
    """An hour in one step of two seconds: without it 20 s are left, and not much more with it."""
    left, _ = after([2.0] * 9 + [3602.0], 20)
    assert left.seconds() == pytest.approx(2.0 * 9 + 40.0)


def test_it_may_be_asked_at_any_moment_of_a_mark() -> None:
    """The window asks while a thread marks: here after each call that a mark makes."""
    left = TimeLeft()
    asked: list[float | None] = []

    def ask(_frame: object, event: str, _what: object) -> None:
        if event == "c_return":
            sys.setprofile(None)
            asked.append(left.seconds())
            sys.setprofile(ask)

    for done in range(3):
        sys.setprofile(ask)
        try:
            left.mark(done, 10)
        finally:
            sys.setprofile(None)
    assert len(asked) > 3

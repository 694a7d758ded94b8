"""Estimates of work in several processes: nothing before anything is known, then what the machine has shown."""

from __future__ import annotations

from itertools import pairwise

import pytest

from tracer.compiling.estimate import Estimate

PARTS = {"a": ("a1", "a2"), "b": ("b1",), "c": ("c1",)}
SHARES = {"a1": 0.1, "a2": 0.3, "b1": 0.2, "c1": 0.4}


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_an_estimate_follows_what_the_machine_shows() -> None:
    clock = Clock()
    estimate = Estimate(PARTS, SHARES, 2, clock=clock)
    assert estimate.seconds_left() is None and estimate.fraction == 0.0
    estimate.begin("a1")
    estimate.begin("b1")
    clock.now += 4.0
    assert estimate.seconds_left() is None, "nothing is done yet that could tell how fast this machine is"
    estimate.end("a1")
    estimate.begin("a2")
    assert estimate.pace == pytest.approx(40.0)
    assert estimate.fraction == pytest.approx(0.1 + 4.0 / 40.0)
    # b has 4 s to go and then c, 16 s; a has 12 s.
    assert estimate.seconds_left() == pytest.approx(20.0)
    assert estimate.seconds_left(("a", "b")) == pytest.approx(12.0)
    clock.now += 4.0
    estimate.end("b1")
    estimate.begin("c1")
    assert estimate.pace == pytest.approx(40.0)
    assert estimate.seconds_left() == pytest.approx(16.0)
    clock.now += 16.0
    estimate.end("a2")  # took 20 s, where 12 were expected: the machine is slower than it seemed
    assert estimate.pace == pytest.approx((4.0 + 8.0 + 20.0) / 0.6)
    left = estimate.seconds_left()
    assert left == pytest.approx(0.4 * estimate.pace - 16.0)
    clock.now += 100.0
    assert 0.0 < estimate.seconds_left() < left, "a step that takes longer than was thought is never over by itself"
    assert estimate.fraction == pytest.approx(0.6 + 0.95 * 0.4)
    estimate.end("c1")
    assert estimate.seconds_left() == 0.0 and estimate.fraction == pytest.approx(1.0)


def test_the_bar_moves_before_anything_is_done_and_never_ends_before_the_work() -> None:
    clock = Clock()
    estimate = Estimate(PARTS, SHARES, 2, 40.0, clock)
    estimate.begin("b1")
    estimate.begin("c1")
    seen = [estimate.fraction]
    for _ in range(60):
        clock.now += 1.0
        seen.append(estimate.fraction)
    assert estimate.seconds_left() is None, "but how long it takes is not known yet"
    assert seen[4] == pytest.approx(8.0 / 40.0), "two steps, as quick as they usually are"
    assert all(0.0 < later - earlier <= 2.0 / 40.0 + 1e-9 for earlier, later in pairwise(seen[:20]))
    assert seen == sorted(seen) and seen[-1] < 0.6
    estimate.end("b1")
    assert seen[-1] <= estimate.fraction < 0.6, "this machine is slower: the bar waits, and does not go back"


def test_a_step_that_never_began_cannot_end() -> None:
    with pytest.raises(KeyError):
        Estimate(PARTS, SHARES, 2).end("a1")

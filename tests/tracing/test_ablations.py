"""Smaller packets and other caches cost time, or save less, and change nothing else."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given

import tracer
from tests.sweeps import crossed
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.same import assert_only_asked_less

SETTINGS = tracer.Settings(48, 40, 2, "none", threads=2, verify=True, record_lights=True)


@pytest.mark.parametrize("method", ["none", "paper+cache"])
def test_smaller_packets_give_the_same_answers_by_more_steps(method: str) -> None:
    """Of random scenes; rays that go together share their steps, so that fewer together take more."""
    steps = dict.fromkeys((128, 16, 1), 0)

    @quickly(2)
    @given(walks())
    def check(walk: Walk) -> None:
        whole = tracer.Renderer(walk.scene, replace(SETTINGS, method=method))
        cut = {n: tracer.Renderer(walk.scene, replace(SETTINGS, method=f"{method}+packets{n}")) for n in (16, 1)}
        for time, camera in walk.frames:
            frame = whole.render(time, camera)
            steps[128] += frame.statistics.shadow.traversal_steps
            for n, renderer in cut.items():
                other = renderer.render(time, camera)
                assert frame.color.tobytes() == other.color.tobytes()
                assert frame.lit is not None and other.lit is not None
                assert frame.lit.tobytes() == other.lit.tobytes()
                assert frame.statistics.shadow.culled == other.statistics.shadow.culled
                steps[n] += other.statistics.shadow.traversal_steps

    check()
    assert 0 < steps[128] < steps[16] <= steps[1]


@pytest.mark.parametrize(("cache", "accelerator"), crossed(["cache-directions", "cache-tile"], ["bvh8", "kdtree"]))
def test_other_caches_change_nothing_but_what_is_asked(cache: str, accelerator: str) -> None:
    """Their counters, too, are those of any number of threads."""
    hits = 0

    @quickly(3)
    @given(walks())
    def check(walk: Walk) -> None:
        nonlocal hits
        settings = replace(SETTINGS, accelerator=accelerator)
        without = tracer.Renderer(walk.scene, settings)
        cached, alone = (
            tracer.Renderer(walk.scene, replace(settings, method=f"none+{cache}", threads=threads))
            for threads in (2, 1)
        )
        for time, camera in walk.frames:
            frame = cached.render(time, camera)
            assert_only_asked_less(frame, without.render(time, camera))
            assert alone.render(time, camera).statistics.shadow == frame.statistics.shadow
            hits += frame.statistics.shadow.cache_hits

    check()
    assert hits > 300

"""Two methods on one world, in turn: each frame is what a renderer alone makes of it, counters and all."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from tests.tracing.same import assert_same
from tests.viewer.fakes import FLYER_SCENE, FakeRenderer
from tracer.frame import Settings
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Camera
from viewer.services.pair import Pair
from viewer.services.render_request import RenderRequest
from viewer.services.render_thread import RenderThread

CAMERA = Camera((0.0, 1.0, 4.0), (0.0, -0.25, -1.0))


def never() -> bool:
    return False


@pytest.mark.parametrize("keeps_modes", [True, False])
def test_neither_knows_what_the_other_has_found_out(tmp_path, keeps_modes):
    """While an object moves, and when it rests, which counts as static for one of the methods alone."""
    (tmp_path / "scene.aff").write_text(FLYER_SCENE)
    scene = load_scene(tmp_path / "scene.aff")
    settings = Settings(width=48, height=32, threads=1, modes=keeps_modes, record_work=True)
    methods = "paper", "certified"
    alone = [Renderer(scene, replace(settings, method=method)) for method in methods]
    first = Renderer(scene, replace(settings, method=methods[0]))
    pair = Pair(first)
    for moment in (1.0, 2.0, 2.0, 2.0, 4.0):
        asked = RenderRequest(moment, CAMERA, settings, samples=2, second=methods[1], parts=(1, 8, 16))
        steps = list(pair.refine(asked, never))
        expected = [[frame for frame, _ in asked.refine(renderer, never)] for renderer in alone]
        assert len(steps) == len(expected[0]) == 4
        for both, *each in zip(steps, *expected, strict=True):
            assert [frame.settings.method for frame in both] == list(methods)
            for one, other in zip(both, each, strict=True):
                assert_same(other, one, f"at {moment} s by {one.settings.method}")
    saved = [step.statistics.shadow.dynamic_only for step in steps[-1]]
    assert saved[0] != saved[1], "both cull the same, so this shows nothing"
    assert pair.is_of(first) and not pair.is_of(alone[0])


def test_the_world_is_left_to_the_first_whatever_becomes_of_the_picture():
    first = FakeRenderer()
    pair = Pair(first)
    asked = RenderRequest(3.0, CAMERA, Settings(), second="none", parts=(1, 16))
    pictures = pair.refine(asked, never)
    one, other = next(pictures)
    assert (one.settings.method, other.settings.method, one.time, other.time) == ("paper", "none", 3.0, 3.0)
    pictures.close()
    assert first.turns == ["paper"], "a picture that nobody wants any more"
    list(pair.refine(asked, never))
    assert first.turns == ["paper", "paper", "none", "paper"], "and between its parts, when questions are answered"
    first.other.failing = ValueError("no")
    with pytest.raises(ValueError, match="no"):
        list(pair.refine(asked, never))
    assert first.turns[-1] == "paper"


def request(at: float, **kinds) -> RenderRequest:
    return RenderRequest(at, CAMERA, Settings(width=8, height=8), **kinds)


def come(thread: RenderThread, wanted) -> None:
    end = time.monotonic() + 5.0
    while time.monotonic() < end:
        traced = thread.take()
        if traced is not None and wanted(traced):
            return
        time.sleep(0.002)
    raise AssertionError("no such frame came")


def test_the_thread_traces_both_for_each_request_and_stops_when_it_may():
    thread = RenderThread()
    renderer = FakeRenderer()
    thread.use(renderer)
    for at in (1.0, 2.0):
        thread.submit(request(at, second="certified", parts=(4, 16)))
        come(thread, lambda traced: traced.whole and traced.second is not None)
    assert [moment for moment, _ in renderer.other.asked] == [1.0, 1.0, 2.0, 2.0]
    assert {settings.method for _, settings in renderer.other.asked} == {"certified"}
    other = renderer.other
    thread.submit(request(2.0, second=""))
    come(thread, lambda traced: traced.second is None)
    assert len(other.asked) == 4, "one method again"
    thread.submit(request(3.0, second="none"))
    come(thread, lambda traced: traced.second is not None)
    assert renderer.other is not other, "what it had learnt is gone"
    assert thread.close(5.0)


def test_cancelled_in_the_second_it_ends_soon_and_the_newest_request_comes():
    thread = RenderThread()
    renderer = FakeRenderer()
    thread.use(renderer)
    thread.submit(request(1.0, second="none"))
    come(thread, lambda traced: traced.second is not None)
    renderer.go.clear()
    renderer.started.clear()
    thread.submit(request(2.0, second="none"))
    assert renderer.started.wait(5.0)
    thread.submit(request(3.0, second="none"))
    renderer.go.set()
    come(thread, lambda traced: traced.request.time == 3.0 and traced.second.time == 3.0)
    renderer.go.clear()
    thread.submit(request(4.0, second="none"))
    assert thread.close(5.0), "the thread hangs"

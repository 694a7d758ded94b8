"""What a method is: one file, one line in the registry, and nothing else that knows of it."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.sweeps import ACCELERATORS
from tests.tracing.nasty_worlds import nasty_walk
from tests.tracing.shades import roof, shadow_scene
from tests.tracing.worlds import scene
from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, vectors
from tracer.method import Kind, Method, bases, register, unregister
from tracer.methods.interface import ShadowMethod, Stage
from tracer.runtime.kernels import native_callback
from tracer.scene.model import Camera, Material

BELOW = Camera((0.3, 0.2, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 40.0)
SETTINGS = tracer.Settings(width=64, height=48, depth=1, method="none", threads=2, record_lights=True)


# A method of ten lines: it takes every point for lit.


@native_callback
def choose(data, call, light, count, counts):
    batch = shadow_batch_in(call_at(call).shadows)
    for v in range(vectors(count)):
        batch.lit[v], batch.live[v] = batch.live[v], 0


class Daylight(ShadowMethod):
    def stages(self, frame, worker, learns):
        return [Stage(choose=choose)]


@pytest.fixture
def daylight() -> Iterator[str]:
    register(Kind("daylight", "Takes every point for lit.", Daylight, exact=False))
    yield "daylight"
    unregister("daylight")


def test_a_method_of_ten_lines_culls_is_verified_and_composes(daylight: str) -> None:
    scene = shadow_scene()
    none = tracer.Renderer(scene, SETTINGS).render()
    for name in (daylight, f"{daylight}+cache"):
        frame = tracer.Renderer(scene, replace(SETTINGS, method=name, verify=True)).render()
        assert np.array_equal(frame.lit, none.due) and not np.array_equal(none.lit, none.due)
        assert frame.reference is not None and frame.reference.tobytes() == none.color.tobytes()
        assert frame.wrong is not None and frame.wrong.sum() == (none.due & ~none.lit).sum() > 0
        assert frame.statistics.shadow.rays == 0 == frame.statistics.shadow.traversal_steps
    modes = tracer.Renderer(scene, replace(SETTINGS, method=daylight, modes=True)).render()
    assert (modes.shadow_mode[none.due] == 2).all(), "modes learn from whoever answers"


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_what_is_free_is_what_none_shows_without_a_ray(accelerator: str) -> None:
    for seed in range(4):
        walk = nasty_walk(seed, frames=5)
        settings = replace(SETTINGS, width=130, height=70, accelerator=accelerator, threads=1 + seed % 2, modes=True)
        none = tracer.Renderer(walk.scene, settings)
        free = tracer.Renderer(walk.scene, replace(settings, method="free", verify=True))
        for time, camera in walk.frames:
            expected, frame = none.render(time, camera), free.render(time, camera)
            assert frame.color.tobytes() == expected.color.tobytes()
            assert np.array_equal(frame.due, expected.due) and np.array_equal(frame.lit, expected.lit)
            assert np.array_equal(frame.modes, expected.modes)
            shadow = frame.statistics.shadow
            assert (shadow.due, shadow.rays, shadow.wrong) == (expected.statistics.shadow.due, 0, 0)
            assert shadow.culled == shadow.due
            assert frame.statistics.secondary == expected.statistics.secondary
            assert frame.statistics.seconds > 0.0


def test_where_there_is_too_little_room_answers_are_recorded_again(monkeypatch: pytest.MonkeyPatch) -> None:
    from tracer.methods import free

    walk = nasty_walk(1, frames=2)
    expected = [tracer.Renderer(walk.scene, SETTINGS).render(*at) for at in walk.frames]
    monkeypatch.setattr(free, "ROOM", 1)
    renderer = tracer.Renderer(walk.scene, replace(SETTINGS, method="free"))
    for (time, camera), right in zip(walk.frames, expected, strict=True):
        assert renderer.render(time, camera).color.tobytes() == right.color.tobytes()
    assert renderer.memory_bytes > 0


def test_refining_and_sampling_by_free_are_those_of_none() -> None:
    walk = nasty_walk(3, frames=1)
    pictures = []
    for name in ("none", "free"):
        renderer = tracer.Renderer(walk.scene, replace(SETTINGS, method=name))
        frames = list(renderer.refine(*walk.frames[0], parts=(2, 16), samples=2))
        pictures.append([frame.color.tobytes() for frame in frames])
    assert pictures[0] == pictures[1]


def test_methods_that_are_not_used_are_dropped_once_the_scene_moves_on() -> None:
    walk = nasty_walk(2, frames=4)
    renderer = tracer.Renderer(walk.scene, replace(SETTINGS, method="certified"))
    (first, camera), (second, _), (third, _) = walk.frames[:3]
    renderer.render(first, camera)
    certified = renderer.state.method("certified")
    store = certified.store
    assert renderer.memory_bytes > 0 and store is not None

    renderer.settings = replace(SETTINGS, method="paper")
    methods = renderer.work_on(renderer.render(first, camera)).methods
    assert certified not in methods, "what the last frame did not follow says nothing"
    renderer.settings = replace(SETTINGS, method="auto")
    renderer.render(first, camera)
    assert renderer.state.method("certified").store is store, "all of it holds still"

    renderer.settings = replace(SETTINGS, method="paper")
    renderer.render(second, camera)
    assert renderer.memory_bytes == 0
    renderer.settings = replace(SETTINGS, method="certified")
    renderer.render(third, camera)
    assert renderer.state.method("certified").store is not store


def test_the_accelerator_is_that_of_the_settings_and_frames_tell_the_truth() -> None:
    scene = shadow_scene()
    renderer = tracer.Renderer(scene, SETTINGS)
    fast = renderer.render()
    renderer.settings = replace(SETTINGS, accelerator="kdtree")
    counted = renderer.render()
    assert (fast.settings.accelerator, counted.settings.accelerator) == ("bvh8", "kdtree")
    expected = tracer.Renderer(scene, replace(SETTINGS, accelerator="kdtree")).render().statistics
    assert counted.statistics.shadow == expected.shadow != fast.statistics.shadow
    shared = tracer.Renderer(scene, SETTINGS, world=tracer.World(scene, accelerator="kdtree"))
    frame = shared.render()
    assert frame.settings.accelerator == "kdtree" and frame.statistics.shadow == expected.shadow


def test_every_base_is_made_from_its_name_alone() -> None:
    scene = shadow_scene()
    for kind in bases(measures=True):
        frame = tracer.Renderer(scene, replace(SETTINGS, method=kind.name)).render()
        assert frame.settings.method == kind.name and Method.parse(kind.name).kind is kind


def test_waves_that_outgrow_their_memory_are_shaded_with_memory_of_their_own() -> None:
    """Glass that sends on two rays for each that comes: waves of eight times as many as a tile has pixels."""
    glass = Material(diffuse=(0.2, 0.2, 0.2), specular=(0.6, 0.6, 0.6), transmission=0.6, ior=1.0)
    panes = [t for z in range(1, 6) for t in roof(float(z), 40.0)]
    hall = scene(panes, lights=[(3.0, 2.0, 9.0), (-2.0, 1.0, 0.5)], camera=BELOW, materials=(glass,))
    settings = tracer.Settings(64, 64, 4, "none", modes=True, threads=1)
    none, certified = (tracer.Renderer(hall, replace(settings, method=name)) for name in ("none", "certified"))
    for _ in range(2):
        expected, frame = none.render(), certified.render()
        assert expected.statistics.secondary.rays > 8 * 64 * 64
        assert frame.color.tobytes() == expected.color.tobytes() and np.array_equal(frame.modes, expected.modes)


def test_a_picture_that_another_has_overtaken_teaches_nothing_and_cannot_go_on() -> None:
    walk = nasty_walk(3, frames=2)
    settings = replace(SETTINGS, method="paper+cache")
    disturbed, straight = tracer.Renderer(walk.scene, settings), tracer.Renderer(walk.scene, settings)
    left = disturbed.refine(*walk.frames[0], parts=(8, 16))
    next(left)
    for time, camera in walk.frames:
        expected, frame = straight.render(time, camera), disturbed.render(time, camera)
        assert np.array_equal(frame.modes, expected.modes) and frame.statistics.shadow == expected.statistics.shadow
    with pytest.raises(RuntimeError, match="another frame"):
        next(left)
    left.close()
    expected, frame = straight.render(*walk.frames[0]), disturbed.render(*walk.frames[0])
    assert np.array_equal(frame.modes, expected.modes)


def test_the_time_in_which_a_picture_is_looked_at_is_not_the_frames() -> None:
    now = [0.0]
    renderer = tracer.Renderer(shadow_scene(), SETTINGS, clock=lambda: now[0])
    for number, frame in enumerate(renderer.refine(parts=(4, 8, 16))):
        assert frame.statistics.seconds == 0.0, number
        now[0] += 10.0


def test_what_a_picture_so_far_records_stays_as_it_is() -> None:
    frames = tracer.Renderer(shadow_scene(), replace(SETTINGS, method="paper")).refine(parts=(1, 16))
    early = next(frames)
    before = early.lit.copy()
    whole = next(frames)
    assert np.array_equal(early.lit, before) and not np.array_equal(early.lit, whole.lit)


def test_a_renderer_that_is_dropped_leaves_nothing_in_a_circle() -> None:
    gc.collect()
    gc.disable()
    try:
        renderer = tracer.Renderer(shadow_scene(), replace(SETTINGS, method="auto"))
        renderer.render()
        world = weakref.ref(renderer.world)
        del renderer
        assert world() is None
    finally:
        gc.enable()

"""Pictures by cuts of lights."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tracer
from tests.golden.pictures import FOLDER, Difference
from tests.scenes import loaded
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.halls import MATERIALS, hall, lights_of
from tests.tracing.nasty_worlds import nasty_walk, with_lamps
from tests.tracing.same import assert_same
from tests.tracing.shades import floor
from tests.tracing.worlds import quad, scene
from tests.viewer.drawn import picture
from tracer.experiments.experiment import figures_of
from tracer.methods.lightcuts import errors_of
from tracer.scene.animation import Animation
from tracer.scene.lights import Light
from tracer.scene.model import Camera
from tracer.shading.lightcuts.block import DARK
from viewer.state.views import View
from viewer.util.resources import embedded_scenes

METHODS = ("lightcuts", "lightcuts-stochastic", "lightcuts-certified")
SETTINGS = tracer.Settings(width=48, height=36, depth=2, method="lightcuts", threads=2)
ALL = {"lightcuts_error": 1e-30, "lightcuts_nodes": 65536}  # every cut is all lights


@cache
def still_hall() -> tracer.Scene:
    return hall()


@cache
def truth(accelerator: str = "bvh8", depth: int = 0) -> tracer.Frame:
    """The hall by all of its lights."""
    return frame_of(still_hall(), method="none", accelerator=accelerator, depth=depth)


def frame_of(made: tracer.Scene, time: float = 0.7, **settings) -> tracer.Frame:
    return tracer.Renderer(made, replace(SETTINGS, **settings)).render(time)


# --- pictures -------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_no_pixel_is_wrong_by_more_than_the_bounds_of_its_cut(method: str) -> None:
    frame, none = frame_of(still_hall(), method=method, depth=0, lightcuts_error=0.05), truth()
    bound = frame.layers["cut bound"] * np.maximum(frame.color.astype(np.float64).sum(2), DARK)
    wrong = np.abs(frame.color.astype(np.float64).sum(2) - none.color.astype(np.float64).sum(2))
    hit = frame.primitive >= 0
    # What is drawn for a pixel may by chance be more than the cluster can send.
    within = wrong[hit] <= bound[hit] * 1.001 + 1e-5
    assert within.all() if method != "lightcuts-stochastic" else within.mean() > 0.99
    cuts = frame.statistics.cuts
    assert cuts is not None and cuts.lights == 390 and cuts.limited == 0
    assert frame.layers["cut nodes"][hit].max() == cuts.most < 390 and cuts.nodes > cuts.blocks
    assert 0 < frame.statistics.shadow.rays < none.statistics.shadow.rays
    assert np.median(errors_of(frame.color[hit], none.color[hit])) < 0.02


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_cuts_of_all_lights_are_the_picture_of_none_bit_for_bit(accelerator: str) -> None:
    none = truth(accelerator, 2)
    for method in ("lightcuts", "lightcuts-certified"):
        frame = frame_of(still_hall(), method=method, accelerator=accelerator, **ALL)
        assert frame.color.tobytes() == none.color.tobytes(), method
        assert frame.statistics.cuts is not None and frame.statistics.cuts.nodes > 0
    for method in METHODS:
        frame = frame_of(still_hall(), method=method, accelerator=accelerator, lightcuts_error=0.0)
        assert frame.color.tobytes() == none.color.tobytes(), method
        assert frame.statistics.cuts is None and "every shadow ray is traced" in frame.statistics.decision


@pytest.mark.parametrize("seed", range(cases(3, 24)))
def test_nasty_worlds_are_those_of_none_where_cuts_are_all_lights(seed: int) -> None:
    walk = with_lamps(nasty_walk(seed, lights=12, frames=3))
    renderers = [
        tracer.Renderer(walk.scene, replace(SETTINGS, width=32, height=24, method=method, **ALL))
        for method in ("none", "lightcuts", "lightcuts-certified")
    ]
    for time, camera in walk.frames:
        none, *others = (renderer.render(time, camera) for renderer in renderers)
        for frame in others:
            assert frame.color.tobytes() == none.color.tobytes(), f"{frame.settings.method} {walk} {time}"


@pytest.mark.parametrize("method", METHODS)
def test_frames_repeat_for_any_number_of_threads_and_whatever_came_before(method: str) -> None:
    made = hall(lights=lights_of(2, 60, track="swings"))
    tiles = replace(SETTINGS, width=66, height=66, method=method, samples=2)
    one, three = (tracer.Renderer(made, replace(tiles, threads=threads)) for threads in (1, 3))
    certified = method == "lightcuts-certified"
    first = one.render(0.4)
    assert_same(first, three.render(0.4), method)
    three.render(1.1)  # lights move
    again, fresh = three.render(0.4), one.render(0.4) if certified else first
    assert again.color.tobytes() == fresh.color.tobytes()
    moved = three.render(1.6)
    none = frame_of(made, 1.6, method="none", width=66, height=66)
    whole = replace(three.settings, samples=1)
    three.settings = whole
    moved = three.render(1.6)
    hit = moved.primitive >= 0
    assert np.median(errors_of(moved.color[hit], none.color[hit])) < 0.02, "of where the lights are now"


@pytest.mark.parametrize("method", METHODS)
def test_errors_that_are_allowed_are_not_exceeded_by_much_and_limits_are_told(method: str) -> None:
    errors, sizes = [], []
    for allowed in (0.2, 0.02):
        frame = frame_of(still_hall(), method=method, lightcuts_error=allowed, depth=0, verify=True)
        cuts = frame.statistics.cuts
        assert cuts is not None and cuts.errors is not None and frame.reference is not None and frame.wrong is not None
        assert frame.reference.tobytes() == truth().color.tobytes()
        hit = frame.primitive >= 0
        wrong = errors_of(frame.color[hit], truth().color[hit])
        assert (cuts.errors.median, cuts.errors.most) == pytest.approx((np.median(wrong), wrong.max()))
        assert frame.statistics.wrong.pixels == cuts.errors.beyond == frame.wrong.sum() == (wrong > allowed).sum()
        assert figures_of(frame.statistics)["wrong"] == cuts.errors.beyond and frame.statistics.shadow.wrong == 0
        assert cuts.errors.median < allowed
        errors.append(cuts.errors.median)
        sizes.append(cuts.mean)
    assert errors == sorted(errors, reverse=True) and sizes == sorted(sizes)
    few = frame_of(still_hall(), method=method, lightcuts_error=0.002, lightcuts_nodes=7, depth=0)
    assert few.statistics.cuts is not None and few.statistics.cuts.most == 7
    assert few.statistics.cuts.limited > 0 and "as large as they may be" in few.statistics.decision
    one = frame_of(still_hall(), method=method, lightcuts_nodes=1, depth=0)
    assert one.layers["cut nodes"].max() == 1


@pytest.mark.parametrize("method", METHODS)
def test_a_picture_that_is_refined_tells_what_is_known_and_ends_within_the_error(method: str) -> None:
    renderer = tracer.Renderer(still_hall(), replace(SETTINGS, method=method, depth=0))
    *parts, whole = renderer.refine(0.7)
    hit, none = whole.primitive >= 0, truth()
    unknown = [(frame.layers["cut nodes"][hit] < 0).mean() for frame in (*parts, whole)]
    assert unknown[0] > 0.7 and unknown == sorted(unknown, reverse=True) and unknown[-1] == 0.0
    assert np.median(errors_of(whole.color[hit], none.color[hit])) < 0.02


def test_what_is_drawn_averages_out() -> None:
    """Sixteen frames at moments that look alike differ in what is drawn; their mean is nearer to the truth."""
    made = replace(still_hall(), animation=Animation.empty(), objects=still_hall().objects[:1])
    none = frame_of(made, method="none", depth=0)
    renderer = tracer.Renderer(made, replace(SETTINGS, method="lightcuts-stochastic", depth=0, lightcuts_error=0.2))
    pictures = [renderer.render(time).color.astype(np.float64) for time in np.linspace(0, 1, 16)]
    assert not np.array_equal(pictures[0], pictures[1])
    assert np.array_equal(pictures[0], renderer.render(0.0).color)
    hit = none.primitive >= 0
    one, mean = (errors_of(p[hit], none.color[hit]).mean() for p in (pictures[0], np.mean(pictures, axis=0)))
    assert mean < 0.5 * one
    bias = np.mean(pictures, axis=0)[hit].mean() / none.color[hit].mean()
    assert bias == pytest.approx(1.0, abs=0.01)


def test_clusters_that_are_proven_to_be_hidden_cost_nothing() -> None:
    """A closed lid over the floor, and half of the lights above it."""
    lid = quad((-9, -9, 2.0), (9, -9, 2.0), (9, 9, 2.0), (-9, 9, 2.0))
    made = hall(objects=scene(floor() + lid, materials=MATERIALS).objects, ambient=(0.0, 0.0, 0.0))
    made = replace(made, camera=Camera((0.0, -4.0, 1.6), (0.0, 9.0, -3.5), (0.0, 0.0, 1.0), 60.0))
    none, plain, certified = (
        frame_of(made, method=name, depth=0) for name in ("none", "lightcuts", "lightcuts-certified")
    )
    a, b = plain.statistics, certified.statistics
    assert a.cuts is not None and b.cuts is not None and b.certificates > 0
    assert b.cuts.nodes < 0.7 * a.cuts.nodes and b.shadow.rays < a.shadow.rays
    hit = none.primitive >= 0
    assert np.median(errors_of(certified.color[hit], none.color[hit])) < 0.02
    assert certified.layers["cut bound"][hit].mean() < plain.layers["cut bound"][hit].mean()


@pytest.mark.parametrize("method", METHODS)
def test_what_is_recorded_of_lights_and_modes_is_what_is_true(method: str) -> None:
    made = hall(count=20)
    recorded = {"record_lights": True, "record_work": True, "modes": True, "depth": 1}
    frame, none = (frame_of(made, method=name, **recorded) for name in (method, "none"))
    assert np.array_equal(frame.asked, none.asked) and np.array_equal(frame.reached, none.reached)
    assert np.array_equal(frame.modes, none.modes)
    assert frame.statistics.by_modes == none.statistics.by_modes
    assert np.array_equal(frame.due_rays, none.due_rays)
    assert (frame.cost + frame.saved == none.cost + none.saved).all()
    unrecorded = frame_of(made, method=method, modes=True, depth=1)
    assert unrecorded.color.tobytes() == frame.color.tobytes()
    assert unrecorded.statistics.shadow == frame.statistics.shadow


@pytest.mark.parametrize("method", METHODS)
def test_few_lights_are_traced_and_said_to_be_few(method: str) -> None:
    for count in (0, 1, 2):
        made = hall(lights=tuple(Light(f"light {i}", (i - 0.5, 0.0, 4.0)) for i in range(count)))
        frame, none = (frame_of(made, method=name) for name in (method, "none"))
        assert frame.color.tobytes() == none.color.tobytes()
        assert "too few" in frame.statistics.decision and frame.statistics.cuts is None
    few = frame_of(hall(lights=tuple(Light(f"light {i}", (i - 1.5, 0.0, 4.0)) for i in range(4))), method=method)
    assert "too few lights to gain" in few.statistics.decision


def test_settings_of_cuts_are_checked() -> None:
    for wrong in ({"lightcuts_error": -0.1}, {"lightcuts_error": float("nan")}, {"lightcuts_nodes": 0}):
        with pytest.raises(ValueError, match="lightcuts_"):
            replace(SETTINGS, **wrong).validated()


def test_memory_is_told_and_forgotten() -> None:
    renderer = tracer.Renderer(still_hall(), replace(SETTINGS, lightcuts_nodes=100, threads=1))
    renderer.render()
    assert 100 * 1024 < renderer.memory_bytes < 400_000
    before = renderer.render(0.7).color
    renderer.reset_modes()
    assert renderer.render(0.7).color.tobytes() == before.tobytes()


def test_the_office_by_cuts_looks_as_it_did() -> None:
    """Cuts may come out otherwise on another processor: a few levels, where none of the lights would move by one."""
    made = loaded(embedded_scenes()["office"])
    frame = tracer.Renderer(made, tracer.Settings(160, 120, 2, "lightcuts")).render(0.0)
    shown, path = picture(frame, View.COLOR), Path(FOLDER) / "lightcuts" / "office.png"
    found = Difference.between(np.asarray(Image.open(path).convert("RGB")), shown)
    assert found.most <= 8 and found.mean <= 0.5, str(found)

"""The paper's table: what it is made of, and that it adds up."""

from __future__ import annotations

import threading

import numpy as np
import pytest

import tracer
from tests.tracing.worlds import quad, scene
from tracer.experiments import experiment

SETTINGS = tracer.Settings(width=32, height=32, depth=1, threads=1, verify=True)
FLOOR = [t for x in range(-2, 2) for t in quad((x, -2, 0), (x + 1, -2, 0), (x + 1, 2, 0), (x, 2, 0))]


def small_scene(**extra) -> tracer.Scene:
    return scene(FLOOR, lights=[(0, 0, 20)], time_range=(0.0, 3.0), frames=4, **extra)


def test_the_same_frames_by_each_method_and_none_culls_nothing():
    *_, results = experiment.run(small_scene(), SETTINGS, ["paper"], experiment.path_times(small_scene()))
    assert results.frames == [0, 1, 2, 3]
    assert list(results.methods) == ["none", "paper"]
    none, paper = results.methods["none"], results.methods["paper"]
    assert none["shadow_rays_due"] == paper["shadow_rays_due"]
    assert not any(none["shadow_rays_culled"] + none["occlusion_tests"])
    assert paper["shadow_rays_dynamic_only"][0] == 0 < min(paper["shadow_rays_dynamic_only"][1:])
    assert all(len(values) == 4 for method in results.methods.values() for values in method.values())


def test_reductions_are_net_of_certificates_and_the_table_averages_them():
    results = experiment.Results("s", (10, 10), frames=[7, 9])
    results.methods = {
        "none": _figures(steps=[100, 200], tests=[10, 0], occlusion=[0, 0]),
        "paper": _figures(steps=[40, 150], tests=[5, 0], occlusion=[20, 30], certificate_steps=[10, 0], wrong=[1, 0]),
    }
    assert results.reductions("paper", "steps") == pytest.approx([0.5, 0.25])
    row = experiment.table(results)[1]
    assert (row.average_steps, row.most_steps, row.most_steps_frame) == pytest.approx((0.375, 0.5, 7))
    assert (row.average_tests, row.most_tests) == pytest.approx((0.25, 0.5))
    assert row.extra_tests_per_pixel == pytest.approx(0.25)
    assert (row.wrong, row.wrong_part) == (1, pytest.approx(1 / 100))


def _figures(steps, tests, occlusion, certificate_steps=(0, 0), wrong=(0, 0)) -> dict[str, list[float]]:
    return {
        "shadow_rays_due": [50, 50],
        "shadow_rays_culled": [0, 0],
        "shadow_rays_dynamic_only": [0, 0],
        "shadow_traversal_steps": list(steps),
        "shadow_intersection_tests": list(tests),
        "occlusion_tests": list(occlusion),
        "certificate_steps": list(certificate_steps),
        "certificate_tests": [0, 0],
        "wrong": list(wrong),
        "frame_seconds": [0.1, 0.3],
    }


def test_a_cancelled_run_keeps_its_whole_frames():
    stop = threading.Event()
    for results in experiment.run(small_scene(), SETTINGS, ["paper"], [0.0] * 50, cancel=stop.is_set):
        if len(results.frames) == 2:
            stop.set()
    assert results.frames == [0, 1]
    assert all(len(v) == 2 for method in results.methods.values() for v in method.values())
    assert len(experiment.table(results)) == 2


def test_paths_are_resampled_with_both_ends():
    assert experiment.path_times(small_scene()) == pytest.approx([0, 1, 2, 3])
    assert experiment.path_times(small_scene(), 7) == pytest.approx(np.arange(7) * 0.5)
    assert experiment.path_times(small_scene(), 1) == [0.0]


def test_a_method_that_does_not_exist_is_named():
    with pytest.raises(ValueError, match="telepathy"):
        next(experiment.run(small_scene(), SETTINGS, ["telepathy"], [0.0]))


def test_each_frame_begins_with_another_method():
    came = []
    for _ in experiment.run(
        small_scene(), SETTINGS, ["paper", "free"], experiment.path_times(small_scene()),
        on_frame=lambda number, method, frame: came.append((number, method)),
    ):  # fmt: skip
        pass
    orders = [[method for number, method in came if number == frame] for frame in range(4)]
    assert orders[:3] == [["none", "paper", "free"], ["paper", "free", "none"], ["free", "none", "paper"]]
    assert orders[3] == orders[0]


def test_a_speed_up_has_the_spread_of_its_frames():
    lots = np.random.default_rng(1)
    truth = 1.25
    hits = 0
    for _ in range(400):
        seconds = lots.uniform(0.9, 1.1, 60)
        none = truth * seconds + lots.normal(0.0, 0.2, 60)
        found, spread = experiment.speed_up(none, seconds)
        hits += abs(found - truth) <= spread
    assert 0.92 < hits / 400 < 0.98, "twice the standard error"
    assert experiment.speed_up(np.array([2.0]), np.array([1.0])) == (2.0, np.inf)
    assert experiment.speed_up(np.zeros(3), np.zeros(3)) == (0.0, 0.0)


def test_the_table_tells_what_is_saved_and_how_sure_the_speed_up_is():
    results = experiment.Results("s", (10, 10), frames=[7, 9])
    figures = _figures(steps=[1, 1], tests=[1, 1], occlusion=[0, 0])
    culled = figures | {
        "shadow_rays_culled": [20, 10],
        "shadow_rays_dynamic_only": [0, 10],
        "frame_seconds": [0.1, 0.1],
    }
    results.methods = {"none": figures, "paper": culled}
    none, paper = experiment.table(results)
    assert (none.saved_part, none.speed_up, none.speed_up_spread) == (0.0, 1.0, 0.0)
    assert paper.saved_part == pytest.approx(0.4) and paper.speed_up == pytest.approx(2.0)
    assert paper.speed_up_spread == pytest.approx(2.0)


def test_what_clusters_get_wrong_is_a_part_of_the_pixels_and_what_culling_gets_wrong_of_the_rays():
    one = _figures(steps=[40, 150], tests=[5, 0], occlusion=[0, 0], wrong=[3, 1])
    results = experiment.Results("s", (10, 10), frames=[7, 9], methods={m: one for m in ("none", "paper", "lightcuts")})
    assert [row.wrong_part for row in experiment.table(results)] == pytest.approx([0.04, 0.04, 0.02])

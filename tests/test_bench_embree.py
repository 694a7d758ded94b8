"""The benchmark beside Embree: that it runs, that its rays are those of frames, and that its checks can fail."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tracer
from tests import scenes
from tests.bench import against_embree, frames
from tests.bench.contest import Embreex, Ours, differing, heats, race
from tests.bench.embree import MODES, EmbreeRays, EmbreeScene
from tests.bench.frame_rays import frame_rays
from tests.bench.rays import (
    Surfaces,
    incoherent_rays,
    joined,
    mirror_rays,
    points_of,
    primary_rays,
    shadow_rays,
    without_quadrics,
)
from tests.bench.report import Goal, gains
from tests.tracing import naive
from tests.tracing.worlds import random_corners, scene
from tracer.geometry.rays import Hits, ray_batch
from tracer.scene.model import Camera
from viewer.util.resources import scene_path

DEFAULT = scene_path(None)
TINY = ["--quick", "--size", "24", "--depth", "3"]


@pytest.mark.parametrize(("closest", "threads"), [(True, 1), (False, 2)])
def test_all_of_embrees_modes_answer_like_brute_force(closest, threads):
    rng = np.random.default_rng(7)
    corners = random_corners(rng, 60, 0.2)
    embree = EmbreeScene(corners)
    count = 101  # no multiple of any packet
    origins, targets = rng.normal(size=(count, 3)) + 0.5, rng.random((count, 3))
    limits = np.where(rng.random(count) < 0.5, 1.2, np.inf)
    rays = ray_batch(origins, targets - origins, 0.0, limits)
    expected = np.array(
        [naive.closest_triangle(corners, o, d)[0] for o, d in zip(rays.origin.T, rays.direction.T, strict=True)]
    )
    hit = expected < rays.t_max
    expected = np.where(hit, expected if closest else -np.inf, rays.t_max)
    clear = np.array([naive.edge_distance(corners, o, d) > 1e-5 for o, d in zip(rays.origin.T, rays.direction.T)])
    assert 10 < hit[clear].sum() < clear.sum() - 10
    for mode in MODES:
        asked = EmbreeRays(embree, rays, closest, mode, threads)
        for _ in range(2):  # again, from packets filled anew
            asked.prepare()
            asked.run()
            assert asked.answers()[clear] == pytest.approx(expected[clear], rel=1e-3), mode


def test_embreex_and_ours_answer_alike():
    rng = np.random.default_rng(3)
    corners = random_corners(rng, 60, 0.2)
    rays = incoherent_rays(np.array([0, 0, 0, 1, 1, 1]), 500, 1)
    contestants = [Embreex(corners, rays), Ours(tracer.World(scene(corners)), rays, True)]
    times, beside = race(contestants, 2, lambda: 1.5)
    assert times.shape == (2, 2) and (times > 0).all() and beside.tolist() == [1.5, 1.5]
    answers = [contestant.answers() for contestant in contestants]
    assert np.isfinite(answers[0]).sum() > 50
    assert differing(rays, *answers) <= 2  # where a ray passes an edge
    modes = heats(EmbreeScene(corners), rays, True, 1)
    assert set(modes) == set(MODES) and list(modes.values()) == sorted(modes.values())


def test_answers_that_differ_are_counted():
    rays = ray_batch(np.full((5, 3), 100.0), np.ones((5, 3)))
    ours = np.array([1.0, np.inf, -np.inf, 5.0, 1e-3], np.float32)
    assert differing(rays, ours, ours.copy()) == 0
    assert differing(rays, ours, np.array([1.01, np.inf, -np.inf, 5.0, 1e-3], np.float32)) == 1
    assert differing(rays, ours, np.array([np.inf, 1.0, np.inf, np.inf, 1e-3], np.float32)) == 4
    near = np.array([1.0, np.inf, -np.inf, 5.0, 1.1e-3], np.float32)  # so near the origin that rounding tells, at 100
    assert differing(rays, ours, near) == 0
    assert differing(rays, ours, near, offset=0.0) == 1


def test_two_threads_are_judged_only_beside_a_second_core():
    assert gains([2.0, 2.0, 2.0], [1.0, 1.1, 2.0], [2.0, 1.95, 1.2]) == [2.0, pytest.approx(2.0 / 1.1)]
    assert Goal("scene", "threads", 1.8, float("nan")).met is None
    assert Goal("scene", "rays", 1.5, 1.49).met is False
    assert Goal("scene", "rays", 1.5, 1.5).met is True


def test_primary_rays_go_through_every_pixel_once_and_neighbours_follow_each_other():
    width, height = 33, 70
    rng = np.random.default_rng(5)
    world = scene(random_corners(rng, 200, 0.5), camera=Camera((0.3, 0.4, 4.0), (0.0, 0.0, -1.0), angle=30.0))
    renderer = tracer.Renderer(world, tracer.Settings(width=width, height=height, depth=0, method="none"))
    rays = primary_rays(world.camera, width, height)
    assert len(rays.t_min) == width * height == len(np.unique(rays.direction, axis=1).T)
    depth = np.sort(renderer.render().depth.reshape(-1))
    assert np.isfinite(depth).mean() > 0.3
    assert np.sort(renderer.world.closest_hits(rays).t) == pytest.approx(depth, rel=1e-5)
    steps = np.linalg.norm(np.diff(rays.direction, axis=1), axis=0)
    pixel = np.linalg.norm(rays.direction[:, 0] - rays.direction[:, 1])
    assert np.median(steps) < 2.5 * pixel


def test_rays_of_a_frame_are_as_many_as_the_renderer_counts():
    loaded = without_quadrics(scenes.loaded(DEFAULT))
    settings = tracer.Settings(width=120, height=90, depth=6)
    renderer = tracer.Renderer(loaded, settings)
    before, frame = (renderer.render(loaded.frame_time(number)) for number in (10, 11))
    told = frame_rays(renderer.world, frame.time, frame.camera, (120, 90), 6, before.modes)
    counted = frame.statistics
    assert len(told.primary.t_min) == counted.primary.rays
    assert len(told.secondary.t_min) == pytest.approx(counted.secondary.rays, rel=1e-3)
    assert len(told.shadow.t_min) == pytest.approx(counted.shadow.due, rel=1e-3)
    assert told.culled.sum() == pytest.approx(counted.shadow.culled, rel=1e-3)
    assert counted.secondary.rays > 1000 and counted.shadow.culled > 100


def test_shadow_and_mirror_rays_start_and_end_where_they_should():
    floor = [[[-5, -5, 0], [5, -5, 0], [0, 5, 0]]]
    world = tracer.World(scene(floor, lights=[(1.0, 2.0, 3.0), (0.0, 0.0, -3.0)]))
    rays = ray_batch([[0, 0, 4], [0.5, 0, 4], [9, 9, 4]], [[0, 0, -1], [0, 0.6, -0.8], [0, 0, -1]])
    hits = world.closest_hits(rays)
    points = points_of(Surfaces.of(world.scene, 0.0), rays, Hits(*hits))
    assert len(points.primitive) == 2  # the third misses
    above, below = (shadow_rays(points, p.astype(np.float32)) for p in world.scene.light_positions(0.0))
    assert above[1].all() and not below[1].any()
    ends = above[0].origin + above[0].direction
    assert np.allclose(ends.T, points.position, atol=1e-3) and (ends[2] > 0).all()
    assert np.allclose(mirror_rays(points).direction.T, [[0, 0, 1], [0, 0.6, 0.8]], atol=1e-6)
    both = joined([above[0], below[0]])
    assert both.origin.shape == (3, 2) and len(both.t_max) == 2


def run(tmp_path: Path, *arguments: str) -> tuple[int, dict]:
    out = tmp_path / "out" / "embree.json"
    code = against_embree.main([str(DEFAULT), *TINY, *arguments, "--json", str(out)])
    return code, json.loads(out.read_text())


def test_the_benchmark_runs_and_writes_what_it_printed(tmp_path, capsys):
    code, report = run(tmp_path)
    printed = capsys.readouterr()
    assert code == 0, printed.err
    assert report["faults"] == [] and report["machine"]["embree"].startswith("4.")
    (result,) = report["scenes"]
    assert {contest["kind"] for contest in result["rays"]} > {"primary", "shadow", "mirror", "incoherent", "left at 0"}
    assert len(result["frames"]) == 3 and sum(frame["embree"] is not None for frame in result["frames"]) == 1
    for contest in result["rays"]:
        assert set(contest["heats"]) == set(map(str, MODES))
        assert contest["ratio"]["median"] == pytest.approx(contest["embree"][0] / contest["ours"][0])
    assert len(report["goals"]) > 12
    for title in ("one thread", "view by view", "Embree's modes", "whole frames along the path", "Goals"):
        assert title in printed.out


def test_wrong_answers_fail_the_benchmark(tmp_path, capsys, monkeypatch):
    right = Ours.answers
    monkeypatch.setattr(Ours, "answers", lambda self: right(self) * np.float32(1.01))
    code, report = run(tmp_path, "--frames", "0")
    assert code == 1
    assert any("primary rays are Embree's" in fault for fault in report["faults"])
    assert "not to be trusted" in capsys.readouterr().err


def test_rays_that_are_not_the_frames_fail_the_benchmark(tmp_path, monkeypatch):
    def fewer(*arguments):
        return replace(frame_rays(*arguments), primary=joined([]))

    monkeypatch.setattr(frames, "frame_rays", fewer)
    code, report = run(tmp_path)
    assert code == 1
    assert any("primary rays: 0 told anew, 576 counted" in fault for fault in report["faults"])


def test_mistakes_are_refused():
    with pytest.raises(SystemExit) as stop:
        against_embree.main([str(DEFAULT), "--rounds", "0"])
    assert stop.value.code == 2


def test_a_scene_that_is_not_there_is_one_line(capsys):
    assert against_embree.main(["nowhere.aff", *TINY]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 1

"""What is told of a pixel's rays is what the frame did with them, and what blocks them does so by brute force."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from tests.sweeps import crossed
from tests.tracing.brute import meet_all, primitives_there
from tests.tracing.glassy import SCENE
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.verdicts import Verdict
from tracer.frame import Frame, Settings
from tracer.geometry.rays import ray_batch
from tracer.inspect.path_records import TRACED, RayKind, RayTree
from tracer.inspect.ray_tree import ray_tree, unused
from tracer.inspect.reasons import WHY_TRACED
from tracer.methods.adaptive_policy import AdaptivePolicy, Plan
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Cancelled

WIDTH, HEIGHT = 16, 12
METHODS = ("none", "paper", "cells", "certified", "paper+cache", "auto")


@pytest.fixture(scope="module")
def scene_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("rays") / "scene.aff"
    path.write_text(SCENE)
    return path


def rendered(path: Path, method: str, accelerator: str, **more) -> tuple[Renderer, Frame]:
    """The third frame, by which the method has learnt; an object moves."""
    settings = Settings(WIDTH, HEIGHT, method=method, threads=1, accelerator=accelerator, depth=4, record_work=True,
                        record_lights=True, **more)  # fmt: skip
    renderer = Renderer(load_scene(path), settings)
    for time in (5.0, 5.5, 6.0):
        frame = renderer.render(time)
    return renderer, frame


def all_trees(renderer: Renderer, frame: Frame) -> list[RayTree]:
    return [ray_tree(renderer, frame, x, y) for y in range(frame.height) for x in range(frame.width)]


@pytest.mark.parametrize(("method", "accelerator"), crossed(METHODS, ["kdtree", "bvh8"]))
def test_all_trees_together_are_the_frame(scene_file: Path, method: str, accelerator: str):
    renderer, frame = rendered(scene_file, method, accelerator)
    trees = all_trees(renderer, frame)
    for tree in trees:
        at = tree.y, tree.x
        assert np.array_equal(tree.color, frame.color[at])
        told = tree.due, tree.due - tree.traced, len(tree.rays) + tree.traced
        assert told == (frame.due_rays[at], frame.saved[at], frame.cost[at])
        first = tree.rays[0].shadows
        if first is not None:
            assert [first.lit[first.of_light(light)].sum() for light in range(3)] == frame.reached[at].tolist()
    counts, shadow = sum((tree.counts for tree in trees), Counter()), frame.statistics.shadow
    assert counts[Verdict.CACHED] == shadow.cache_hits and counts[Verdict.CANDIDATES] == shadow.candidates_only
    assert counts[Verdict.FULL_SHADOW] + counts[Verdict.CERTIFIED_FULL] + counts[Verdict.BEAM] >= shadow.culled
    assert counts[Verdict.NON_SHADOW] + counts[Verdict.CERTIFIED_LIT] == shadow.dynamic_only
    reasons = [why for tree in trees for ray in tree.rays if ray.shadows for why in ray.shadows.reasons.values()]
    known = Counter(why.known for why in reasons if why.known)
    if method in ("paper", "cells", "paper+cache"):
        assert sum(known.values()) == counts[Verdict.TRACED]
        assert set(known) <= {"INIT", "PARTIALLY_OCCLUDED", "DYNAMIC", "PARTIAL_SHADOW"} and len(known) > 1
    else:
        assert set(known) <= {"candidates"} or method == "auto"
    culled = sum(number for verdict, number in counts.items() if verdict.culled)
    assert culled == shadow.due - counts[Verdict.TRACED] and (culled > 0 or method in ("none", "auto"))
    if accelerator == "kdtree" and method in ("none", "paper", "cells"):
        shadows = [ray.shadows for tree in trees for ray in tree.rays if ray.shadows is not None]
        assert sum(int(s.steps.sum()) for s in shadows) == shadow.traversal_steps
        assert sum(int(s.tests.sum()) for s in shadows) == shadow.intersection_tests
        others = [ray for tree in trees for ray in tree.rays if ray.kind is not RayKind.PRIMARY]
        assert sum(ray.steps for ray in others) == frame.statistics.secondary.traversal_steps


def test_certificates_that_auto_does_not_look_up_are_told_as_in_the_inspector(
    scene_file: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(AdaptivePolicy, "plan", lambda self, *_: Plan(seconds=1.0))
    renderer, frame = rendered(scene_file, "auto", "bvh8")
    told: Counter[str] = Counter()
    (auto,) = renderer.work_on(frame).methods
    for tree in all_trees(renderer, frame)[::5]:
        for ray, place in tree.shadow_rays():
            s, (state, _) = ray.shadows, auto.explain(ray.primitive, ray.end, int(ray.shadows.light[place]))
            expected = "" if state == "none" else unused(state)
            assert s.verdict[place] == TRACED and s.reason(place).known == expected
            told[expected] += 1
    assert told[""] < told.total() and set(told) - {""} <= set(WHY_TRACED), told


@pytest.mark.parametrize("accelerator", ["kdtree", "bvh8"])
def test_shadow_rays_end_where_the_pixel_looks_just_above_the_surface(scene_file: Path, accelerator: str):
    renderer, frame = rendered(scene_file, "none", accelerator)
    right, up, forward = frame.camera.basis()
    half = np.tan(np.radians(frame.camera.angle) / 2.0)
    for tree in all_trees(renderer, frame):
        ray = tree.rays[0]
        if ray.shadows is not None:
            across = half * WIDTH / HEIGHT * (2.0 * (tree.x + 0.5) / WIDTH - 1.0)
            way = forward + across * right + half * (1.0 - 2.0 * (tree.y + 0.5) / HEIGHT) * up
            surface = frame.camera.position + way / np.linalg.norm(way) * frame.depth[tree.y, tree.x]
            assert ray.point == pytest.approx(surface, abs=1e-4)
            assert 1e-6 < np.linalg.norm(surface - ray.end) < 5e-4


def test_a_tree_branches_where_the_surface_says(scene_file: Path):
    trees = all_trees(*rendered(scene_file, "none", "bvh8"))
    kinds = Counter(ray.kind for tree in trees for ray in tree.rays)
    assert kinds[RayKind.PRIMARY] == WIDTH * HEIGHT and min(kinds.values()) > 20
    for tree in trees:
        for ray in tree.rays[1:]:
            sender = tree.rays[ray.parent]
            assert ray.bounce == sender.bounce + 1 and ray.number in tree.children[sender.number]
            below = (ray.direction @ sender.direction) > -1.0 and (ray.origin - sender.point) @ (
                sender.end - sender.point
            )
            assert (below > 0.0) == (ray.kind is RayKind.REFLECTED)
        assert all((ray.shadows is None) == (ray.primitive < 0) == (ray.t == np.inf) for ray in tree.rays)


@pytest.mark.parametrize("accelerator", ["kdtree", "bvh8"])
def test_what_blocks_is_what_blocks_by_brute_force(scene_file: Path, accelerator: str):
    renderer, frame = rendered(scene_file, "paper", accelerator)
    asked = [(tree, ray, place) for tree in all_trees(renderer, frame)[::3] for ray, place in tree.shadow_rays()]
    starts = np.array([tree.samples[place] for tree, _, place in asked])
    ends = np.array([ray.end for _, ray, _ in asked])
    there = primitives_there(renderer.scene, frame.time)
    met = meet_all(renderer.world, ray_batch(starts, ends - starts, LIGHT_MARGIN, 1.0), there)
    nearest, differ, kinds = met.closest(), 0, Counter()
    for i, (_, ray, place) in enumerate(asked):
        s, blocked = ray.shadows, bool(nearest[i] >= 0)
        if (s.blocker[place] >= 0) != blocked:  # the 8-wide trees round otherwise along an edge
            differ += 1
            continue
        assert s.wrong[place] == (s.lit[place] == blocked)
        kinds[renderer.world.object_of[nearest[i]] if blocked else None] += 1
        if blocked:
            assert s.blocked_at[place] == pytest.approx(met.t[i, nearest[i]], abs=1e-5)
            assert met.t[i, s.blocker[place]] == pytest.approx(met.t[i, nearest[i]], abs=1e-5)
        if s.verdict[place] == TRACED:
            assert np.isfinite(met.t[i, s.met[place]]) if blocked else s.met[place] == -1
    assert differ <= (0 if accelerator == "kdtree" else 2)
    assert set(kinds) == {None, 0, 1} and min(kinds.values()) > 0


def test_lamps_and_many_lights_are_told_sample_by_sample(scene_file: Path, tmp_path: Path):
    renderer, frame = rendered(scene_file, "certified", "bvh8", lamp_radius=0.2, lamp_samples=16)
    _sums_agree(renderer, frame, 48)
    many = tmp_path / "many.aff"
    bulbs = "".join(
        f"l {x} 1.5 {z} 0.1 0.1 0.1\nl {x} -2 {z} 0.1 0.1 0.1\n" for x in range(-3, 4) for z in range(-2, 2)
    )
    many.write_text(SCENE + bulbs)
    renderer, frame = rendered(many, "certified", "bvh8")
    counts = _sums_agree(renderer, frame, 59)
    assert counts[Verdict.PASSED_OVER] > 0
    renderer, frame = rendered(many, "certified", "bvh8", lamp_radius=0.2, lamp_samples=9)
    assert _sums_agree(renderer, frame, 59 * 9)[Verdict.BEAM] > 0, "samples that recent occluders hide"


def _sums_agree(renderer: Renderer, frame: Frame, samples: int) -> Counter[Verdict]:
    counts: Counter[Verdict] = Counter()
    for y in range(0, HEIGHT, 2):
        for x in range(0, WIDTH, 2):
            tree = ray_tree(renderer, frame, x, y)
            counts += tree.counts
            assert (tree.due, tree.due - tree.traced) == (frame.due_rays[y, x], frame.saved[y, x])
            assert np.array_equal(tree.color, frame.color[y, x]) and len(tree.samples) == samples
            assert not any(ray.shadows.wrong.any() for ray in tree.rays if ray.shadows is not None)
    return counts


def test_a_picture_that_came_in_parts_is_told_as_it_came(scene_file: Path):
    settings = Settings(64, 48, method="certified", threads=1, record_work=True, lamp_radius=0.2, lamp_samples=8)
    renderer = Renderer(load_scene(scene_file), settings)
    renderer.render(6.0)
    *_, whole, last = renderer.refine(6.0, parts=(1, 4, 16), samples=2)
    for x, y in ((20, 30), (33, 25), (40, 31), (13, 28)):
        for frame in (whole, last):  # which are of the same first sample
            tree = ray_tree(renderer, frame, x, y)
            assert (tree.due, tree.due - tree.traced) == (whole.due_rays[y, x], whole.saved[y, x])
            assert np.array_equal(tree.color, whole.color[y, x])


def test_what_cannot_be_told_is_said(scene_file: Path):
    renderer, frame = rendered(scene_file, "paper", "bvh8")
    with pytest.raises(IndexError, match=r"no pixel 16,0: the picture is 16 x 12"):
        ray_tree(renderer, frame, 16, 0)
    with pytest.raises(Cancelled):
        ray_tree(renderer, frame, 8, 6, cancelled=lambda: True)
    before, tree = frame, ray_tree(renderer, frame, 8, 9)
    renderer.render(6.0)
    with pytest.raises(LookupError, match="another frame has begun"):
        ray_tree(renderer, before, 8, 9)
    assert tree.due > 0, "what has been told stays"


def test_a_wrong_answer_is_seen_to_be_one(scene_file: Path):
    renderer, frame = rendered(scene_file, "paper", "bvh8", verify=True)
    for tree in all_trees(renderer, frame):
        wrong = sum(int(ray.shadows.wrong.sum()) for ray in tree.rays if ray.shadows is not None)
        assert wrong == frame.wrong[tree.y, tree.x]

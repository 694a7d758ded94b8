"""A hunt finds what is wrong, says where it was learnt, and finds it again from what it keeps."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.marbles import LAST, STEP, write_marbles
from tracer.experiments import counterexample, hunt, warmup_frames
from tracer.experiments.counterexample import AROUND, PATH
from tracer.experiments.hunt import Results, Search
from tracer.inspect.projection import seen_at
from tracer.inspect.ray_tree import ray_tree
from viewer.output.comparison import Crop

SETTINGS = tracer.Settings(width=96, height=96, depth=2, method="paper", threads=1)
FRAMES = LAST // STEP + 1


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> tracer.World:
    return tracer.World(tracer.load_scene(write_marbles(tmp_path_factory.mktemp("marbles"))))


def search(world: tracer.World, **options) -> Search:
    times = [world.scene.frame_time(number) for number in range(0, LAST + 1, STEP)]
    plan = {"camera": None, "around": 0, "radius": 0.3, "seed": 1, "keep": 8} | options
    return Search(SETTINGS, times, **plan)


def result(world: tracer.World, wanted: Search, **options) -> Results:
    *_, found = hunt.run(world.scene, wanted, world=world, **options)
    return found


@pytest.fixture(scope="module")
def found(world: tracer.World) -> Results:
    return result(world, search(world, around=8, keep=5))


@pytest.fixture(scope="module")
def alone(world: tracer.World) -> Results:
    """Of the path, and no pictures beside it."""
    return result(world, search(world, keep=5))


def test_the_path_is_searched_as_it_is_traced(world: tracer.World, alone: Results, found: Results) -> None:
    """Against frames traced here, one after another: the worst pixel of all is found, if not beside the path."""
    scene = world.scene
    renderer = tracer.Renderer(scene, replace(SETTINGS, verify=True), world=world)
    wrong, worst = 0, 0.0
    for time in search(world).times:
        frame = renderer.render(time)
        assert frame.wrong is not None and frame.reference is not None
        wrong += np.count_nonzero(frame.wrong)
        worst = max(worst, float(np.abs(np.clip(frame.color, 0, 1) - np.clip(frame.reference, 0, 1)).max()))
    assert (alone.frames, alone.pixels) == (FRAMES, FRAMES * 96 * 96) and alone.wrong_pixels == wrong > 0
    assert alone.finds[0].difference == pytest.approx(worst, abs=1e-6)
    assert all(find.place == PATH for find in alone.finds)
    assert found.frames == FRAMES + 8 and found.wrong_pixels > wrong and found.finds[0].difference >= worst


def test_finds_are_distinct_and_the_worst_first(found: Results) -> None:
    assert len(found.finds) > 2 and len(found.finds) == len({find.key for find in found.finds})
    differences = [find.difference for find in found.finds]
    assert differences == sorted(differences, reverse=True) and differences[-1] > hunt.VISIBLE
    assert AROUND in {find.place for find in found.finds}


def test_a_find_is_made_again_by_its_frames(world: tracer.World, alone: Results, found: Results) -> None:
    """Its pixel has the same wrong colour, bit for bit, after no more frames than it needs; and its rays say why."""
    scene = world.scene
    assert any(len(find.before) < find.learnt_from for find in alone.finds), "nothing was left out: this shows nothing"
    for find in (*alone.finds, *found.finds):
        kept = warmup_frames.from_json(json.loads(json.dumps(counterexample.to_json(find, scene))))
        assert kept == find.before and kept
        renderer = tracer.Renderer(scene, SETTINGS, world=world)
        for one in kept:
            renderer.render(one.time, one.camera)
        frame = renderer.render(find.time, find.seen_camera)
        assert tuple(frame.color[find.y, find.x].tolist()) == find.color
        tree = ray_tree(renderer, frame, find.x, find.y)
        assert seen_at(frame, find.x, find.y) == pytest.approx(tree.rays[0].point, abs=1e-3)
        (ray, *_) = [ray for ray in tree.rays if ray.primitive == find.primitive and ray.bounce == find.bounces]
        assert ray.shadows is not None
        place = ray.shadows.of_light(find.light).start
        assert ray.shadows.wrong[place] and ray.shadows.lit[place] == find.lit
        assert ray.shadows.blocker[place] == find.blocker
        right = tracer.Renderer(scene, replace(SETTINGS, method="none"), world=world)
        assert tuple(right.render(find.time, find.seen_camera).color[find.y, find.x].tolist()) == find.reference


def test_the_frame_that_taught_has_set_the_mode(world: tracer.World, alone: Results, found: Results) -> None:
    """Traced along the same path here: the mode that is wrong is first there after that frame."""
    scene = world.scene
    on_path = [find for find in alone.finds if find.taught >= 0]
    assert on_path
    renderer, words = tracer.Renderer(scene, SETTINGS, world=world), []
    for time in search(world).times:
        words.append(renderer.render(time).modes)
    for find in on_path:
        bit = (2 if find.lit else 1) << (2 + 2 * find.light)
        has = [bool(int(word[find.primitive]) & bit) for word in words]
        assert has.index(True) == find.taught and search(world).times[find.taught] == find.taught_time


def test_the_frames_before_a_find_are_looked_for_once(world: tracer.World, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before the pictures beside the path, or after them: a find that is short already is left alone."""
    tried: list[tuple[object, object]] = []
    makes = hunt._Hunter._makes

    def watched(self, before, find):
        assert len(find.before) == find.learnt_from and set(before) < set(find.before)
        tried.append((find, before))
        return len(before) > 1 and makes(self, before, find)  # so that some stay that have several

    monkeypatch.setattr(hunt._Hunter, "_makes", watched)
    result(world, search(world, around=1, keep=5))
    assert tried and len(set(tried)) == len(tried), "none is tried twice"


def test_the_same_seed_finds_the_same(world: tracer.World, found: Results) -> None:
    assert result(world, search(world, around=8, keep=5)) == found
    assert result(world, search(world, around=8, keep=5, seed=2)).finds != found.finds


def test_an_exact_method_is_never_wrong(world: tracer.World) -> None:
    wanted = replace(search(world, around=2), settings=replace(SETTINGS, method="certified"))
    exact = result(world, wanted)
    assert exact.finds == [] and exact.frames == FRAMES + 2 and exact.wrong_pixels == 0
    assert exact.summary == f"{exact.pixels:,} pixels of {FRAMES + 2} frames compared: none is wrong"


def test_a_hunt_that_is_stopped_keeps_what_it_has(world: tracer.World) -> None:
    traced: list[str] = []
    until_six = {"cancel": lambda: len(traced) >= 6, "on_frame": lambda label, frame: traced.append(label)}
    stopped = result(world, search(world, around=8), **until_six)
    assert stopped.frames == 6 and stopped.finds
    assert traced[0] == f"frame 1 of {FRAMES}"


def test_words_say_what_is_wrong_and_true(world: tracer.World, found: Results) -> None:
    scene = world.scene
    for find in found.finds:
        text = " ".join(counterexample.in_words(find, scene))
        assert f"Pixel {find.x}, {find.y} is too " in text and f" {find.primitive} of " in text
        assert ("but it is blocked by" in text or "but the first is blocked by" in text) == find.lit
        assert ("nothing is in" in text) != find.lit
        crop = Crop.around((find.x, find.y), found.size)
        assert 0 <= find.x - crop.x < crop.width and 0 <= find.y - crop.y < crop.height
        assert crop.x + crop.width <= 96 and crop.y + crop.height <= 96


def test_cameras_beside_the_path_look_at_what_is_wrong(world: tracer.World, monkeypatch: pytest.MonkeyPatch) -> None:
    """Their pictures have it near where the find had it, and nothing lies between the two cameras."""
    targets, cameras = [], []
    another = hunt._Hunter._another

    def watched(self, camera, target, time, lots):
        moved = another(self, camera, target, time, lots)
        targets.append(target), cameras.append((camera, moved))
        return moved

    monkeypatch.setattr(hunt._Hunter, "_another", watched)
    result(world, search(world, around=5, radius=0.2))
    assert len(cameras) == 5
    for target, (camera, moved) in zip(targets, cameras):
        before, after = (np.asarray(target) - np.asarray(c.position) for c in (camera, moved))
        ratio = np.linalg.norm(after) / np.linalg.norm(before)
        assert 0.5 / 1.25 <= ratio <= 1.25 * 1.25
        cosines = [float(way @ c.basis()[2] / np.linalg.norm(way)) for way, c in ((before, camera), (after, moved))]
        assert cosines[1] == pytest.approx(cosines[0], abs=0.15)

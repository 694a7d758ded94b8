"""A hunt finds what is wrong, says where it was learnt, and finds it again from what it keeps."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tracer
from tests.scenes import loaded, world_of
from tracer.ray_tree import ray_tree
from viewer.output import finds
from viewer.output.finds import AROUND, PATH, Findings
from viewer.services import hunting
from viewer.services.hunting import Search, hunt
from viewer.state import earlier

DEFAULT = Path(__file__).resolve().parents[3] / "assets" / "scenes" / "default.aff"
SETTINGS = tracer.Settings(width=64, height=48, depth=2, method="paper", threads=1)


def search(**options: object) -> Search:
    scene = loaded(DEFAULT)
    return Search(SETTINGS, [scene.frame_time(number) for number in range(0, 12, 2)], **options)  # type: ignore


def result(wanted: Search, **options) -> Findings:
    *_, found = hunt(loaded(DEFAULT), wanted, world_of(DEFAULT, "bvh8"), **options)
    return found


@pytest.fixture(scope="module")
def found() -> Findings:
    return result(search(around=6, keep=5))


def test_the_path_is_searched_as_it_is_traced(found: Findings) -> None:
    """Against frames traced here, one after another: the worst pixel of all is found, if not beside the path."""
    scene = loaded(DEFAULT)
    renderer = tracer.Renderer(scene, replace(SETTINGS, verify=True), world=world_of(DEFAULT, "bvh8"))
    wrong, worst = 0, 0.0
    for time in search().times:
        frame = renderer.render(time)
        assert frame.wrong is not None and frame.reference is not None
        wrong += np.count_nonzero(frame.wrong)
        worst = max(worst, float(np.abs(np.clip(frame.color, 0, 1) - np.clip(frame.reference, 0, 1)).max()))
    alone = result(search())
    assert (alone.frames, alone.pixels) == (6, 6 * 64 * 48) and alone.wrong_pixels == wrong > 0
    assert alone.finds[0].difference == pytest.approx(worst, abs=1e-6)
    assert all(find.place == PATH for find in alone.finds)
    assert found.frames == 12 and found.wrong_pixels > wrong and found.finds[0].difference >= worst


def test_finds_are_distinct_and_the_worst_first(found: Findings) -> None:
    assert len(found.finds) == 5 == len({find.key for find in found.finds})
    differences = [find.difference for find in found.finds]
    assert differences == sorted(differences, reverse=True) and differences[-1] > finds.VISIBLE
    assert {find.place for find in found.finds} == {PATH, AROUND}, "both are searched"


def test_a_find_is_made_again_by_the_frames_that_it_keeps(found: Findings) -> None:
    """Its pixel has the same wrong colour, bit for bit, after no more frames than it needs; and its rays say why."""
    scene = loaded(DEFAULT)
    assert any(len(find.before) < find.learnt_from for find in found.finds), "nothing was left out: this shows nothing"
    for find in found.finds:
        kept = earlier.from_json(json.loads(json.dumps(finds.to_json(find, scene))))
        assert kept == find.before and kept
        renderer = tracer.Renderer(scene, SETTINGS, world=world_of(DEFAULT, "bvh8"))
        for one in kept:
            renderer.render(one.time, one.camera)
        frame = renderer.render(find.time, find.seen_camera)
        assert tuple(frame.color[find.y, find.x].tolist()) == find.color
        tree = ray_tree(renderer, frame, find.x, find.y)
        (ray, *_) = [ray for ray in tree.rays if ray.primitive == find.primitive and ray.bounce == find.bounces]
        assert ray.shadows is not None
        place = ray.shadows.of_light(find.light).start
        assert ray.shadows.wrong[place] and ray.shadows.lit[place] == find.lit
        assert ray.shadows.blocker[place] == find.blocker
        right = tracer.Renderer(scene, replace(SETTINGS, method="none"), world=world_of(DEFAULT, "bvh8"))
        assert tuple(right.render(find.time, find.seen_camera).color[find.y, find.x].tolist()) == find.reference


def test_the_frame_that_taught_has_set_the_mode(found: Findings) -> None:
    """Traced along the same path here: the mode that is wrong is first there after that frame."""
    scene = loaded(DEFAULT)
    on_path = [find for find in found.finds if find.place == PATH and find.taught >= 0]
    assert on_path
    renderer, words = tracer.Renderer(scene, SETTINGS, world=world_of(DEFAULT, "bvh8")), []
    for time in search().times:
        words.append(renderer.render(time).modes)
    for find in on_path:
        bit = (2 if find.lit else 1) << (2 + 2 * find.light)
        has = [bool(int(word[find.primitive]) & bit) for word in words]
        assert has.index(True) == find.taught and search().times[find.taught] == find.taught_time


def test_the_same_seed_finds_the_same(found: Findings) -> None:
    assert result(search(around=6, keep=5)) == found
    assert result(search(around=6, keep=5, seed=2)).finds != found.finds


def test_an_exact_method_is_never_wrong() -> None:
    wanted = replace(search(around=2), settings=replace(SETTINGS, method="certified"))
    exact = result(wanted)
    assert exact.finds == [] and exact.frames == 8 and exact.wrong_pixels == 0
    assert exact.summary == f"{8 * 64 * 48:,} pixels of 8 frames compared: none is wrong"


def test_a_hunt_that_is_stopped_keeps_what_it_has() -> None:
    traced: list[str] = []
    stopped = result(
        search(around=6),
        cancelled=lambda: len(traced) >= 4,
        on_frame=lambda label, done, total, frame: traced.append(f"{label}: {done} of {total}"),
    )
    assert stopped.frames == 4 and stopped.finds
    assert traced[0] == "frame 1 of 6: 1 of 12"


def test_words_say_what_is_wrong_and_true(found: Findings) -> None:
    scene = loaded(DEFAULT)
    for find in found.finds:
        text = " ".join(finds.in_words(find, scene))
        assert f"Pixel {find.x},{find.y} is too " in text and f" {find.primitive} of " in text
        assert ("but is blocked by" in text or "but the first is blocked by" in text) == find.lit
        assert ("nothing is in" in text) != find.lit
        crop = finds.crop_of(find, found.size)
        assert 0 <= find.x - crop.x < crop.width and 0 <= find.y - crop.y < crop.height
        assert crop.x + crop.width <= 64 and crop.y + crop.height <= 48


def test_cameras_beside_the_path_look_at_what_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """Their pictures have it near where the find had it, and nothing lies between the two cameras."""
    scene, targets, cameras = loaded(DEFAULT), [], []
    another = hunting._Hunter._another

    def watched(self, camera, target, time, lots):
        moved = another(self, camera, target, time, lots)
        targets.append(target), cameras.append((camera, moved))
        return moved

    monkeypatch.setattr(hunting._Hunter, "_another", watched)
    result(search(around=5, radius=0.2))
    assert len(cameras) == 5 and scene is not None
    for target, (camera, moved) in zip(targets, cameras):
        before, after = (np.asarray(target) - np.asarray(c.position) for c in (camera, moved))
        ratio = np.linalg.norm(after) / np.linalg.norm(before)
        assert 0.5 / 1.25 <= ratio <= 1.25 * 1.25
        cosines = [float(way @ c.basis()[2] / np.linalg.norm(way)) for way, c in ((before, camera), (after, moved))]
        assert cosines[1] == pytest.approx(cosines[0], abs=0.15)

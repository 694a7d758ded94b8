"""Laying out millions of primitives: in parts, between which it can be given up, and the same whatever these are."""

from __future__ import annotations

import numpy as np
import pytest

import tracer
from tests.tracing.rays_and_movers import movers
from tests.tracing.worlds import random_corners, scene
from tracer.geometry import building, primitives
from tracer.geometry.primitives import Primitives
from tracer.geometry.wide_tree import cells
from tracer.scene.model import Cancelled, Scene


def large() -> Scene:
    rng = np.random.default_rng(3)
    return scene(random_corners(rng, 1000, 0.1), dynamic=movers(rng, 4))


@pytest.mark.parametrize("block", [primitives.BLOCK, 64, 1])
def test_rows_are_what_the_scene_says_in_parts_of_any_size(block: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(primitives, "BLOCK", block)
    made = large()
    laid = Primitives(made)
    held = [o.triangles for o in made.objects]
    corners = np.concatenate([t.corners for t in held]).astype(np.float64)
    edges = (corners[:, 1:] - corners[:, :1]).astype(np.float32)
    assert np.array_equal(laid.triangles.reshape(-1, 3, 3)[:, 0], corners[:, 0])
    assert np.array_equal(laid.triangles.reshape(-1, 3, 3)[:, 1:], edges)
    rows, numbers, count = laid.attributes, laid.attributes.view(np.int32), made.triangle_count
    assert np.array_equal(laid.normals.reshape(-1, 3, 3), np.concatenate([t.normals for t in held]))
    assert rows[:count, primitives.FACE_NORMAL : primitives.OBJECT] == pytest.approx(
        np.cross(edges[:, 0], edges[:, 1]), rel=1e-5, abs=1e-6
    )
    owners = [made.object_of(primitive) for primitive in range(made.primitive_count)]
    assert numbers[:, primitives.OBJECT].tolist() == owners == laid.object_of.tolist()
    named = [made.materials[number] for number in numbers[:, primitives.MATERIAL]]
    assert named == [made.material_of(primitive) for primitive in range(made.primitive_count)]
    assert (numbers[:, primitives.TEXTURE] == -1).all() and not numbers[:, primitives.TEXTURE + 1 :].any()
    for index, one in enumerate(held):
        if len(one) and not len(made.objects[index].quadrics):
            points = one.corners.reshape(-1, 3)
            assert np.array_equal(laid.boxes[index], np.concatenate([points.min(0), points.max(0)]))


@pytest.mark.parametrize("accelerator", ["bvh8", "kdtree", "kdtree-lazy"])
def test_a_world_can_be_given_up_at_any_report(accelerator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(primitives, "BLOCK", 128)
    made, said = large(), []
    tracer.World(made, 0.0, accelerator, lambda what, done: said.append((what, done)))
    assert [done for _, done in said] == sorted(done for _, done in said)
    assert sum(what == "laying out primitives" for what, _ in said) > 12
    for stop in range(len(said)):
        left = iter(range(stop, -1, -1))

        def progress(what: str, done: float, left=left) -> None:
            if not next(left):
                raise Cancelled("enough")

        with pytest.raises(Cancelled):
            tracer.World(made, 0.0, accelerator, progress)


class EndsSoon:
    """A build's control that is told to end when it is asked for the k-th time."""

    def __init__(self, asked: int) -> None:
        self.left = asked

    def __getitem__(self, which: int) -> int:
        self.left -= 1
        return int(self.left <= 0)


def test_sorting_into_cells_ends_soon_once_it_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(2)
    rows = primitives.triangle_rows(random_corners(rng, 500, 0.1).astype(np.float32))
    whole = cells.cells_over(rows, 16, np.zeros(2, np.int64))
    monkeypatch.setattr(cells, "PART", 32)
    monkeypatch.setattr(cells, "CHUNK", 32)
    monkeypatch.setattr(building, "CHUNK", 32)
    for one, other in zip(cells.cells_over(rows, 16, np.zeros(2, np.int64)), whole, strict=True):
        assert np.array_equal(one, other)
    for asked in (1, 10, 17, 20, 40, 50, 60):  # the two passes that look at boxes, counting, and sorting
        control = EndsSoon(asked)
        with pytest.raises(Cancelled):
            cells.cells_over(rows, 16, control)
        assert control.left == 0  # nobody asked again

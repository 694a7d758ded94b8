"""What of a tree that waits lies where: against walks through the same memory, point by point, that read it naively."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator

import numpy as np
import pytest

import tracer
from tests.tracing.rays_and_movers import movers, random_rays
from tests.tracing.worlds import random_corners, scene
from tracer.geometry.bvh8 import layout, subtrees
from tracer.geometry.bvh8.layout import CHILDREN, COUNT
from tracer.geometry.lazy_tree.node import HEADER, SUBTREE
from tracer.geometry.lazy_tree.structure import LazyTree
from tracer.geometry.rays import Rays
from tracer.geometry.tree_parts import NOWHERE, PartsAt, most_of
from tracer.scene.model import Scene

Box = tuple[np.ndarray, np.ndarray]


def made(triangles: int = 2000) -> Scene:
    rng = np.random.default_rng(3)
    return scene(random_corners(rng, triangles, 0.02), dynamic=movers(rng, 4))


def few(rays: Rays, many: int) -> Rays:
    return Rays(*(np.ascontiguousarray(part[..., :many]) for part in rays))


def asked(world: tracer.World, points: np.ndarray, across: int) -> PartsAt:
    before, parts = world.built(), world.parts_built()
    assert parts is not None
    found = parts.at(points, across)
    assert found is not None and world.built() == before, "looking has built something"
    return found


def points_around(world: tracer.World, many: int = 1000) -> np.ndarray:
    """Some of them outside of everything, and one nowhere."""
    low, high = world.bounds()[:3], world.bounds()[3:]
    lots = np.random.default_rng(8).uniform(-0.05, 1.05, (many, 3))
    points = (low + lots * (high - low)).astype(np.float32)
    points[0] = np.nan
    return points


# --- one kd-tree over everything -------------------------------------------------------------------


class _Leaf:
    """A part of a kd-tree: its corners, level, whether it is built, and how many primitives it holds."""

    def __init__(self, low: np.ndarray, high: np.ndarray, level: int, built: bool, held: int) -> None:
        self.low, self.high, self.level, self.built, self.held = low, high, level, built, held


class _Leaves:
    """All parts of a tree, and which of them hold a point, up to a margin."""

    def __init__(self, tree: LazyTree) -> None:
        self.all = list(_leaves(tree.root, tree.box[:3], tree.box[3:], 0))
        self._low, self._high = (np.stack([getattr(leaf, side) for leaf in self.all]) for side in ("low", "high"))

    def holding(self, point: np.ndarray, margin: float) -> list[_Leaf]:
        inside = ((point >= self._low + margin) & (point <= self._high - margin)).all(1)
        return [self.all[k] for k in np.flatnonzero(inside)]


def _leaves(address: int, low: np.ndarray, high: np.ndarray, level: int) -> Iterator[_Leaf]:
    """All parts below a node, as they lie in memory; nothing is built."""
    word, plane_bits, first, second = (ctypes.c_int64 * 4).from_address(address)
    if word < 0 or word >= SUBTREE:
        if word != SUBTREE:
            yield _Leaf(low, high, level, False, -1)
            return
        words, _ = (ctypes.c_int64 * 2).from_address(first)
        both = np.array((ctypes.c_int32 * words).from_address(first + HEADER), np.int32)
        yield from _below(both, 0, low, high, level)
        return
    plane = np.array([plane_bits], np.int64).astype(np.int32).view(np.float32)[0]
    for side, child in enumerate((first, second)):
        lower, upper = low.copy(), high.copy()
        (lower if side else upper)[word] = plane
        yield from _leaves(child, lower, upper, level + 1)


def _below(words: np.ndarray, node: int, low: np.ndarray, high: np.ndarray, level: int) -> Iterator[_Leaf]:
    axis, rest = int(words[2 * node + 1]) & 3, int(words[2 * node + 1]) >> 2
    if axis == 3:
        yield _Leaf(low, high, level, True, rest)
        return
    plane = words.view(np.float32)[2 * node]
    for side, child in enumerate((node + 1, rest)):
        lower, upper = low.copy(), high.copy()
        (lower if side else upper)[axis] = plane
        yield from _below(words, child, lower, upper, level + 1)


@pytest.mark.parametrize("many", [0, 3, 400])
def test_each_point_lies_in_the_leaf_that_holds_it_or_in_what_waits(many: int) -> None:
    world = tracer.World(made(), 0.3, "kdtree-lazy")
    if many:
        world.closest_hits(few(random_rays(np.random.default_rng(1), 400), many))
    points, across = points_around(world), 1
    found = asked(world, points, across)
    structure, poses = world.structure, world._poses
    static = _Leaves(structure.trees[0])
    moving = {o: _Leaves(tree) for o, tree in enumerate(structure.trees) if o and poses.present[o]}
    sure, seen = 0, set()
    for i, point in enumerate(points):
        owner, local, leaves = -1, point.astype(np.float64), static
        for o, its in moving.items():
            there = poses.to_object[o] @ [*point.astype(np.float64), 1.0]
            box = structure.trees[o].box
            if (there >= box[:3]).all() and (there <= box[3:]).all():
                owner, local, leaves = o, there, its
        holding = leaves.holding(local, 1e-5)
        if not holding:  # it lies on a border, or outside
            if not leaves.holding(local, -1e-5):
                assert found.numbers[i] == NOWHERE
            continue
        (leaf,), sure = holding, sure + 1
        told = found.owners[i], found.levels[i], bool(found.built[i]), found.held[i]
        assert told == (owner, leaf.level, leaf.built, leaf.held), point
        if owner < 0:
            sides = leaf.high - leaf.low
            assert found.widths[i] == pytest.approx(min(sides[0], sides[2]), rel=1e-5)
        seen.add((owner >= 0, leaf.built))
    assert sure > 0.4 * len(points) and found.numbers[0] == NOWHERE
    waits = [(False, False), (True, False)]
    assert seen >= set(waits if not many else [(False, True), (False, False)][: 1 + (many == 3)])
    for same in (found.numbers[:, None] == found.numbers[None, :])[1:200]:
        assert len(set(zip(found.owners[same], found.levels[same], found.held[same], strict=True))) == 1


def test_a_tree_that_is_gone_says_so() -> None:
    world = tracer.World(made(50), 0.0, "kdtree-lazy")
    parts = world.parts_built()
    assert parts is not None and parts.alive
    del world
    assert not parts.alive and parts.at(np.zeros((1, 3), np.float32), 0) is None
    for accelerator in ("kdtree", "bvh8"):
        assert tracer.World(made(50), 0.0, accelerator, lazy=True).parts_built() is None


# --- a large 8-wide tree of subtrees ---------------------------------------------------------------


@pytest.mark.parametrize("many", [0, 2, 400])
def test_each_point_lies_in_the_deepest_box_of_subtrees_that_are_there(many: int, monkeypatch) -> None:
    monkeypatch.setattr(subtrees, "LARGE", 10)
    monkeypatch.setattr(subtrees, "SUBTREE_SIZE", 64)
    world = tracer.World(made(), 0.0, lazy=True)
    if many:
        world.closest_hits(few(random_rays(np.random.default_rng(1), 400), many))
    points, across = points_around(world), 0
    found, tree = asked(world, points, across), world.structure._large
    boxes: list[tuple[Box, int, int, int, bool, int]] = []  # with the number, level, piece, whether it is there, held

    def gather(node: int, level: int, piece: int) -> None:
        codes = tree.tree.nodes.view(np.int32)[node, CHILDREN : CHILDREN + 8]
        sides = tree.tree.nodes[node, :48].reshape(2, 3, 8)
        for slot in np.flatnonzero(codes != ~0).tolist():
            code, box = int(codes[slot]), (sides[0, :, slot], sides[1, :, slot])
            owner, there, held = piece, True, -1
            if code >= layout.SUBTREE:
                owner = code - layout.SUBTREE
                code = int(tree.table[1 + owner])
                there = code >= 0
            elif code < 0:
                held = int(tree.tree.blocks.view(np.int32)[~code, COUNT])
            boxes.append((box, 8 * node + slot, level, owner, there, held))
            if code >= 0 and there:
                gather(code, level + 1, owner)

    gather(0, 1, -1)
    inside = 0
    for i, point in enumerate(points):
        around = [b for b in boxes if (point >= b[0][0]).all() and (point <= b[0][1]).all()]
        if not around:
            assert found.numbers[i] == NOWHERE
            continue
        inside += 1
        deepest = max(b[2] for b in around)
        assert found.levels[i] == deepest
        (box,) = [b for b in around if b[1] == found.numbers[i]]
        sides = box[0][1] - box[0][0]
        told = found.levels[i], found.owners[i], bool(found.built[i]), found.held[i], found.widths[i]
        assert told == (deepest, *box[3:], min(sides[1], sides[2]))
    assert inside > 300 and found.numbers[0] == NOWHERE
    assert set(found.built[found.numbers >= 0]) == {0: {0, 1}, 2: {0, 1}, 400: {1}}[many]
    assert (found.held > 0).any() == (many > 0)


def test_a_few_primitives_far_away_do_not_widen_what_most_are_in() -> None:
    boxes = np.random.default_rng(2).uniform(-1.0, 1.0, (1000, 6)).astype(np.float32)
    boxes[:, 3:] = boxes[:, :3] + 0.1
    boxes[0] = -500.0, -500.0, 0.0, 500.0, 500.0, 0.0
    most = most_of(boxes, np.full(1000, 16))
    for k in range(3):
        low, high = np.sort(boxes[:, k]), np.sort(boxes[:, k + 3])
        assert (most[k], most[k + 3]) == (low[4], high[-5])
    assert (np.abs(most) < 1.2).all() and (most_of(boxes[:0], np.zeros(0)) == 0.0).all()
    world = tracer.World(made(), 0.3, "kdtree-lazy")
    extent, bounds = world.parts_built().extent, world.bounds()
    assert (extent[:3] >= bounds[:3]).all() and (extent[3:] <= bounds[3:]).all() and (extent[3:] > extent[:3]).all()

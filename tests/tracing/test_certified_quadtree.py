"""The ways down a quadtree, for one point and for sixteen, lead to the leaf whose place holds the point."""

from __future__ import annotations

import numpy as np

from tracer.neighbours.certified.quadtree import descend, part_of, place_of_part
from tracer.runtime.kernels import kernel
from tracer.simd import address_of, load_f32x16, load_i32x16, store

LEAF = -1


@kernel
def _descend(child, cell, u, v, leaves):
    """leaves (n,) below cells (n,), n a multiple of sixteen."""
    for first in range(0, len(cell), 16):
        at = 4 * first
        start, x, y = (
            load_i32x16(address_of(cell) + at),
            load_f32x16(address_of(u) + at),
            load_f32x16(address_of(v) + at),
        )
        store(address_of(leaves) + at, descend(address_of(child), start, x, y))


def _random_tree(rng: np.random.Generator, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """child (n,) int32 and place (n, 3) float32; cell 0 is none, cell 1 the root."""
    child, place = [LEAF, LEAF], [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    while len(child) < cells:
        number = int(rng.integers(1, len(child)))
        if child[number] == LEAF:
            child[number] = len(child)
            u, v, size = (np.float32(x) for x in place[number])
            place += [place_of_part.py_func(u, v, size, part) for part in range(4)]
            child += [LEAF] * 4
    return np.array(child, np.int32), np.array(place, np.float32)


def test_one_point_and_sixteen_find_the_leaf_that_holds_them() -> None:
    rng = np.random.default_rng(4)
    child, place = _random_tree(rng, 400)
    u, v = rng.dirichlet((1, 1, 1), 4096).astype(np.float32).T[:2].copy()
    u[:1024], v[:1024] = (rng.integers(0, 17, (2, 1024)) / 16).astype(np.float32)  # on edges and corners of cells
    v[:1024] = np.minimum(v[:1024], 1 - u[:1024])
    found = np.empty(len(u), np.int32)
    _descend(child, np.ones(len(u), np.int32), u, v, found)
    for k, leaf in enumerate(found.tolist()):
        cell, x, y = 1, float(u[k]), float(v[k])
        while child[cell] > LEAF:
            part, x, y = part_of.py_func(x, y)
            cell = int(child[cell]) + part
        assert cell == leaf
        at_u, at_v, size = place[leaf].tolist()
        inside = (u[k] - at_u) / size, (v[k] - at_v) / size
        assert min(*inside, 1 - sum(inside)) >= -1e-6
    large = np.flatnonzero((child == LEAF) & (np.abs(place[:, 2]) >= 1 / 8))
    assert len(large) > 10 and set(large.tolist()) <= set(found.tolist())

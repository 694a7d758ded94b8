"""Frusta: what one refuses every one of its rays refuses, to the last bit, however the rays and boxes are made."""

from __future__ import annotations

import numpy as np
import pytest

from tests.sweeps import ALL
from tracer.geometry.bvh8.packet import MEMORY, fill, lanes_inside, open_vectors
from tracer.geometry.bvh8.packet_group import box_at, boxes_at, entering, frusta_of, group_of, lead_of, reaches_of
from tracer.geometry.bvh8.placed import child_planes
from tracer.geometry.queries import batch_of
from tracer.geometry.rays import Rays, ray_batch
from tracer.runtime.kernels import kernel
from tracer.simd import address_of, any_lane, bits_of, largest, local_memory, lowest_bit

RAYS = 128


@kernel
def _refusals(batch, count, boxes, found):
    """Into found (5,) int64: vectors grouped; pairs of a vector and a box that some ray enters; of these, refused by
    the vector's frustum, and boxes refused by the packet's; and pairs that no ray enters and the frustum refuses.

    boxes (n, 64) float32 are nodes, eight boxes each."""
    memory = local_memory(MEMORY)
    vectors, _low, _high, finite = fill(memory, batch, 0, count)
    todo = open_vectors(memory, vectors)
    while todo != 0:
        v = lowest_bit(todo)
        axis, way, together = lead_of(memory, v)
        if not (finite and together):
            todo &= todo - 1
            continue
        group = group_of(memory, todo, axis, way)
        todo &= ~group.vectors
        for n in range(len(boxes)):
            node = address_of(boxes) + 256 * n
            _enter, mask = entering(boxes_at(node, group.axes), group.frustum, largest(reaches_of(memory)))
            opened = bits_of(mask)
            for c in range(8):
                box = node + 4 * c
                _enter, mask = entering(box_at(box, group.axes), frusta_of(memory), reaches_of(memory))
                entered = bits_of(mask)
                rest = group.vectors
                while rest != 0:
                    v = lowest_bit(rest)
                    rest &= rest - 1
                    enter, leave = lanes_inside(None, memory, v, child_planes(box))
                    refused = ((entered >> v) & 1) == 0
                    found[0] += c == 0 and n == 0
                    if any_lane(enter <= leave):
                        found[1] += 1
                        found[2] += refused
                        found[3] += ((opened >> c) & 1) == 0
                    else:
                        found[4] += refused


def _company(rng: np.random.Generator, kind: str) -> Rays:
    """RAYS rays that spread a little, from one point or from many, of all lengths."""
    spread, scale = 10.0 ** rng.uniform(-5, 0), 10.0 ** rng.uniform(-3, 3)
    main = rng.normal(size=3) * rng.choice([1.0, 1.0, 1e-4, 0.0], 3)
    main[rng.integers(3)] += rng.choice([-1.0, 1.0])
    directions = main + spread * rng.uniform(-1, 1, (RAYS, 3))
    directions[rng.random((RAYS, 3)) < 0.05] = 0.0  # along planes
    directions[np.abs(directions).max(axis=1) == 0] = main
    origins = scale * rng.uniform(-1, 1, 3) + (scale * spread * rng.uniform(-1, 1, (RAYS, 3)) if kind == "apart" else 0)
    directions *= 10.0 ** rng.uniform(-12, 12) * 10.0 ** rng.uniform(-1, 1, (RAYS, 1))
    ends = np.where(rng.random(RAYS) < 0.5, np.inf, 10.0 ** rng.uniform(-3, 3, RAYS))
    return ray_batch(np.broadcast_to(origins, (RAYS, 3)), directions, 10.0 ** rng.uniform(-6, -2), ends)


def _boxes(rng: np.random.Generator, rays: Rays, count: int) -> np.ndarray:
    """Nodes (count, 64) of boxes that rays graze: corners lie on rays, or a few ulps beside them."""
    which = rng.integers(RAYS, size=(count, 8))
    t = 10.0 ** rng.uniform(-3, 3, (count, 8, 1)) / np.linalg.norm(rays.direction.T[which], axis=2, keepdims=True)
    corner = (rays.origin.T[which] + t * rays.direction.T[which]).astype(np.float32)
    for _ in range(2):
        corner = np.where(
            rng.random(corner.shape) < 0.3, np.nextafter(corner, np.float32(rng.choice([-1e9, 1e9]))), corner
        )
    size = (10.0 ** rng.uniform(-5, 2, corner.shape) * (rng.random(corner.shape) < 0.9)).astype(np.float32)
    other = corner + rng.choice([-1, 1], corner.shape).astype(np.float32) * size
    nodes = np.zeros((count, 64), np.float32)
    both = np.stack([np.minimum(corner, other), np.maximum(corner, other)], axis=1)  # count, 2, 8, 3
    nodes[:, :48] = both.transpose(0, 1, 3, 2).reshape(count, 48)
    return nodes


@pytest.mark.skipif(not ALL, reason="left to make test-all: answers are held against those of every leaf")
@pytest.mark.parametrize("kind", ["from one point", "apart"])
def test_what_a_frustum_refuses_all_its_rays_refuse(kind: str):
    rng, found = np.random.default_rng(5), np.zeros(5, np.int64)
    for _ in range(400):
        rays = _company(rng, kind)
        batch = batch_of(rays)  # which has to live as long as its address is used
        _refusals(batch.ctypes.data, RAYS, _boxes(rng, rays, 16), found)
    grouped, pairs, wrong, wrong_whole, refused = found.tolist()
    assert grouped > 1000 and pairs > 30_000 and refused > 10_000
    assert wrong == 0 and wrong_whole == 0

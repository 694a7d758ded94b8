"""An occluder cache: what blocked the light before is asked first (Haines and Greenberg 1986).

Neighbouring points are shadowed by the same triangle as a rule.  So for every primitive and light, and
at large primitives for every small range of directions in which the light sees them, the last occluder is
kept.  A shadow ray is tested against that; only where it does not surely block the ray, the trees are
asked.  Cells of a primitive share what is kept: the light cannot tell them apart.
For comparison, a slot can also hold the last occluder of a light in a range of directions, whatever the primitive
(theirs), or in a whole tile of the picture (Wald 2004).
The slots are a hash table of fixed size: where two want the same, one is forgotten, which costs a test.
Slots are read as the last frame left them.  Of what workers find for the next frame, the occluder of the
highest number is kept, so that pictures and counters are the same for any number of threads.

The picture is that of the method without a cache, bit for bit, and so a cached occluder counts only where
the trees themselves would report it, or another.  In the notation of `tracer.geometry.intersect`, s from
corner to light, e1 and e2 the edges, d the ray, let a "volume" be one of the triple products that the
intersectors compare.  Computed in float32, and in any order, a volume of vectors a, b, c is wrong by at most
5 roundings (2^-24) of |a| |b| |c|, measured by sums of absolute coordinates.  Here and there together these
are 10, the sum that makes the third side of the triangle bears three such errors, and the divisions add a
few roundings of the greatest volume: 32 roundings of all products that occur bound everything.  Where
all comparisons hold by that much:

- `hit_triangle` makes them all the same way.  The kd-tree leads the ray to the triangle, too: it might
  pass a leaf by only where it runs along an edge of the leaf, nearer than 3 roundings to two of its
  planes, neither of which the triangle reaches through; but the hit lies 32 roundings inside the triangle,
  which cannot be flat against both.
- The 8-wide trees make the same comparisons with the same operations as the test here does, only less
  strictly.  They ask besides that the hit lies in the box of the triangle's block.  The box of the
  triangle alone, made larger by as much as theirs at most, lies in that one, and as rounding is monotone, a
  hit that is computed to lie in the smaller box is so in the larger.

Only triangles that never move are cached.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.counters import CACHE_HITS, TESTS
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.stages import vectors
from tracer.geometry.boxes import PADDING, inverse
from tracer.geometry.rays import MISS
from tracer.geometry.triangle_test import Triangle, crossing, terms_of
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import (
    address_of,
    as_f32,
    as_i32,
    bits_of,
    gather_f32x16,
    gather_i32x16,
    i32x16,
    load_i32x16,
    load_three,
    lowest_bit,
    maximum,
    minimum,
    ones,
    select,
    size_of,
    store,
    to_i32,
)

SLOTS = 1 << 20  # 4 MB, and as much again for each worker
DIRECTIONS = np.float32(64)  # ranges of directions along half an edge of a cube around the light
ROUNDINGS = np.float32(32 * 2.0**-24)
SMALLEST, LARGEST = np.float32(1e-30), np.float32(1e12)  # volumes and lengths outside of which float32 may lose more
ZERO, ONE = np.float32(0), np.float32(1)


class SlotKey(NamedTuple):
    """What a slot is found by besides the light, 1 for yes: the primitive, the range of directions in which the light
    sees the point, and the tile of the picture."""

    primitive: int
    direction: int
    tile: int


class OccluderSlots:
    """The slots of a scene whose first `static` triangles of (t, 9) never move: occluders (SLOTS,) int32 as the last
    frame left them, MISS for none, and found (workers, SLOTS) for the next.

    `padding` is by how much the boxes of the 8-wide trees are larger than those of triangles, at least."""

    def __init__(self, triangles: NDArray[np.float32], static: int) -> None:
        corner, *edges = np.split(triangles[:static], 3, axis=1)
        extent = max(float(np.abs(part).max(initial=0.0)) for part in (corner, *(corner + edge for edge in edges)))
        self.static, self.padding = static, float(np.float32(PADDING * np.float32(extent)))
        self.occluders = np.full(SLOTS, MISS, np.int32)
        self.found = np.full((0, SLOTS), MISS, np.int32)

    def make_room(self, workers: int) -> None:
        """For what so many workers find."""
        if len(self.found) < workers:
            self.found = np.full((workers, SLOTS), MISS, np.int32)

    def keep_found(self) -> None:
        """Put what has been found into its slots, for the next frame; what this frame has read stays as it was."""
        self.occluders = self.occluders.copy()
        merge_occluders(self.occluders, self.found)

    def discard_found(self) -> None:
        """Drop what an unfinished frame has found."""
        self.found[:] = MISS


@kernel
def merge_occluders(occluders, found):
    """Put what each worker has found, (workers, slots), in its slot, of several the highest number, and clear it."""
    for worker in range(1, len(found)):
        for slot in range(len(occluders)):
            found[0, slot] = max(found[0, slot], found[worker, slot])
            found[worker, slot] = MISS
    for slot in range(len(occluders)):
        occluders[slot] = found[0, slot] if found[0, slot] != MISS else occluders[slot]
        found[0, slot] = MISS


@inlined
def _range_of(x, scale):
    """Number of the range that a coordinate falls into, from 0 on; any where it is no number."""
    return to_i32(minimum(maximum(x * scale + DIRECTIONS, ZERO), DIRECTIONS + DIRECTIONS))


@inlined
def slots_of(key, tile, points, v, direction, number):
    """Slots of the v-th vector of points of a tile, seen from light `number` in these directions, by a `SlotKey`."""
    x, y, z = direction
    of_primitive, of_direction, of_tile = np.int32(key.primitive), np.int32(key.direction), np.int32(key.tile)
    scale = DIRECTIONS / maximum(maximum(maximum(x, -x), maximum(y, -y)), maximum(maximum(z, -z), SMALLEST))
    primitive = load_i32x16(address_of(points.primitive) + 64 * v)
    mixed = primitive * (of_primitive * np.int32(0x1E3779B1)) + np.int32(0x3C6EF372) * np.int32(number + 1)
    mixed = mixed + of_tile * np.int32(0x165667B1) * np.int32(tile + 1)
    mixed = mixed + _range_of(x, scale) * (of_direction * np.int32(0x05EBCA77))
    mixed = mixed + _range_of(y, scale) * (of_direction * np.int32(0x2B2AE3D3))
    mixed = mixed + _range_of(z, scale) * (of_direction * np.int32(0x27D4EB2F))
    mixed = (mixed ^ (mixed >> np.int32(15))) * np.int32(0x2C1B3C6D)
    return (mixed ^ (mixed >> np.int32(13))) & np.int32(SLOTS - 1)


@inlined
def _in_slab(light, direction, t, a, e1, e2, padding):
    """In which lanes the place at t is computed to lie between a triangle's least and greatest coordinate on an axis,
    these moved apart by the padding; by the operations that a block's box is made and entered with."""
    b, c, backwards = a + e1, a + e2, inverse(direction)
    low, high = minimum(a, minimum(b, c)) + -padding, maximum(a, maximum(b, c)) + padding
    first, second = (low - light) * backwards, (high - light) * backwards
    return (t >= minimum(first, second)) & (t <= maximum(first, second))


@subkernel
def surely_blocked(triangles, light, direction, t_min, numbers, padding):
    """Mask of those rays from the light (3,) to its `direction`s at t = 1, from t_min on, that the trees would report
    as blocked by triangles (t, 9) of these numbers, or others."""
    first, at = numbers * np.int32(9), address_of(triangles)
    a = gather_f32x16(at, first), gather_f32x16(at + 4, first), gather_f32x16(at + 8, first)
    e1 = gather_f32x16(at + 12, first), gather_f32x16(at + 16, first), gather_f32x16(at + 20, first)
    e2 = gather_f32x16(at + 24, first), gather_f32x16(at + 28, first), gather_f32x16(at + 32, first)
    terms = terms_of(light[0], light[1], light[2], Triangle(a[0], a[1], a[2], e1[0], e1[1], e1[2], e2[0], e2[1], e2[2]))
    crosses, sign, u, v, area = crossing(direction[0], direction[1], direction[2], terms)
    height = as_f32(as_i32(terms.height) ^ sign)
    ray, edge = size_of(direction), maximum(size_of(e1), size_of(e2))
    away = size_of((light[0] - a[0], light[1] - a[1], light[2] - a[2]))
    margin = maximum(ROUNDINGS * edge * (ray * edge + away * ray + away * edge), SMALLEST)
    sure = (
        crosses & (u > margin) & (v > margin) & (area - u - v > margin) & (maximum(edge, maximum(ray, away)) < LARGEST)
    )
    sure = sure & (height - t_min * area > margin) & (area - height > margin)
    t = height * (ONE / area)
    inside = _in_slab(light[0], direction[0], t, a[0], e1[0], e2[0], padding)
    inside = inside & _in_slab(light[1], direction[1], t, a[1], e1[1], e2[1], padding)
    inside = inside & _in_slab(light[2], direction[2], t, a[2], e1[2], e2[2], padding)
    return sure & inside & (t > t_min) & (t < ONE)


@subkernel
def test_slots(cache, tile, points, light, number, count, batch, slots, counts):
    """Test the points that are to be traced against what blocked their light before; `slots` (n,) get theirs."""
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live == 0:
            continue
        x, y, z = load_three(points.lifted, v)
        direction = x - light[0], y - light[1], z - light[2]
        mine = slots_of(cache, tile, points, v, direction, number)
        store(address_of(slots) + 64 * v, mine)
        known = gather_i32x16(address_of(cache.occluders), mine)
        there = known > np.int32(MISS)
        tested = bits_of(there) & live
        if tested == 0:
            continue
        names, padding = select(there, known, i32x16(0)), np.float32(cache.padding)
        hit = bits_of(surely_blocked(cache.triangles, light, direction, LIGHT_MARGIN, names, padding)) & tested
        counts[TESTS] += ones(tested)
        counts[CACHE_HITS] += ones(hit)
        batch.cached[v] |= hit
        batch.live[v] = live & ~hit


@subkernel
def remember(cache, slots, count, batch):
    """Note for the next frame what static geometry has blocked the traced rays."""
    n = np.int64(0)
    for v in range(vectors(count)):
        asked = np.int64(batch.live[v])
        blocked = asked & ~np.int64(batch.unblocked[v])
        last = np.int32(MISS), np.int32(MISS)
        while blocked != 0:
            lane = lowest_bit(blocked)
            blocked &= blocked - 1
            this = slots[16 * v + lane], batch.occluders[n + ones(asked & ((1 << lane) - 1))]
            if this != last and this[1] < cache.static:
                cache.found[this[0]] = max(cache.found[this[0]], this[1])
            last = this
        n += ones(asked)

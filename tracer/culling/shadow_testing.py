"""Shadow testing (§2.4 of the paper): which points does a light reach?

A shadow ray is *due* where the light is on the viewer's side of the surface.  Then, for the points of a wave:

1. the stages of the method choose which of the due rays they can answer (`tracer.culling.stages`);
2. rays that static geometry is known to leave unblocked ask dynamic objects alone;
3. all others ask static geometry and, where nothing static blocks the light, dynamic objects;
4. the stages learn from the answers (§2.5).

Shadow rays start at the light.  They end a little above the surface (`lifted`), so that it does not shadow itself.

Points come in vectors of sixteen.  Rays are packed, so that batches shrink with what is not due and what is culled;
what is found is kept as bits, one for each point.  Once the due rays are found, only vectors that have
any are gone through: `active` of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import CULLED, DUE, DYNAMIC_ONLY, PASSED_OVER, RAYS, WRONG
from tracer.culling.modes import FULL_SHADOW, FULLY_RENDERED, NON_SHADOW, occlusion_modes, shadow_modes
from tracer.culling.stages import CHOOSE, LEARN, looked_at, looks_at, run_stages, vectors
from tracer.geometry.boxes import segments_miss_box
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING, STATIC_GEOMETRY, any_hits, any_hits_by
from tracer.geometry.rays import Rays
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    lanes_below,
    load_spread_bytes16,
    load_three,
    mask16,
    maximum,
    ones,
    pack_three,
    store,
    store_three,
)
from tracer.simd.records import IntRow, Memory, Row, Row3, row_count, rows_of

LIGHT_MARGIN = np.float32(1e-5)  # of the way from the light: what lies nearer to it is the lamp itself
ROUNDED = np.float32(1e-5)  # of coordinates
ZERO, ONE = np.float32(0), np.float32(1)


class ShadowBatch(NamedTuple):
    """The shadow rays of n points to one light: rows of `memory` (SHADOW_ROWS, n) float32.

    Sets of points are bits of int32, sixteen points a number, in the first n / 16 numbers of a row:

    - due: the light is on the viewer's side of the surface;
    - live: nothing is known yet, so that the trees are to be asked;
    - unblocked: due, and no static geometry is in the way;
    - settled: due, and dynamic objects need not be asked any more;
    - candidates: answered by a few static primitives, which were tested in the place of all;
    - cached: blocked by what blocked a light before;
    - lit: due, and nothing is in the way: the answer that shading uses;
    - truth: the same by tracing every due ray, where answers are verified.

    `active` are the numbers of those vectors of sixteen in which any ray is due, in the first numbers of the row.

    Rays that are traced are packed, one after the other: origin and direction (3, n), t_min and t_max (n,); `blocked`
    has a byte for each, and `occluders` (n,) what blocks it, where somebody wants to know.  `asked` are the bits of
    the points whose rays these are."""

    memory: Memory
    origin: Row3
    direction: Row3
    t_min: Row
    t_max: Row
    due: IntRow
    live: IntRow
    unblocked: IntRow
    settled: IntRow
    candidates: IntRow
    cached: IntRow
    lit: IntRow
    truth: IntRow
    active: IntRow
    asked: IntRow
    blocked: Row
    occluders: IntRow


shadow_batch_in = rows_of(ShadowBatch)
SHADOW_ROWS = row_count(ShadowBatch)


@subkernel
def shadow_testing(world, points, count, light, number, stages, call, batch, counts):
    """Which of `count` points are due to light `number` at light (3,), and which does it reach?  Into the batch."""
    looked, everything = looked_at(stages.looks, number, count), number < stages.everything
    active = _find_due(points, light, count, looked, everything, batch, counts)
    run_stages(stages, CHOOSE, call, number, count, counts)
    _ask_dynamic(world, points, light, active, batch, counts)
    _trace_live(world, points, light, active, stages.occluders, batch, counts)
    run_stages(stages, LEARN, call, number, count, counts)
    if stages.verify:
        _verify(world, points, light, count, active, batch, counts)


@inlined
def faces(points, light, v):
    """Bits of the points whose surface faces the light."""
    px, py, pz = load_three(points.position, v)
    gx, gy, gz = load_three(points.geometric, v)
    return bits_of(gx * (light[0] - px) + gy * (light[1] - py) + gz * (light[2] - pz) > ZERO)


@inlined
def may_face(points, light, radius, v):
    """Bits of the points whose surface may face some place of a ball around the light: of no others a ray is due."""
    px, py, pz = load_three(points.position, v)
    gx, gy, gz = load_three(points.geometric, v)
    x, y, z = light[0] - px, light[1] - py, light[2] - pz
    far = maximum(x, -x) + maximum(y, -y) + maximum(z, -z) + (abs(light[0]) + abs(light[1]) + abs(light[2]))
    return bits_of(gx * x + gy * y + gz * z > -(np.float32(1.001) * radius + ROUNDED * far))


@subkernel
def _find_due(points, light, count, looked, everything, batch, counts):
    """Find the rays that are due, about which nothing is known yet; how many vectors have any.

    Vectors that need not look at the light (`looks_at`) are passed over, or culled where one asks for everything."""
    active = 0
    for v in range(vectors(count)):
        batch.lit[v] = batch.settled[v] = batch.unblocked[v] = batch.candidates[v] = batch.cached[v] = 0
        looks, there = looks_at(looked, v), lanes_below(count, v)
        if not looks and not everything:
            batch.due[v] = batch.live[v] = 0
            counts[PASSED_OVER] += ones(there)
            continue
        due = faces(points, light, v) & there
        batch.due[v] = due
        batch.live[v] = due if looks else 0
        counts[DUE] += ones(due)
        counts[CULLED] += 0 if looks else ones(due)
        batch.active[active] = v
        active += due != 0
    return active


@inlined
def classify_by_modes(modes, light, v):
    """Return bits of those of sixteen points whose shadow rays can be skipped, as they are blocked, and of those whose
    rays ask dynamic objects only (§2.4); modes are `PointModes` that have been looked up."""
    seen_whole, shadow = occlusion_modes(modes, v) == FULLY_RENDERED, shadow_modes(modes, light, v)
    return bits_of(seen_whole & (shadow == FULL_SHADOW)), bits_of(seen_whole & (shadow == NON_SHADOW))


@inlined
def answer(batch, v, skip, dynamic_only, counts):
    """Take points out of those that are to be traced, and count them: their rays are known to be blocked, or to meet
    nothing static."""
    live = np.int64(batch.live[v])
    batch.live[v] = live & ~(skip | dynamic_only)
    batch.lit[v] |= live & dynamic_only
    counts[CULLED] += ones(live & skip)
    counts[DYNAMIC_ONLY] += ones(live & dynamic_only)


@subkernel
def _ask_dynamic(world, points, light, active, batch, counts):
    """Note what is known to be lit by all that is static, and ask dynamic objects alone about it."""
    # Take note of what static geometry leaves unblocked, and of what is to be asked.
    some = np.int64(0)
    for a in range(active):
        v = batch.active[a]
        lit = np.int64(batch.lit[v])
        batch.unblocked[v] = lit
        batch.asked[v] = lit & ~np.int64(batch.settled[v])
        some |= np.int64(batch.asked[v])
    if some == 0 or not world.has_dynamic:
        return
    # Rays that miss the box around all that moves have their answer already.
    for a in range(active):
        v = batch.active[a]
        asked = np.int64(batch.asked[v])
        counts[RAYS] += ones(asked)
        batch.asked[v] = 0 if asked == 0 else asked & _towards(world.moving_box, points, light, v)
    _trace(world, points, light, active, batch.asked, DYNAMIC_OBJECTS, batch, counts)
    _drop_blocked(batch.lit, batch.asked, active, batch)


@subkernel
def _trace_live(world, points, light, active, occluders, batch, counts):
    """Ask everything about the points of which nothing is known."""
    n = _rays_from_light(points, light, active, batch.live, batch)
    counts[RAYS] += n
    if n == 0:
        return
    if occluders:
        any_hits_by(world, shadow_rays(batch), EVERYTHING, batch.blocked, batch.occluders, 0, n, counts)
    else:
        any_hits(world, shadow_rays(batch), EVERYTHING, batch.blocked, 0, n, counts)
    # Spread the answers of the packed rays to their points.
    n = 0
    for a in range(active):
        v = batch.active[a]
        asked = np.int64(batch.live[v])
        if asked == 0:
            continue
        blocked, for_good = _blocked(batch, asked, n)
        batch.lit[v] |= asked & ~blocked
        batch.unblocked[v] |= asked & ~for_good
        n += ones(asked)


@subkernel
def _verify(world, points, light, count, active, batch, counts):
    """Trace every due ray, its steps uncounted, and count the answers that differ."""
    uncounted = np.zeros(RAYS, np.int64)  # steps and tests
    for v in range(vectors(count)):
        batch.truth[v] = batch.due[v]
    _trace(world, points, light, active, batch.due, EVERYTHING, batch, uncounted)
    _drop_blocked(batch.truth, batch.due, active, batch)
    for a in range(active):
        v = batch.active[a]
        counts[WRONG] += ones(np.int64(batch.truth[v] ^ batch.lit[v]))


@inlined
def shadow_rays(batch):
    """The batch's rays, as queries take them."""
    return Rays(batch.origin, batch.direction, batch.t_min, batch.t_max)


@inlined
def pack_ways(points, light, v, lanes, batch, n):
    """Put the ways from the light to those points of a vector that the bits `lanes` name into the batch, behind n that
    are there already; how many there are then."""
    if lanes == 0:
        return n
    x, y, z = load_three(points.lifted, v)
    way = pack_three((x - light[0], y - light[1], z - light[2]), mask16(lanes))
    store_three(address_of(batch.direction) + 4 * n, 4 * batch.origin.shape[1], way)
    return n + ones(lanes)


@inlined
def begin_at(light, n, batch):
    """Let the first n rays of the batch begin at the light and end where their ways do, at t = 1."""
    stride = 4 * batch.origin.shape[1]
    for at in range(0, 4 * n, 64):
        store_three(address_of(batch.origin) + at, stride, (f32x16(light[0]), f32x16(light[1]), f32x16(light[2])))
        store(address_of(batch.t_min) + at, f32x16(LIGHT_MARGIN))
        store(address_of(batch.t_max) + at, f32x16(ONE))


@subkernel
def _rays_from_light(points, light, active, bits, batch):
    """Pack the shadow rays from the light to the points that `bits` names; how many there are."""
    n = 0
    for a in range(active):
        v = batch.active[a]
        n = pack_ways(points, light, v, np.int64(bits[v]), batch, n)
    begin_at(light, n, batch)
    return n


@inlined
def _trace(world, points, light, active, bits, which, batch, counts):
    """Ask `which` geometry is between the light and the points that `bits` names."""
    n = _rays_from_light(points, light, active, bits, batch)
    if n > 0:
        any_hits(world, shadow_rays(batch), which, batch.blocked, 0, n, counts)


@inlined
def _blocked(batch, asked, n):
    """Bits of those lanes, of the bits `asked`, whose rays, from the n-th on, anything blocks; and something static."""
    found = load_spread_bytes16(address_of(batch.blocked) + n, mask16(asked))
    return bits_of(found > 0), bits_of(found == STATIC_GEOMETRY)


@inlined
def _drop_blocked(bits, asked, active, batch):
    """Clear the bits of those points, of the bits `asked`, whose rays were blocked."""
    n = 0
    for a in range(active):
        v = batch.active[a]
        lanes = np.int64(asked[v])
        blocked, _ = _blocked(batch, lanes, n)
        bits[v] &= ~blocked
        n += ones(lanes)


@inlined
def _towards(box, points, light, v):
    """Bits of the points of a vector between which and the light a box (6,) may lie.

    The box is made larger by more than roundings, so that none is left out that a tree with this box at its root would
    let in."""
    x, y, z = load_three(points.lifted, v)
    rx, ry, rz = (
        ROUNDED * (abs(light[0]) + abs(box[0]) + abs(box[3])),
        ROUNDED * (abs(light[1]) + abs(box[1]) + abs(box[4])),
        ROUNDED * (abs(light[2]) + abs(box[2]) + abs(box[5])),
    )
    low, high = (box[0] - rx, box[1] - ry, box[2] - rz), (box[3] + rx, box[4] + ry, box[5] + rz)
    return bits_of(~segments_miss_box(light, (x - light[0], y - light[1], z - light[2]), low, high))

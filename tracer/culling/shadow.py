"""Shadow testing and shadow-mode setting (§2.4 and §2.5 of the paper).

A shadow ray is *due* where the light is on the viewer's side of the surface.  What its primitive
is known to be, as the last frame left it, decides the ray's fate:

- FULLY_RENDERED and FULL_SHADOW: culled, the point is in shadow;
- FULLY_RENDERED and NON_SHADOW: dynamic objects alone are asked;
- anything else: static geometry is asked and, where nothing static blocks the light, dynamic objects
  are; what static geometry answers is OR-ed into the shadow mode.  Where there is an occluder cache, it
  is asked before (`tracer.culling.cache`).

Shadow rays start at the light.  They end a little above the surface (`lifted`), so that it does not
shadow itself.

Points come in vectors of sixteen.  Rays are packed, so that batches shrink with what is not due and
what is culled; what is found is kept as bits, one for each point.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.cache import Cache, occluders_in, remember, slots_of, surely_blocked
from tracer.culling.certified.candidates import ask_candidates
from tracer.culling.certified.lookup import Certified
from tracer.culling.modes import DYNAMIC, FULL_SHADOW, FULLY_RENDERED, MAX_CULLED_LIGHTS, NON_SHADOW, add_shadow
from tracer.geometry.bvh8.packet import segments_miss_box
from tracer.geometry.queries import DYNAMIC as MOVING
from tracer.geometry.queries import STATIC, any_hits, any_hits_by
from tracer.geometry.rays import MISS
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    gather_i32x16,
    i32x16,
    lane_numbers_x16,
    lanes_below,
    load_i32x16,
    load_spread_bytes16,
    load_three,
    lowest_bit,
    mask16,
    ones,
    pack,
    pack_three,
    select,
    store,
    store_three,
)

# Shadow counters; the first two are those that queries add to.
STEPS, TESTS, RAYS, DUE, CULLED, DYNAMIC_ONLY, CANDIDATES_ONLY, CACHE_HITS, WRONG = range(9)
SHADOW_COUNTERS = 9

LIGHT_MARGIN = np.float32(1e-5)  # of the way from the light: what lies nearer to it is the lamp itself
ROUNDED = np.float32(1e-5)  # of coordinates
ZERO, ONE = np.float32(0), np.float32(1)


class Knowledge(NamedTuple):
    """What culling goes by: words (units,) as the last frame left them, what this worker gains for the next, of the
    same shape; the first unit of each primitive (p + 1,), or nothing where primitives are the units; whether to cull
    by the words, to learn from rays, and to verify what was culled; whether units are certified cells; and the
    occluder cache."""

    words: NDArray[np.unsignedinteger]
    gained: NDArray[np.unsignedinteger]
    first: NDArray[np.int32]
    cull: bool
    learn: bool
    verify: bool
    certify: bool
    certified: Certified
    cache: Cache


@inlined
def _look_up(points, v, knowledge, answers):
    """Put the words of the v-th vector of points side by side, once for all lights."""
    if answers.looked_up[v]:
        return
    answers.looked_up[v] = 1
    words, at = address_of(knowledge.words), 64 * v
    unit = load_i32x16(address_of(points.unit) + at)
    if knowledge.words.itemsize == 4:
        store(address_of(answers.low) + at, gather_i32x16(words, unit))
    else:
        store(address_of(answers.low) + at, gather_i32x16(words, unit << np.int32(1)))
        store(address_of(answers.high) + at, gather_i32x16(words + 4, unit << np.int32(1)))


@inlined
def _due(points, light, v):
    """Bits of the points whose surface faces the light."""
    px, py, pz = load_three(points.position, v)
    gx, gy, gz = load_three(points.geometric, v)
    return bits_of(gx * (light[0] - px) + gy * (light[1] - py) + gz * (light[2] - pz) > ZERO)


@inlined
def _words(answers, number, v):
    """Words of the v-th vector of points, the halves of them that hold a light's modes, and by how many bits in."""
    word = load_i32x16(address_of(answers.low) + 64 * v)
    field = word if 2 + 2 * number < 32 else load_i32x16(address_of(answers.high) + 64 * v)
    shift = (2 + 2 * number) % 32
    return word, field, shift


@inlined
def _known(answers, number, v):
    """Bits of the points that are known to be in full shadow, and of those known to be in none."""
    word, field, shift = _words(answers, number, v)
    trusted = (word & 3) == FULLY_RENDERED
    field = field & np.int32(3 << shift)
    return (
        bits_of(trusted & (field == np.int32(FULL_SHADOW << shift))),
        bits_of(trusted & (field == np.int32(NON_SHADOW << shift))),
    )


@subkernel
def _choose_fates(points, light, number, knowledge, count, answers, counts):
    """What is due, and what of it is known: answers.lit is what is known to be lit, live what is to be asked."""
    vectors, asked = (count + 15) // 16, np.int64(0)
    for v in range(vectors):
        due = _due(points, light, v) & lanes_below(count, v)
        full, non = np.int64(0), np.int64(0)
        if knowledge.cull and number < MAX_CULLED_LIGHTS and due != 0:
            _look_up(points, v, knowledge, answers)
            full, non = _known(answers, number, v)
        answers.due[v], answers.lit[v], answers.live[v] = due, due & non, due & ~(full | non)
        counts[DUE] += ones(due)
        counts[CULLED] += ones(due & full)
        counts[DYNAMIC_ONLY] += ones(due & non)
        if knowledge.certify and answers.live[v] != 0:
            asked = _note_candidates(number, knowledge.certified, answers, v, asked)
    if asked > 0:
        certified, live, lit = knowledge.certified, answers.live, answers.lit
        known, tests = ask_candidates(
            certified, points, light, number, answers.asked, asked, answers.questions, live, lit
        )
        counts[CANDIDATES_ONLY] += known
        counts[TESTS] += tests


@inlined
def _note_candidates(number, certified, answers, v, asked):
    """Note which certificates are wanting at the live points of a vector, and those that have candidates in
    answers.asked, where there are so many of others; how many there are."""
    if number >= len(certified.still) or not certified.still[number]:
        return asked
    live = np.int64(answers.live[v])
    _, field, shift = _words(answers, number, v)
    field = field & np.int32(3 << shift)
    some = bits_of(field == np.int32(3 << shift)) & live
    answers.untried[v] |= live & ~some
    answers.doubtful[v] |= some
    if certified.asked > 0 and answers.asks:
        which = lane_numbers_x16() + np.int32(16 * v)
        store(address_of(answers.asked) + 4 * asked, pack(which, mask16(some)))
        asked += ones(some)
    return asked


@subkernel
def _rays_from_light(points, light, vectors, bits, answers):
    """Shadow rays, from the light to the points that `bits` names, one after the other; how many there are.

    At t = 1 is the point."""
    rays = answers.rays
    stride, n = 4 * rays.origin.shape[1], 0
    for v in range(vectors):
        live = np.int64(bits[v])
        if live == 0:
            continue
        x, y, z = load_three(points.lifted, v)
        direction = pack_three((x - light[0], y - light[1], z - light[2]), mask16(live))
        store_three(address_of(rays.direction) + 4 * n, stride, direction)
        n += ones(live)
    for at in range(0, 4 * n, 64):
        store_three(address_of(rays.origin) + at, stride, (f32x16(light[0]), f32x16(light[1]), f32x16(light[2])))
        store(address_of(rays.t_min) + at, f32x16(LIGHT_MARGIN))
        store(address_of(rays.t_max) + at, f32x16(ONE))
    return n


@inlined
def _ask(world, points, light, vectors, bits, which, answers, counts):
    """Ask `which` geometry is between the light and the points that `bits` names, into answers.blocked, one after
    the other (`_blocked`); how many they are."""
    n = _rays_from_light(points, light, vectors, bits, answers)
    if n > 0:
        any_hits(world, answers.rays, which, answers.blocked, 0, n, counts)
    return n


@inlined
def _blocked(answers, asked, n):
    """Bits of those lanes, of the bits `asked`, whose rays, from the n-th on, anything blocks; and something static."""
    found = load_spread_bytes16(address_of(answers.blocked) + n, mask16(asked))
    return bits_of(found > 0), bits_of(found == STATIC)


@subkernel
def _learn(points, v, number, knowledge, answers, asked, blocked):
    """OR what rays have met into the shadow modes of their primitives, where it is news."""
    word, field, shift = _words(answers, number, v)
    moves = bits_of((word & 3) == DYNAMIC)
    seen_blocked = bits_of((field & np.int32(FULL_SHADOW << shift)) == 0)
    seen_free = bits_of((field & np.int32(NON_SHADOW << shift)) == 0)
    news = asked & ~moves & ((blocked & seen_blocked) | (~blocked & seen_free))
    while news != 0:
        lane = lowest_bit(news)
        news &= news - 1
        mode = FULL_SHADOW if (blocked >> lane) & 1 else NON_SHADOW
        add_shadow(knowledge.gained, points.unit[16 * v + lane], number, mode)


@inlined
def _take_blocked(bits, asked, vectors, answers):
    """Clear the bits (vectors,) of points, of those `asked` about, whose rays were blocked."""
    n = 0
    for v in range(vectors):
        lanes = np.int64(asked[v])
        blocked, _ = _blocked(answers, lanes, n)
        bits[v] &= ~blocked
        n += ones(lanes)


@subkernel
def _ask_about_known(world, points, light, vectors, answers, counts):
    """Ask dynamic objects alone about the points that are known to be lit by all that is static."""
    for v in range(vectors):
        lit = np.int64(answers.lit[v])
        counts[RAYS] += ones(lit)  # those that miss the box around all that moves are done with that
        answers.asked[v] = 0 if lit == 0 else lit & _towards(world.moving_box, points, light, v)
    _ask(world, points, light, vectors, answers.asked, MOVING, answers, counts)
    _take_blocked(answers.lit, answers.asked, vectors, answers)


@inlined
def _towards(box, points, light, v):
    """Bits of the points of a vector between which and the light a box (6,) may lie: none is left out that a tree with
    this box at its root would let in, as the box is made larger here by more than roundings."""
    x, y, z = load_three(points.lifted, v)
    rx, ry, rz = (
        ROUNDED * (abs(light[0]) + abs(box[0]) + abs(box[3])),
        ROUNDED * (abs(light[1]) + abs(box[1]) + abs(box[4])),
        ROUNDED * (abs(light[2]) + abs(box[2]) + abs(box[5])),
    )
    low, high = (box[0] - rx, box[1] - ry, box[2] - rz), (box[3] + rx, box[4] + ry, box[5] + rz)
    return bits_of(~segments_miss_box(light, (x - light[0], y - light[1], z - light[2]), low, high))


@subkernel
def _ask_cache(world, points, light, number, knowledge, vectors, answers, counts):
    """Test the points that are to be asked about against what blocked their light before, and set shadow modes."""
    cache = knowledge.cache
    for v in range(vectors):
        live = np.int64(answers.live[v])
        if live == 0:
            continue
        x, y, z = load_three(points.lifted, v)
        direction = x - light[0], y - light[1], z - light[2]
        slots = slots_of(points, v, direction, number)
        store(address_of(answers.slots) + 64 * v, slots)
        known = occluders_in(cache, slots)
        there = known > np.int32(MISS)
        tested = bits_of(there) & live
        if tested == 0:
            continue
        numbers = select(there, known, i32x16(0))
        hit = bits_of(surely_blocked(world.triangles, light, direction, LIGHT_MARGIN, numbers, cache.padding)) & tested
        counts[TESTS] += ones(tested)
        counts[CACHE_HITS] += ones(hit)
        answers.live[v] = live & ~hit
        if knowledge.learn and number < MAX_CULLED_LIGHTS:
            _learn(points, v, number, knowledge, answers, hit, hit)


@subkernel
def _ask_about_others(world, points, light, number, knowledge, vectors, answers, counts):
    """Ask everything about the points of which nothing is known, and set shadow modes by what is static."""
    cached = len(knowledge.cache.occluders) > 0
    if cached:
        _ask_cache(world, points, light, number, knowledge, vectors, answers, counts)
    count = _rays_from_light(points, light, vectors, answers.live, answers)
    counts[RAYS] += count
    if count == 0:
        return
    if cached:
        any_hits_by(world, answers.rays, STATIC | MOVING, answers.blocked, answers.occluders, 0, count, counts)
    else:
        any_hits(world, answers.rays, STATIC | MOVING, answers.blocked, 0, count, counts)
    n = 0
    for v in range(vectors):
        asked = np.int64(answers.live[v])
        if asked == 0:
            continue
        blocked, for_good = _blocked(answers, asked, n)
        if len(knowledge.cache.found) > 0:
            remember(knowledge.cache, answers.slots, v, answers.occluders, n, asked, for_good)
        n += ones(asked)
        if knowledge.learn and number < MAX_CULLED_LIGHTS:
            _learn(points, v, number, knowledge, answers, asked, for_good)
        answers.lit[v] |= asked & ~blocked


@subkernel
def _verify(world, points, light, vectors, answers, counts):
    """Trace every due ray, its steps uncounted, and count the answers that differ."""
    scratch = np.zeros(SHADOW_COUNTERS, np.int64)
    for v in range(vectors):
        answers.truth[v] = answers.due[v]
    _ask(world, points, light, vectors, answers.due, STATIC | MOVING, answers, scratch)
    _take_blocked(answers.truth, answers.due, vectors, answers)
    for v in range(vectors):
        counts[WRONG] += ones(np.int64(answers.truth[v] ^ answers.lit[v]))


@subkernel
def shadow_testing(world, points, count, light, number, knowledge, answers, counts):
    """Which of `count` points are due to light `number` at light (3,), and which it reaches: into answers."""
    vectors = (count + 15) // 16
    before = counts[DYNAMIC_ONLY] + counts[CANDIDATES_ONLY]
    _choose_fates(points, light, number, knowledge, count, answers, counts)
    if world.has_dynamic and counts[DYNAMIC_ONLY] + counts[CANDIDATES_ONLY] > before:
        _ask_about_known(world, points, light, vectors, answers, counts)
    _ask_about_others(world, points, light, number, knowledge, vectors, answers, counts)
    if knowledge.verify:
        _verify(world, points, light, vectors, answers, counts)

"""Shadow testing and shadow-mode setting (§2.4 and §2.5 of the paper).

A shadow ray is *due* where the light is on the viewer's side of the surface.  What its primitive
is known to be, as the last frame left it, decides the ray's fate:

- FULLY_RENDERED and FULL_SHADOW: culled, the point is in shadow;
- FULLY_RENDERED and NON_SHADOW: dynamic objects alone are asked;
- anything else: static geometry is asked and, where nothing static blocks the light, dynamic objects
  are; what static geometry answers is OR-ed into the shadow mode.  Where there is an occluder cache, it
  is asked before (`tracer.culling.cache`).

Modes may also be kept beside a method that does not cull by them (`tracer.culling.learning`).

Shadow rays start at the light.  They end a little above the surface (`lifted`), so that it does not
shadow itself.

Points come in vectors of sixteen.  Rays are packed, so that batches shrink with what is not due and
what is culled; what is found is kept as bits, one for each point.  What loops over vectors need is taken
out of tuples before: numba counts references to all arrays of a tuple that is handed on, which may cost
more than a look-up does, even where the counts are nobody's.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.cache import Cache, occluders_in, remember, slots_of, surely_blocked
from tracer.culling.certified.candidates import ask_candidates
from tracer.culling.certified.view import CertificateView
from tracer.culling.learning import consult_modes, learn, look_up, trusted, with_modes, words_of
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.geometry.boxes import segments_miss_box
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING, STATIC_GEOMETRY, any_hits, any_hits_by
from tracer.geometry.rays import MISS
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    i32x16,
    lane_numbers_x16,
    lanes_below,
    load_spread_bytes16,
    load_three,
    mask16,
    ones,
    pack,
    pack_three,
    select,
    store,
    store_three,
)

# Shadow counters; the first two are those that queries add to.  Then, by light, three of what modes say: rays that are
# due, and of those the ones that the paper's method culls, and that it asks moving objects about.
STEPS, TESTS, RAYS, DUE, CULLED, DYNAMIC_ONLY, CANDIDATES_ONLY, CACHE_HITS, WRONG, BY_LIGHT = range(10)
SHADOW_COUNTERS = BY_LIGHT + 3 * MAX_CULLED_LIGHTS

LIGHT_MARGIN = np.float32(1e-5)  # of the way from the light: what lies nearer to it is the lamp itself
ROUNDED = np.float32(1e-5)  # of coordinates
ZERO, ONE = np.float32(0), np.float32(1)


class Knowledge(NamedTuple):
    """What culling goes by: words (units,); modes (units,) as the last frame left them, which are the same words but
    where those are of certified cells, and what this worker gains for the next, of the same shape; the first unit of
    each primitive (p + 1,), or nothing where primitives are the units; whether to cull by the words, to learn modes
    from rays, and to verify what was culled; whether units are certified cells; and the occluder cache."""

    words: NDArray[np.unsignedinteger]
    modes: NDArray[np.unsignedinteger]
    gained: NDArray[np.unsignedinteger]
    first: NDArray[np.int32]
    cull: bool
    learn: bool
    verify: bool
    certify: bool
    certified: CertificateView
    cache: Cache


@inlined
def faces(points, light, v):
    """Bits of the points whose surface faces the light."""
    px, py, pz = load_three(points.position, v)
    gx, gy, gz = load_three(points.geometric, v)
    return bits_of(gx * (light[0] - px) + gy * (light[1] - py) + gz * (light[2] - pz) > ZERO)


@subkernel
def _choose_fates(points, light, number, knowledge, count, answers, counts):
    """What is due, and what of it is known: answers.lit is what is known to be lit, live what is to be asked."""
    vectors, asked = (count + 15) // 16, np.int64(0)
    certified = _is_certified(number, knowledge)
    asks = certified and answers.asks and knowledge.certified.max_asked > 0
    culls = knowledge.cull and number < MAX_CULLED_LIGHTS
    words, units, found = knowledge.words, points.unit, answers.known
    for v in range(vectors):
        due = faces(points, light, v) & lanes_below(count, v)
        full, non = np.int64(0), np.int64(0)
        if culls and due != 0:
            look_up(words, units, v, found)
            full, non = trusted(found, number, v)
        live = due & ~(full | non)
        answers.due[v], answers.lit[v], answers.live[v] = due, due & non, live
        counts[DUE] += ones(due)
        counts[CULLED] += ones(due & full)
        counts[DYNAMIC_ONLY] += ones(due & non)
        if certified and live != 0:
            some = _with_candidates(found, number, v, live)
            answers.untried[v] |= live & ~some
            answers.doubtful[v] |= some
            if asks:
                which = lane_numbers_x16() + np.int32(16 * v)
                store(address_of(answers.asked) + 4 * asked, pack(which, mask16(some)))
                asked += ones(some)
    if asked > 0:
        view, live, lit = knowledge.certified, answers.live, answers.lit
        known, tests = ask_candidates(view, points, light, number, answers.asked, asked, answers.questions, live, lit)
        counts[CANDIDATES_ONLY] += known
        counts[TESTS] += tests


@inlined
def _is_certified(number, knowledge):
    """Whether a light has certificates."""
    stationary = knowledge.certified.stationary
    return knowledge.certify and number < len(stationary) and bool(stationary[number])


@inlined
def _with_candidates(found, number, v, live):
    """Bits of the live points of a vector whose cells have candidates."""
    _, field, shift = words_of(found, number, v)
    field = field & np.int32(3 << shift)
    return bits_of(field == np.int32(3 << shift)) & live


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
    return bits_of(found > 0), bits_of(found == STATIC_GEOMETRY)


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
    _ask(world, points, light, vectors, answers.asked, DYNAMIC_OBJECTS, answers, counts)
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
            learn(knowledge.gained, with_modes(points, knowledge), answers.modes, v, number, hit, hit)


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
        any_hits_by(world, answers.rays, EVERYTHING, answers.blocked, answers.occluders, 0, count, counts)
    else:
        any_hits(world, answers.rays, EVERYTHING, answers.blocked, 0, count, counts)
    n, learns = 0, knowledge.learn and number < MAX_CULLED_LIGHTS
    gained, units, found = knowledge.gained, with_modes(points, knowledge), answers.modes
    for v in range(vectors):
        asked = np.int64(answers.live[v])
        if asked == 0:
            continue
        blocked, for_good = _blocked(answers, asked, n)
        if len(knowledge.cache.found) > 0:
            remember(knowledge.cache, answers.slots, v, answers.occluders, n, asked, for_good)
        n += ones(asked)
        if learns:
            learn(gained, units, found, v, number, asked, for_good)
        answers.lit[v] |= asked & ~blocked


@subkernel
def _verify(world, points, light, vectors, answers, counts):
    """Trace every due ray, its steps uncounted, and count the answers that differ."""
    scratch = np.zeros(RAYS, np.int64)  # steps and tests
    for v in range(vectors):
        answers.truth[v] = answers.due[v]
    _ask(world, points, light, vectors, answers.due, EVERYTHING, answers, scratch)
    _take_blocked(answers.truth, answers.due, vectors, answers)
    for v in range(vectors):
        counts[WRONG] += ones(np.int64(answers.truth[v] ^ answers.lit[v]))


@subkernel
def shadow_testing(world, points, count, light, number, knowledge, answers, counts):
    """Which of `count` points are due to light `number` at light (3,), and which it reaches: into answers."""
    vectors = (count + 15) // 16
    before = counts[DYNAMIC_ONLY] + counts[CANDIDATES_ONLY]
    _choose_fates(points, light, number, knowledge, count, answers, counts)
    if knowledge.learn and number < MAX_CULLED_LIGHTS:
        consult_modes(points, number, knowledge, vectors, answers, counts[BY_LIGHT + 3 * number :])
    if world.has_dynamic and counts[DYNAMIC_ONLY] + counts[CANDIDATES_ONLY] > before:
        _ask_about_known(world, points, light, vectors, answers, counts)
    _ask_about_others(world, points, light, number, knowledge, vectors, answers, counts)
    if knowledge.verify:
        _verify(world, points, light, vectors, answers, counts)

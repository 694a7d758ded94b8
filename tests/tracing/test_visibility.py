"""The proof of visibility, attacked by itself: whatever is claimed of a triangle between two hulls is held against
exact rational arithmetic, and against what both structures trace, just where the claim begins to be made."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pytest

from tests.sweeps import ACCELERATORS, cases
from tests.tracing.exact import cross, dot, exact, minus
from tests.tracing.worlds import scene
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.rays import ray_batch
from tracer.geometry.world import World
from tracer.runtime.kernels import kernel
from tracer.simd import address_of, bits_of, f32x16, load_columns, load_three, local_memory
from tracer.visibility.area_light_tests import KEPT, ask_points
from tracer.visibility.blockers import find_blockers, hull_of, that_hide
from tracer.visibility.classify import PrismQuestion, classify_for_prism
from tracer.visibility.error_bounds import BOX, CORNER_ERROR, ROW, SureHitLength
from tracer.visibility.light_space import LIGHT_ROW, in_all_lanes, judge, put_light_space, verdicts
from tracer.visibility.prepared_triangles import PREPARED, Lamp, prepare
from tracer.visibility.shaft import PrismShaft, make_prism_shaft, put_light

LANES, HIT, MISSED = 16, "hit", "missed"
Vectors = np.ndarray


# --- hulls ----------------------------------------------------------------------------------------------


class Hull(NamedTuple):
    """A kind of hull: `extremes` (n, 3) float32 points in it, all of its corners among them; `kind` names it."""

    kind: str
    middle: Vectors
    size: Vectors  # half sides of a box; the radius of a ball, three times
    extremes: Vectors


def point(middle: Vectors, size: float, rng: np.random.Generator) -> Hull:
    middle = middle.astype(np.float32)
    return Hull("point", middle, np.zeros(3, np.float32), middle[None])


def box(middle: Vectors, size: float, rng: np.random.Generator) -> Hull:
    middle, half = middle.astype(np.float32), (size * rng.uniform(0.05, 1.0, 3)).astype(np.float32)
    corners = np.array(list(product((-1, 1), repeat=3)))
    return Hull("box", middle, half, _within(middle + half * corners, middle - half, middle + half))


def _within(points: Vectors, low: Vectors, high: Vectors) -> Vectors:
    return np.clip(points.astype(np.float32), low, high)


def ball(middle: Vectors, size: float, rng: np.random.Generator) -> Hull:
    middle, radius = middle.astype(np.float32), np.float32(size)
    ways = rng.normal(size=(60, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    return Hull("ball", middle, np.full(3, radius), (middle + (1.0 - 1e-6) * radius * ways).astype(np.float32))


def prism(middle: Vectors, size: float, rng: np.random.Generator) -> Hull:
    """Corners of a triangle, and the same somewhat higher: above is where the light is, at the origin."""
    up = -middle / np.linalg.norm(middle) + 0.3 * rng.normal(size=3)
    up /= np.linalg.norm(up)
    floor = middle + size * rng.normal(size=(3, 3))
    floor -= ((floor - middle) @ up)[:, None] * up
    corners = np.concatenate([floor, floor + 0.05 * size * up])
    return Hull("prism", middle, up, corners)


# --- claims ---------------------------------------------------------------------------------------------


class Rows(NamedTuple):
    """What `classify_for_prism` reads of occluders."""

    rows: Any
    farthest: Any


def rows_of(triangle: Vectors, corner_error: float) -> Vectors:
    """Sixteen times the row of a triangle (9,) float32, corner and edges, and what its corners may be wrong by."""
    rows = np.zeros((LANES, ROW), np.float32)
    corners = np.stack([triangle[:3], triangle[:3] + triangle[3:6], triangle[:3] + triangle[6:]])
    room = 1e-5 * np.abs(corners).max() + corner_error
    rows[:, CORNER_ERROR] = corner_error
    rows[:, :9], rows[:, BOX : BOX + 3], rows[:, BOX + 3 :] = triangle, corners.min(0) - room, corners.max(0) + room
    return rows


@kernel
def _rays(rows, sure, light, ends, claims):
    """Sixteen rays from a light to ends (3, 16)."""
    farthest, made = SureHitLength(LANES, sure, sure), np.zeros((LANES, LIGHT_ROW), np.float32)
    names = np.zeros(LANES, np.int32)
    place = light[0], light[1], light[2]
    put_light_space(rows, farthest, place, made)
    end = load_three(ends, 0)
    way = end[0] - place[0], end[1] - place[1], end[2] - place[2]
    hit, missed = verdicts(load_columns(address_of(made), address_of(names), LIGHT_ROW), place, way, end)
    claims[0], claims[1] = hit == 0xFFFF, missed == 0xFFFF
    return names


@kernel
def _box(rows, sure, light, middle, half, longest, claims):
    """All rays from a light to a box."""
    farthest, made, names = (
        SureHitLength(LANES, sure, sure),
        np.zeros((LANES, LIGHT_ROW), np.float32),
        np.zeros(LANES, np.int32),
    )
    place = light[0], light[1], light[2]
    put_light_space(rows, farthest, place, made)
    columns = load_columns(address_of(made), address_of(names), LIGHT_ROW)
    hit, missed = judge(columns, place, in_all_lanes(middle), in_all_lanes(half), f32x16(longest))
    claims[0], claims[1] = bits_of(hit) & 1, bits_of(missed) & 1
    return names


@kernel
def _prism(rows, sure, light, radius, shaft, claims):
    """All rays from a ball, or a point, to a prism."""
    names, place = np.zeros(LANES, np.int32), (np.float64(light[0]), np.float64(light[1]), np.float64(light[2]))
    if put_light(shaft, place, radius):
        question = PrismQuestion(Rows(rows, SureHitLength(LANES, sure, sure)), 0, place, shaft)
        hit, missed = classify_for_prism(question, address_of(names))
        claims[0], claims[1] = hit & 1, missed & 1
    return names


@kernel
def _ball(rows, sure, light, radius, ends, claims):
    """All rays from a ball to sixteen points (3, 16)."""
    names, made, kept = np.zeros(LANES, np.int32), local_memory(PREPARED), local_memory(KEPT)
    lamp = Lamp(0, (light[0], light[1], light[2]), radius, 1)
    prepare(rows, SureHitLength(LANES, sure, sure), lamp, address_of(names), made)
    hit, missed, _can = ask_points(made, load_three(ends, 0), lamp.light, radius, kept)
    claims[0], claims[1] = hit == 0xFFFF, missed == 0xFFFF
    return names


@kernel
def _boxes(blockers, lights, region, claims):
    """All rays from one box (1, 6) to another."""
    claims[0] = that_hide(blockers, 0, hull_of(lights, 0), hull_of(region, 0)) & 1


def _prism_shaft(hull: Hull) -> PrismShaft:
    shaft = make_prism_shaft()
    shaft.corners[:] = hull.extremes.T
    shaft.planes[3, :3], shaft.planes[3, 3] = -hull.size, -float(hull.size @ hull.extremes[0])
    return shaft


def claim(triangle: Vectors, light: Hull, receiver: Hull, sure: float, corner_error: float = 0.0) -> set[str]:
    """What is claimed of a triangle (9,) and all rays from one hull to another."""
    claims, rows = np.zeros(2, np.int64), rows_of(triangle, corner_error)
    ends = np.ascontiguousarray(np.repeat(receiver.middle[:, None], LANES, axis=1), np.float32)
    if light.kind == "box":
        one, other = (
            np.concatenate([h.middle - h.size, h.middle + h.size])[None].astype(np.float64) for h in (light, receiver)
        )
        _boxes(find_blockers(triangle[None], sure), one, other, claims)
    elif receiver.kind == "prism":
        _prism(rows, sure, light.middle, float(light.size[0]), _prism_shaft(receiver), claims)
    elif light.kind == "ball":
        _ball(rows, sure, light.middle, np.float32(light.size[0]), ends, claims)
    elif receiver.kind == "box":
        longest = np.abs(receiver.middle - light.middle).sum() + receiver.size.sum()
        half = tuple((receiver.size * np.float32(1.000001)).tolist())
        _box(
            rows,
            sure,
            light.middle,
            tuple(receiver.middle),
            tuple(np.float32(half)),
            np.float32(1.00001 * longest),
            claims,
        )
    else:
        _rays(rows, sure, light.middle, ends, claims)
    return {name for name, claimed in zip((HIT, MISSED), claims, strict=True) if claimed}


# --- the judges -----------------------------------------------------------------------------------------


def crosses(triangle: Vectors, start: Vectors, end: Vectors) -> bool:
    """Whether a segment crosses the inside of a triangle (9,): exactly, in whole numbers."""
    a, e1, e2, begin, aim = exact(triangle[:3], triangle[3:6], triangle[6:], start, end)
    d, s, n = minus(aim, begin), minus(begin, a), cross(e1, e2)
    u, v, along, t = dot(d, cross(e2, s)), dot(d, cross(s, e1)), -dot(d, n), dot(s, n)
    if along < 0:
        u, v, along, t = -u, -v, -along, -t
    return u > 0 and v > 0 and along - u - v > 0 and 0 < t < along


def contradictions(triangle: Vectors, light: Hull, receiver: Hull, claimed: str, rng: np.random.Generator) -> list[str]:
    """What contradicts a claim: exact segments between extreme points, and rays between these and others."""
    found, pairs = [], list(product(light.extremes, receiver.extremes))
    for start, end in (pairs[k] for k in rng.permutation(len(pairs))[:64]):
        if crosses(triangle, start, end) != (claimed == HIT):
            found.append(f"exactly: {start.tolist()} to {end.tolist()}")
    weights = (
        rng.dirichlet(np.full(len(light.extremes), 0.3), 400),
        rng.dirichlet(np.full(len(receiver.extremes), 0.3), 400),
    )
    starts, ends = (w @ h.extremes.astype(np.float64) for w, h in zip(weights, (light, receiver), strict=True))
    starts = np.concatenate([np.array([p[0] for p in pairs]), starts]).astype(np.float32)
    ends = np.concatenate([np.array([p[1] for p in pairs]), ends]).astype(np.float32)
    if receiver.kind == "prism":  # whose corners are none of float32: rays end within
        ends = (receiver.middle + (1.0 - 1e-5) * (ends - receiver.middle)).astype(np.float32)
    if light.kind == "box":
        starts = _within(starts, light.middle - light.size, light.middle + light.size)
    made = scene([[triangle[:3], triangle[:3] + triangle[3:6], triangle[:3] + triangle[6:]]])
    for name in ACCELERATORS:
        blocked = World(made, accelerator=name).any_hits(ray_batch(starts, ends - starts, LIGHT_MARGIN, 1.0), threads=1)
        if (blocked != (claimed == HIT)).any():
            found.append(f"{name}: {int((blocked != (claimed == HIT)).sum())} of {len(blocked)} rays")
    return found


# --- the attack -----------------------------------------------------------------------------------------

PAIRS: dict[str, tuple[Callable[..., Hull], Callable[..., Hull]]] = {
    "point to point": (point, point),
    "point to box": (point, box),
    "point to prism": (point, prism),
    "ball to point": (ball, point),
    "ball to prism": (ball, prism),
    "box to box": (box, box),
}


def _triangle(middle: Vectors, across: Vectors, size: float, rng: np.random.Generator) -> Vectors:
    """A triangle (9,) float32 around a place, mostly across a way, as float32 has it."""
    corners = rng.normal(size=(3, 3))
    corners -= rng.choice([0.5, 0.9, 1.0]) * (corners @ across)[:, None] * across
    corners = (middle + size * (corners - corners.mean(0))).astype(np.float32)
    return np.concatenate([corners[0], corners[1] - corners[0], corners[2] - corners[0]]).astype(np.float32)


class Slide(NamedTuple):
    """A triangle (9,) that slides sideways, and the hulls of light and receiver that it lies between."""

    triangle: Vectors
    aside: Vectors
    light: Hull
    receiver: Hull
    sure: float
    corner_error: float = 0.0

    def at(self, part: float) -> Vectors:
        corner = self.triangle[:3] + np.float32(part) * self.aside.astype(np.float32)
        return np.concatenate([corner, self.triangle[3:]]).astype(np.float32)

    def claims(self, part: float) -> set[str]:
        return claim(self.at(part), self.light, self.receiver, self.sure, self.corner_error)

    def claimed(self, name: str, part: float) -> bool:
        return name in self.claims(part)

    def crosses_all(self, part: float) -> bool:
        """Whether all segments between corners cross the triangle, exactly."""
        pairs = product(self.light.extremes[:8], self.receiver.extremes)
        return all(crosses(self.at(part), start, end) for start, end in pairs)


def last(holds: Callable[[float], bool], inner: float, outer: float) -> float:
    """The last place, by halving, at which something holds that does at the first."""
    for _ in range(30):
        middle = 0.5 * (inner + outer)
        inner, outer = (middle, outer) if holds(middle) else (inner, middle)
    return inner


@pytest.mark.parametrize("pair", PAIRS)
def test_claims_hold_exactly_and_for_rays_where_they_begin(pair: str) -> None:
    """A triangle slides from where it hides the hull to where it misses it: the last place is found at which either is
    claimed, and the claim is tried there."""
    rng, tried, (a_light, a_receiver) = np.random.default_rng(5), Counter[str](), PAIRS[pair]
    for number in range(cases(24, 400)):
        scale = 10.0 ** rng.uniform(-2, 2)
        way, aside = rng.normal(size=(2, 3))
        way, aside = way / np.linalg.norm(way), np.cross(way, aside)
        light = a_light(np.zeros(3), scale * 10.0 ** rng.uniform(-2.5, -0.5), rng)
        receiver = a_receiver(4.0 * scale * way, scale * 10.0 ** rng.uniform(-2.5, -0.3), rng)
        middle = 4.0 * scale * rng.uniform(0.2, 0.8) * way
        triangle = _triangle(middle, way, scale * 10.0 ** rng.uniform(-0.5, 0.7), rng)
        slide = Slide(triangle, 20.0 * scale / np.linalg.norm(aside) * aside, light, receiver, 1e6 * scale)
        for claimed, inner, outer in ((HIT, 0.0, 1.0), (MISSED, 1.0, 0.0)):
            if claimed not in slide.claims(inner):
                continue
            part = last(partial(slide.claimed, claimed), inner, outer)
            if claimed == HIT and _too_long(slide.at(part), light, receiver):
                continue
            tried[claimed] += 1
            found = contradictions(slide.at(part), light, receiver, claimed, rng)
            assert not found, (number, claimed, found[:3])
    least = cases(24, 400) // 6
    assert tried[HIT] > least and (tried[MISSED] > 2 * least or pair == "box to box"), tried


def _too_long(triangle: Vectors, light: Hull, receiver: Hull) -> bool:
    """Whether rays are longer than those that the fast structure is certain of (`SureHitLength`)."""
    extent = np.abs(np.stack([triangle[:3], triangle[:3] + triangle[3:6], triangle[:3] + triangle[6:]])).max()
    return max(np.linalg.norm(p - q) for p in light.extremes for q in receiver.extremes) > 2.0 * extent


def test_nothing_false_is_claimed_where_products_of_lengths_overflow() -> None:
    """A triangle within the range of float32, and prisms so far behind it that U, V and W overflow, also to NaN."""
    corner = [-243399311360, -277788360704, 45160247296]
    e1, e2 = [133535039488, 208200007680, 3711275008], [278131048448, 3757817856, 249759907840]
    triangle = np.array([*corner, *e1, *e2], np.float32)
    rng, light = np.random.default_rng(3), point(np.zeros(3), 0, np.random.default_rng(0))
    way, middle = np.array([-0.3960, -0.7801, 0.4844]), triangle[:3] + (triangle[3:6] + triangle[6:]) / 3
    assert claim(triangle * np.float32(1e-3), light, prism(1.5e-3 * middle, 1e6, rng), 1e36) == {HIT}
    for distance in np.logspace(11.5, 16.5, 101):
        receiver = prism(distance * way, 1e-3 * distance, np.random.default_rng(3))
        with np.errstate(over="ignore", invalid="ignore"):
            claimed = claim(triangle, light, receiver, 1e36)
        for name in claimed:
            assert all(crosses(triangle, light.middle, end) == (name == HIT) for end in receiver.extremes), distance
    assert not claimed, "nothing is known of lengths whose products overflow"


@pytest.mark.parametrize("pair", ["point to point", "point to prism", "ball to point"])
def test_claims_hold_for_all_triangles_whose_corners_are_that_close(pair: str) -> None:
    """The corners of a resting triangle are somewhere near where they are taken to be: claims hold wherever that is."""
    rng, tried, (a_light, a_receiver) = np.random.default_rng(13), Counter[str](), PAIRS[pair]
    for number in range(cases(30, 600)):
        way, aside = rng.normal(size=(2, 3))
        way, aside = way / np.linalg.norm(way), np.cross(way, aside)
        light = a_light(np.zeros(3), 10.0 ** rng.uniform(-3, -1), rng)
        receiver = a_receiver(4.0 * way, 10.0 ** rng.uniform(-3, -1), rng)
        size, corner_error = 10.0 ** rng.uniform(-3, 0.5), 10.0 ** rng.uniform(-6, -2)
        triangle = _triangle(rng.uniform(0.05, 3.95) * way, way, size, rng)
        slide = Slide(triangle, aside, light, receiver, 1e6, corner_error)
        for claimed, inner, outer in ((HIT, 0.0, 8.0), (MISSED, 8.0, 0.0)):
            holds = partial(slide.claimed, claimed)
            if not holds(inner):
                continue
            tried[claimed] += 1
            triangle = slide.at(last(holds, inner, outer))
            corners = np.stack([triangle[:3], triangle[:3] + triangle[3:6], triangle[:3] + triangle[6:]])
            for _ in range(40):
                moves = rng.normal(size=(3, 3))
                a, b, c = corners + 0.999 * corner_error * moves / np.linalg.norm(moves, axis=1, keepdims=True)
                moved = np.concatenate([a, b - a, c - a])
                for start, end in product(light.extremes[:8], receiver.extremes):
                    assert crosses(moved, start, end) == (claimed == HIT), (number, claimed, corner_error)
    assert tried[HIT] > cases(3, 60) and tried[MISSED] > cases(12, 240), tried


@pytest.mark.parametrize("pair", PAIRS)
def test_nearly_all_is_claimed_that_is_so(pair: str) -> None:
    """Between the last place at which a triangle is known to hide a hull and the last at which it exactly does lies
    next to nothing, so that the bounds are not merely wide."""
    rng, gaps, way = np.random.default_rng(7), [], np.array([1.0, 0.3, -0.2]) / np.linalg.norm([1.0, 0.3, -0.2])
    for _ in range(cases(8, 200)):
        light, receiver = PAIRS[pair][0](np.zeros(3), 0.02, rng), PAIRS[pair][1](4.0 * way, 0.05, rng)
        aside = np.cross(way, rng.normal(size=3))
        slide = Slide(_triangle(2.0 * way, way, 2.0, rng), 20.0 * aside, light, receiver, 1e6)
        if HIT in slide.claims(0.0):
            known = last(partial(slide.claimed, HIT), 0.0, 1.0)
            gaps.append((last(slide.crosses_all, 0.0, 1.0) - known) / max(known, 1e-3))
    assert len(gaps) > 3
    assert np.median(gaps) < (0.05 if pair.startswith("ball") else 2e-3), gaps

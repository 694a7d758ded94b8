"""Check proofs of visibility in exact arithmetic.

It shares no code with what made them: the numbers of a file are ratios of integers, and all is decided by integers.
A proof is about all segments from a light to a prism, whose six corners are given.

- "full": they cross the triangles `by`.  The four functions that say so, U, V, W and B, are linear in where a segment
  ends, so that each triangle hides a convex part of the prism; what all hide is cut off the whole, and nothing may be
  left.
- "lit": they cross nothing.  The hull of light and prism is convex, and so is each triangle, or box: a plane lies
  between them, which is looked for in floating point, and then held against all corners.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import combinations, pairwise, product
from typing import Any, NamedTuple

import numpy as np

Point = Sequence[Any]  # three numbers
SHAFT_EDGES = [(0, k) for k in range(1, 7)] + [(1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)]
FACES = [0, 1, 2, 3, 4, 5, 6, 9, 0, 1, 2], [1, 2, 0, 4, 5, 3, 7, 10, 12, 13, 14]  # pairs of edges in a face
LARGEST = 1e30  # of numbers, so that products are finite
BITS = 48  # of the normals of planes: any normal will do


class Answer(NamedTuple):
    """Whether a proof holds; why not, in words, where it does not."""

    holds: bool
    why: str = ""


def minus(a: Point, b: Point) -> tuple:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def plus(a: Point, b: Point) -> tuple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def dot(a: Point, b: Point) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Point, b: Point) -> tuple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


class Checker:
    """Checks the proofs of a file, as JSON has it; raises ValueError, in one line, where it is none."""

    def __init__(self, data: Any) -> None:
        try:
            self.lights = [_numbers(light, 3) for light in data["lights"]]
            rows = [_numbers(row, 9) for row in data["triangles"]]
            boxes = [_numbers(box, 6) for box in data["boxes"]]
            self.cells = [[_numbers(corner, 3) for corner in cell] for cell in data["cells"]]
            self.proofs = [(p["cell"], p["light"], p["verdict"], p["by"]) for p in data["proofs"]]
        except KeyError as error:
            raise ValueError(f"these are no proofs: {error} is missing") from None
        except (TypeError, ValueError, OverflowError) as error:
            raise ValueError(f"these are no proofs: {error}") from None
        if not self.proofs:
            raise ValueError("there are no proofs in it")
        every = [x for many in (self.lights, rows, boxes, *self.cells) for row in many for x in row]
        # The least power of two that makes integers of all numbers.
        self.scale = max((x.as_integer_ratio()[1] for x in every), default=1)
        self.triangles = [(row[0:3], row[3:6], row[6:9]) for row in rows]
        # What may hide a light: triangles, and boxes, of which those are empty that begin where they have ended.
        self._occluders = [*self.triangles, *((box[:3], box[3:]) for box in boxes if box[0] <= box[3])]
        hulls = [_hull_of(occluder) for occluder in self._occluders]
        self._hulls = np.array([hull + hull[:1] * (8 - len(hull)) for hull in hulls], float).reshape(-1, 8, 3)
        self._low, self._high = _bounds(self._hulls)
        self._exact_hulls: dict[int, list[tuple]] = {}  # of those that have been asked for

    def _exact(self, point: Point) -> tuple[int, ...]:
        """A point in integers: so many of the least part that any number of the file has."""
        ratios = (x.as_integer_ratio() for x in point)
        return tuple(above * (self.scale // below) for above, below in ratios)

    def check(self, proof: tuple[int, int, str, list[int]]) -> Answer:
        """Check a proof."""
        cell, light, verdict, by = proof
        try:
            start, corners = _of(self.lights, light), _of(self.cells, cell)
            blockers = [_of(self.triangles, k) for k in by]
        except (IndexError, TypeError):
            return Answer(False, "it names what is not in the file")
        if len(corners) != 6:
            return Answer(False, f"its cell has {len(corners)} corners in place of 6")
        if verdict not in ("full", "lit"):
            return Answer(False, "its verdict is neither full nor lit")
        return self._check_full(start, corners, blockers) if verdict == "full" else self._check_lit(start, corners)

    def _check_full(self, start: Point, corners: list, blockers: Iterable[tuple]) -> Answer:
        light, ends = self._exact(start), [self._exact(corner) for corner in corners]
        pieces: list[list] = [[tuple(Fraction(int(j == k)) for j in range(3)) for k in range(3)]]
        for triangle in blockers:
            functions = _functions(light, ends, *map(self._exact, triangle))
            if not functions:
                continue
            left = []
            for inside in pieces:
                for f in functions:  # what lies outside of one of them is left
                    left.append(_cut(inside, [-x for x in f]))
                    inside = _cut(inside, f)
            pieces = [some for some in left if _area(some) > 0]
        return Answer(False, "a part of it is not hidden by the triangles that it names") if pieces else Answer(True)

    def _check_lit(self, start: Point, corners: list) -> Answer:
        shaft = np.array([start, *corners])
        exact = [self._exact(p) for p in (start, *corners)]
        edges = np.array([shaft[i] - shaft[j] for i, j in SHAFT_EDGES])
        (low, high), faces = _bounds(shaft[None]), _unit(np.cross(edges[FACES[0]], edges[FACES[1]]))
        near = np.flatnonzero(((self._low <= high) & (self._high >= low)).all(1))
        if not len(faces):
            return Answer(False, "its cell and light span no space")
        best, gaps = _widest(faces, shaft, self._hulls[near])
        planes = [[round(x * (1 << BITS)) for x in normal] for normal in faces.tolist()]
        spans = [(min(dots), max(dots)) for dots in ([dot(n, p) for p in exact] for n in planes)]
        for k, face, gap in zip(near.tolist(), best.tolist(), gaps.tolist(), strict=True):
            if k not in self._exact_hulls:
                self._exact_hulls[k] = _hull_of(tuple(map(self._exact, self._occluders[k])))
            hull = self._exact_hulls[k]
            ours, theirs = spans[face], [dot(planes[face], p) for p in hull]
            if gap > 0.0 and (min(theirs) > ours[1] or max(theirs) < ours[0]):
                continue
            if not self._separated(shaft, exact, edges, self._hulls[k], hull):
                return Answer(False, "no plane is found between it and something that may hide the light")
        return Answer(True)

    def _separated(self, shaft: np.ndarray, exact: list, edges: np.ndarray, hull: np.ndarray, hull_exact: list) -> bool:
        """Whether a plane lies between two hulls: exactly.  If any does, then one along an edge of each, or a face."""
        others = np.array([a - b for a, b in combinations(hull, 2)])
        tried = [np.cross(edges[:, None], others[None]).reshape(-1, 3), np.cross(others[:1], others[1:])]
        normals = _unit(np.concatenate([*tried, np.cross(edges[FACES[0]], edges[FACES[1]])]))
        if not len(normals):
            return False
        best, _gap = _widest(normals, shaft, hull[None])
        n = [round(x * (1 << BITS)) for x in normals[best[0]].tolist()]
        ours, theirs = [dot(n, p) for p in exact], [dot(n, p) for p in hull_exact]
        return max(ours) < min(theirs) or max(theirs) < min(ours)


def _unit(normals: np.ndarray) -> np.ndarray:
    """Those of normals (n, 3) that are not 0, of length 1."""
    sizes = np.linalg.norm(normals, axis=1)
    return normals[sizes > 0.0] / sizes[sizes > 0.0, None]


def _widest(normals: np.ndarray, shaft: np.ndarray, hulls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of normals (n, 3) has the widest gap between points (7, 3) and each of hulls (m, k, 3), and how wide."""
    ours, theirs = normals @ shaft.T, hulls @ normals.T
    gaps = np.maximum(theirs.min(1) - ours.max(1), ours.min(1) - theirs.max(1))
    return gaps.argmax(1), gaps.max(1)


def _hull_of(occluder: tuple) -> list[tuple]:
    """The corners of a triangle, (a, e1, e2), or of a box, (lower, upper)."""
    if len(occluder) == 3:
        a, e1, e2 = occluder
        return [a, plus(a, e1), plus(a, e2)]
    return list(product(*zip(*occluder, strict=True)))


def _numbers(row: Any, count: int) -> tuple[float, ...]:
    if not isinstance(row, list) or len(row) != count or not all(type(x) in (int, float) for x in row):
        raise ValueError(f"not {count} numbers: {ascii(row)[:60]}")
    found = tuple(float(x) for x in row)
    if not all(abs(x) <= LARGEST for x in found):
        raise ValueError(f"numbers beyond {LARGEST:g}: {ascii(row)[:60]}")
    return found


def _of(things: list, number: Any) -> Any:
    """The thing of a number; raises IndexError for what is none."""
    if type(number) is not int or number < 0:
        raise IndexError(number)
    return things[number]


def _bounds(hulls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Boxes around hulls (m, k, 3), a little larger than rounded sums need: lower and upper corners (m, 3)."""
    room = 1e-12 * np.abs(hulls).max((1, 2), initial=0.0)[:, None]
    return hulls.min(1) - room, hulls.max(1) + room


def _functions(light: Point, ends: list, a: Point, e1: Point, e2: Point) -> list[list]:
    """U, V, W and B of segments from a light to a prism, at the three corners of its floor or its ceiling, whichever is
    less; none where the light is in the triangle's plane."""
    n, s = cross(e1, e2), minus(light, a)
    side = dot(s, n)
    if side == 0:
        return []
    sign, found = (1 if side > 0 else -1), []
    for end in ends:
        d = minus(end, light)
        u, v, along = dot(d, cross(e2, s)), dot(d, cross(s, e1)), -dot(d, n)
        found.append([sign * x for x in (u, v, along - u - v, along - side)])
    return [[min(found[k][j], found[3 + k][j]) for k in range(3)] for j in range(4)]


def _cut(polygon: list, f: Sequence) -> list:
    """A convex polygon, in barycentric coordinates, where a linear function, given at the corners, is not negative."""
    values, kept = [dot(f, p) for p in polygon], []
    for (p, a), (q, b) in zip(zip(polygon, values), zip(polygon[1:] + polygon[:1], values[1:] + values[:1])):
        if a >= 0:
            kept.append(p)
        if a * b < 0:
            t = Fraction(a) / (a - b)
            kept.append(tuple(x + t * (y - x) for x, y in zip(p, q, strict=True)))
    return kept


def _area(polygon: list) -> Any:
    """Twice the area of a polygon in barycentric coordinates."""
    found = Fraction(0)
    for p, q in pairwise(polygon[1:]):
        a, b = minus(p, polygon[0]), minus(q, polygon[0])
        found += a[0] * b[1] - a[1] * b[0]
    return abs(found)

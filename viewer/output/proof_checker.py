"""Check proofs of visibility in exact arithmetic.

It shares no code with what made them: all numbers of a file are made integers, by the same power of two, and integers
decide.  A proof is about all segments from a light to a prism, whose six corners are given.

- "full": they cross the triangles `by`.  The four functions that say so, U, V, W and B, are linear in where a segment
  ends, so that each triangle hides a convex part of the prism; what all hide is cut off the whole, and nothing may be
  left.
- "lit": they cross nothing.  The hull of light and prism is convex, and so is each triangle, or box: a plane lies
  between them, which is looked for in floating point, and then held against all corners.
"""

from __future__ import annotations

from itertools import product
from typing import Any, NamedTuple

import numpy as np

SHAPES = {"lights": (3,), "triangles": (9,), "boxes": (6,), "cells": (6, 3)}  # of the numbers of each
SHAFT_EDGES = [(0, k) for k in range(1, 7)] + [(1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)]
FACES = [0, 1, 2, 3, 4, 5, 6, 9, 0, 1, 2], [1, 2, 0, 4, 5, 3, 7, 10, 12, 13, 14]  # pairs of edges in a face
LARGEST = 1e30  # of numbers, so that products are finite
BITS = 48  # of the normals of planes: any normal will do


class Answer(NamedTuple):
    """Whether a proof holds; why not, in words, where it does not."""

    holds: bool
    why: str = ""


class Things(NamedTuple):
    """What is in a file: as floating-point numbers, or as integers in arrays of objects."""

    lights: np.ndarray  # (l, 3)
    triangles: np.ndarray  # (t, 3, 3): a corner and two edges
    cells: np.ndarray  # (c, 6, 3)
    hulls: np.ndarray  # (m, 8, 3): corners of all that may hide a light, triangles and then boxes

    @classmethod
    def of(cls, lights: np.ndarray, triangles: np.ndarray, boxes: np.ndarray, cells: np.ndarray) -> Things:
        triangles = triangles.reshape(-1, 3, 3)
        of_triangles = triangles[:, [0, 1, 2, 0, 0, 0, 0, 0]]
        of_triangles[:, 1:3] += triangles[:, :1]
        of_boxes = boxes.reshape(-1, 2, 3)[:, list(product((0, 1), repeat=3)), [0, 1, 2]]
        return cls(lights, triangles, cells, np.concatenate([of_triangles, of_boxes]))


class Checker:
    """Checks the proofs of a file, as JSON has it; raises ValueError, in one line, where it is none."""

    def __init__(self, data: Any) -> None:
        try:
            lights, triangles, boxes, cells = (_numbers(data[name], name) for name in SHAPES)
            self.proofs = [(p["cell"], p["light"], p["verdict"], p["by"]) for p in data["proofs"]]
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            missing = " is missing" if isinstance(error, KeyError) else ""
            raise ValueError(f"these are no proofs: {error}{missing}") from None
        if not self.proofs:
            raise ValueError("there are no proofs in it")
        boxes = boxes[boxes[:, 0] <= boxes[:, 3]]  # those of what moves are empty
        self._rounded = Things.of(lights, triangles, boxes, cells)
        parts = [np.frexp(numbers) for numbers in (lights, triangles, boxes, cells)]
        least = min(exponent.min(initial=0) for _, exponent in parts)
        whole = [((m * 2.0**53).astype(np.int64), exponent - least) for m, exponent in parts]
        self._exact = Things.of(*(m.astype(object) << shift.astype(object) for m, shift in whole))
        self._low, self._high = _bounds(self._rounded.hulls)
        e1, e2 = self._rounded.triangles[:, 1], self._rounded.triangles[:, 2]
        self._edges = np.concatenate([np.stack([e1, e2, e2 - e1], 1), np.tile(np.eye(3), (len(boxes), 1, 1))])

    def check(self, proof: tuple[int, int, str, list[int]]) -> Answer:
        """Check a proof."""
        cell, light, verdict, by = proof
        lights, triangles, cells, _ = map(len, self._exact)
        by = list(by) if isinstance(by, list | tuple) else [-1]
        named = [(cell, cells), (light, lights), *((k, triangles) for k in by)]
        if not all(type(number) is int and 0 <= number < count for number, count in named):
            return Answer(False, "it names what is not in the file")
        rounded, exact = (np.vstack([file.lights[light], file.cells[cell]]) for file in (self._rounded, self._exact))
        if verdict == "full":
            return self._check_full(exact, self._exact.triangles[by])
        if verdict == "lit":
            return self._check_lit(rounded, exact)
        return Answer(False, "its verdict is neither full nor lit")

    def _check_full(self, shaft: np.ndarray, blockers: np.ndarray) -> Answer:
        """Of a shaft (7, 3), the light and the corners of the prism."""
        pieces = [np.eye(3, dtype=int).astype(object)]
        for triangle in blockers:
            functions, left = _functions(shaft[0], shaft[1:], *triangle), []
            for inside in pieces:
                for f in functions:  # what lies outside of one of them is left
                    left.append(_cut(inside, -f))
                    inside = _cut(inside, f)
            pieces = [some for some in left if _has_area(some)]
        return Answer(False, "a part of it is not hidden by the triangles that it names") if pieces else Answer(True)

    def _check_lit(self, shaft: np.ndarray, exact: np.ndarray) -> Answer:
        """If a plane lies between two hulls, then one along a face of one of them, or along an edge of each."""
        (low, high), edges = _bounds(shaft[None]), np.array([shaft[i] - shaft[j] for i, j in SHAFT_EDGES])
        faces = np.cross(edges[FACES[0]], edges[FACES[1]])
        near = np.flatnonzero(((self._low <= high) & (self._high >= low)).all(1))
        for k in near[~self._are_apart(faces, shaft, exact, near)]:  # few, of which all planes are tried
            theirs = self._edges[k]
            tried = [faces, np.cross(theirs, theirs[[1, 2, 0]]), np.cross(edges[:, None], theirs).reshape(-1, 3)]
            if not self._are_apart(np.concatenate(tried), shaft, exact, np.array([k])).all():
                return Answer(False, "no plane is found between it and something that may hide the light")
        return Answer(True)

    def _are_apart(self, normals: np.ndarray, shaft: np.ndarray, exact: np.ndarray, others: np.ndarray) -> np.ndarray:
        """Of which of `others`, numbers of hulls, a plane with one of normals (n, 3) parts a shaft: the one that leaves
        the widest gap in floating point, held against all corners exactly."""
        sizes = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = normals / np.where(sizes > 0.0, sizes, 1.0)
        ours, theirs = normals @ shaft.T, self._rounded.hulls[others] @ normals.T
        best = np.maximum(theirs.min(1) - ours.max(1), ours.min(1) - theirs.max(1)).argmax(1)
        planes = np.rint(normals * 2.0**BITS).astype(np.int64).astype(object)
        ours, theirs = planes @ exact.T, (self._exact.hulls[others] @ planes[best][:, :, None])[..., 0]
        return (theirs.min(1) > ours.max(1)[best]) | (theirs.max(1) < ours.min(1)[best])


def _numbers(rows: Any, name: str) -> np.ndarray:
    """What a file has of this name, as an array; raises ValueError where that is something else."""
    shape = SHAPES[name]
    found = np.array(rows or np.empty((0, *shape)), object)
    are_numbers = found.shape[1:] == shape and {*map(type, found.flat)} <= {int, float}
    numbers = found.astype(np.float64) if are_numbers else np.array(np.nan)
    if not (np.abs(numbers) <= LARGEST).all():
        raise ValueError(f"{name} are not {' x '.join(map(str, shape))} numbers each, up to {LARGEST:g}")
    return numbers


def _bounds(hulls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Boxes around hulls (m, k, 3), a little larger than rounded sums need: lower and upper corners (m, 3)."""
    room = 1e-12 * np.abs(hulls).max((1, 2), initial=0.0)[:, None]
    return hulls.min(1) - room, hulls.max(1) + room


def _functions(light: np.ndarray, ends: np.ndarray, a: np.ndarray, e1: np.ndarray, e2: np.ndarray) -> np.ndarray:
    """(4, 3): U, V, W and B of segments from a light to a prism, at the three corners of its floor or its ceiling,
    whichever is less; one that is below 0 where the light is in the triangle's plane, which hides nothing."""
    n, s, d = np.cross(e1, e2), light - a, ends - light
    side = s @ n
    if side == 0:
        return np.full((1, 3), -1, object)
    u, v, along = d @ np.cross(e2, s), d @ np.cross(s, e1), -(d @ n)
    found = np.array([u, v, along - u - v, along - side]) * (1 if side > 0 else -1)
    return np.minimum(found[:, :3], found[:, 3:])


def _cut(polygon: np.ndarray, f: np.ndarray) -> np.ndarray:
    """A convex polygon (n, 3), in barycentric coordinates times anything above 0, where a linear function, given at the
    corners, is not negative."""
    kept, values = [], polygon @ f
    for p, q, a, b in zip(polygon, np.roll(polygon, -1, 0), values, np.roll(values, -1), strict=True):
        if a >= 0:
            kept.append(p)
        if a * b < 0:
            between = abs(b) * p + abs(a) * q
            kept.append(between // np.gcd.reduce(between))
    return np.array(kept, object).reshape(-1, 3)


def _has_area(polygon: np.ndarray) -> bool:
    """Whether a convex polygon is more than a line, a point or nothing."""
    return bool(len(polygon)) and any(np.cross(polygon[1:-1], polygon[2:]) @ polygon[0])

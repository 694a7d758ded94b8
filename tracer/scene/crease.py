"""Normals of meshes that have none: round where the surface is, sharp at its creases.

A corner's normal is the mean of the normals of the faces around its vertex that are bent by no more than the crease
angle against its own, weighted by their angles there (Thürmer and Wüthrich 1998). So it depends neither on how a flat
face is cut into triangles nor on whether triangles share their vertices in the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import kernel
from tracer.scene.arrays import BLOCK, Float32, Float64, Int32, Report
from tracer.scene.distinct_points import DistinctPoints

MOST_AROUND = 64
"""Other faces that are asked at a vertex: the hub of a fan of thousands is asked for those nearest in the file."""


def creased_normals(
    vertices: Float32 | Float64,
    faces: NDArray[np.integer],
    degrees: float,
    report: Report = lambda done: None,
    place: Int32 | None = None,
) -> Float32:
    """(n, 3, 3) normals of the corners of faces (n, 3), of any length; those of faces without area are zero.

    `degrees` is the crease angle; at 0, only faces in one plane are smoothed, which changes nothing to be seen.
    `place` (k,) numbers the places of vertices (k, 3) where that is known, from 0 without a gap. `report` is given the
    part that is done, again and again, and may raise Cancelled."""
    n = len(faces)
    if place is None:
        place = _places(vertices, report)
    normals, angles = np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    ends = np.zeros(int(place.max(initial=-1)) + 2, np.int64)
    with np.errstate(all="ignore"):  # what is not finite is found, and named, later
        for part, some in _blocks(faces):
            report(0.2 + 0.2 * part.start / n)
            measure_faces(np.ascontiguousarray(vertices[some], np.float64), normals[part], angles[part])
            count_around(some, place, ends[1:])
        np.cumsum(ends, out=ends)
        around = np.empty(3 * n, np.int32)
        for part, some in _blocks(faces):
            report(0.4 + 0.2 * part.start / n)
            sort_around(some, part.start, place, ends, around)
        found = np.empty((n, 3, 3), np.float32)
        least = np.cos(np.radians(degrees)) - 1e-9
        for part, some in _blocks(faces):
            report(0.6 + 0.4 * part.start / n)
            smooth(some, part.start, place, ends, around, normals, angles, least, found[part])
    return found


def _blocks(faces: NDArray[np.integer]) -> Iterator[tuple[slice, Int32]]:
    for start in range(0, len(faces), BLOCK):
        part = slice(start, start + BLOCK)
        yield part, np.ascontiguousarray(faces[part], np.int32)


def _places(vertices: Float32 | Float64, report: Report) -> Int32:
    """(vertices,) numbers that are equal where the positions are."""
    places, found = DistinctPoints(len(vertices) // 4), np.empty(len(vertices), np.int32)
    for start in range(0, len(vertices), BLOCK):
        report(0.2 * start / len(vertices))
        found[start : start + BLOCK] = places.numbered(vertices[start : start + BLOCK])
    return found


@kernel
def measure_faces(corners, normals, angles):
    """Unit normals (n, 3) of triangles (n, 3, 3) float64, zero where there is no area, and the angles (n, 3) at their
    corners in radians."""
    edges = np.empty((3, 3))
    for i in range(len(corners)):
        for c in range(3):
            length = 0.0
            for axis in range(3):
                edges[c, axis] = corners[i, (c + 1) % 3, axis] - corners[i, c, axis]
                length += edges[c, axis] * edges[c, axis]
            length = math.sqrt(length)
            for axis in range(3):
                edges[c, axis] /= length if length > 0.0 else 1.0
        for c in range(3):
            before = (c + 2) % 3
            cosine = 0.0
            for axis in range(3):
                cosine -= edges[c, axis] * edges[before, axis]
            angles[i, c] = math.acos(min(max(cosine, -1.0), 1.0))
        x = edges[0, 1] * edges[1, 2] - edges[0, 2] * edges[1, 1]
        y = edges[0, 2] * edges[1, 0] - edges[0, 0] * edges[1, 2]
        z = edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]
        length = math.sqrt(x * x + y * y + z * z)
        scale = 1.0 / length if length > 1e-12 else 0.0
        normals[i, 0], normals[i, 1], normals[i, 2] = x * scale, y * scale, z * scale


@kernel
def count_around(faces, place, counts):
    """Count the corners of faces (n, 3) at each place; `place` says where each vertex lies."""
    for i in range(len(faces)):
        for c in range(3):
            counts[place[faces[i, c]]] += 1


@kernel
def sort_around(faces, first, place, ends, around):
    """Put the corners of faces (n, 3), of which the first is face `first`, to their places in `around`, in the order of
    the file; `ends` says where the next one of each place goes."""
    for i in range(len(faces)):
        for c in range(3):
            at = place[faces[i, c]]
            around[ends[at]] = 3 * (first + i) + c
            ends[at] += 1


@kernel
def smooth(faces, first, place, ends, around, normals, angles, least, found):
    """The normals (n, 3, 3) of the corners of faces (n, 3), of which the first is face `first`: sums over the faces
    around each place, of normals that are bent by a cosine of `least` at least, weighted by angles."""
    for i in range(len(faces)):
        own = first + i
        a, b, c = np.float64(normals[own, 0]), np.float64(normals[own, 1]), np.float64(normals[own, 2])
        for corner in range(3):
            at = place[faces[i, corner]]
            begin = ends[at - 1] if at > 0 else 0
            valence = ends[at] - begin
            weight = np.float64(angles[own, corner])
            x, y, z = a * weight, b * weight, c * weight
            me = 3 * own + corner
            rank = 0
            if valence > MOST_AROUND + 1:
                rank = np.searchsorted(around[begin : begin + valence], me)
            for turn in range(min(valence, MOST_AROUND + 1)):
                step = turn
                if valence > MOST_AROUND + 1:  # the nearest in the file, on both sides
                    step = (rank + ((turn + 1) // 2 if turn % 2 else -(turn // 2))) % valence
                other = around[begin + step]
                if other == me:
                    continue
                face = other // 3
                p, q, r = np.float64(normals[face, 0]), np.float64(normals[face, 1]), np.float64(normals[face, 2])
                if a * p + b * q + c * r >= least:
                    weight = np.float64(angles[face, other % 3])
                    x, y, z = x + p * weight, y + q * weight, z + r * weight
            found[i, corner, 0], found[i, corner, 1], found[i, corner, 2] = x, y, z

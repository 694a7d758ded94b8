"""Normals of meshes that have none: round where the surface is, sharp at its creases.

A corner's normal is the mean of the normals of the faces around its vertex that are bent by no more than the crease
angle against its own, weighted by their angles there (Thürmer and Wüthrich 1998). So it depends neither on how a flat
face is cut into triangles nor on whether triangles share their vertices in the file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Float32, Float64, Int32
from tracer.scene.distinct_points import DistinctPoints
from tracer.scene.mesh_kernels import count_around, measure_faces, smooth, sort_around

BLOCK = 1 << 18
"""Faces that are worked on at once."""

Report = Callable[[float], None]


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

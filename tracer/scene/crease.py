"""Normals of meshes that have none: round where the surface is, sharp at its creases.

A corner's normal is the mean of the normals of the faces around its vertex that are bent by no more than the crease
angle against its own, weighted by their angles there (Thürmer and Wüthrich 1998). So it depends neither on how a flat
face is cut into triangles nor on whether triangles share their vertices in the file.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Float64

BLOCK = 1 << 18
"""Faces that are worked on at once: all of a mesh at once would take a gigabyte for each million."""

MOST_AROUND = 64
"""Other faces that are asked at a vertex: the hub of a fan of thousands is asked for those nearest in the file."""


def creased_normals(
    vertices: Float64, faces: NDArray[np.int64], degrees: float, report: Callable[[], None] = lambda: None
) -> Float64:
    """(n, 3, 3) normals of the corners of faces (n, 3); those of faces without area are zero.

    `degrees` is the crease angle; at 0, only faces in one plane are smoothed, which changes nothing to be seen.
    `report` is called again and again on the way, and may raise Cancelled."""
    with np.errstate(all="ignore"):  # what is not finite is found, and named, later
        vertices = np.asarray(vertices, np.float64)
        normals, angles = np.empty((len(faces), 3)), np.empty((len(faces), 3))
        for start in range(0, len(faces), BLOCK):
            report()
            part = slice(start, start + BLOCK)
            normals[part], angles[part] = _faces(vertices[faces[part]])
        place = _places(vertices)[faces].reshape(-1)
        order = np.argsort(place, kind="stable")
        place = place[order]
        found = np.empty((len(order), 3))
        least = np.cos(np.radians(degrees)) - 1e-9
        start = 0
        while start < len(order):  # so many vertices at once, each with all faces around it
            report()
            end = min(start + 3 * BLOCK, len(order))
            end = int(np.searchsorted(place, place[end - 1], side="right"))
            corners = order[start:end]
            found[corners] = _sums(place[start:end], normals[corners // 3], angles.reshape(-1)[corners], least)
            start = end
    return found.reshape(-1, 3, 3)


def _sums(place: NDArray[np.int64], own: Float64, angles: Float64, least: float) -> Float64:
    """(n, 3) sums over the faces around each of n corners, in the order of places, of normals (n, 3) that are bent
    by a cosine of `least` at least, weighted by angles (n,)."""
    numbers = place - place[0]
    firsts = np.searchsorted(place, place)
    valence = np.bincount(numbers)[numbers]
    rank = np.arange(len(place)) - firsts
    weighted = own * angles[:, None]
    sums = weighted.copy()
    active = np.arange(len(place))
    for turn in range(1, MOST_AROUND + 1):
        active = active[valence[active] > turn]
        if not len(active):
            break
        step = (turn + 1) // 2 if turn % 2 else -(turn // 2)  # the nearest in the file first, on both sides
        other = firsts[active] + (rank[active] + step) % valence[active]
        near = np.einsum("ij,ij->i", own[active], own[other]) >= least
        sums[active[near]] += weighted[other[near]]
    return sums


def _faces(corners: Float64) -> tuple[Float64, Float64]:
    """Unit normals (n, 3), zero where there is no area, and the angles (n, 3) at the corners in radians."""
    edges = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(edges, axis=2, keepdims=True)
    edges = edges / np.where(lengths > 0, lengths, 1.0)
    cosines = -np.einsum("nij,nij->ni", edges, np.roll(edges, 1, axis=1))
    normals = np.cross(edges[:, 0], edges[:, 1])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    flat = ~(length > 1e-12)
    return np.where(flat, 0.0, normals / np.where(flat, 1.0, length)), np.arccos(np.clip(cosines, -1.0, 1.0))


def _places(vertices: Float64) -> NDArray[np.int64]:
    """(vertices,) numbers that are equal where the positions are."""
    order = np.lexsort(vertices.T)
    placed = vertices[order]
    new = np.concatenate([[False], (placed[1:] != placed[:-1]).any(axis=1)])
    numbers = np.empty(len(vertices), np.int64)
    numbers[order] = np.cumsum(new[: len(vertices)])
    return numbers

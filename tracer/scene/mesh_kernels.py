"""What is done for every corner of a mesh of millions: to find those that share a place, and to smooth over them.

Each kernel does a part of the corners at a time, so that it can be given up in between.
"""

from __future__ import annotations

import math

import numpy as np

from tracer.runtime.kernels import kernel

MOST_AROUND = 64
"""Other faces that are asked at a vertex: the hub of a fan of thousands is asked for those nearest in the file."""


@kernel
def number_places(words, begin, places, count, table, seed, numbers):
    """Number the points that are words (n, 3) uint32 from `begin` on by the places (m, 3) that they lie at, `count` of
    which are there; new ones are added.  The table (a power of two,) int32 holds their numbers, and -1 elsewhere.

    Returns how many points are numbered, and how many places there are now: fewer than all where the places or half of
    the table are full."""
    mask = np.uint64(len(table) - 1)
    for i in range(begin, len(words)):
        if count == len(places) or 2 * count >= len(table):
            return i, count
        a, b, c = words[i, 0], words[i, 1], words[i, 2]
        mixed = (seed ^ np.uint64(a)) * np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(29)) ^ np.uint64(b)) * np.uint64(0xC2B2AE3D27D4EB4F)
        mixed = (mixed ^ (mixed >> np.uint64(31)) ^ np.uint64(c)) * np.uint64(0x165667B19E3779F9)
        slot = (mixed ^ (mixed >> np.uint64(32))) & mask
        while True:
            number = table[slot]
            if number < 0:
                number = count
                table[slot] = number
                places[number, 0], places[number, 1], places[number, 2] = a, b, c
                count += 1
                break
            if places[number, 0] == a and places[number, 1] == b and places[number, 2] == c:
                break
            slot = (slot + np.uint64(1)) & mask
        numbers[i] = number
    return len(words), count


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

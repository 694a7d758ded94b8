"""Patches: flat pieces of surface, each of many triangles perhaps, that may hide lights from a whole region.

Walls and floors are mostly cut into triangles of which none hides a lamp alone.  Triangles of one plane that share
edges form a patch.  Its outline are the edges that belong to one triangle only; a path on the plane that crosses no
outline stays on the patch or off it.

Only geometry that never moves is taken, so that what patches hide stays hidden.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Float64 = NDArray[np.float64]

LANES = 16
CONSIDERED, MOST = 1 << 16, 8192  # the largest triangles of a scene, and the largest patches of these
COPLANAR = 1e-10  # what the cosine of two normals may fall short of 1 by
ALIKE = 2.0  # what the slenderness of triangles in one patch may differ by from one to the next, as a factor
FLAT = 1e-5  # of a patch's extent: how far its corners may lie off its plane


class Patches(NamedTuple):
    """n patches, those close together next to each other.  Points of a plane have two coordinates, along its axes.

    Attributes:
        frames: (n, 3, 4) float64: rows that take (x, y, z, 1) to the two coordinates and to the height above the plane.
        boxes: (n, 4) float64, the lower and the upper corner around the patch in its plane.
        shapes: (n, 5) float64, what errors grow with: the greatest |e1| + |e2| and |e1||e2| of its triangles over the
            length of their normal, the longest edge, how far corners lie off the plane, and the greatest sine of the
            angle between a triangle's normal and the plane's.
        ranges: (n, 3) int32, where each patch's edges begin, where those follow that two of its triangles share, and
            where it ends.
        edges: (m, 4) float64, both ends of an edge in the plane.
        filters: (n / 16, 16, 16) float32, frames (the first 12) and boxes by column, of sixteen patches at a time;
            those past n are empty.
        around: (n / 256, 6, 16) float32, the lower and upper corners of boxes around groups of sixteen patches, sixteen
            groups at a time; those of nothing are inverted.
        first: (n,) int32, the number of one of its triangles.
    """

    frames: Float64
    boxes: Float64
    shapes: Float64
    ranges: NDArray[np.int32]
    edges: Float64
    filters: NDArray[np.float32]
    around: NDArray[np.float32]
    first: NDArray[np.int32]


def find_patches(triangles: NDArray[np.float32], merges: bool) -> Patches:
    """The patches of triangles (t, 9), corner and two edges; without `merges` every triangle is one of its own."""
    rows = triangles.astype(np.float64)
    c = np.stack([rows[:, :3], rows[:, :3] + rows[:, 3:6], rows[:, :3] + rows[:, 6:]], 1)
    corners = c.astype(np.float32)  # neighbours have these in common
    normals = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    area = np.linalg.norm(normals, axis=1)
    chosen = np.argsort(-area, kind="stable")[: CONSIDERED if merges else MOST]
    chosen = chosen[area[chosen] > 0.0]
    if not len(chosen):
        return _patches(c[chosen], normals[chosen], chosen, chosen.astype(np.int32), corners[chosen])
    c, area, unit = c[chosen], area[chosen], normals[chosen] / area[chosen, None]
    group = _groups(corners[chosen], unit) if merges else np.arange(len(chosen))
    group = _flat_groups(group, c, unit, area)

    # Keep the patches with the largest area, in an order in which neighbours are close.
    names, group = np.unique(group, return_inverse=True)
    kept = np.argsort(-np.bincount(group, area), kind="stable")[:MOST]
    centers = np.stack([np.bincount(group, c[:, :, axis].mean(1) * area) for axis in range(3)], 1)
    kept = kept[_halved((centers / np.bincount(group, area)[:, None])[kept])]
    rank = np.full(len(names), len(kept))
    rank[kept] = np.arange(len(kept))
    group = rank[group]
    order = np.argsort(group, kind="stable")
    order = order[group[order] < len(kept)]
    return _patches(c[order], unit[order], group[order], chosen[order].astype(np.int32), corners[chosen[order]])


def _halved(places: Float64) -> NDArray[np.int64]:
    """An order of places (n, 3) in which sixteen that follow each other are close: halved again and again."""
    order, waiting = np.arange(len(places)), [(0, len(places))]
    while waiting:
        first, last = waiting.pop()
        if last - first > LANES:
            here = order[first:last]
            axis = int(np.argmax(np.ptp(places[here], axis=0)))
            order[first:last] = here[np.argsort(places[here, axis], kind="stable")]
            middle = first + LANES * max(1, (last - first) // (2 * LANES))
            waiting += [(first, middle), (middle, last)]
    return order


def _edge_keys(corners: NDArray[np.float32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """A number for each edge (t, 3) of triangles, the same for edges between the same corners; and the corners' (t, 3).

    The k-th edge lies opposite the k-th corner."""
    _, vertices = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    vertices = vertices.reshape(-1, 3).astype(np.int64)
    ends = np.stack([vertices[:, [1, 2]], vertices[:, [2, 0]], vertices[:, [0, 1]]], 1)
    return ends.min(2) * (vertices.max() + 1) + ends.max(2), vertices


def _groups(corners: NDArray[np.float32], unit: Float64) -> NDArray[np.int64]:
    """The group (t,) of each triangle: they share edges, lie in one plane, and do not overlap where they meet."""
    keys, _ = _edge_keys(corners)
    order = np.argsort(keys.reshape(-1), kind="stable")
    key = keys.reshape(-1)[order]
    first = np.flatnonzero(np.r_[True, key[1:] != key[:-1]])
    pairs = first[np.diff(np.r_[first, len(key)]) == 2]
    (a, i), (b, j) = np.divmod(order[pairs], 3), np.divmod(order[pairs + 1], 3)
    c = corners.astype(np.float64)
    start, along = c[a, (i + 1) % 3], c[a, (i + 2) % 3] - c[a, (i + 1) % 3]
    sides = [np.einsum("ij,ij->i", unit[a], np.cross(along, c[t, k] - start)) for t, k in ((a, i), (b, j))]
    coplanar = np.abs(np.einsum("ij,ij->i", unit[a], unit[b])) > 1.0 - COPLANAR
    slender = _slenderness(c)
    alike = np.maximum(slender[a], slender[b]) <= ALIKE * np.minimum(slender[a], slender[b])
    joined = coplanar & alike & (sides[0] * sides[1] < 0.0)
    a, b = a[joined], b[joined]
    group = np.arange(len(corners))
    while True:
        least = np.minimum(group[a], group[b])
        following = group.copy()
        np.minimum.at(following, group[a], least)
        np.minimum.at(following, group[b], least)
        following = following[following]
        if (following == group).all():
            return group
        group = following


def _slenderness(c: Float64) -> Float64:
    """(t,) |e1| + |e2| over the length of the normal, of triangles with corners (t, 3, 3): what errors grow with."""
    e1, e2 = c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]
    across = np.linalg.norm(np.cross(e1, e2), axis=1)
    return (np.linalg.norm(e1, axis=1) + np.linalg.norm(e2, axis=1)) / across


def _flat_groups(group: NDArray[np.int64], c: Float64, unit: Float64, area: Float64) -> NDArray[np.int64]:
    """The same groups, but for those that bend: their triangles stay alone."""
    leader = np.full(len(group), -1)
    order = np.argsort(area, kind="stable")
    leader[group[order]] = order  # the largest triangle of each
    plane = leader[group]
    off = np.abs(np.einsum("ikj,ij->ik", c - c[plane, :1], unit[plane])).max(1)
    size = np.abs(c - c[plane, :1]).max((1, 2))
    far, extent = np.zeros(len(group)), np.zeros(len(group))
    np.maximum.at(far, group, off)
    np.maximum.at(extent, group, size)
    bent = (far > FLAT * extent)[group]
    return np.where(bent, len(group) + np.arange(len(group)), group)


def _patches(
    c: Float64, unit: Float64, group: NDArray[np.int64], numbers: NDArray[np.int32], corners: NDArray[np.float32]
) -> Patches:
    """Patches of triangles that are sorted by group: 0, 1, ..."""
    starts = np.flatnonzero(np.r_[True, np.diff(group) != 0]) if len(group) else np.empty(0, np.int64)
    n = len(starts)
    e1, e2 = c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]
    first, second, third = (np.linalg.norm(e, axis=1) for e in (e1, e2, e2 - e1))
    across = np.linalg.norm(np.cross(e1, e2), axis=1)

    # Axes in each plane: an edge of its first triangle, so that walls lie along them.
    w = unit[starts]
    u = e1[starts] / first[starts, None]
    v = np.cross(w, u)
    frames = np.zeros((n, 3, 4))
    frames[:, :, :3] = np.stack([u, v, w], 1)
    frames[:, :, 3] = -np.einsum("nij,nj->ni", frames[:, :, :3], c[starts, 0])
    local = np.einsum("tij,tkj->tki", frames[group, :, :3], c) + frames[group, None, :, 3]

    def greatest(values: Float64) -> Float64:
        return np.maximum.reduceat(values, starts, axis=-1) if n else values

    boxes = np.stack(
        [-greatest(-local[:, :, 0].min(1)), -greatest(-local[:, :, 1].min(1)),
         greatest(local[:, :, 0].max(1)), greatest(local[:, :, 1].max(1))], 1,
    )  # fmt: skip
    shapes = np.stack(
        [greatest(_slenderness(c)), greatest(first * second / across),
         greatest(np.maximum(np.maximum(first, second), third)), greatest(np.abs(local[:, :, 2]).max(1)),
         greatest(np.linalg.norm(np.cross(unit, w[group]), axis=1))], 1,
    )  # fmt: skip

    # Edges that belong to one triangle of the patch only, and then those that two share.
    edges, ranges = np.empty((0, 4)), np.zeros((n, 3), np.int32)
    if n:
        keys, _ = _edge_keys(corners)
        _, one, same, count = np.unique(
            np.stack([np.repeat(group, 3), keys.reshape(-1)], 1),
            axis=0, return_index=True, return_inverse=True, return_counts=True,
        )  # fmt: skip
        shared = count > 1
        one = one[np.lexsort((shared, group[one // 3]))]
        shared = shared[same.reshape(-1)[one]]
        which, k = np.divmod(one, 3)
        edges = np.concatenate([local[which, (k + 1) % 3, :2], local[which, (k + 2) % 3, :2]], 1)
        outer, ends = np.bincount(group[which[~shared]], minlength=n), np.cumsum(np.bincount(group[which], minlength=n))
        ranges[1:, 0], ranges[:, 2] = ends[:-1], ends
        ranges[:, 1] = ranges[:, 0] + outer
    columns = np.concatenate([frames.reshape(n, 12), boxes], 1)
    low, high = -greatest(-c.min(1).T).T, greatest(c.max(1).T).T
    return Patches(frames, boxes, shapes, ranges, edges, _by_column(columns, 0.0), _around(low, high), numbers[starts])


def _by_column(rows: Float64, nothing: float) -> NDArray[np.float32]:
    """Rows (n, k), sixteen at a time, column by column: (n / 16, k, 16) float32, filled up with `nothing`."""
    n, k = rows.shape
    padded = np.full((-(-n // LANES) * LANES, k), nothing, np.float32)
    padded[:n] = rows
    return np.ascontiguousarray(padded.reshape(-1, LANES, k).transpose(0, 2, 1))


def _around(low: Float64, high: Float64) -> NDArray[np.float32]:
    """Boxes (n / 256, 6, 16) around groups of sixteen boxes, a little larger."""
    groups = np.arange(0, len(low), LANES)
    if not len(groups):
        return np.empty((0, 6, LANES), np.float32)
    low, high = np.minimum.reduceat(low, groups), np.maximum.reduceat(high, groups)
    room = 1e-5 * np.maximum(np.abs(low), np.abs(high)).max()
    return _by_column(np.concatenate([low - room, high + room], 1), np.nan)

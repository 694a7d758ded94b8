"""Blockers: the triangles that are large enough to hide a box of lights from a whole box of space.

Only geometry that never moves is taken, so that what blockers hide stays hidden.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, bits_of, f32x16, load_f32x16, maximum, minimum, square_root
from tracer.visibility.error_bounds import (
    LAMP,
    LANES,
    ZERO,
    Functions,
    bounds,
    cross,
    dot,
    factors,
    functions,
    length16,
    scaled,
    seen_from,
    spread_in_box,
    surely_hit,
)
from tracer.visibility.light_tree import halved

MOST = 8192  # blockers of a scene, the largest triangles
COLUMNS = 9  # of a triangle: a corner and two edges
HUGE = np.float32(3e38)
_ROUNDED, _LAMP = np.float32(1e-6), np.float32(LAMP)


class Blockers(NamedTuple):
    """n triangles, those close together next to each other, in groups of sixteen.

    Attributes:
        groups: (n / 16, COLUMNS, 16) float32, corner and edges of each, by column; those past n have no area.
        around: (n / 256, 6, 16) float32, the lower and upper corners of boxes around groups, sixteen groups at a time;
            those of nothing are NaN.
        numbers: (n,) int32, of the triangles.
        longest: rays no longer than this, in units of the scene, are certain of a hit.
    """

    groups: NDArray[np.float32]
    around: NDArray[np.float32]
    numbers: NDArray[np.int32]
    longest: float


class Hull(NamedTuple):
    """A box, as its middle and half its sides (3,) float32, which are large enough for its corners to be rounded."""

    middle: tuple
    half: tuple


def find_blockers(triangles: NDArray[np.float32], longest: float) -> Blockers:
    """The blockers among triangles (t, 9), corner and two edges, with which rays up to `longest` are certain of
    hits."""
    corner, e1, e2 = (triangles[:, k : k + 3].astype(np.float64) for k in (0, 3, 6))
    across = np.linalg.norm(np.cross(e1, e2), axis=1)
    numbers = np.argsort(-across, kind="stable")[:MOST]
    numbers = numbers[across[numbers] > 0.0]
    numbers = numbers[halved((corner + (e1 + e2) / 3.0)[numbers], LANES, LANES)[0]]
    every = np.stack([corner, corner + e1, corner + e2], 1)[numbers]
    groups = _by_column(triangles[numbers, :COLUMNS], 0.0)
    return Blockers(groups, _around(every.min(1), every.max(1)), numbers.astype(np.int32), longest)


def _by_column(rows: NDArray, nothing: float) -> NDArray[np.float32]:
    """Rows (n, k), sixteen at a time, column by column: (n / 16, k, 16) float32, filled up with `nothing`."""
    n, k = rows.shape
    padded = np.full((-(-n // LANES) * LANES, k), nothing, np.float32)
    padded[:n] = rows
    return np.ascontiguousarray(padded.reshape(-1, LANES, k).transpose(0, 2, 1))


def _around(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float32]:
    """Boxes (n / 256, 6, 16) around groups of sixteen boxes, a little larger."""
    groups = np.arange(0, len(low), LANES)
    if not len(groups):
        return np.empty((0, 6, LANES), np.float32)
    low, high = np.minimum.reduceat(low, groups), np.maximum.reduceat(high, groups)
    room = 1e-5 * np.maximum(np.abs(low), np.abs(high)).max()
    return _by_column(np.concatenate([low - room, high + room], 1), np.nan)


@inlined
def hull_of(boxes, i):
    """The i-th of boxes (n, 6), lower and upper corners, as a `Hull`."""
    x, y, z = (
        np.float32(0.5 * (boxes[i, 0] + boxes[i, 3])),
        np.float32(0.5 * (boxes[i, 1] + boxes[i, 4])),
        np.float32(0.5 * (boxes[i, 2] + boxes[i, 5])),
    )
    hx, hy, hz = (
        np.float32(0.5 * (boxes[i, 3] - boxes[i, 0])),
        np.float32(0.5 * (boxes[i, 4] - boxes[i, 1])),
        np.float32(0.5 * (boxes[i, 5] - boxes[i, 2])),
    )
    return Hull(
        (x, y, z), (hx + _ROUNDED * (hx + abs(x)), hy + _ROUNDED * (hy + abs(y)), hz + _ROUNDED * (hz + abs(z)))
    )


@inlined
def between_middles(blockers, group, lights, region):
    """Bits of the blockers of a group that lie between the middles of two `Hull`s: few others hide one from another."""
    t = seen_from(lights.middle, ZERO, _columns_of(blockers, group))
    x, y, z = region.middle
    way = x - lights.middle[0], y - lights.middle[1], z - lights.middle[2]
    f, _d = functions(t, way, region.middle)
    return bits_of((f.u > ZERO) & (f.v > ZERO) & (f.w > ZERO) & (f.b > ZERO) & (t.height > ZERO))


@inlined
def _columns_of(blockers, group):
    """The columns of sixteen triangles' rows (`error_bounds.seen_from`), as far as they have any."""
    at, zero = address_of(blockers.groups[group]), f32x16(ZERO)
    return (
        load_f32x16(at), load_f32x16(at + 64), load_f32x16(at + 128), load_f32x16(at + 192), load_f32x16(at + 256),
        load_f32x16(at + 320), load_f32x16(at + 384), load_f32x16(at + 448), load_f32x16(at + 512), zero,
    )  # fmt: skip


@subkernel
def that_hide(blockers, group, lights, region):
    """Bits of the blockers of a group that block every ray from one `Hull` to another."""
    row, half = _columns_of(blockers, group), region.half
    t = seen_from(lights.middle, ZERO, row)
    normal = scaled(cross(t.e1, t.e2), t.side)

    # Bound lengths: of rays, and from both of their ends to the triangles' corners.
    reach = lights.half[0] + half[0], lights.half[1] + half[1], lights.half[2] + half[2]
    x, y, z = region.middle
    wx, wy, wz = x - lights.middle[0], y - lights.middle[1], z - lights.middle[2]
    longest = square_root(
        (abs(wx) + reach[0]) * (abs(wx) + reach[0])
        + (abs(wy) + reach[1]) * (abs(wy) + reach[1])
        + (abs(wz) + reach[2]) * (abs(wz) + reach[2])
    ) * (_ROUNDED + np.float32(1))  # fmt: skip
    from_corner = x - row[0], y - row[1], z - row[2]
    near = length16(from_corner) + (half[0] + half[1] + half[2])
    away = t.away + (lights.half[0] + lights.half[1] + lights.half[2])
    coordinates = abs(x) + abs(y) + abs(z) + (half[0] + half[1] + half[2])

    # T over the lights, B over the region, and U, V and W at the corners of the one, over the other.
    by_t, by_b = spread_in_box(normal, lights.half), spread_in_box(normal, half)
    height, highest = t.height - by_t, t.height + by_t
    b = dot(t.d, from_corner)
    along = highest + maximum(b, -b) + by_b  # D = T + B
    u, v, w = f32x16(HUGE), f32x16(HUGE), f32x16(HUGE)
    for k in range(8):
        lx = lights.half[0] if k & 1 else -lights.half[0]
        ly = lights.half[1] if k & 2 else -lights.half[1]
        lz = lights.half[2] if k & 4 else -lights.half[2]
        s, way = (t.s[0] + lx, t.s[1] + ly, t.s[2] + lz), (wx - lx, wy - ly, wz - lz)
        to_u, to_v = scaled(cross(t.e2, s), t.side), scaled(cross(s, t.e1), t.side)
        to_w = t.d[0] - to_u[0] - to_v[0], t.d[1] - to_u[1] - to_v[1], t.d[2] - to_u[2] - to_v[2]
        u = minimum(u, dot(to_u, way) - spread_in_box(to_u, half))
        v = minimum(v, dot(to_v, way) - spread_in_box(to_v, half))
        w = minimum(w, dot(to_w, way) - spread_in_box(to_w, half))

    # Corners of the lights, and spreads, are rounded a few times more than `factors` know: as if the light were
    # farther.
    further = np.float32(1.25) * away
    f = factors(t.first, t.second, maximum(t.first, t.second), t.across, further, highest, ZERO)
    hit = t.in_range & surely_hit(Functions(u, v, w, b - by_b), bounds(f, f32x16(longest), near, along, coordinates))
    hit = hit & (height > t.unsure * (further / t.away)) & (height > _LAMP * along)
    return bits_of(hit & (f32x16(longest) < np.float32(blockers.longest)))

"""A frustum against boxes: which boxes rays that travel together may enter at all.

Take sixteen rays whose directions have the same sign along one axis k.  At every distance along k they are bounded by
the intervals in which they start and the intervals of their slopes du/dk and dv/dk along the other two axes u and v
(after Reshetov, Soupikov, Hurley 2005, and Overbeck, Ramamoorthi, Mark 2008).  Unlike bounds on where rays meet the six
planes of a box, this has no cases for mixed signs, and lengths of directions do not matter.

The same code tests one frustum against eight boxes and one box against eight frusta: either may be vectors.

A box that is refused is one that every ray refuses: slopes and distances are wider by MARGIN than rounding can make a
ray's own test (`packet.lanes_inside`), whose differences and products are wrong by a few 1e-7 of themselves.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.simd import load_f32, load_f32x8, maximum, minimum

MARGIN = np.float32(2e-6)
NO_RAYS = np.float32(-1)  # where a frustum ends that holds no ray: before it begins


class Axes(NamedTuple):
    """The axis that frusta go along, 1 or -1 for the way, and, for a box whose six numbers lie 32 bytes
    apart, where its planes are: near and far along the axis, low and high along the other two."""

    along: Any
    way: Any
    near: Any
    far: Any
    low_u: Any
    high_u: Any
    low_v: Any
    high_v: Any


class Frustum(NamedTuple):
    """Bounds of rays: where they start, along the axis in the way they go and along the other two axes; their slopes;
    and the distance along the axis from which on they look."""

    start0: Any
    start1: Any
    u_start0: Any
    u_start1: Any
    v_start0: Any
    v_start1: Any
    u0: Any
    u1: Any
    v0: Any
    v1: Any
    near: Any


@inlined
def axes_of(axis, way):
    """Frusta along an axis, 0 to 2, upwards for 1 and downwards for -1."""
    u, v = 32 * ((axis + 1) % 3), 32 * ((axis + 2) % 3)
    near = 32 * axis + (96 if way < np.float32(0) else 0)
    return Axes(axis, way, near, 64 * axis + 96 - near, u, u + 96, v, v + 96)


@inlined
def wider(low, high):
    """An interval of slopes, by the margin wider."""
    least, greatest = maximum(low, -low), maximum(high, -high)
    return low - MARGIN * least, high + MARGIN * greatest


@inlined
def box_at(a, axes):
    """Planes of the box at an address, as `entering` wants them."""
    return (
        load_f32(a + axes.near) * axes.way, load_f32(a + axes.far) * axes.way,
        load_f32(a + axes.low_u), load_f32(a + axes.high_u), load_f32(a + axes.low_v), load_f32(a + axes.high_v),
    )  # fmt: skip


@inlined
def boxes_at(a, axes):
    """Planes of the eight boxes at an address."""
    return (
        load_f32x8(a + axes.near) * axes.way, load_f32x8(a + axes.far) * axes.way,
        load_f32x8(a + axes.low_u), load_f32x8(a + axes.high_u),
        load_f32x8(a + axes.low_v), load_f32x8(a + axes.high_v),
    )  # fmt: skip


@inlined
def entering(planes, f, reach):
    """(least distance along the axis, mask): which boxes some ray of which frustum may enter, if it looks as far as
    `reach` along the axis."""
    near, far, low_u, high_u, low_v, high_v = planes
    enter, leave = maximum(near - f.start1, f.near), minimum(far - f.start0, reach)
    low_side = minimum(enter * f.u0, leave * f.u0) <= high_u - f.u_start0
    high_side = maximum(enter * f.u1, leave * f.u1) >= low_u - f.u_start1
    bottom = minimum(enter * f.v0, leave * f.v0) <= high_v - f.v_start0
    top = maximum(enter * f.v1, leave * f.v1) >= low_v - f.v_start1
    return enter, (enter <= leave) & low_side & high_side & bottom & top

"""Axis-aligned boxes: (6,) numbers, the lower corner and then the upper; inverted where there is nothing inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined
from tracer.scene.arrays import Float32, Float64
from tracer.simd import as_f32, as_i32, f32x16, maximum, minimum

OUTWARDS = np.array([-1.0, -1.0, -1.0, 1.0, 1.0, 1.0])  # times a number, what makes a box (6,) larger by it
NO_BOX = np.array([1, 1, 1, -1, -1, -1], np.float32)  # around nothing
PADDING = 2e-6  # of a tree's largest coordinate: by so much the boxes that it stores are larger than what they hold
TINY = np.float32(1e-20)  # a component of a direction that is smaller counts as this


def triangle_boxes(rows: Float32) -> Float32:
    """Boxes (n, 6) of triangles (n, 9), corner and two edges."""
    corners = np.stack([rows[:, :3], rows[:, :3] + rows[:, 3:6], rows[:, :3] + rows[:, 6:]], axis=1)
    return np.concatenate([corners.min(1), corners.max(1)], axis=1)


def transform_boxes(boxes: Float64, affine: Float64) -> Float64:
    """Boxes (n, 6) around the images of boxes (n, 6) under affine maps (n, 3, 4) (Arvo 1990), a little larger."""
    middle, half = (boxes[:, 3:] + boxes[:, :3]) * 0.5, (boxes[:, 3:] - boxes[:, :3]) * 0.5
    centre = (affine[:, :, :3] @ middle[:, :, None])[:, :, 0] + affine[:, :, 3]
    reach = (np.abs(affine[:, :, :3]) @ half[:, :, None])[:, :, 0]
    reach = reach + 2e-6 * (np.abs(centre).max(1, initial=0) + reach.max(1, initial=0))[:, None]
    return np.concatenate([centre - reach, centre + reach], axis=1)


def union_of(boxes: NDArray[np.float32]) -> NDArray[np.float32]:
    """The box (6,) around boxes (n, 6), of which inverted ones hold nothing; NO_BOX where none holds anything."""
    boxes = boxes[boxes[:, 0] <= boxes[:, 3]]
    return np.concatenate([boxes[:, :3].min(0), boxes[:, 3:].max(0)]) if len(boxes) else NO_BOX.copy()


@inlined
def inverse(x):
    """1 / x for float32 or vectors of them; for 0 a huge number of its sign, so that 0 * inverse is 0 and never NaN."""
    sign = as_i32(x) & np.int32(-0x80000000)
    size = maximum(as_f32(as_i32(x) ^ sign), TINY)
    return as_f32(as_i32(np.float32(1) / size) | sign)


@inlined
def interval(triangles, i, axis):
    """The lower and upper end of the i-th of triangles (n, 9), corner and two edges, along an axis."""
    a = triangles[i, axis]
    b, c = a + triangles[i, 3 + axis], a + triangles[i, 6 + axis]
    return min(a, min(b, c)), max(a, max(b, c))


@inlined
def hit_box(ray, boxes, i):
    """Interval of t of a ray in the i-th of boxes (lower, upper); empty where first > second (slab test)."""
    b = 6 * i
    ix, iy, iz = inverse(ray.dx), inverse(ray.dy), inverse(ray.dz)
    x0, x1 = (boxes[b] - ray.ox) * ix, (boxes[b + 3] - ray.ox) * ix
    y0, y1 = (boxes[b + 1] - ray.oy) * iy, (boxes[b + 4] - ray.oy) * iy
    z0, z1 = (boxes[b + 2] - ray.oz) * iz, (boxes[b + 5] - ray.oz) * iz
    enter = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), ray.t_min))
    leave = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), ray.t_max))
    return enter, leave


@inlined
def segments_miss_box(start, direction, low, high):
    """In which of 16 lanes the segments from a start (3,), t = 0, to t = 1 miss the box between low (3,) and high (3,).

    Any of these may be float32 or vectors of 16 (slab test)."""
    enter, leave = f32x16(np.float32(0)), f32x16(np.float32(1))
    for axis in range(3):
        backwards = inverse(direction[axis])
        first, last = (low[axis] - start[axis]) * backwards, (high[axis] - start[axis]) * backwards
        enter, leave = maximum(enter, minimum(first, last)), minimum(leave, maximum(first, last))
    return enter > leave

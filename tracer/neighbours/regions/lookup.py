"""Which lights do the points of a wave have to look at?

Sixteen points at a time: lights that one of their regions is left with, and any light where a region has not been
looked into yet.  Of these, lights that lie behind the surface at all sixteen points are left out.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.stages import vectors
from tracer.neighbours.cells_of_space import want
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    any_lane,
    bits_of,
    gather_i32x16,
    i32_at,
    i32x16,
    lanes_below,
    load_three,
    local_memory,
    lowest_bit,
    mark,
    mask16,
    maximum,
    select,
    store,
)
from tracer.visibility.grid import cubes_at

BEHIND = np.float32(1e-5)  # of lengths: by how much a light has to lie behind a surface to be certain of it
NOWHERE = -1  # instead of a region


@subkernel
def look(regions, points, count, looks):
    """Put the vectors of points that have to look at each light into looks (l, words) int64, 64 to a word, in bits.

    regions is a `RegionView`; regions that are not known yet are wanted from now on."""
    lights, words, numbers, lists = len(looks), (vectors(count) + 63) // 64, local_memory(64), local_memory(64)
    for light in range(lights):
        for word in range(words):
            looks[light, word] = -1 if regions.moved[light] else 0
    certified, of, list_of = address_of(regions.certified), i32_at(numbers), i32_at(lists)
    for v in range(vectors(count)):
        x, y, z = load_three(points.lifted, v)
        number = cubes_at(regions.grid, x, y, z, NOWHERE)
        inside = number > np.int32(NOWHERE)
        found = select(inside, gather_i32x16(certified, select(inside, number, i32x16(0))), i32x16(0))
        store(numbers, number)
        store(lists, found)
        bit, word, known = np.int64(1) << (v & 63), v >> 6, True
        before = np.int32(0)
        rest = lanes_below(count, v)
        while rest != 0:
            lane = lowest_bit(rest)
            rest &= rest - 1
            which = list_of[lane]
            if which == 0:
                known = False
                if of[lane] >= 0:
                    mark(address_of(regions.wanted) + of[lane])
            elif which != before and known:
                for k in range(regions.starts[which - 1], regions.starts[which]):
                    looks[regions.lights[k], word] |= bit
            before = which
        if not known:
            for light in range(lights):
                looks[light, word] |= bit
    _leave_out(regions.boxes, points, count, looks)


@inlined
def _behind(box, points, v, there):
    """Whether a light in a box (6,) lies behind the surface at all points of a vector."""
    half = np.float32(0.5)
    cx, cy, cz = half * (box[0] + box[3]), half * (box[1] + box[4]), half * (box[2] + box[5])
    hx, hy, hz = half * (box[3] - box[0]), half * (box[4] - box[1]), half * (box[5] - box[2])
    px, py, pz = load_three(points.position, v)
    gx, gy, gz = load_three(points.geometric, v)
    ax, ay, az = maximum(gx, -gx), maximum(gy, -gy), maximum(gz, -gz)
    dx, dy, dz = cx - px, cy - py, cz - pz
    far = maximum(dx, -dx) + maximum(dy, -dy) + maximum(dz, -dz) + (hx + hy + hz + abs(cx) + abs(cy) + abs(cz))
    most = gx * dx + gy * dy + gz * dz + ax * hx + ay * hy + az * hz
    return not any_lane(there & (most > -BEHIND * far))


@subkernel
def _leave_out(boxes, points, count, looks):
    """Take those vectors out of looks (l, words) whose points a light, in boxes (l, 6), does not face."""
    for light in range(len(looks)):
        for word in range((vectors(count) + 63) // 64):
            rest = looks[light, word]
            while rest != 0:
                bit = lowest_bit(rest)
                v = 64 * word + bit
                rest &= rest - 1
                if v >= vectors(count) or _behind(boxes[light], points, v, mask16(lanes_below(count, v))):
                    looks[light, word] &= ~(np.int64(1) << bit)


@subkernel
def want_around(regions, point, room, there):
    """Want the regions in which points lie that are not known yet, and those that their rays may end in besides, no
    further away than `room` along each axis."""
    numbers = local_memory(64)
    for corner in range(8):
        x = point[0] + (room if corner & 1 else -room)
        y = point[1] + (room if corner & 2 else -room)
        z = point[2] + (room if corner & 4 else -room)
        number = cubes_at(regions.grid, x, y, z, NOWHERE)
        store(numbers, number)
        want(regions.wanted, regions.certified, 0, numbers, bits_of(there & (number > np.int32(NOWHERE))))

"""What is proved of cells and a light: that it is hidden from all of a cell, lights all of it, or what may block it.

A cell begins with what the cell around it is left with (`tracer.culling.voxels.classify`).
"""

from __future__ import annotations

import numpy as np

from tracer.culling.environments.octree import HIDDEN, LIT, UNKNOWN
from tracer.culling.voxels.box_shaft import put_box
from tracer.culling.voxels.classify import CERTIFICATES, MOST, come_between, make_room
from tracer.geometry.memory import borrowed
from tracer.runtime.kernels import kernel


@kernel
def settle(o, light, boxes, above, names, rounded, codes, found, counts):
    """Find the codes (n,) int32 of cells in boxes (n, 6) for a `Light`; above (n,) are those of the cells around them.

    Where blockers are left, the code is their number, and they are in found (n, MOST) int32: more than MOST are not
    named and make UNKNOWN.  names (m,) are those of the cells around.  o are `Occluders`; rounded is more, in units of
    the scene, than planes are wrong by in float32.  counts (COUNTERS,) int64 are added to."""
    o, room = borrowed(o), make_room()
    place = np.float64(light.place[0]), np.float64(light.place[1]), np.float64(light.place[2])
    for i in range(len(boxes)):
        code = above[i]
        if code in (HIDDEN, LIT):
            codes[i] = code
            continue
        given, start = np.int64(MOST + 1), np.int64(0)
        if code > 0:
            given, start = np.int64(names[code]), np.int64(code) + 1
        half = 0.5 * (boxes[i, 3] - boxes[i, 0])
        middle = boxes[i, 0] + half, boxes[i, 1] + half, boxes[i, 2] + half
        put_box(room.shaft, place, middle, half, rounded)
        center = np.float32(middle[0]), np.float32(middle[1]), np.float32(middle[2])
        room.state[0] = room.state[1] = 0
        counts[CERTIFICATES] += 1
        count = come_between(o, light, room, center, np.float32(half), names[start:], given, room.found[0], counts)
        codes[i] = UNKNOWN if count > MOST else (HIDDEN if count < 0 else count)
        for k in range(max(0, min(count, MOST))):
            if count <= MOST:
                found[i, k] = room.found[0, k]

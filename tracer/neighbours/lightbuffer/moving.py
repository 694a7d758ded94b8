"""What moves, as a light sees it: from what depth on, in each direction, anything may be in the way.

Made anew for each frame, from the boxes of objects.  A ray to a point that is nearer need not ask what moves.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import without_refcount
from tracer.neighbours.lightbuffer.cube import FACES, SEAM, axes_of, box_on_face
from tracer.runtime.kernels import kernel

SIDE = 64  # cells
FAR = np.float32(3e38)  # nothing is there
WIDER = 1e-4  # of coordinates and distances, by which boxes are taken to be larger


@kernel
def _put_boxes(boxes, light, side, depths):
    """Put the least depth of any of boxes (k, 6), as seen from light (3,), into depths (FACES, side, side)."""
    boxes, depths = without_refcount((boxes, depths))
    depths[:] = FAR
    for k in range(len(boxes)):
        box = boxes[k]
        size = 0.0
        for axis in range(3):
            size = max(size, abs(box[axis]), abs(box[axis + 3]), abs(light[axis]))
        room = WIDER * size
        for face in range(FACES):
            left, right, low, high, z0, z1 = box_on_face(box, light, room, axes_of(face))
            if z1 <= 0.0 or left > 1.0 + SEAM or right < -1.0 - SEAM or low > 1.0 + SEAM or high < -1.0 - SEAM:
                continue
            first, last, half = (0, 0), (side - 1, side - 1), 0.5 * side
            if z0 > 0.0:
                first = max(0, int((left - SEAM + 1.0) * half)), max(0, int((low - SEAM + 1.0) * half))
                last = (min(side - 1, int((right + SEAM + 1.0) * half)), min(side - 1, int((high + SEAM + 1.0) * half)))
            nearest = np.float32(max(z0, 0.0) * 0.99999)
            for row in range(first[1], last[1] + 1):
                for column in range(first[0], last[0] + 1):
                    depths[face, row, column] = min(depths[face, row, column], nearest)


def depths_of(boxes: NDArray[np.float32], light: NDArray[np.float32], side: int = SIDE) -> NDArray[np.float32]:
    """(FACES, side, side) float32, for boxes (k, 6) in the world and a light (3,)."""
    depths = np.empty((FACES, side, side), np.float32)
    _put_boxes(np.ascontiguousarray(boxes, np.float64), light.astype(np.float64), side, depths)
    return depths

"""What certificates are told of structures whose rays are transformed to the space of each object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.accelerators import MOST_TOGETHER
from tracer.geometry.boxes import OUTWARDS, transform_boxes, triangle_boxes
from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives, WorldTriangles
from tracer.scene.arrays import Float64

TRANSFORMED = 8 * 2.0**-24  # of the coordinates: by so much rays are wrong that are transformed to an object's space
EVEN = (
    1.1  # an object's axes differ by so much in length at most, or else a little in its space may be much in the world
)


class InObjectSpace:
    """Primitives are tested one by one, each in the space of its object, and nothing but its own test decides."""

    together = MOST_TOGETHER  # of which they take no note: they trace rays one by one
    extent = 0.0  # boxes of dynamic objects are not padded
    hit_padding = 1e30  # and a hit need not lie in any

    def __init__(self, primitives: Primitives) -> None:
        self._primitives = primitives

    def certain(self, poses: Poses) -> NDArray[np.bool_]:
        """Those that are not flattened, stretched or sheared.

        What a ray is wrong by in an object's space is more in the world by the ratio of its longest to its shortest
        axis, and the errors of the triangle test there by its square."""
        scales = np.linalg.svd(poses.to_world[:, :, :3], compute_uv=False)
        return scales[:, 0] <= EVEN * scales[:, 2]

    def triangles_of(self, index: int, to_world: Float64) -> WorldTriangles:
        """The triangles of an object that to_world (3, 4) takes to the world; rays go to its space in float32.

        Blurs and boxes hold of objects that are `certain`."""
        local = self._primitives.triangles[self._primitives.triangles_of(index)]
        near = triangle_boxes(local).astype(np.float64)  # a hit lies no further outside than the box is wide
        near += (near[:, 3:] - near[:, :3]).max(1, initial=0.0)[:, None] * 1.0001 * OUTWARDS
        if index == 0:
            return WorldTriangles(local, np.zeros(len(local), np.float32), near.astype(np.float32))
        linear = to_world[:, :3]
        world = local.astype(np.float64).reshape(-1, 3, 3) @ linear.T
        world[:, 0] += to_world[:, 3]
        scales = np.linalg.svd(linear, compute_uv=False)
        reach = np.abs(local).max(initial=0.0) * 2 * scales[0]
        reach += np.abs(to_world[:, 3]).max() + np.abs(world).max(initial=0.0)
        blurs = np.full(len(local), TRANSFORMED * reach, np.float32)
        boxes = transform_boxes(near, np.broadcast_to(to_world, (len(local), 3, 4)))
        boxes = boxes + TRANSFORMED * reach * OUTWARDS
        return WorldTriangles(world.reshape(-1, 9).astype(np.float32), blurs, boxes.astype(np.float32))

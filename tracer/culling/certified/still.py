"""What is static now, as certificates see it: all that never moves, and the objects that rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.margins import EPSILON, LONGEST
from tracer.culling.certified.occluders import BOXES, Occluders, blocks_of, joined, know_light, shape_of
from tracer.geometry.bvh8.collapse import Shape
from tracer.geometry.bvh8.tree import PADDING, WIDTH
from tracer.geometry.primitives import Outlines
from tracer.geometry.world import World
from tracer.parallel import for_each_chunk

CARRIED = 8 * EPSILON  # of the coordinates: what is carried to the world, or rays to it, may be elsewhere by that


class Still:
    """rows (t, 9) float32 and blurs (t,) of triangles as in `Occluders`, of which those of objects that rest are where
    they rest; bounds (2, 3) float64 around all that is static; largest, its largest coordinate."""

    def __init__(self, world: World, lights: int, threads: int) -> None:
        self._primitives, self._lights, self._threads = world.primitives, lights, threads
        primitives = world.primitives
        self.rows = primitives.triangles.copy()
        self.blurs = np.zeros(len(self.rows), np.float32)
        quadrics = primitives.quadrics_of(0)
        self._boxes = np.zeros((len(primitives.quadrics), 6), np.float32)
        self._boxes[quadrics] = primitives.quadric_boxes(quadrics, primitives.to_object[quadrics])
        self._shapes: dict[int, Shape] = {0: self._shape(0)}
        self._bounds_of = {0: self._bounds(0)}
        self._join()

    def _rest(self, index: int, outlines: Outlines) -> None:
        """An object is static from now on, where it is."""
        triangles, quadrics = self._primitives.triangles_of(index), self._primitives.quadrics_of(index)
        to_world = outlines.to_world[index].reshape(3, 4)
        local = outlines.triangles[triangles].astype(np.float64).reshape(-1, 3, 3)
        world = local @ to_world[:, :3].T
        world[:, 0] += to_world[:, 3]
        self.rows[triangles] = world.reshape(-1, 9)
        scale = np.linalg.norm(to_world[:, :3], 2)
        reach = (
            np.abs(local).max(initial=0.0) * 2 * scale + np.abs(to_world[:, 3]).max() + np.abs(world).max(initial=0.0)
        )
        self.blurs[triangles] = CARRIED * reach
        self._boxes[quadrics] = outlines.boxes[quadrics]
        self._shapes[index], self._bounds_of[index] = self._shape(index), self._bounds(index)

    def follow(self, started: NDArray[np.int64], stopped: NDArray[np.int64], outlines: Outlines) -> None:
        """Of these objects (k,) some move now, others rest."""
        for index in started:
            del self._shapes[int(index)], self._bounds_of[int(index)]
        for index in stopped:
            self._rest(int(index), outlines)
        self._join()

    def know(self, numbers: list[int], lights: NDArray[np.float32]) -> None:
        """Know where lights of these numbers are, of lights (n, 3)."""

        def know(chunk: int, worker: int) -> None:
            light = lights[numbers[chunk]]
            farthest = float(np.linalg.norm(np.abs(light - self.bounds).max(0))) * 1.001
            know_light(self.occluders, numbers[chunk], light, farthest, self.largest)

        for_each_chunk(know, len(numbers), self._threads)

    def _shape(self, index: int) -> Shape:
        triangles, quadrics = self._primitives.triangles_of(index), self._primitives.quadrics_of(index)
        numbers = np.r_[triangles, len(self.rows) + np.r_[quadrics]].astype(np.int32)
        return shape_of(self.rows[triangles], self._boxes[quadrics], numbers, self._threads)

    def _bounds(self, index: int) -> NDArray[np.float64]:
        """Lower and upper corner (2, 3) of a box around an object."""
        rows = self.rows[self._primitives.triangles_of(index)]
        corner, e1, e2 = (rows[:, k : k + 3].astype(np.float64) for k in (0, 3, 6))
        boxes = self._boxes[self._primitives.quadrics_of(index)].astype(np.float64)
        every = np.concatenate([corner, corner + e1, corner + e2, boxes[:, :3], boxes[:, 3:]])
        return np.stack([every.min(0), every.max(0)]) if len(every) else np.zeros((2, 3))

    def _join(self) -> None:
        shape, roots = joined(list(self._shapes.values()))
        every = np.concatenate(list(self._bounds_of.values()))
        self.bounds = np.stack([every.min(0), every.max(0)])
        self.largest = float(np.abs(self.bounds).max())
        # The fast structure pads what never moves and what may each by the largest coordinate there is.
        extents = [np.abs(bounds).max() for index, bounds in self._bounds_of.items() if index > 0]
        padding = PADDING * float(min(np.abs(self._bounds_of[0]).max(), max(extents, default=np.inf)))
        count = self._lights
        self.occluders = Occluders(
            self.rows,
            self.blurs,
            self._boxes,
            shape.children,
            *blocks_of(shape, self.rows),
            roots,
            np.empty((count, len(shape.children), BOXES), np.float32),
            np.empty((count, len(shape.leaves), WIDTH), np.float32),
            np.zeros((count, len(self.rows)), np.int32),
            np.zeros(count, np.int32),
            padding / LONGEST,
        )

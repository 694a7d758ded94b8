"""What is static now, as certificates see it: all that never moves, and the objects that rest.

Each object has a tree of its own, made once it is static; `Occluders` hold these back to back.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import OUTWARDS, PADDING, triangle_boxes
from tracer.geometry.memory import aligned_rows
from tracer.geometry.primitives import Outlines
from tracer.geometry.rays import RAY_OFFSET
from tracer.geometry.wide_tree.topology import WIDTH, Topology
from tracer.runtime.parallel import for_each_chunk
from tracer.visibility.error_bounds import BOX, CORNER_ERROR, LANES, LONGEST, ROW, SureHitLength
from tracer.visibility.light_space import LIGHT_ROW, OF_U
from tracer.visibility.occluders import BOXES, ROUNDED, Occluders, blocks_of, enlarge_boxes, joined, shape_of

if TYPE_CHECKING:
    from tracer.geometry.world import World

HIGHEST = 2.0  # times RAY_OFFSET and the scene's largest coordinate: rays that end higher above a surface are traced
GROWTH = 4  # times that what moves may grow before all is certified anew
NEVER_HIT = np.zeros(LIGHT_ROW, np.float32)  # in light space: a triangle without any area misses for certain
NEVER_HIT[OF_U] = -1.0
QUADRIC = 4e-6  # of the coordinates: how far from a quadric a ray that is transformed to it may hit it


def max_height(largest: float) -> float:
    """How high above surfaces rays may end for something to be known of them, by the largest coordinate; both in units
    of the scene."""
    return float(np.float32(HIGHEST * RAY_OFFSET * largest))


def put_rows(
    world: World, index: int, outlines: Outlines, triangles: NDArray[np.float32], quadrics: NDArray[np.float32]
) -> None:
    """Put the rows (n, ROW) of an object that is present (`error_bounds`), where it is now.

    They hold of one that rests until the extent of what moves has grown GROWTH times."""
    triangles[:, :CORNER_ERROR], triangles[:, CORNER_ERROR], triangles[:, BOX:] = world.triangles_of(index)
    quadrics[:, BOX:] = outlines.boxes[world.primitives.quadrics_of(index)]
    room = 0.0
    if index > 0:
        there = outlines.to_world[index].reshape(3, 4)[:, 3]
        reach = np.abs(quadrics[:, BOX:]).max(initial=0.0)
        room = PADDING * GROWTH * world.extent + QUADRIC * (np.abs(there).max() + reach)
    outwards = OUTWARDS.astype(np.float32)
    for rows in (triangles[:, BOX:], quadrics[:, BOX:]):
        rows += (ROUNDED * np.abs(rows).max(1, initial=0.0, keepdims=True) + room) * outwards


def bounds_around(triangles: NDArray[np.float32], boxes: NDArray[np.float32]) -> NDArray[np.float64]:
    """Lower and upper corner (2, 3) around triangles (t, 9), corner and edges, and boxes (q, 6); 0 around nothing."""
    every = np.concatenate([triangle_boxes(triangles.astype(np.float64)), boxes])
    return np.stack([every[:, :3].min(0), every[:, 3:].max(0)]) if len(every) else np.zeros((2, 3))


class StaticGeometry:
    """Rows, trees and bounds of all static geometry.

    Attributes:
        rows: (t, ROW) float32 as in `Occluders`; those of objects that rest are where they rest.
        first_quadric: rows from here on are those of quadrics.
        occluders: all of it as a tree that knows lights.
        bounds: (2, 3) float64, lower and upper corner around it.
        largest: its largest coordinate.
        allowed: the extent up to which what moves may grow before boxes, which are padded by a part of it, no longer
            hold.
    """

    def __init__(
        self, world: World, lights: int, threads: int, asks: bool, known: StaticGeometry | None = None
    ) -> None:
        """`asks`: somebody asks light-space triangles; `known` has what never moves of the same world."""
        self._world, self._lights, self._threads = world, lights, threads
        self._primitives = world.primitives
        self.first_quadric = len(world.primitives.triangles)
        self.rows = aligned_rows(self.first_quadric + len(world.primitives.quadrics), ROW)
        self.rows[:] = 0
        seen = len(self.rows) if asks else 0
        self._light_space = aligned_rows(lights * seen, LIGHT_ROW).reshape(lights, seen, LIGHT_ROW)
        self.allowed = np.inf  # how large what moves may be for boxes to hold, which are padded by a part of that
        self._shapes: dict[int, Topology] = {}
        self._bounds_of: dict[int, NDArray[np.float64]] = {}
        if known is None:
            self._add(0, world.outlines())
        else:
            for rows in self._rows_of(0):
                self.rows[rows] = known.rows[rows]
            self._shapes[0], self._bounds_of[0] = known._shapes[0], known._bounds_of[0]
        self._join()

    def _add(self, index: int, outlines: Outlines) -> None:
        """Let an object be static from now on, where it is."""
        triangles, quadrics = self._rows_of(index)
        if index > 0:
            self.allowed = min(self.allowed, GROWTH * self._world.extent)
        put_rows(self._world, index, outlines, self.rows[triangles], self.rows[quadrics])
        boxes, numbers = self.rows[quadrics, BOX:], np.r_[triangles, quadrics].astype(np.int32)
        self._shapes[index] = shape_of(self.rows[triangles, :CORNER_ERROR], boxes, numbers, self._threads)
        self._bounds_of[index] = bounds_around(self.rows[triangles, :CORNER_ERROR], boxes)

    @property
    def bytes(self) -> int:
        """Memory that rows and trees take, in bytes."""
        o = self.occluders
        return sum(a.nbytes for a in (self.rows, o.boxes, o.blocks, o.error_radii, o.leaf_radii, o.light_space))

    def _rows_of(self, index: int) -> tuple[slice, slice]:
        """The rows of an object's triangles, and of its quadrics."""
        quadrics, first = self._primitives.quadrics_of(index), self.first_quadric
        return self._primitives.triangles_of(index), slice(first + quadrics.start, first + quadrics.stop)

    def reported_within(self, index: int, lights: list[int]) -> NDArray[np.float64]:
        """Boxes (k, 6) outside of which no ray from these k lights reports a hit on an object that is static.

        Boxes must have been fitted to the lights.  They are inverted for an object of nothing."""
        triangles, quadrics = self._rows_of(index)
        boxes = triangle_boxes(self.rows[triangles, :CORNER_ERROR]).astype(np.float64)
        fixed, result = self.rows[quadrics, BOX:], np.empty((len(lights), 6))
        for k, light in enumerate(lights):
            every = np.concatenate([boxes + self.occluders.error_radii[light, triangles, None] * OUTWARDS, fixed])
            result[k, :3], result[k, 3:] = every[:, :3].min(0, initial=np.inf), every[:, 3:].max(0, initial=-np.inf)
        return result

    @staticmethod
    def _farthest(light: NDArray[np.float32], radius: float, bounds: NDArray[np.float64]) -> float:
        """No less than the distance of any point of a ball around light (3,) from any of bounds (2, 3)."""
        return (float(np.linalg.norm(np.abs(light - bounds).max(0))) + radius) * 1.001

    def update(self, started: NDArray[np.int64], stopped: NDArray[np.int64], outlines: Outlines) -> None:
        """Let objects (k,) that have started no longer be static, and those that have stopped be static."""
        for index in started:
            del self._shapes[int(index)], self._bounds_of[int(index)]
        for index in stopped:
            self._add(int(index), outlines)
        self._join()

    def update_lights(
        self, numbers: list[int], lights: NDArray[np.float32], radii: NDArray[np.float32], highest: float
    ) -> None:
        """Fit boxes and light-space triangles to where lights of these numbers are now, balls around lights (n, 3).

        Their rays end no higher above what is static than `highest`."""

        def update(chunk: int, worker: int) -> None:
            number = numbers[chunk]
            light, radius = lights[number], float(radii[number])
            farthest = self._farthest(light, radius, self.bounds) + 2.0 * highest
            enlarge_boxes(self.occluders, number, light, radius, farthest, self.largest)

        for_each_chunk(update, len(numbers), self._threads)

    def in_ball(self, number: int, lights: NDArray[np.float32], radius: float, highest: float) -> Occluders:
        """The occluders as `update_lights` would fit them to a ball around one of lights (n, 3); these stay as they
        are."""
        o, other = self.occluders, copy(self)
        arrays = {name: np.empty_like(getattr(o, name)) for name in ("boxes", "error_radii", "leaf_radii")}
        other.occluders = o._replace(**arrays)
        other.update_lights([number], lights, np.full(len(lights), radius, np.float32), highest)
        return other.occluders

    def update_points(self, numbers: list[int], lights: NDArray[np.float32], around: NDArray[np.float64]) -> None:
        """The same for points, whose rays end in a box `around` (2, 3) all that is static.  What has no area is never
        hit."""
        beyond = np.maximum(0.0, np.maximum(self.bounds[0] - around[0], around[1] - self.bounds[1]))
        self.update_lights(numbers, lights, np.zeros(len(lights), np.float32), float(np.linalg.norm(beyond)))
        flat = self.flat()
        for number in numbers:
            self.occluders.light_space[number][flat] = NEVER_HIT

    def flat(self) -> NDArray[np.bool_]:
        """(n,) which primitives are triangles with an edge of no length, which nothing hits."""
        flat = (self.rows[:, 3:6] == 0).all(1) | (self.rows[:, 6:9] == 0).all(1)
        flat[self.first_quadric :] = False
        return flat

    def _join(self) -> None:
        """Put the trees of all objects back to back."""
        shape, roots = joined(list(self._shapes.values()))
        every = np.concatenate(list(self._bounds_of.values()))
        self.bounds = np.stack([every.min(0), every.max(0)])
        self.largest = float(np.abs(self.bounds).max())
        extents = [np.abs(bounds).max() for index, bounds in self._bounds_of.items() if index > 0]
        static, resting = np.abs(self._bounds_of[0]).max(), max(extents, default=0.0)
        padding = self._world.hit_padding / LONGEST  # what never moves and what may are padded apart
        farthest = SureHitLength(self._primitives.triangles_of(0).stop, padding * static, padding * resting)
        count = self._lights
        self.occluders = Occluders(
            self.rows,
            self.first_quadric,
            shape.children,
            *blocks_of(shape, self.rows, self.first_quadric),
            roots,
            np.empty((count, len(shape.children), BOXES), np.float32),
            np.empty((count, -(-len(self.rows) // LANES) * LANES), np.float32),
            np.empty((count, len(shape.leaves), WIDTH), np.float32),
            self._light_space,
            farthest,
        )

"""A naive twin of traversal: one ray through the kd-trees by recursion, to count what is entered and tested.

The trees are the tracer's, and so is where the ray meets each primitive (tests/tracing/brute.py); the
way through them is told anew, in float32, as one bit decides which of two leaves comes first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from tracer.geometry.kdtree.tree import KdWorld, Trees

F = np.float32
Vector = tuple[np.float32, np.float32, np.float32]


@dataclass(frozen=True)
class Line:
    """A ray without its interval, in some object's space."""

    origin: Vector
    direction: Vector

    def carried(self, matrix: np.ndarray) -> Line:
        """Into another space, by a map (12,)."""
        (x, y, z), (dx, dy, dz) = self.origin, self.direction
        rows = matrix.reshape(3, 4)
        origin = tuple(m[0] * x + m[1] * y + m[2] * z + m[3] for m in rows)
        return Line(origin, tuple(m[0] * dx + m[1] * dy + m[2] * dz for m in rows))

    def inverse(self, axis: int) -> np.float32:
        d = self.direction[axis]
        return F(1) / (d if abs(d) > F(1e-20) else np.copysign(F(1e-20), d))

    def within(self, box: np.ndarray, enter: np.float32, leave: np.float32) -> tuple[np.float32, np.float32]:
        """The part of an interval that lies in a box (6,); empty where the first is greater."""
        for axis in range(3):
            a, b = ((side - self.origin[axis]) * self.inverse(axis) for side in (box[axis], box[axis + 3]))
            enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
        return enter, leave


class Traversal:
    """One ray's way to an answer.  `steps` nodes were entered and `tests` primitives tested.

    meets (primitives,) float32 is where the ray meets each, inf where it does not.
    """

    def __init__(self, parts: KdWorld, line: Line, t_min: float, t_max: float, meets: np.ndarray) -> None:
        self.parts, self.line, self.meets = parts, line, meets
        self.t_min, self.t_max = F(t_min), F(t_max)
        self.steps = self.tests = 0
        self.nearest, self.primitive = self.t_max, -1

    def closest(self) -> tuple[np.float32, int]:
        """(t, primitive) of the nearest hit, of equally near ones the first; inf and -1 for a miss."""
        for leaf in self._leaves(False):
            self.tests += len(leaf)
            for primitive in leaf:
                t = self.meets[primitive]
                if t < self.nearest or (t == self.nearest < np.inf and primitive < self.primitive):
                    self.nearest, self.primitive = t, primitive
        return (self.nearest if self.primitive >= 0 else F(np.inf)), self.primitive

    def any(self) -> bool:
        """Whether anything is hit: the first hit ends the search."""
        for leaf in self._leaves(True):
            for primitive in leaf:
                self.tests += 1
                if self.meets[primitive] < np.inf:
                    return True
        return False

    def _leaves(self, whatever: bool) -> Iterator[list[int]]:
        """Primitives of the leaves in the ray's way, in its order: static geometry's, then those of the dynamic
        objects whose boxes it crosses, of those that rest first.  Unless it asks for whatever is there, nothing beyond
        `nearest` counts."""
        parts = self.parts

        def limit() -> np.float32:
            return self.t_max if whatever else self.nearest

        enter, leave = self.line.within(parts.boxes[0], self.t_min, self.t_max)
        yield from (items for items, _, _ in self._walk(parts.static, 0, self.line, enter, leave, limit))
        for top in (parts.resting, parts.moving):
            if not top.there:
                continue
            enter, leave = self.line.within(top.box, self.t_min, self.t_max)
            for objects, first, last in self._walk(top.trees, 0, self.line, enter, leave, limit):
                first, last = first - F(1e-5) * abs(first), last + F(1e-5) * abs(last)
                for o in objects:
                    line = self.line.carried(parts.to_object[o])
                    enter, leave = line.within(parts.boxes[o], first, last if whatever else min(last, self.nearest))
                    walk = self._walk(parts.dynamic, int(parts.roots[o]), line, enter, leave, limit)
                    yield from (items for items, _, _ in walk)

    def _walk(
        self, trees: Trees, node: int, line: Line, enter: np.float32, leave: np.float32, limit: Callable
    ) -> Iterator[tuple[list[int], np.float32, np.float32]]:
        """Items of the leaves below a node, nearest first, each with the ray's interval in it."""
        if enter > leave or enter > limit():
            return
        self.steps += 1
        low, high = int(trees.words[2 * node]), int(trees.words[2 * node + 1])
        axis, rest = high & 3, high >> 2
        if axis == 3:
            yield trees.items[low : low + rest].tolist(), enter, leave
            return
        plane, origin = trees.planes[2 * node], line.origin[axis]
        t = (plane - origin) * line.inverse(axis)
        below = origin < plane or (origin == plane and line.direction[axis] <= 0)
        near, far = (node + 1, rest) if below else (rest, node + 1)
        if t > leave or t <= 0:
            yield from self._walk(trees, near, line, enter, leave, limit)
        elif t < enter:
            yield from self._walk(trees, far, line, enter, leave, limit)
        else:
            yield from self._walk(trees, near, line, enter, t, limit)
            yield from self._walk(trees, far, line, t, leave, limit)

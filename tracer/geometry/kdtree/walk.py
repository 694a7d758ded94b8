"""The way of one ray through the kd-trees, node by node: what `traverse` does, told as it goes."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tracer.geometry.boxes import hit_box, inverse
from tracer.geometry.interpreted import interpreted
from tracer.geometry.intersect import hit_quadric, hit_triangle, transform_ray
from tracer.geometry.kdtree.traverse import SLACK
from tracer.geometry.kdtree.tree import LEAF, Parts, Trees
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY
from tracer.geometry.rays import INFINITY, MISS, Ray
from tracer.geometry.visits import WORLD, Visit, corners_of
from tracer.scene.arrays import Float64

_hit_box, _inverse, _transformed = interpreted(hit_box), interpreted(inverse), interpreted(transform_ray)
_hit_triangle, _hit_quadric = interpreted(hit_triangle), interpreted(hit_quadric)


class _Pending(NamedTuple):
    """A node that is still to be entered: with the ray's interval in it, its box and its level."""

    node: int
    enter: np.float32
    leave: np.float32
    box: np.ndarray
    level: int


class Walk:
    """One ray's way: for its `nearest` hit, or for any."""

    def __init__(self, parts: Parts, to_world: Float64, nearest: bool) -> None:
        self._parts, self._to_world, self._nearest = parts, to_world, nearest
        self._triangles, self._quadrics = parts.triangles.reshape(-1), parts.quadrics.reshape(-1)
        self._to_object, self._boxes = parts.to_object.reshape(-1), parts.boxes.reshape(-1)
        self.visits: list[Visit] = []
        self.t, self.primitive = INFINITY, MISS

    def go(self, ray: Ray, which: int) -> list[Visit]:
        """All nodes that the ray enters, in their order."""
        parts, rest = self._parts, ray
        with np.errstate(all="ignore"):
            self.t = ray.t_max
            if self._nearest or which & STATIC_GEOMETRY:
                self._object("static", 0, parts.static, rest, ray.t_min, ray.t_max)
                self._top("resting objects", parts.resting, parts.resting_box, ray)
            if self._nearest or which & DYNAMIC_OBJECTS:
                self._top("moving objects", parts.moving, parts.moving_box, ray)
        return self.visits

    @property
    def _done(self) -> bool:
        return not self._nearest and self.primitive != MISS

    def _object(self, name: str, o: int, trees: Trees, ray: Ray, enter: np.float32, leave: np.float32) -> None:
        """Go through the tree of an object; the ray is in its space."""
        near, far = _hit_box(ray._replace(t_min=enter, t_max=leave), self._boxes, o)
        if self._done or near > far:
            return

        def test(first: int, size: int, _: _Pending) -> tuple[tuple[int, ...], tuple[tuple[int, float], ...]]:
            tested, hits = [], []
            for primitive in trees.items[first : first + size].tolist():
                tested.append(primitive)
                t = self._t_of(ray, primitive)
                if t < INFINITY:
                    hits.append((primitive, float(t)))
                if self._nearest:
                    if t < self.t or (t == self.t and t < INFINITY and primitive < self.primitive):
                        self.t, self.primitive = t, primitive
                elif t < INFINITY:
                    self.t, self.primitive = t, primitive
                    break
            return tuple(tested), tuple(hits)

        root = _Pending(int(self._parts.roots[o]), near, far, self._parts.boxes[o], 0)
        self._descend(name, trees, ray, root, self._to_world[o] if o else WORLD, test)

    def _t_of(self, ray: Ray, primitive: int) -> np.float32:
        count = len(self._parts.triangles)
        if primitive < count:
            return np.float32(_hit_triangle(ray, self._triangles, primitive)[0])
        return np.float32(_hit_quadric(ray, self._quadrics, primitive - count))

    def _top(self, name: str, trees: Trees, box: np.ndarray, ray: Ray) -> None:
        """Go through a tree over objects, and through those that it leads to."""
        if self._done or box[0] > box[3]:
            return
        near, far = _hit_box(ray, box, 0)
        if near > (min(far, self.t) if self._nearest else far):
            return

        def enter_objects(first: int, size: int, leaf: _Pending) -> tuple[tuple[int, ...], tuple]:
            enter, leave = leaf.enter - SLACK * abs(leaf.enter), leaf.leave + SLACK * abs(leaf.leave)
            for o in trees.items[first : first + size].tolist():
                local = _transformed(ray, self._to_object, o, 12)
                last = min(leave, self.t) if self._nearest else leave
                self._object(f"object {o}", o, self._parts.dynamic, local, enter, last)
            return (), ()

        self._descend(name, trees, ray, _Pending(0, near, far, box, 0), WORLD, enter_objects)

    def _descend(
        self,
        name: str,
        trees: Trees,
        ray: Ray,
        root: _Pending,
        to_world: Float64,
        test: Callable[[int, int, _Pending], tuple[tuple[int, ...], tuple[tuple[int, float], ...]]],
    ) -> None:
        """Enter the nodes of a tree, the nearer child first; `test` says what happens in a leaf."""
        pending = [root]
        while pending and not self._done and (not self._nearest or pending[-1].enter <= self.t):
            at = pending.pop()
            while True:
                word = int(trees.words[2 * at.node + 1])
                axis, leaf = word & 3, word & 3 == LEAF
                corners = corners_of(at.box, to_world)
                visit = Visit(name, at.node, leaf, at.level, corners, float(at.enter), float(at.leave))
                place = len(self.visits)
                self.visits.append(visit)
                if leaf:
                    tested, hits = test(int(trees.words[2 * at.node]), word >> 2, at)
                    self.visits[place] = visit._replace(tested=tested, hits=hits)
                    break
                at = self._child(trees, ray, at, axis, word >> 2, pending)

    @staticmethod
    def _child(trees: Trees, ray: Ray, at: _Pending, axis: int, upper: int, pending: list[_Pending]) -> _Pending:
        """The child that the ray enters next; the other one, if it enters that too, is pending from now on."""
        origin, direction = ray[axis], ray[3 + axis]
        plane = trees.planes[2 * at.node]
        t = (plane - origin) * _inverse(direction)
        lower_first = origin < plane or (origin == plane and direction <= 0)
        boxes = at.box.copy(), at.box.copy()
        boxes[0][3 + axis] = boxes[1][axis] = plane
        children = tuple(
            _Pending(node, at.enter, at.leave, box, at.level + 1)
            for node, box in zip((at.node + 1, upper), boxes, strict=True)
        )
        near, far = children if lower_first else children[::-1]
        if t > at.leave or t <= 0:
            return near
        if t < at.enter:
            return far
        pending.append(far._replace(enter=t))
        return near._replace(leave=t)

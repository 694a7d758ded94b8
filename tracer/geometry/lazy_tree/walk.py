"""The way of one ray through the tree, node by node: what `traverse` does, told as it goes.  Nodes on it are built.

A node's number is 1 for the root of its tree, and 2 n and 2 n + 1 for the children of n.
"""

from __future__ import annotations

import ctypes
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import hit_box, inverse
from tracer.geometry.interpreted import interpreted
from tracer.geometry.intersect import hit_quadric, hit_triangle, transform_ray
from tracer.geometry.kdtree.tree import LEAF
from tracer.geometry.lazy_tree.build import HEADER, open_node
from tracer.geometry.lazy_tree.node import KIND, LOWER_MOVES, OBJECTS, SUBTREE, UNBUILT, UPPER_MOVES
from tracer.geometry.lazy_tree.traverse import REMEMBERED
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY
from tracer.geometry.rays import INFINITY, MISS, Ray
from tracer.geometry.visits import WORLD, Visit, corners_of
from tracer.scene.arrays import Float64

_hit_box, _inverse, _transformed = interpreted(hit_box), interpreted(inverse), interpreted(transform_ray)
_hit_triangle, _hit_quadric = interpreted(hit_triangle), interpreted(hit_quadric)


class Told(NamedTuple):
    """A placed world, for those who tell: what `traverse` reads."""

    triangles: NDArray[np.float32]
    quadrics: NDArray[np.float32]
    root: int
    bounds: NDArray[np.float32]
    object_roots: NDArray[np.int64]
    object_boxes: NDArray[np.float32]
    to_object: NDArray[np.float32]
    rests: NDArray[np.uint8]
    pause: int
    moving_box: NDArray[np.float32]
    moves: bool


class Node(NamedTuple):
    """A node as it lies in memory; `flags` say where something moves, and an upper one has a list of `objects`."""

    kind: int
    flags: int
    plane: np.float32
    first: int
    second: int

    @property
    def objects(self) -> list[int]:
        n = ctypes.c_int32.from_address(self.second).value
        return list((ctypes.c_int32 * n).from_address(self.second + 4))

    @property
    def subtree(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """The words and items of a SUBTREE, copied."""
        words, items = (ctypes.c_int64 * 2).from_address(self.first)
        both = (ctypes.c_int32 * (words + items)).from_address(self.first + HEADER)
        numbers = np.array(both, np.int32)
        return numbers[:words], numbers[words:]


def node_at(address: int, pause: int = 0) -> Node:
    """The node at an address, built if nobody has been there yet."""
    while True:
        words = tuple((ctypes.c_int64 * 4).from_address(address))
        kind = words[0] & KIND
        if kind < UNBUILT or kind in (SUBTREE, OBJECTS):
            plane = np.array([words[1]], np.int64).astype(np.int32).view(np.float32)[0]
            return Node(kind, words[0] & ~KIND, plane, words[2], words[3])
        open_node.call(address, pause, 0, 0, 0)


class _Pending(NamedTuple):
    """A node that is still to be entered, with the ray's interval in it, its box, level and number; `again`: what never
    moves has been asked there, and objects are next."""

    address: int
    enter: np.float32
    leave: np.float32
    box: NDArray[np.float32]
    level: int
    number: int
    tree: str
    again: bool = False


class Walk:
    """One ray's way: for its `nearest` hit, or for any."""

    def __init__(self, told: Told, to_world: Float64, nearest: bool) -> None:
        self._told, self._to_world, self._nearest = told, to_world, nearest
        self._flat = told.triangles.reshape(-1), told.quadrics.reshape(-1)
        self._maps, self._boxes = told.to_object.reshape(-1), told.object_boxes.reshape(-1)
        self.visits: list[Visit] = []
        self.t, self.primitive = INFINITY, MISS
        self._found, self._searched = 0, list[int]()

    def go(self, ray: Ray, which: int) -> list[Visit]:
        """All nodes that the ray enters, in their order."""
        told, nearest = self._told, self._nearest
        which = STATIC_GEOMETRY | DYNAMIC_OBJECTS if nearest else which
        with np.errstate(all="ignore"):
            near, far = _hit_box(ray, told.moving_box, 0)
            if not told.moves or near > far:
                which &= ~DYNAMIC_OBJECTS
            self.t = ray.t_max
            near, far = _hit_box(ray, told.bounds, 0)
            name = "all objects" if told.root != told.object_roots[0] else "static"
            pending = [_Pending(told.root, near, far, told.bounds, 0, 1, name)] if near <= far and which else []
            while pending and not self._done(which):
                if nearest and pending[-1].enter > self.t:
                    pending.pop()
                    continue
                at = pending.pop()
                if at.again:
                    self._objects(ray, at, which)
                    continue
                met = self._down(ray, at, pending, not nearest and which == DYNAMIC_OBJECTS, WORLD)
                if met is None:
                    continue
                at, node = met
                if node.kind == SUBTREE:
                    self._subtree(ray, at, node, WORLD)
                elif nearest or which & STATIC_GEOMETRY:
                    pending.append(at._replace(again=True))
                    pending.append(at._replace(address=node.first, tree="static", level=at.level + 1, number=1))
                else:
                    self._objects(ray, at, which)
        return self.visits

    def _done(self, which: int) -> bool:
        """Whether a ray that asks for anything knows enough: what never moves comes before what moves."""
        return not self._nearest and (self._found == STATIC_GEOMETRY or (self._found != 0 and self._found == which))

    def _down(
        self, ray: Ray, at: _Pending, pending: list[_Pending], moving: bool, to_world: Float64
    ) -> tuple[_Pending, Node] | None:
        """Enter nodes from one on, the nearer child first, down to one that holds something."""
        while True:
            node = node_at(at.address, self._told.pause)
            if node.kind == SUBTREE:
                return at, node
            self._tell(at, node.kind == OBJECTS, to_world)
            if node.kind == OBJECTS:
                return at, node
            origin, direction = ray[node.kind], ray[3 + node.kind]
            near, far, t, lower_first = _children(at, node, origin, direction)
            flags = (LOWER_MOVES, UPPER_MOVES) if lower_first else (UPPER_MOVES, LOWER_MOVES)
            near_asked, far_asked = (not moving or bool(node.flags & flag) for flag in flags)
            if t > at.leave or t <= 0:
                far_asked = False
            elif t < at.enter:
                near_asked = False
            else:
                near, far = near._replace(leave=t), far._replace(enter=t)
                if near_asked and far_asked:
                    pending.append(far)
            if not near_asked and not far_asked:
                return None
            at = near if near_asked else far

    def _tell(self, at: _Pending, leaf: bool, to_world: Float64, tested: Any = (), hits: Any = ()) -> None:
        corners = corners_of(at.box, to_world)
        enter, leave = float(at.enter), float(at.leave)
        self.visits.append(Visit(at.tree, at.number, leaf, at.level, corners, enter, leave, tuple(tested), tuple(hits)))

    def _objects(self, ray: Ray, at: _Pending, which: int) -> None:
        """Go through the objects that a node leads to."""
        for o in node_at(at.address).objects:
            kind = STATIC_GEOMETRY if self._told.rests[o] else DYNAMIC_OBJECTS
            if not which & kind or (not self._nearest and kind == DYNAMIC_OBJECTS and self._found):
                continue
            if o in self._searched[-REMEMBERED:]:
                continue
            self._searched.append(o)
            local = _transformed(ray, self._maps, o, 12)
            before = self.primitive
            if not self._nearest:
                self.primitive = MISS
            self._object(o, local, ray.t_min, self.t if self._nearest else ray.t_max)
            if not self._nearest:
                if self.primitive != MISS:
                    self._found = kind
                    if self._done(which):
                        return
                else:
                    self.primitive = before

    def _object(self, o: int, ray: Ray, enter: np.float32, leave: np.float32) -> None:
        near, far = _hit_box(ray._replace(t_min=enter, t_max=leave), self._boxes, o)
        if near > far:
            return
        root, box = int(self._told.object_roots[o]), self._told.object_boxes[o]
        pending = [_Pending(root, near, far, box, 0, 1, f"object {o}")]
        while pending and (not self._nearest or pending[-1].enter <= self.t):
            met = self._down(ray, pending.pop(), pending, False, self._to_world[o])
            if met is not None and self._subtree(ray, *met, self._to_world[o]):
                return

    def _subtree(self, ray: Ray, root: _Pending, node: Node, to_world: Float64) -> bool:
        """Go through a whole subtree; whether a ray that asks for anything found something."""
        words, items = node.subtree
        planes = words.view(np.float32)
        pending = [(root, 0)]
        while pending and (not self._nearest or pending[-1][0].enter <= self.t):
            at, place = pending.pop()
            while True:
                first, word = int(words[2 * place]), int(words[2 * place + 1])
                axis = word & 3
                if axis == LEAF:
                    if self._leaf(ray, at, items[first : first + (word >> 2)].tolist(), to_world):
                        return True
                    break
                self._tell(at, False, to_world)
                inner = Node(axis, 0, planes[2 * place], 0, 0)
                near, far, t, lower_first = _children(at, inner, ray[axis], ray[3 + axis])
                near_place, far_place = (place + 1, word >> 2) if lower_first else (word >> 2, place + 1)
                if t > at.leave or t <= 0:
                    at, place = near, near_place
                elif t < at.enter:
                    at, place = far, far_place
                else:
                    pending.append((far._replace(enter=t), far_place))
                    at, place = near._replace(leave=t), near_place
        return False

    def _leaf(self, ray: Ray, at: _Pending, primitives: list[int], to_world: Float64) -> bool:
        tested, hits = [], []
        for primitive in primitives:
            tested.append(primitive)
            t = self._t_of(ray, primitive)
            if t < INFINITY:
                hits.append((primitive, float(t)))
            if self._nearest:
                if t < self.t or (t == self.t and t < INFINITY and primitive < self.primitive):
                    self.t, self.primitive = t, primitive
            elif t < INFINITY:
                self.primitive = primitive
                break
        self._tell(at, True, to_world, tested, hits)
        found = not self._nearest and bool(hits)
        if found and not at.tree.startswith("object"):
            self._found = STATIC_GEOMETRY
        return found

    def _t_of(self, ray: Ray, primitive: int) -> np.float32:
        triangles, quadrics = self._flat
        count = len(self._told.triangles)
        if primitive < count:
            return np.float32(_hit_triangle(ray, triangles, primitive)[0])
        return np.float32(_hit_quadric(ray, quadrics, primitive - count))


def _children(
    at: _Pending, node: Node, origin: np.float32, direction: np.float32
) -> tuple[_Pending, _Pending, np.float32, bool]:
    """The nearer and the farther child of a node, with its own interval; where the ray meets the plane between them;
    and whether the nearer one is the lower."""
    t = (node.plane - origin) * _inverse(direction)
    lower_first = bool(origin < node.plane or (origin == node.plane and direction <= 0))
    boxes = at.box.copy(), at.box.copy()
    boxes[0][3 + node.kind] = boxes[1][node.kind] = node.plane
    lower, upper = (
        at._replace(address=address, box=box, level=at.level + 1, number=2 * at.number + side)
        for side, (address, box) in enumerate(zip((node.first, node.second), boxes, strict=True))
    )
    return (lower, upper, t, True) if lower_first else (upper, lower, t, False)

"""A naive twin of the way through a tree that is built where rays arrive: one ray by recursion, as in `naive_tree`.

The nodes are the tracer's, and so is where the ray meets each primitive (tests/tracing/brute.py).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tests.tracing.naive_tree import F, Line, Traversal
from tracer.geometry.lazy_tree.build import open_node
from tracer.geometry.lazy_tree.node import HEADER, KIND, LOWER_MOVES, OBJECTS, SUBTREE, UPPER_MOVES
from tracer.geometry.lazy_tree.traverse import LazyWorld
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING, STATIC_GEOMETRY

REMEMBERED = 8


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
        if words[0] >= 0:
            kind = words[0] & KIND
            plane = np.array([words[1]], np.int64).astype(np.int32).view(np.float32)[0]
            return Node(kind, words[0] & ~KIND, plane, words[2], words[3])
        open_node.call(address, pause, 0, 0, 0)


class LazyTraversal(Traversal):
    """One ray's way to an answer.  `steps` nodes were entered and `tests` primitives tested."""

    def __init__(self, parts: LazyWorld, line: Line, t_min: float, t_max: float, meets: np.ndarray) -> None:
        super().__init__(None, line, t_min, t_max, meets)  # type: ignore[arg-type]
        self.world, self.searched = parts, list[int]()
        self.over: object = None  # the way through a moving object that has ended with a hit
        first, last = line.within(parts.moving_box, self.t_min, self.t_max)
        self.meets_moving = parts.moves and first <= last

    def closest(self) -> tuple[np.float32, int]:
        for _, leaf in self._ways(EVERYTHING, lambda: self.nearest, lambda kind: False):
            self.tests += len(leaf)
            for primitive in leaf:
                t = self.meets[primitive]
                if t < self.nearest or (t == self.nearest < np.inf and primitive < self.primitive):
                    self.nearest, self.primitive = t, primitive
        return (self.nearest if self.primitive >= 0 else F(np.inf)), self.primitive

    def what(self, which: int) -> int:
        """What blocks the ray, of `which` is asked: what is static comes before what moves."""
        found = 0
        ways = self._ways(which, lambda: self.t_max, lambda kind: kind == DYNAMIC_OBJECTS and found != 0)
        for (kind, way), leaf in ways:
            for primitive in leaf:
                self.tests += 1
                if self.meets[primitive] < np.inf:
                    if kind == STATIC_GEOMETRY or which == DYNAMIC_OBJECTS:
                        return kind
                    found, self.over = kind, way
                    break
        return found

    def _ways(
        self, which: int, limit: Callable[[], np.float32], skip: Callable[[int], bool]
    ) -> Iterator[tuple[tuple[int, object], list[int]]]:
        if not self.meets_moving:
            which &= ~DYNAMIC_OBJECTS
        enter, leave = self.line.within(self.world.bounds, self.t_min, self.t_max)
        if enter <= leave and which:
            yield from self._world(self.world.root, which, enter, leave, limit, skip)

    def _world(self, address: int, which: int, enter, leave, limit, skip) -> Iterator:
        """Leaves below a node of the world: of what never moves, and of the objects that hang there."""
        if enter > limit():
            return
        node = node_at(address)
        if node.kind == SUBTREE:
            for leaf in self._subtree(node, self.line, enter, leave, limit):
                yield (STATIC_GEOMETRY, None), leaf
            return
        self.steps += 1
        if node.kind == OBJECTS:
            if which & STATIC_GEOMETRY:
                yield from self._world(node.first, which, enter, leave, limit, skip)
                if enter > limit():
                    return
            for o in node.objects:
                kind = STATIC_GEOMETRY if self.world.rests[o] else DYNAMIC_OBJECTS
                if not which & kind or skip(kind) or o in self.searched[-REMEMBERED:]:
                    continue
                self.searched.append(o)
                line, way = self.line.carried(self.world.to_object[o]), object()
                first, last = line.within(self.world.object_boxes[o], self.t_min, limit())
                if first > last:
                    continue
                for leaf in self._object(int(self.world.object_roots[o]), line, first, last, limit):
                    yield (kind, way), leaf
                    if self.over is way:
                        break
            return
        for child, first, last in self._children(node, self.line, enter, leave):
            flag = UPPER_MOVES if child else LOWER_MOVES
            if which != DYNAMIC_OBJECTS or node.flags & flag:
                yield from self._world((node.first, node.second)[child], which, first, last, limit, skip)

    def _object(self, address: int, line: Line, enter, leave, limit) -> Iterator[list[int]]:
        if enter > limit():
            return
        node = node_at(address)
        if node.kind == SUBTREE:
            yield from self._subtree(node, line, enter, leave, limit)
            return
        self.steps += 1
        for child, first, last in self._children(node, line, enter, leave):
            yield from self._object((node.first, node.second)[child], line, first, last, limit)

    def _subtree(self, node, line: Line, enter, leave, limit) -> Iterator[list[int]]:
        words, items = node.subtree
        trees = SimpleNamespace(words=words, planes=words.view(np.float32), items=items)
        yield from (leaf for leaf, _, _ in self._walk(trees, 0, line, enter, leave, limit))  # type: ignore[arg-type]

    @staticmethod
    def _children(node, line: Line, enter, leave) -> list[tuple[int, np.float32, np.float32]]:
        """Which children the ray enters, the nearer one first: 0 for the lower, and its interval there."""
        plane, origin = node.plane, line.origin[node.kind]
        t = (plane - origin) * line.inverse(node.kind)
        below = origin < plane or (origin == plane and line.direction[node.kind] <= 0)
        near, far = (0, 1) if below else (1, 0)
        if t > leave or t <= 0:
            return [(near, enter, leave)]
        if t < enter:
            return [(far, enter, leave)]
        return [(near, enter, t), (far, t, leave)]

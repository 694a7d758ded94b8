"""A kd-tree as the traversal sees it: eight bytes a node, and one way to walk to the next leaf.

An inner node is followed by its lower child; the second word holds the number of the upper child
and, in the two lowest bits, the axis.  In a leaf those bits are LEAF, the first word is the
position of its first item, and the rest of the second word their count.
(Pharr, Jakob, Humphreys: Physically Based Rendering, third edition, section 4.4.)
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import inverse
from tracer.geometry.intersect import ZERO
from tracer.kernels import inlined

LEAF = 3
MAX_DEPTH = 60
STACK_SIZE = MAX_DEPTH + 4


class Trees(NamedTuple):
    """Any number of kd-trees, back to back: a root is a node's number.

    words (2 n,) int32 and planes, the same memory as float32; items (m,) int32, what leaves hold.
    Kernels that walk them are given pointers instead of arrays.
    """

    words: NDArray[np.int32]
    planes: NDArray[np.float32]
    items: NDArray[np.int32]


class Parts(NamedTuple):
    """All that a placed world is to its kd-trees.

    triangles (t, 9) and quadrics (q, 16) float32 are in the space of their object.  static and dynamic
    are trees over primitives, resting one over those dynamic objects that rest, inside resting_box (6,),
    and moving one over the others.  roots (objects,) int32, boxes (objects, 6) and to_object (objects, 12)
    float32; object 0 is static.
    """

    triangles: NDArray[np.float32]
    quadrics: NDArray[np.float32]
    static: Trees
    dynamic: Trees
    resting: Trees
    moving: Trees
    roots: NDArray[np.int32]
    boxes: NDArray[np.float32]
    to_object: NDArray[np.float32]
    resting_box: NDArray[np.float32]
    moving_box: NDArray[np.float32]


class Stack(NamedTuple):
    """Nodes still to be entered by one ray, each with its interval of t: pointers to STACK_SIZE entries."""

    node: Any
    enter: Any
    leave: Any


class Leaf(NamedTuple):
    """A leaf that a ray enters: its items, the ray's interval in it, and what it took to get there."""

    first: int
    size: int
    enter: float
    leave: float
    steps: int
    pending: int


@inlined
def push(stack, pending, node, enter, leave):
    stack.node[pending] = node
    stack.enter[pending] = enter
    stack.leave[pending] = leave
    return pending + 1


@inlined
def next_leaf(trees, ray, stack, pending):
    """Enter the newest of the `pending` nodes and walk down to a leaf, nearer child first."""
    pending -= 1
    node, enter, leave = stack.node[pending], stack.enter[pending], stack.leave[pending]
    inverse_x, inverse_y, inverse_z = inverse(ray.dx), inverse(ray.dy), inverse(ray.dz)
    steps = 1
    while True:
        word = trees.words[2 * node + 1]
        axis = word & 3
        if axis == LEAF:
            return Leaf(trees.words[2 * node], word >> 2, enter, leave, steps, pending)
        origin = ray.ox if axis == 0 else (ray.oy if axis == 1 else ray.oz)
        direction = ray.dx if axis == 0 else (ray.dy if axis == 1 else ray.dz)
        inverted = inverse_x if axis == 0 else (inverse_y if axis == 1 else inverse_z)
        plane = trees.planes[2 * node]
        t = (plane - origin) * inverted
        lower_first = origin < plane or (origin == plane and direction <= ZERO)
        near = node + 1 if lower_first else word >> 2
        far = word >> 2 if lower_first else node + 1
        if t > leave or t <= ZERO:
            node = near
        elif t < enter:
            node = far
        else:
            pending = push(stack, pending, far, t, leave)
            node, leave = near, t
        steps += 1

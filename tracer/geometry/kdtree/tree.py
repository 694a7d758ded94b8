"""How a kd-tree lies in memory, eight bytes a node, and the walk of a ray to its next leaf.

The first word of an inner node is its plane; the second holds the number of the upper child and, in the two lowest
bits, the axis.  The lower child follows its parent.  In a leaf those two bits are LEAF, the rest of the second word is
the number of items, and the first word says where they begin.
(Pharr, Jakob, Humphreys: Physically Based Rendering, third edition, section 4.4.)
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import inverse
from tracer.geometry.intersect import ZERO
from tracer.runtime.kernels import inlined

LEAF = 3
MAX_DEPTH = 60
STACK_SIZE = MAX_DEPTH + 4


class Trees(NamedTuple):
    """Any number of kd-trees side by side: a root is a node's number.

    words (2 n,) int32, and planes, the same memory as float32; items (m,) int32, what leaves hold.
    Kernels that walk them are given pointers instead of arrays.
    """

    words: NDArray[np.int32]
    planes: NDArray[np.float32]
    items: NDArray[np.int32]


class Parts(NamedTuple):
    """A world placed in kd-trees.

    triangles (t, 9) and quadrics (q, 16) float32 are in the space of their object.  `static` is the tree over the
    primitives of object 0, `dynamic` are those of the other objects, each in the space of its object.  `resting` is
    a tree over the objects that rest, in the world and inside resting_box (6,), and `moving` one over the others.
    For each object: roots (objects,) int32, where its tree begins; boxes (objects, 6) float32, in its own space;
    to_object (objects, 12) float32, the map from the world.
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
    """Nodes that one ray has still to enter, each with its interval of t: pointers to STACK_SIZE entries."""

    node: Any
    enter: Any
    leave: Any


class Leaf(NamedTuple):
    """A leaf that a ray enters: where its items begin and how many they are, the ray's interval of t in it, the steps
    taken on the way, and how many nodes are pending then."""

    first: int
    size: int
    enter: float
    leave: float
    steps: int
    pending: int


@inlined
def push(stack, pending, node, enter, leave):
    """Put a node and a ray's interval in it on the stack; how many are pending then."""
    stack.node[pending] = node
    stack.enter[pending] = enter
    stack.leave[pending] = leave
    return pending + 1


@inlined
def at_plane(ray, inverse_x, inverse_y, inverse_z, axis, plane):
    """The t at which a ray meets a node's plane, and whether the lower child is the nearer one; inverse_x, y and z are
    those of its direction."""
    origin = ray.ox if axis == 0 else (ray.oy if axis == 1 else ray.oz)
    direction = ray.dx if axis == 0 else (ray.dy if axis == 1 else ray.dz)
    inverted = inverse_x if axis == 0 else (inverse_y if axis == 1 else inverse_z)
    return (plane - origin) * inverted, origin < plane or (origin == plane and direction <= ZERO)


@inlined
def next_leaf(trees, ray, stack, pending):
    """Enter the newest of the pending nodes and walk down to a leaf, nearer child first."""
    # Take the newest pending node, with the ray's interval in it.
    pending -= 1
    node, enter, leave = stack.node[pending], stack.enter[pending], stack.leave[pending]
    inverse_x, inverse_y, inverse_z = inverse(ray.dx), inverse(ray.dy), inverse(ray.dz)
    steps = 1
    while True:
        # Stop at a leaf.
        word = trees.words[2 * node + 1]
        axis = word & 3
        if axis == LEAF:
            return Leaf(trees.words[2 * node], word >> 2, enter, leave, steps, pending)
        t, lower_first = at_plane(ray, inverse_x, inverse_y, inverse_z, axis, trees.planes[2 * node])
        near = node + 1 if lower_first else word >> 2
        far = word >> 2 if lower_first else node + 1
        # Go on to the only child that the ray meets; or to the nearer one, with the other pending.
        if t > leave or t <= ZERO:
            node = near
        elif t < enter:
            node = far
        else:
            pending = push(stack, pending, far, t, leave)
            node, leave = near, t
        steps += 1

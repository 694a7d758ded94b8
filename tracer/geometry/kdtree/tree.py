"""How a kd-tree lies in memory, eight bytes a node, and the walk of a ray to its next leaf.

The first word of an inner node is its plane; the second holds the number of the upper child and, in the two lowest
bits, the axis.  The lower child follows its parent.  In a leaf those two bits are LEAF, the rest of the second word is
the number of items, and the first word says where they begin.
(Pharr, Jakob, Humphreys: Physically Based Rendering, third edition, section 4.4.)
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.boxes import inverse
from tracer.geometry.intersect import ZERO, hit_quadric, hit_triangle
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.rays import INFINITY, MISS, Ray
from tracer.runtime.kernels import inlined
from tracer.simd.records import F32At, I32At

LEAF = 3
MAX_DEPTH = 60
STACK_SIZE = MAX_DEPTH + 4


class Trees(NamedTuple):
    """Any number of kd-trees side by side: a root is a node's number.

    words (2 n,) int32, and planes, the same memory as float32; items (m,) int32, what leaves hold.
    Kernels that walk them are given pointers instead of arrays.
    """

    words: I32At
    planes: F32At
    items: I32At


class Top(NamedTuple):
    """A tree over objects where they are in the world, the box (6,) float32 around it, and whether it has any."""

    trees: Trees
    box: F32At
    there: bool


class KdWorld(NamedTuple):
    """A world placed in kd-trees.

    triangles (t, 9) and quadrics (q, 16) float32 are in the space of their object.  `static` is the tree over the
    primitives of object 0, `dynamic` are those of the other objects, each in the space of its object; `resting` leads
    to the objects that rest, and `moving` to the others.  For each object: roots (objects,) int32, where its tree
    begins; boxes (objects, 6) float32, in its own space; to_object (objects, 12) float32, the map from the world.
    """

    triangles: F32At
    triangle_count: int
    quadrics: F32At
    static: Trees
    dynamic: Trees
    resting: Top
    moving: Top
    roots: I32At
    boxes: F32At
    to_object: F32At


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


class Best(NamedTuple):
    """The nearest hit so far."""

    t: Any
    primitive: Any
    u: Any
    v: Any


@inlined
def no_hit(t_max):
    """Nothing hit yet, and only what is nearer than t_max will do."""
    return Best(t_max, np.int32(MISS), ZERO, ZERO)


@inlined
def between(ray, t_min, t_max):
    """The same ray in another interval."""
    return Ray(ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ray.dz, t_min, t_max)


@inlined
def hit_primitive(s, ray, primitive):
    """(t, u, v) of a ray, in the primitive's own space, on a primitive of a search; t = inf for a miss."""
    world = s.world
    if primitive < world.triangle_count:
        return hit_triangle(ray, world.triangles, primitive)
    return hit_quadric(ray, world.quadrics, primitive - world.triangle_count), ZERO, ZERO


@inlined
def walk_leaves(s, trees, ray, pending, best, nearest):
    """The nearer of `best` and the nearest hit below the nodes pending on the stack of a search; or, where not the
    `nearest` is wanted, the first found.

    Of hits at equal t the one on the lower number is the nearest.  `nearest` is a constant, so that either walk is
    compiled without the other."""
    while pending > 0 and (not nearest or s.stack.enter[pending - 1] <= best.t):
        # Walk to the next leaf and test its primitives.
        leaf = next_leaf(trees, ray, s.stack, pending)
        pending = leaf.pending
        s.counts[STEPS] += leaf.steps
        for i in range(leaf.first, leaf.first + leaf.size):
            s.counts[TESTS] += 1
            primitive = trees.items[i]
            t, u, v = hit_primitive(s, ray, primitive)
            if nearest:
                if t < best.t or (t == best.t and t < INFINITY and primitive < best.primitive):
                    best = Best(t, primitive, u, v)
            elif t < INFINITY:
                return Best(t, primitive, u, v)
    return best

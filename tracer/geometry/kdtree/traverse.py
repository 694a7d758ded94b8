"""The two queries on a placed world, one ray at a time, every step counted.

Static geometry has one tree.  Each dynamic object has its own, in its own space, and a small tree
over the objects' boxes leads to them; a ray is carried into an object's space rather than the
object into the world's (Hunt, Mark, Stoll 2006; §3 of the paper).  A step is a node entered, inner
or leaf, in any of these trees; a test is a ray against a primitive.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.intersect import ZERO, hit_box, hit_quadric, hit_triangle, transform_ray
from tracer.geometry.kdtree.tree import STACK_SIZE, Stack, Trees, next_leaf, pointers_to, push
from tracer.geometry.memory import local_float32, local_int32, pointer
from tracer.geometry.rays import INFINITY, MISS, Ray, ray_at, ray_pointers
from tracer.kernels import inlined, kernel, subkernel

STEPS, TESTS = 0, 1  # what a query adds to its counts
SLACK = np.float32(1e-5)  # relative; by so much an object's interval is wider than that of its leaf


class Placed(NamedTuple):
    """What rays can meet, placed for one moment.

    triangles (t, 9) and quadrics (q, 16) float32 are in the space of their object: triangle i is
    primitive i, quadric j primitive t + j, and object_of (t + q,) int32 tells whose they are.
    static and dynamic are trees over primitives, top is one over the dynamic objects, inside top_box (6,).
    roots (objects,) int32, boxes (objects, 6) and to_object (objects, 12) float32; object 0 is static.
    """

    triangles: NDArray[np.float32]
    quadrics: NDArray[np.float32]
    static: Trees
    dynamic: Trees
    top: Trees
    roots: NDArray[np.int32]
    boxes: NDArray[np.float32]
    to_object: NDArray[np.float32]
    top_box: NDArray[np.float32]
    object_of: NDArray[np.int32]


class _Search(NamedTuple):
    """A world as pointers, with what one ray at a time needs to search it."""

    triangles: Any
    triangle_count: int
    quadrics: Any
    static: Trees
    dynamic: Trees
    top: Trees
    roots: Any
    boxes: Any
    to_object: Any
    top_box: Any
    stack: Stack
    top_stack: Stack
    counts: Any


class _Best(NamedTuple):
    """The nearest hit so far."""

    t: Any
    primitive: Any
    u: Any
    v: Any


@inlined
def _search(world, stack, top_stack, counts):
    return _Search(
        pointer(world.triangles),
        len(world.triangles),
        pointer(world.quadrics),
        pointers_to(world.static),
        pointers_to(world.dynamic),
        pointers_to(world.top),
        pointer(world.roots),
        pointer(world.boxes),
        pointer(world.to_object),
        pointer(world.top_box),
        stack,
        top_stack,
        pointer(counts),
    )


@inlined
def _hit_primitive(triangles, triangle_count, quadrics, ray, primitive):
    """(t, u, v) of a ray, in the primitive's own space, on a primitive; t = inf for a miss."""
    if primitive < triangle_count:
        return hit_triangle(ray, triangles, primitive)
    return hit_quadric(ray, quadrics, primitive - triangle_count), ZERO, ZERO


@inlined
def _between(ray, t_min, t_max):
    return Ray(ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ray.dz, t_min, t_max)


@subkernel
def _closest_in_tree(s, trees, o, ray, enter, leave, best):
    """Nearest hit in object o, if nearer than `best`; equal t goes to the lower number."""
    near, far = hit_box(_between(ray, enter, leave), s.boxes, o)
    if near > far:
        return best
    pending = push(s.stack, 0, s.roots[o], near, far)
    while pending > 0 and s.stack.enter[pending - 1] <= best.t:
        leaf = next_leaf(trees, ray, s.stack, pending)
        pending = leaf.pending
        s.counts[STEPS] += leaf.steps
        s.counts[TESTS] += leaf.size
        for i in range(leaf.first, leaf.first + leaf.size):
            primitive = trees.items[i]
            t, u, v = _hit_primitive(s.triangles, s.triangle_count, s.quadrics, ray, primitive)
            if t < best.t or (t == best.t and t < INFINITY and primitive < best.primitive):
                best = _Best(t, primitive, u, v)
    return best


@subkernel
def _any_in_tree(s, trees, o, ray, enter, leave):
    """Whether anything of object o is hit."""
    near, far = hit_box(_between(ray, enter, leave), s.boxes, o)
    if near > far:
        return False
    pending = push(s.stack, 0, s.roots[o], near, far)
    while pending > 0:
        leaf = next_leaf(trees, ray, s.stack, pending)
        pending = leaf.pending
        s.counts[STEPS] += leaf.steps
        for i in range(leaf.first, leaf.first + leaf.size):
            s.counts[TESTS] += 1
            if _hit_primitive(s.triangles, s.triangle_count, s.quadrics, ray, trees.items[i])[0] < INFINITY:
                return True
    return False


@inlined
def _piece(leaf):
    """The part of a ray that is in a leaf: an object that lies in several is searched piece by piece."""
    return leaf.enter - SLACK * abs(leaf.enter), leaf.leave + SLACK * abs(leaf.leave)


@subkernel
def _closest_dynamic(s, ray, best):
    near, far = hit_box(ray, s.top_box, 0)
    if near > min(far, best.t):
        return best
    pending = push(s.top_stack, 0, 0, near, far)
    while pending > 0 and s.top_stack.enter[pending - 1] <= best.t:
        leaf = next_leaf(s.top, ray, s.top_stack, pending)
        pending = leaf.pending
        s.counts[STEPS] += leaf.steps
        enter, leave = _piece(leaf)
        for i in range(leaf.first, leaf.first + leaf.size):
            o = s.top.items[i]
            local = transform_ray(ray, s.to_object, o, 12)
            best = _closest_in_tree(s, s.dynamic, o, local, enter, min(leave, best.t), best)
    return best


@subkernel
def _any_dynamic(s, ray):
    near, far = hit_box(ray, s.top_box, 0)
    if near > far:
        return False
    pending = push(s.top_stack, 0, 0, near, far)
    while pending > 0:
        leaf = next_leaf(s.top, ray, s.top_stack, pending)
        pending = leaf.pending
        s.counts[STEPS] += leaf.steps
        enter, leave = _piece(leaf)
        for i in range(leaf.first, leaf.first + leaf.size):
            o = s.top.items[i]
            if _any_in_tree(s, s.dynamic, o, transform_ray(ray, s.to_object, o, 12), enter, leave):
                return True
    return False


@kernel
def closest_hits(world, rays, hits, first, last, counts):
    """Nearest hits of rays first to last - 1, into `hits`; counts[STEPS] and counts[TESTS] grow."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    top_stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(world, stack, top_stack, counts)
    batch = ray_pointers(rays)
    for i in range(first, last):
        ray = ray_at(batch, i)
        best = _Best(ray.t_max, np.int32(MISS), ZERO, ZERO)
        best = _closest_in_tree(s, s.static, 0, ray, ray.t_min, ray.t_max, best)
        best = _closest_dynamic(s, ray, best)
        hits.t[i] = best.t if best.primitive != MISS else INFINITY
        hits.primitive[i], hits.u[i], hits.v[i] = best.primitive, best.u, best.v


@subkernel
def any_static_hits(world, rays, blocked, first, last, counts):
    """blocked[i] for rays first to last - 1: whether static geometry lies in their interval."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(world, stack, stack, counts)
    batch = ray_pointers(rays)
    for i in range(first, last):
        ray = ray_at(batch, i)
        blocked[i] = _any_in_tree(s, s.static, 0, ray, ray.t_min, ray.t_max)


@subkernel
def any_dynamic_hits(world, rays, blocked, first, last, counts):
    """blocked[i] for rays first to last - 1: whether a dynamic object lies in their interval."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    top_stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(world, stack, top_stack, counts)
    batch = ray_pointers(rays)
    for i in range(first, last):
        blocked[i] = _any_dynamic(s, ray_at(batch, i))


@kernel
def any_hits(world, rays, blocked, first, last, counts):
    """blocked[i] for rays first to last - 1: whether anything lies in their interval, static geometry asked first."""
    any_static_hits(world, rays, blocked, first, last, counts)
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    top_stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(world, stack, top_stack, counts)
    batch = ray_pointers(rays)
    for i in range(first, last):
        blocked[i] = blocked[i] or _any_dynamic(s, ray_at(batch, i))


@subkernel
def hits_alone(world, ray, primitive):
    """Whether a ray in world space meets this primitive, nothing else asked."""
    o = world.object_of[primitive]
    if o != 0:
        ray = transform_ray(ray, pointer(world.to_object), o, 12)
    triangles, quadrics = pointer(world.triangles), pointer(world.quadrics)
    return _hit_primitive(triangles, len(world.triangles), quadrics, ray, primitive)[0] < INFINITY

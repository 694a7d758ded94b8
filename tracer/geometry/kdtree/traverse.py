"""The two queries on a placed world, one ray at a time, every step counted.

Static geometry has one tree.  Each dynamic object has its own, in its own space.  Two small trees over the objects'
boxes lead to them: one over the objects that rest, and one over those that move.  The ray is transformed to an object's
space rather than the object to the world (Hunt, Mark, Stoll 2006; §3 of the paper).  A step is a node entered, inner or
leaf, in any of these trees; a test is a ray against a primitive.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.boxes import hit_box
from tracer.geometry.intersect import ZERO, transform_ray
from tracer.geometry.kdtree.tree import STACK_SIZE, Best, KdWorld, Stack, between, next_leaf, no_hit, push, walk_leaves
from tracer.geometry.memory import local_float32, local_int32
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY, STEPS, rays_of, read_batch
from tracer.geometry.rays import INFINITY, MISS, ray_at
from tracer.runtime.kernels import inlined, native_callback, subkernel
from tracer.simd import f32_at, i32_at, i64_at, u8_at
from tracer.simd.records import reading

SLACK = np.float32(1e-5)  # relative: by so much a ray's interval in an object is wider than in the leaf that names it


class _Search(NamedTuple):
    """A placed world, as pointers, and the memory that the walk of one ray needs."""

    world: Any
    stack: Stack
    top_stack: Stack
    counts: Any


_read_world = reading(KdWorld)


@inlined
def _walk(s, trees, o, ray, enter, leave, best, nearest):
    """The nearest hit in object o if it is nearer than `best`; or, where not the `nearest` is wanted, the first."""
    # Start at the root with the ray's interval in the object's box.
    near, far = hit_box(between(ray, enter, leave), s.world.boxes, o)
    if near > far:
        return best
    pending = push(s.stack, 0, s.world.roots[o], near, far)
    return walk_leaves(s, trees, ray, pending, best, nearest)


@subkernel
def _closest_in_tree(s, trees, o, ray, enter, leave, best):
    """The nearer of `best` and the nearest hit in object o."""
    return _walk(s, trees, o, ray, enter, leave, best, True)


@subkernel
def _any_in_tree(s, trees, o, ray, enter, leave):
    """The first primitive of object o that is found to be hit, or MISS."""
    return _walk(s, trees, o, ray, enter, leave, no_hit(INFINITY), False).primitive


@inlined
def _piece(leaf):
    """The interval of a ray in a leaf of objects: an object that lies in several leaves is searched piece by piece."""
    return leaf.enter - SLACK * abs(leaf.enter), leaf.leave + SLACK * abs(leaf.leave)


@inlined
def _walk_top(s, top, ray, best, nearest):
    """As `_walk`, in all objects of a tree over objects."""
    near, far = hit_box(ray, top.box, 0)
    if near > (min(far, best.t) if nearest else far):
        return best
    pending = push(s.top_stack, 0, 0, near, far)
    while pending > 0 and (not nearest or s.top_stack.enter[pending - 1] <= best.t):
        leaf = next_leaf(top.trees, ray, s.top_stack, pending)
        pending = leaf.pending
        s.counts[STEPS] += leaf.steps
        enter, leave = _piece(leaf)
        for i in range(leaf.first, leaf.first + leaf.size):
            o = top.trees.items[i]
            local = transform_ray(ray, s.world.to_object, o, 12)
            if nearest:
                best = _closest_in_tree(s, s.world.dynamic, o, local, enter, min(leave, best.t), best)
            else:
                primitive = _any_in_tree(s, s.world.dynamic, o, local, enter, leave)
                if primitive != MISS:
                    return Best(ZERO, primitive, ZERO, ZERO)
    return best


@inlined
def _closest_of(s, top, ray, best):
    """Nearest hit in the objects of a tree, if nearer than `best`."""
    return _walk_top(s, top, ray, best, True)


@subkernel
def _any_of(s, top, ray):
    """The first primitive of the objects of a tree that is found to be hit, or MISS."""
    return _walk_top(s, top, ray, no_hit(INFINITY), False).primitive


@native_callback
def closest(data, batch, first, last, counts):
    """Nearest hits of rays first to last - 1; counts[STEPS] and counts[TESTS] grow."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    top_stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s, asked = _Search(_read_world(data), stack, top_stack, i64_at(counts)), read_batch(batch)
    rays, hit_t, hit_primitive = rays_of(asked), f32_at(asked.t), i32_at(asked.primitive)
    hit_u, hit_v = f32_at(asked.u), f32_at(asked.v)
    for i in range(first, last):
        # Search the static tree, then the objects that rest and those that move.
        ray = ray_at(rays, i)
        best = no_hit(ray.t_max)
        best = _closest_in_tree(s, s.world.static, 0, ray, ray.t_min, ray.t_max, best)
        for number in range(2):
            top = s.world.resting if number == 0 else s.world.moving
            if top.there:
                best = _closest_of(s, top, ray, best)
        hit_t[i] = best.t if best.primitive != MISS else INFINITY
        hit_primitive[i], hit_u[i], hit_v[i] = best.primitive, best.u, best.v


@native_callback
def any_hit(data, batch, first, last, counts):
    """What of that which is asked for lies in the interval of rays first to last - 1."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    top_stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s, asked = _Search(_read_world(data), stack, top_stack, i64_at(counts)), read_batch(batch)
    rays, blocked, which = rays_of(asked), u8_at(asked.blocked), asked.which
    named, occluders = asked.occluders != 0, i32_at(asked.occluders)
    for i in range(first, last):
        ray = ray_at(rays, i)
        # Search what is asked for, static geometry first, and stop at the first hit.
        found, primitive = 0, np.int32(MISS)
        if ray.t_min < ray.t_max:
            if which & STATIC_GEOMETRY:
                primitive = _any_in_tree(s, s.world.static, 0, ray, ray.t_min, ray.t_max)
                if primitive == MISS and s.world.resting.there:
                    primitive = _any_of(s, s.world.resting, ray)
                found = STATIC_GEOMETRY if primitive != MISS else 0
            if which & DYNAMIC_OBJECTS and s.world.moving.there and found == 0:
                primitive = _any_of(s, s.world.moving, ray)
                found = DYNAMIC_OBJECTS if primitive != MISS else 0
        blocked[i] = np.uint8(found)
        if named:
            occluders[i] = primitive

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
from tracer.geometry.kdtree.nearest import Best, between, no_hit, walk_leaves
from tracer.geometry.kdtree.tree import STACK_SIZE, Stack, Trees, next_leaf, push
from tracer.geometry.memory import local_float32, local_int32
from tracer.geometry.queries import (
    BLOCKED,
    DYNAMIC_OBJECTS,
    HIT_PRIMITIVE,
    HIT_T,
    HIT_U,
    HIT_V,
    OCCLUDER,
    STATIC_GEOMETRY,
    STEPS,
    WHICH,
    rays_of,
)
from tracer.geometry.rays import INFINITY, MISS, ray_at
from tracer.runtime.kernels import entry, inlined, subkernel
from tracer.simd import f32_at, i32_at, i64_at, load_i64, u8_at

SLACK = np.float32(1e-5)  # relative: by so much a ray's interval in an object is wider than in the leaf that names it


# A placed world as the entries get it: the address, an int64 each, of everything in Parts; then the number of
# triangles, whether anything rests, and whether anything moves.
(
    TRIANGLES, QUADRICS, STATIC_WORDS, STATIC_ITEMS, DYNAMIC_WORDS, DYNAMIC_ITEMS, RESTING_WORDS, RESTING_ITEMS,
    MOVING_WORDS, MOVING_ITEMS, ROOTS, BOXES, TO_OBJECT, RESTING_BOX, MOVING_BOX, TRIANGLE_COUNT,
    HAS_RESTING, HAS_MOVING,
) = range(0, 144, 8)  # fmt: skip


class _Top(NamedTuple):
    """A tree over objects, the box around it, and whether there is anything in it."""

    trees: Trees
    box: Any
    there: Any


class _Search(NamedTuple):
    """A placed world as pointers, and the memory that the walk of one ray needs."""

    triangles: Any
    triangle_count: int
    quadrics: Any
    static: Trees
    dynamic: Trees
    resting: _Top
    moving: _Top
    roots: Any
    boxes: Any
    to_object: Any
    stack: Stack
    top_stack: Stack
    counts: Any


@inlined
def _trees(data, words, items):
    return Trees(i32_at(load_i64(data + words)), f32_at(load_i64(data + words)), i32_at(load_i64(data + items)))


@inlined
def _top(data, words, items, box, there):
    return _Top(_trees(data, words, items), f32_at(load_i64(data + box)), load_i64(data + there) != 0)


@inlined
def _search(data, stack, top_stack, counts):
    return _Search(
        f32_at(load_i64(data + TRIANGLES)),
        load_i64(data + TRIANGLE_COUNT),
        f32_at(load_i64(data + QUADRICS)),
        _trees(data, STATIC_WORDS, STATIC_ITEMS),
        _trees(data, DYNAMIC_WORDS, DYNAMIC_ITEMS),
        _top(data, RESTING_WORDS, RESTING_ITEMS, RESTING_BOX, HAS_RESTING),
        _top(data, MOVING_WORDS, MOVING_ITEMS, MOVING_BOX, HAS_MOVING),
        i32_at(load_i64(data + ROOTS)),
        f32_at(load_i64(data + BOXES)),
        f32_at(load_i64(data + TO_OBJECT)),
        stack,
        top_stack,
        i64_at(counts),
    )


@inlined
def _walk(s, trees, o, ray, enter, leave, best, nearest):
    """The nearest hit in object o if it is nearer than `best`; or, where not the `nearest` is wanted, the first."""
    # Start at the root with the ray's interval in the object's box.
    near, far = hit_box(between(ray, enter, leave), s.boxes, o)
    if near > far:
        return best
    pending = push(s.stack, 0, s.roots[o], near, far)
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
            local = transform_ray(ray, s.to_object, o, 12)
            if nearest:
                best = _closest_in_tree(s, s.dynamic, o, local, enter, min(leave, best.t), best)
            else:
                primitive = _any_in_tree(s, s.dynamic, o, local, enter, leave)
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


@entry
def closest(data, batch, first, last, counts):
    """Nearest hits of rays first to last - 1; counts[STEPS] and counts[TESTS] grow."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    top_stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(data, stack, top_stack, counts)
    rays = rays_of(batch)
    hit_t, hit_primitive = f32_at(load_i64(batch + HIT_T)), i32_at(load_i64(batch + HIT_PRIMITIVE))
    hit_u, hit_v = f32_at(load_i64(batch + HIT_U)), f32_at(load_i64(batch + HIT_V))
    for i in range(first, last):
        # Search the static tree, then the objects that rest and those that move.
        ray = ray_at(rays, i)
        best = no_hit(ray.t_max)
        best = _closest_in_tree(s, s.static, 0, ray, ray.t_min, ray.t_max, best)
        for number in range(2):
            top = s.resting if number == 0 else s.moving
            if top.there:
                best = _closest_of(s, top, ray, best)
        hit_t[i] = best.t if best.primitive != MISS else INFINITY
        hit_primitive[i], hit_u[i], hit_v[i] = best.primitive, best.u, best.v


@entry
def any_hit(data, batch, first, last, counts):
    """What of that which is asked for lies in the interval of rays first to last - 1."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    top_stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(data, stack, top_stack, counts)
    rays, blocked, which = rays_of(batch), u8_at(load_i64(batch + BLOCKED)), load_i64(batch + WHICH)
    named, occluders = load_i64(batch + OCCLUDER) != 0, i32_at(load_i64(batch + OCCLUDER))
    for i in range(first, last):
        ray = ray_at(rays, i)
        # Search what is asked for, static geometry first, and stop at the first hit.
        found, primitive = 0, np.int32(MISS)
        if ray.t_min < ray.t_max:
            if which & STATIC_GEOMETRY:
                primitive = _any_in_tree(s, s.static, 0, ray, ray.t_min, ray.t_max)
                if primitive == MISS and s.resting.there:
                    primitive = _any_of(s, s.resting, ray)
                found = STATIC_GEOMETRY if primitive != MISS else 0
            if which & DYNAMIC_OBJECTS and s.moving.there and found == 0:
                primitive = _any_of(s, s.moving, ray)
                found = DYNAMIC_OBJECTS if primitive != MISS else 0
        blocked[i] = np.uint8(found)
        if named:
            occluders[i] = primitive

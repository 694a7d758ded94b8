"""The two queries on one tree of everything, which is built where rays arrive.

The upper nodes separate what moves from what never does; below them hang what never moves, a tree for all frames, and
the objects that are there, each with a tree in its own space to which the ray is transformed.  A ray that asks for what
moves alone stops at nodes below which nothing does (section 2.4 of the paper).  A step is a node entered, inner or
leaf; a test is a ray against a primitive.  What building costs is neither.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.boxes import hit_box
from tracer.geometry.intersect import transform_ray
from tracer.geometry.kdtree.tree import STACK_SIZE, Stack, Trees, between, no_hit, push, walk_leaves
from tracer.geometry.lazy_tree.node import (
    FIRST,
    HEADER,
    OBJECTS,
    SECOND,
    STACK,
    STATIC_VISITED,
    SUBTREE,
    Building,
    next_node,
)
from tracer.geometry.memory import local_float32, local_int32
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY, STEPS, rays_of, read_batch
from tracer.geometry.rays import INFINITY, MISS, ray_at
from tracer.runtime.kernels import inlined, native_callback, subkernel
from tracer.simd import f32_at, i32_at, i64_at, load_i64, local_memory, u8_at
from tracer.simd.records import BytesAt, F32At, I64At, reading

REMEMBERED = 8  # objects that a ray has searched last, which other nodes that they reach into need not search again
STACK_BYTES = 8 * STACK
STACKS = 6 * STACK_BYTES


class LazyWorld(NamedTuple):
    """A placed world: triangles (t, 9) and quadrics (q, 16) float32, in the space of their object; the address of the
    root of everything, and the box (6,) around it; for each object the address of its root, its box (6,) in its own
    space, the map (12,) there, and whether it rests; the box (6,) around those that move, and whether any does; and
    what builds nodes."""

    triangles: F32At
    triangle_count: int
    quadrics: F32At
    root: int
    bounds: F32At
    object_roots: I64At
    object_boxes: F32At
    to_object: F32At
    rests: BytesAt
    moving_box: F32At
    moves: bool
    building: Building


_read_world = reading(LazyWorld)


class _Search(NamedTuple):
    """A placed world, as pointers, and the memory that the walk of one ray needs."""

    world: Any
    upper: Stack
    lower: Stack
    stack: Stack
    searched: Any
    counts: Any


@subkernel
def _in_subtree(s, node, ray, enter, leave, best, nearest):
    """The nearer of `best` and the nearest hit in a SUBTREE; or, where not the `nearest` is wanted, the first found."""
    subtree = load_i64(node + FIRST)
    words = subtree + HEADER
    trees = Trees(i32_at(words), f32_at(words), i32_at(words + 4 * load_i64(subtree)))
    pending = push(s.stack, 0, np.int32(0), enter, leave)
    return walk_leaves(s, trees, ray, pending, best, nearest)


@subkernel
def _in_object(s, o, ray, enter, leave, best, nearest):
    """As `_in_subtree`, in all of object o; the ray is in its space."""
    near, far = hit_box(between(ray, enter, leave), s.world.object_boxes, o)
    if near > far:
        return best
    pending = push(s.lower, 0, s.world.object_roots[o], near, far)
    while pending > 0 and (not nearest or s.lower.enter[pending - 1] <= best.t):
        met = next_node(ray, s.lower, pending, s.world.building, False)
        pending = met.pending
        s.counts[STEPS] += met.steps
        best = _in_subtree(s, met.node, ray, met.enter, met.leave, best, nearest)
        if not nearest and best.primitive != MISS:
            break
    return best


@inlined
def _meets_what_moves(s, ray):
    """Whether a ray meets the box around all that moves: methods rely on it that nothing else has hits on that."""
    near, far = hit_box(ray, s.world.moving_box, 0)
    return s.world.moves and near <= far


@inlined
def _local(s, ray, o):
    return transform_ray(ray, s.world.to_object, o, 12)


@inlined
def _is_searched(s, o, count):
    """Whether object o is among the last of `count` that a ray has searched.

    Each is searched as a whole: where an object is flat, t is too uncertain to go by pieces."""
    found = False
    for i in range(min(count, REMEMBERED)):
        found = found or s.searched[i] == o
    return found


@inlined
def _put_off(s, met, pending):
    """Leave the objects of a node until what never moves has been asked there: how many nodes are pending then."""
    pending = push(s.upper, pending, met.node | STATIC_VISITED, met.enter, met.leave)
    return push(s.upper, pending, load_i64(met.node + FIRST), met.enter, met.leave)


@inlined
def _closest(s, ray):
    """The nearest hit of a ray."""
    best, searched, moving = no_hit(ray.t_max), 0, _meets_what_moves(s, ray)
    near, far = hit_box(ray, s.world.bounds, 0)
    pending = push(s.upper, 0, s.world.root, near, far) if near <= far else 0
    while pending > 0:
        if s.upper.enter[pending - 1] > best.t:  # but objects that were put off, further down, may be nearer
            pending -= 1
            continue
        met = next_node(ray, s.upper, pending, s.world.building, False)
        pending = met.pending
        s.counts[STEPS] += met.steps
        if met.kind == SUBTREE:
            best = _in_subtree(s, met.node, ray, met.enter, met.leave, best, True)
        elif not met.node & STATIC_VISITED:
            pending = _put_off(s, met, pending)
        else:
            objects = i32_at(load_i64(met.node - STATIC_VISITED + SECOND))
            for i in range(1, 1 + objects[0]):
                o = objects[i]
                if (moving or s.world.rests[o] != 0) and not _is_searched(s, o, searched):
                    s.searched[searched % REMEMBERED] = o
                    searched += 1
                    best = _in_object(s, o, _local(s, ray, o), ray.t_min, best.t, best, True)
    return best


@inlined
def _any(s, ray, which):
    """What blocks a ray: STATIC_GEOMETRY, DYNAMIC_OBJECTS or 0, and which primitive.

    What never moves, or rests, is looked for as long as it may be there; what moves, until something is found."""
    if which & DYNAMIC_OBJECTS and not _meets_what_moves(s, ray):
        which ^= DYNAMIC_OBJECTS
    found, moving, searched = 0, np.int32(MISS), 0
    near, far = hit_box(ray, s.world.bounds, 0)
    pending = push(s.upper, 0, s.world.root, near, far) if near <= far and which else 0
    while pending > 0:
        met = next_node(ray, s.upper, pending, s.world.building, which == DYNAMIC_OBJECTS)
        pending = met.pending
        s.counts[STEPS] += met.steps
        if met.kind == SUBTREE:
            if which & STATIC_GEOMETRY:
                primitive = _in_subtree(s, met.node, ray, met.enter, met.leave, no_hit(INFINITY), False).primitive
                if primitive != MISS:
                    return STATIC_GEOMETRY, primitive
        elif met.kind == OBJECTS:
            if which & STATIC_GEOMETRY and not met.node & STATIC_VISITED:
                pending = _put_off(s, met, pending)
                continue
            objects = i32_at(load_i64((met.node | STATIC_VISITED) - STATIC_VISITED + SECOND))
            for i in range(1, 1 + objects[0]):
                o = objects[i]
                kind = STATIC_GEOMETRY if s.world.rests[o] != 0 else DYNAMIC_OBJECTS
                if not which & kind or (kind == DYNAMIC_OBJECTS and found != 0) or _is_searched(s, o, searched):
                    continue
                s.searched[searched % REMEMBERED] = o
                searched += 1
                local = _local(s, ray, o)
                primitive = _in_object(s, o, local, ray.t_min, ray.t_max, no_hit(INFINITY), False).primitive
                if primitive == MISS:
                    continue
                if kind == STATIC_GEOMETRY or which == DYNAMIC_OBJECTS:
                    return kind, primitive
                found, moving = DYNAMIC_OBJECTS, primitive
    return found, moving


@inlined
def _search(data, counts, stacks, stack, searched):
    """The search of one ray after another; `stacks` is the address of STACKS bytes."""
    lower = stacks + 3 * STACK_BYTES
    return _Search(
        _read_world(data),
        Stack(i64_at(stacks), f32_at(stacks + STACK_BYTES), f32_at(stacks + 2 * STACK_BYTES)),
        Stack(i64_at(lower), f32_at(lower + STACK_BYTES), f32_at(lower + 2 * STACK_BYTES)),
        stack,
        searched,
        i64_at(counts),
    )


@native_callback
def closest(data, batch, first, last, counts):
    """Nearest hits of rays first to last - 1; counts[STEPS] and counts[TESTS] grow."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(data, counts, local_memory(STACKS), stack, local_int32(REMEMBERED))
    asked = read_batch(batch)
    rays, hit_t, hit_primitive = rays_of(asked), f32_at(asked.t), i32_at(asked.primitive)
    hit_u, hit_v = f32_at(asked.u), f32_at(asked.v)
    for i in range(first, last):
        best = _closest(s, ray_at(rays, i))
        hit_t[i] = best.t if best.primitive != MISS else INFINITY
        hit_primitive[i], hit_u[i], hit_v[i] = best.primitive, best.u, best.v


@native_callback
def any_hit(data, batch, first, last, counts):
    """What of that which is asked for lies in the interval of rays first to last - 1."""
    stack = Stack(local_int32(STACK_SIZE), local_float32(STACK_SIZE), local_float32(STACK_SIZE))
    s = _search(data, counts, local_memory(STACKS), stack, local_int32(REMEMBERED))
    asked = read_batch(batch)
    rays, blocked, which = rays_of(asked), u8_at(asked.blocked), asked.which
    named, occluders = asked.occluders != 0, i32_at(asked.occluders)
    for i in range(first, last):
        ray = ray_at(rays, i)
        found, primitive = 0, np.int32(MISS)
        if ray.t_min < ray.t_max:
            found, primitive = _any(s, ray, which)
        blocked[i] = np.uint8(found)
        if named:
            occluders[i] = primitive

"""The two queries on a placed world, one ray at a time, every step counted.

Static geometry has one tree.  Each dynamic object has its own, in its own space, and a small tree
over the objects' boxes leads to them; a ray is carried into an object's space rather than the
object into the world's (Hunt, Mark, Stoll 2006; §3 of the paper).  A step is a node entered, inner
or leaf, in any of these trees; a test is a ray against a primitive.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.intersect import ZERO, hit_box, hit_quadric, hit_triangle, transform_ray
from tracer.geometry.kdtree.tree import Trees, empty_stack, next_leaf, push
from tracer.geometry.rays import INFINITY, MISS, Ray, ray_at
from tracer.kernels import inlined, kernel

STEPS, TESTS = 0, 1  # what a query adds to its counts
SLACK = np.float32(1e-5)  # relative; by so much an object's interval is wider than that of its leaf


class World(NamedTuple):
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


@inlined
def hit_primitive(triangles, quadrics, ray, primitive):
    """(t, u, v) of a ray, in the primitive's own space, on a primitive; t = inf for a miss."""
    if primitive < len(triangles):
        return hit_triangle(ray, triangles, primitive)
    return hit_quadric(ray, quadrics, primitive - len(triangles)), ZERO, ZERO


@inlined
def _limited(ray, t_min, t_max):
    return Ray(ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ray.dz, t_min, t_max)


@kernel
def _closest_in_tree(world, trees, root, box, ray, enter, leave, stack, best, counts):
    """Nearest hit nearer than best = (t, primitive, u, v), which it replaces; equal t goes to the lower number."""
    near, far = hit_box(_limited(ray, enter, leave), box)
    if near > far:
        return best
    pending = push(stack, 0, root, near, far)
    while pending > 0 and stack.enter[pending - 1] <= best[0]:
        leaf = next_leaf(trees, ray, stack, pending)
        pending = leaf.pending
        counts[STEPS] += leaf.steps
        counts[TESTS] += leaf.count
        for i in range(leaf.first, leaf.first + leaf.count):
            primitive = trees.items[i]
            t, u, v = hit_primitive(world.triangles, world.quadrics, ray, primitive)
            if t < best[0] or (t == best[0] and t < INFINITY and primitive < best[1]):
                best = (t, primitive, u, v)
    return best


@kernel
def _any_in_tree(world, trees, root, box, ray, enter, leave, stack, counts):
    """Whether anything is hit at all."""
    near, far = hit_box(_limited(ray, enter, leave), box)
    if near > far:
        return False
    pending = push(stack, 0, root, near, far)
    while pending > 0:
        leaf = next_leaf(trees, ray, stack, pending)
        pending = leaf.pending
        counts[STEPS] += leaf.steps
        for i in range(leaf.first, leaf.first + leaf.count):
            counts[TESTS] += 1
            if hit_primitive(world.triangles, world.quadrics, ray, trees.items[i])[0] < INFINITY:
                return True
    return False


@kernel
def _closest_dynamic(world, ray, stack, top_stack, best, counts):
    near, far = hit_box(ray, world.top_box)
    if near > min(far, best[0]):
        return best
    pending = push(top_stack, 0, 0, near, far)
    while pending > 0 and top_stack.enter[pending - 1] <= best[0]:
        leaf = next_leaf(world.top, ray, top_stack, pending)
        pending = leaf.pending
        counts[STEPS] += leaf.steps
        # Only the part of the ray in this leaf: an object that lies in several is searched piece by piece.
        enter, leave = leaf.enter - SLACK * abs(leaf.enter), leaf.leave + SLACK * abs(leaf.leave)
        for i in range(leaf.first, leaf.first + leaf.count):
            o = world.top.items[i]
            local = transform_ray(ray, world.to_object[o])
            best = _closest_in_tree(
                world, world.dynamic, world.roots[o], world.boxes[o], local, enter, min(leave, best[0]), stack, best, counts
            )
    return best


@kernel
def _any_dynamic(world, ray, stack, top_stack, counts):
    near, far = hit_box(ray, world.top_box)
    if near > far:
        return False
    pending = push(top_stack, 0, 0, near, far)
    while pending > 0:
        leaf = next_leaf(world.top, ray, top_stack, pending)
        pending = leaf.pending
        counts[STEPS] += leaf.steps
        enter, leave = leaf.enter - SLACK * abs(leaf.enter), leaf.leave + SLACK * abs(leaf.leave)
        for i in range(leaf.first, leaf.first + leaf.count):
            o = world.top.items[i]
            local = transform_ray(ray, world.to_object[o])
            if _any_in_tree(
                world, world.dynamic, world.roots[o], world.boxes[o], local, enter, leave, stack, counts
            ):
                return True
    return False


@kernel
def closest_hits(world, rays, hits, first, last, counts):
    """Nearest hits of rays first to last - 1, into `hits`; counts[STEPS] and counts[TESTS] grow."""
    stack, top_stack = empty_stack(), empty_stack()
    for i in range(first, last):
        ray = ray_at(rays, i)
        best = (ray.t_max, np.int32(MISS), ZERO, ZERO)
        best = _closest_in_tree(
            world, world.static, world.roots[0], world.boxes[0], ray, ray.t_min, ray.t_max, stack, best, counts
        )
        best = _closest_dynamic(world, ray, stack, top_stack, best, counts)
        hits.t[i] = best[0] if best[1] != MISS else INFINITY
        hits.primitive[i], hits.u[i], hits.v[i] = best[1], best[2], best[3]


@kernel
def any_static_hits(world, rays, blocked, first, last, counts):
    """blocked[i] for rays first to last - 1: whether static geometry lies in their interval."""
    stack = empty_stack()
    for i in range(first, last):
        ray = ray_at(rays, i)
        blocked[i] = _any_in_tree(
            world, world.static, world.roots[0], world.boxes[0], ray, ray.t_min, ray.t_max, stack, counts
        )


@kernel
def any_dynamic_hits(world, rays, blocked, first, last, counts):
    """blocked[i] for rays first to last - 1: whether a dynamic object lies in their interval."""
    stack, top_stack = empty_stack(), empty_stack()
    for i in range(first, last):
        blocked[i] = _any_dynamic(world, ray_at(rays, i), stack, top_stack, counts)


@kernel
def any_hits(world, rays, blocked, first, last, counts):
    """blocked[i] for rays first to last - 1: whether anything lies in their interval, static geometry asked first."""
    any_static_hits(world, rays, blocked, first, last, counts)
    stack, top_stack = empty_stack(), empty_stack()
    for i in range(first, last):
        blocked[i] = blocked[i] or _any_dynamic(world, ray_at(rays, i), stack, top_stack, counts)


@kernel
def hits_alone(world, ray, primitive):
    """Whether a ray in world space meets this primitive, nothing else asked."""
    o = world.object_of[primitive]
    if o != 0:
        ray = transform_ray(ray, world.to_object[o])
    return hit_primitive(world.triangles, world.quadrics, ray, primitive)[0] < INFINITY

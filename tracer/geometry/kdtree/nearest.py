"""The nearest hit so far, and the walk of one ray through the leaves of a tree that looks for a nearer one."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.intersect import ZERO, hit_quadric, hit_triangle
from tracer.geometry.kdtree.tree import next_leaf
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.rays import INFINITY, MISS, Ray
from tracer.runtime.kernels import inlined


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
    if primitive < s.triangle_count:
        return hit_triangle(ray, s.triangles, primitive)
    return hit_quadric(ray, s.quadrics, primitive - s.triangle_count), ZERO, ZERO


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

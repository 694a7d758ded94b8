"""The two queries on a placed world, closest hits and any hits, whichever acceleration structure is below.

The queries of a structure are machine code.  They are compiled once and called by address, so that shading is compiled
without them and need not know which structure it calls.  A structure has two entries,

    closest(data, batch, first, last, counts)
    any_hit(data, batch, first, last, counts)

whose arguments are int64: data is the address of the structure's own description of the placed world, batch the address
of a table of addresses (below), first and last - 1 are the first and the last ray to trace, and counts is the address
of two int64 to which traversal steps and intersection tests are added.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.intersect import hit_quadric, hit_triangle, transform_ray
from tracer.geometry.memory import data_pointer
from tracer.geometry.rays import INFINITY, Hits, RayPointers, Rays
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, call_entry, f32_at, load_i64, local_memory, store

# The table of a batch, as offsets in bytes.  Rays: the addresses of origins and directions, (3, stride) float32, of
# t_min and t_max, and the stride.  Results of closest hits: the addresses of t, primitive, u and v.  Any hits: the
# address of the flags for what blocks each ray; which of STATIC_GEOMETRY and DYNAMIC_OBJECTS to ask; and the address of
# the occluders' numbers, or 0 where nobody wants them.
(
    ORIGIN, DIRECTION, T_MIN, T_MAX, STRIDE, HIT_T, HIT_PRIMITIVE, HIT_U, HIT_V, BLOCKED, WHICH, OCCLUDER,
) = range(0, 96, 8)  # fmt: skip
BATCH = 96  # bytes
STATIC_GEOMETRY, DYNAMIC_OBJECTS = 1, 2
EVERYTHING = STATIC_GEOMETRY | DYNAMIC_OBJECTS
STEPS, TESTS = 0, 1  # what a query adds to its counts


class Placed(NamedTuple):
    """A world placed for one moment, as kernels get it.

    triangles (t, 9) and quadrics (q, 16) float32 are in the space of their object; to_object (objects, 12)
    float32 takes the world there.  Triangle i is primitive i, and quadric j is primitive t + j; object_of
    (t + q,) int32 tells the object of each primitive, and object 0 is static.  closest and any_hit are the
    addresses of the structure's entries, and data is their first argument.  has_dynamic says whether any
    object moves (and does not rest), and moving_box (6,) float32 is around all that do.
    """

    triangles: NDArray[np.float32]
    quadrics: NDArray[np.float32]
    to_object: NDArray[np.float32]
    object_of: NDArray[np.int32]
    closest: int
    any_hit: int
    data: int
    has_dynamic: bool
    moving_box: NDArray[np.float32]


@inlined
def _describe(batch, rays):
    store(batch + ORIGIN, address_of(rays.origin))
    store(batch + DIRECTION, address_of(rays.direction))
    store(batch + T_MIN, address_of(rays.t_min))
    store(batch + T_MAX, address_of(rays.t_max))
    store(batch + STRIDE, np.int64(rays.origin.shape[1]))


@inlined
def closest_hits(world, rays, hits, first, last, counts):
    """Nearest hits of rays first to last - 1, into `hits`."""
    batch = local_memory(BATCH)
    _describe(batch, rays)
    store(batch + HIT_T, address_of(hits.t))
    store(batch + HIT_PRIMITIVE, address_of(hits.primitive))
    store(batch + HIT_U, address_of(hits.u))
    store(batch + HIT_V, address_of(hits.v))
    call_entry(world.closest, world.data, batch, first, last, address_of(counts))


@inlined
def any_hits(world, rays, which, blocked, first, last, counts):
    """What lies in the intervals of rays first to last - 1, into blocked (n,) uint8: STATIC_GEOMETRY, DYNAMIC_OBJECTS,
    or 0 for nothing.  Only `which` of the two is asked; for EVERYTHING, static geometry is asked first."""
    _any_hits(world, rays, which, blocked, np.int64(0), first, last, counts)


@inlined
def any_hits_by(world, rays, which, blocked, occluders, first, last, counts):
    """As `any_hits`; occluders (n,) int32 gets the number of a primitive that blocks each ray, MISS where nothing does.

    This is the first that was found, not always the nearest.  In the kd-tree it depends on the ray alone; in the 8-wide
    trees also on the rays before it, from `first` on."""
    _any_hits(world, rays, which, blocked, address_of(occluders), first, last, counts)


@inlined
def _any_hits(world, rays, which, blocked, occluders, first, last, counts):
    batch = local_memory(BATCH)
    _describe(batch, rays)
    store(batch + BLOCKED, address_of(blocked))
    store(batch + WHICH, np.int64(which))
    store(batch + OCCLUDER, occluders)
    call_entry(world.any_hit, world.data, batch, first, last, address_of(counts))


@inlined
def rays_of(batch):
    """The rays of a described batch, to be read one at a time."""
    return RayPointers(
        f32_at(load_i64(batch + ORIGIN)),
        f32_at(load_i64(batch + DIRECTION)),
        f32_at(load_i64(batch + T_MIN)),
        f32_at(load_i64(batch + T_MAX)),
        load_i64(batch + STRIDE),
    )


def batch_of(
    rays: Rays,
    hits: Hits | None = None,
    blocked: NDArray[np.uint8] | None = None,
    which: int = EVERYTHING,
    occluders: NDArray[np.int32] | None = None,
) -> NDArray[np.int64]:
    """The table of a batch, (12,) int64, for an entry that Python calls; the arrays must live as long as it does."""
    arrays = [rays.origin, rays.direction, rays.t_min, rays.t_max]
    results = [0, 0, 0, 0] if hits is None else [a.ctypes.data for a in (hits.t, hits.primitive, hits.u, hits.v)]
    answer, names = (0 if a is None else a.ctypes.data for a in (blocked, occluders))
    return np.array([*(a.ctypes.data for a in arrays), rays.origin.shape[1], *results, answer, which, names], np.int64)


@subkernel
def hits_alone(world, ray, primitive):
    """Whether a ray in world space hits this primitive."""
    o = world.object_of[primitive]
    if o != 0:
        ray = transform_ray(ray, data_pointer(world.to_object), o, 12)
    if primitive < len(world.triangles):
        return hit_triangle(ray, data_pointer(world.triangles), primitive)[0] < INFINITY
    return hit_quadric(ray, data_pointer(world.quadrics), primitive - len(world.triangles)) < INFINITY

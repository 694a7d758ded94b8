"""The two queries on a placed world, closest hits and any hits, whichever acceleration structure is below.

The queries of a structure are machine code.  They are compiled once and called by address, so that shading is compiled
without them and need not know which structure it calls.  A structure has two callbacks,

    closest(data, batch, first, last, counts)
    any_hit(data, batch, first, last, counts)

whose arguments are int64: data is the address of the structure's own description of the placed world, batch the address
of a `Batch`, first and last - 1 are the first and the last ray to trace, and counts is the address
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
from tracer.simd import address_of, call_native, f32_at, local_memory
from tracer.simd.records import block_size, pack, reading, writing

STATIC_GEOMETRY, DYNAMIC_OBJECTS = 1, 2
EVERYTHING = STATIC_GEOMETRY | DYNAMIC_OBJECTS
STEPS, TESTS = 0, 1  # what a query adds to its counts


class Placed(NamedTuple):
    """A world placed for one moment, as kernels get it.

    triangles (t, 9) and quadrics (q, 16) float32 are in the space of their object; to_object (objects, 12)
    float32 takes the world there.  Triangle i is primitive i, and quadric j is primitive t + j; object_of
    (t + q,) int32 tells the object of each primitive, and object 0 is static.  closest and any_hit are the
    addresses of the structure's callbacks, and data is their first argument.  has_dynamic says whether any
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


class Batch(NamedTuple):
    """What a callback traces, all of it addresses but for two numbers.

    Rays: origins and directions, (3, stride) float32, t_min and t_max.  Results of closest hits: t, primitive, u and v.
    Any hits: a byte for what blocks each ray, `which` of STATIC_GEOMETRY and DYNAMIC_OBJECTS is asked, and the
    occluders' numbers, or 0 where nobody wants them."""

    origin: int
    direction: int
    t_min: int
    t_max: int
    stride: int
    t: int
    primitive: int
    u: int
    v: int
    blocked: int
    which: int
    occluders: int


BATCH = block_size(Batch)
read_batch, _write_batch = reading(Batch), writing(Batch)


@inlined
def _call(callback, data, rays, t, primitive, u, v, blocked, which, occluders, first, last, counts):
    """Call a callback for rays and results that are addresses."""
    batch = local_memory(BATCH)
    origin, direction = address_of(rays.origin), address_of(rays.direction)
    t_min, t_max, stride = address_of(rays.t_min), address_of(rays.t_max), rays.origin.shape[1]
    _write_batch(batch, Batch(origin, direction, t_min, t_max, stride, t, primitive, u, v, blocked, which, occluders))
    call_native(callback, data, batch, first, last, address_of(counts))


@inlined
def closest_hits(world, rays, hits, first, last, counts):
    """Nearest hits of rays first to last - 1, into `hits`."""
    t, primitive, u, v = address_of(hits.t), address_of(hits.primitive), address_of(hits.u), address_of(hits.v)
    _call(world.closest, world.data, rays, t, primitive, u, v, 0, 0, 0, first, last, counts)


@inlined
def any_hits(world, rays, which, blocked, first, last, counts):
    """What lies in the intervals of rays first to last - 1, into blocked (n,) uint8: STATIC_GEOMETRY, DYNAMIC_OBJECTS,
    or 0 for nothing.  Only `which` of the two is asked; for EVERYTHING, static geometry is asked first."""
    _call(world.any_hit, world.data, rays, 0, 0, 0, 0, address_of(blocked), which, 0, first, last, counts)


@inlined
def any_hits_by(world, rays, which, blocked, occluders, first, last, counts):
    """As `any_hits`; occluders (n,) int32 gets the number of a primitive that blocks each ray, MISS where nothing does.

    This is the first that was found, not always the nearest.  In the kd-tree it depends on the ray alone; in the 8-wide
    trees also on the rays before it, from `first` on."""
    by = address_of(occluders)
    _call(world.any_hit, world.data, rays, 0, 0, 0, 0, address_of(blocked), which, by, first, last, counts)


@inlined
def rays_of(batch):
    """The rays of a batch, to be read one at a time."""
    return RayPointers(
        f32_at(batch.origin), f32_at(batch.direction), f32_at(batch.t_min), f32_at(batch.t_max), batch.stride
    )


def batch_of(
    rays: Rays,
    hits: Hits | None = None,
    blocked: NDArray[np.uint8] | None = None,
    which: int = EVERYTHING,
    occluders: NDArray[np.int32] | None = None,
) -> NDArray[np.int64]:
    """A batch as a block, (12,) int64, for a callback that Python calls; the arrays must live as long as it does."""

    def at(array: NDArray | None) -> int:
        return 0 if array is None else array.ctypes.data

    found = (0, 0, 0, 0) if hits is None else (at(hits.t), at(hits.primitive), at(hits.u), at(hits.v))
    asked = at(rays.origin), at(rays.direction), at(rays.t_min), at(rays.t_max), rays.origin.shape[1]
    return pack(Batch(*asked, *found, at(blocked), which, at(occluders)))


@subkernel
def hits_alone(world, ray, primitive):
    """Whether a ray in world space hits this primitive."""
    o = world.object_of[primitive]
    if o != 0:
        ray = transform_ray(ray, data_pointer(world.to_object), o, 12)
    if primitive < len(world.triangles):
        return hit_triangle(ray, data_pointer(world.triangles), primitive)[0] < INFINITY
    return hit_quadric(ray, data_pointer(world.quadrics), primitive - len(world.triangles)) < INFINITY

"""All that a world's structure can be asked of a batch of rays, as it is given to kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import tracer
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY, batch_of
from tracer.geometry.rays import MISS, Hits, Rays

UNTOUCHED = 77


class Answers(NamedTuple):
    """Of n rays: the nearest hit, t, u and v float32 and primitive int32, and whether anything static, or dynamic,
    is in the way, bool; all (n,)."""

    t: np.ndarray
    primitive: np.ndarray
    u: np.ndarray
    v: np.ndarray
    static: np.ndarray
    dynamic: np.ndarray

    def of(self, which: np.ndarray | slice) -> Answers:
        return Answers(*(a[which] for a in self))

    def differing(self, other: Answers) -> np.ndarray:
        """(n,) bool: which are not the same in every bit."""
        same = [(a.view(np.int32) == b.view(np.int32)) if a.itemsize == 4 else a == b for a, b in zip(self, other)]
        return ~np.logical_and.reduce(same)


def ask(world: tracer.World, rays: Rays, first: int = 0, last: int | None = None) -> Answers:
    """Answers for rays first to last - 1; on the way, that those of the others are left alone."""
    n = len(rays.t_min)
    last = n if last is None else last
    numbers = [np.full(n, UNTOUCHED, dtype) for dtype in (np.float32, np.int32, np.float32, np.float32)]
    flags = [np.full(n, UNTOUCHED, np.uint8) for _ in range(2)]
    counts = np.zeros(2, np.int64)
    structure, data = world.structure, world.placed.data
    batch = batch_of(rays, Hits(*numbers))
    structure.closest.call(data, batch.ctypes.data, first, last, counts.ctypes.data)
    names = [np.full(n, UNTOUCHED, np.int32) for _ in range(2)]
    for which, blocked, occluders in zip((STATIC_GEOMETRY, DYNAMIC_OBJECTS), flags, names, strict=True):
        batch = batch_of(rays, blocked=blocked, which=which, occluders=occluders)
        structure.any_hit.call(data, batch.ctypes.data, first, last, counts.ctypes.data)
        assert np.isin(blocked[first:last], (0, which)).all()
        named = occluders[first:last] != MISS
        assert np.array_equal(named, blocked[first:last] != 0)
        assert ((world.object_of[occluders[first:last][named]] == 0) == (which == STATIC_GEOMETRY)).all()
    both = np.full(n, UNTOUCHED, np.uint8)
    batch = batch_of(rays, blocked=both)
    structure.any_hit.call(data, batch.ctypes.data, first, last, counts.ctypes.data)
    static, dynamic = (f[first:last] for f in flags)
    assert np.array_equal(both[first:last], np.where(static, STATIC_GEOMETRY, dynamic))
    for array in (*numbers, *flags, *names, both):
        assert (array[:first] == UNTOUCHED).all() and (array[last:] == UNTOUCHED).all()
    return Answers(*(a[first:last] for a in numbers), *(f[first:last].astype(np.bool_) for f in flags))


def chosen(rays: Rays, which: np.ndarray) -> Rays:
    """Some rays of a batch, as a batch."""
    return Rays(*(np.ascontiguousarray(a[..., which]) for a in rays))

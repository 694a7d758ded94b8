"""Rays and hits as numba sees them: one ray as a tuple of scalars, many as structure of arrays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracer.runtime.kernels import inlined

MISS = -1
INFINITY = np.float32(np.inf)
RAY_OFFSET = 2e-5
"""How far above a surface rays start, so that a rounded hit point does not hit its own surface again: of the largest
coordinate at hand (the depth of the hit or a coordinate of the point, whichever is larger) about 300 roundings of a
float32."""


class Ray(NamedTuple):
    """One ray, float32: its origin, its direction (of any length, which is the unit of t), and the open interval of t,
    which begins at 0 or later."""

    ox: Any
    oy: Any
    oz: Any
    dx: Any
    dy: Any
    dz: Any
    t_min: Any
    t_max: Any


class Rays(NamedTuple):
    """A batch of n rays.

    Attributes
    ----------
    origin, direction : (3, n) float32
        Where the rays start, and where they point.
    t_min, t_max : (n,) float32
        The open interval in which hits count.
    """

    origin: NDArray[np.float32]
    direction: NDArray[np.float32]
    t_min: NDArray[np.float32]
    t_max: NDArray[np.float32]


class Hits(NamedTuple):
    """The nearest hits of n rays.

    Attributes
    ----------
    t : (n,) float32
        Distance in lengths of the ray's direction, inf for a miss.
    primitive : (n,) int32
        Number of the primitive, -1 for a miss.
    u, v : (n,) float32
        Barycentric weights of a triangle's second and third corner.
    """

    t: NDArray[np.float32]
    primitive: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]


def ray_batch(origins: ArrayLike, directions: ArrayLike, t_min: ArrayLike = 0.0, t_max: ArrayLike = np.inf) -> Rays:
    """Make a batch of n rays, which can be traced as often as one likes.

    Directions keep their length, and t is measured in it. The batch holds copies.

    Parameters
    ----------
    origins, directions : (n, 3) array
        Where each ray starts, and where it points.
    t_min, t_max : float or (n,) array
        The open interval in which hits count; t_min is not negative.

    Returns
    -------
    Rays
        The batch, as structure of arrays.

    Raises
    ------
    ValueError
        If shapes do not fit, or a t_min is negative.
    """
    o, d = np.asarray(origins, np.float32), np.asarray(directions, np.float32)
    if o.ndim != 2 or o.shape[1] != 3 or o.shape != d.shape:
        raise ValueError(f"origins and directions are (n, 3) each, not {o.shape} and {d.shape}")
    n = len(o)
    # Copies throughout: a view that cannot be written to is another type, for which kernels would compile anew.
    lo, hi = (np.array(np.broadcast_to(np.asarray(t, np.float32), (n,))) for t in (t_min, t_max))
    if (lo < 0).any():
        raise ValueError(f"t_min is {lo.min():g}: rays look ahead, from 0 on")
    return Rays(np.array(o.T, order="C"), np.array(d.T, order="C"), lo, hi)


@inlined
def padded(n):
    """n rounded up to whole vectors of 16."""
    return (n + 15) & ~15


class RayPointers(NamedTuple):
    """A batch of `size` rays as pointers, to be read one ray at a time."""

    origin: Any
    direction: Any
    t_min: Any
    t_max: Any
    size: int


@inlined
def ray_at(rays, i):
    """The i-th of a batch given as pointers."""
    o, d, y, z = rays.origin, rays.direction, rays.size + i, 2 * rays.size + i
    return Ray(o[i], o[y], o[z], d[i], d[y], d[z], rays.t_min[i], rays.t_max[i])

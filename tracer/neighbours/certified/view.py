"""What kernels are given of certificates."""

from __future__ import annotations

from typing import NamedTuple

from tracer.culling.modes import Words
from tracer.neighbours.certified.requests import Requests
from tracer.simd.records import F32, I32, Bytes, F32x2D, I32x2D, reading
from tracer.visibility.occluders import Occluders


class LampsView(NamedTuple):
    """The lamps whose rays are answered by beams.

    Attributes:
        known: (lights,) bool, which lights are such lamps.
        places, radii: (lights, 3) and (lights,) float32, the ball in which a lamp's samples lie.
        samples: (lights,) int32, how many.
        within: (6,) float32, a box outside of which nothing is known of where rays end.
        unknown: (6,) float32, a box around objects of which nothing can be proved; its lower corner is far above the
            upper one if there are none.
        ray_cost: nanoseconds that tracing a ray takes, about; 0 where a few are traced to find out.
        occluders: everything else, moving or not.
        any_hit, data: the query of the structure (`tracer.geometry.queries`).
    """

    known: Bytes
    places: F32x2D
    radii: F32
    samples: I32
    within: F32
    unknown: F32
    ray_cost: int
    occluders: Occluders
    any_hit: int
    data: int


class CertificateView(NamedTuple):
    """All certificates, as kernels that are called by address read them.

    Attributes:
        words, child, receivers, rooted, lists, names: of all cells (`tracer.neighbours.certified.cells.Cells`).
        stationary: (lights,) bool, which lights are certified.
        occluders: all that is static.
        lamps: lights that are lamps.
        highest: how high above a cell a ray may end, in units of the scene.
        max_asked, first_asking: candidates that a ray tests at most, and from which bounce on (`CostModel`).
        costly_rays: whether rays cost so much that every look-up pays (`CostModel`).
        stride, first_vector: one in `stride` vectors of points makes requests, from that one on.
        requests: a row for each tile, or without rows where none are made.
        cell: (pixels,) int32, gets the cell at each primary hit; empty where nobody wants to know.
    """

    words: Words
    child: I32
    receivers: F32x2D
    rooted: I32
    lists: I32x2D
    names: I32
    stationary: Bytes
    occluders: Occluders
    lamps: LampsView
    highest: float
    max_asked: int
    first_asking: int
    costly_rays: bool
    stride: int
    first_vector: int
    requests: Requests
    cell: I32


view_at = reading(CertificateView)

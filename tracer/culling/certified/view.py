"""What the kernels that shade are given of certificates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.cells import (
    Cells,
    make_cells,
)
from tracer.culling.certified.light_space import LIGHT_ROW
from tracer.culling.certified.requests import Requests, no_requests


class CertificateView(NamedTuple):
    """What a tile is given of certificates, and where its requests go.

    Attributes:
        cells: all cells.
        light_space: (lights, n, LIGHT_ROW) float32, rows of the primitives that certificates name.
        stationary: (lights,) bool, which lights are certified.
        highest: how high above a cell a ray may end, in units of the scene.
        max_asked: candidates that a ray tests at most (`CostModel`).
        costly_rays: whether rays cost so much that every look-up pays (`CostModel`).
        stride, first_vector: one in `stride` vectors of points makes requests, from that one on.
        requests: of this tile.
    """

    cells: Cells
    light_space: NDArray[np.float32]
    stationary: NDArray[np.bool_]
    highest: float
    max_asked: int
    costly_rays: bool
    stride: int
    first_vector: int
    requests: Requests


def empty_view(lights: int) -> CertificateView:
    """What tiles are given where nothing is certified."""
    light_space, stationary = np.empty((0, 0, LIGHT_ROW), np.float32), np.empty(0, np.bool_)
    return CertificateView(make_cells(1, lights, 1), light_space, stationary, 0.0, 0, False, 1, 0, no_requests())

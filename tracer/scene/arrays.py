"""Types of the arrays that scenes are made of, and what is said while large ones are worked on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Float32 = NDArray[np.float32]
Float64 = NDArray[np.float64]
Int32 = NDArray[np.int32]
Vector = tuple[float, float, float]

Report = Callable[[float], None]
"""Is given the part that is done, again and again, and may raise Cancelled."""

BLOCK = 1 << 18
"""Triangles that are worked on at once."""


def vector(values: ArrayLike) -> Vector:
    """Three numbers of an array (3,), as Python's own."""
    x, y, z = np.asarray(values, np.float64).tolist()
    return x, y, z

"""Surface attributes: what shading reads of a primitive, in a row of 64 bytes, the size of a cache line.

Rows of quadrics hold no normals, since those depend on the point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Columns: the normals of three corners; the triangle's own normal, of any length; and, as the bits of int32, the
# numbers of its object, its material and its texture (-1 for none).
CORNER_NORMALS, FACE_NORMAL, OBJECT, MATERIAL, TEXTURE = 0, 9, 12, 13, 14
COLUMNS = 16


def edge_products(triangles: NDArray[np.float32]) -> NDArray[np.float32]:
    """Cross products (t, 3) float32 of the two edges of triangles (t, 9), corner and edges: normals of any length."""
    a, b = triangles[:, 3:6].T, triangles[:, 6:9].T
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], axis=1)

"""Surface attributes: what shading reads of a primitive, in a row of 64 bytes, the size of a cache line.

Rows of quadrics hold no normals, since those depend on the point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import aligned_rows
from tracer.scene.model import Scene

# Columns: the normals of three corners; the triangle's own normal, of any length; and, as the bits of int32, the
# numbers of its object, its material and its texture (-1 for none).
CORNER_NORMALS, FACE_NORMAL, OBJECT, MATERIAL, TEXTURE = 0, 9, 12, 13, 14
COLUMNS = 16


def edge_products(triangles: NDArray[np.float32]) -> NDArray[np.float32]:
    """Cross products (t, 3) float32 of the two edges of triangles (t, 9), corner and edges: normals of any length."""
    a, b = triangles[:, 3:6].T, triangles[:, 6:9].T
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], axis=1)


def attribute_rows(scene: Scene, triangles: NDArray[np.float32], object_of: NDArray[np.int32]) -> NDArray[np.float32]:
    """Rows (p, 16) of all primitives, triangles (t, 9) first; object_of (p,)."""
    count, objects = len(triangles), scene.objects
    rows = aligned_rows(len(object_of), COLUMNS)
    rows[:] = 0
    rows[:count, CORNER_NORMALS:FACE_NORMAL] = np.concatenate([o.triangles.normals for o in objects]).reshape(-1, 9)
    rows[:count, FACE_NORMAL:OBJECT] = edge_products(triangles)
    numbers = rows.view(np.int32)
    numbers[:, OBJECT] = object_of
    numbers[:, MATERIAL] = np.concatenate(
        [o.triangles.material for o in objects] + [o.quadrics.material for o in objects]
    )
    numbers[:, TEXTURE] = -1
    numbers[:count, TEXTURE] = np.concatenate([o.triangles.texture for o in objects])
    return rows

"""Triangle strips of PLY files, as Stanford's scans have them (`element tristrips`); trimesh reads them as points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def triangles_of_strips(strip: NDArray[np.int64]) -> NDArray[np.int64]:
    """(n, 3) the triangles of a row of strips that end with -1.

    Every vertex from a strip's third on makes a triangle with the two before it. Every other one is turned around, so
    that all are counter-clockwise from the same side. Those that name a vertex twice only lead on, and are left out."""
    if len(strip) < 3:
        return np.empty((0, 3), np.int64)
    a, b, c = strip[:-2], strip[1:-1], strip[2:]
    places = np.arange(len(strip))
    begins = np.maximum.accumulate(np.where(strip < 0, places + 1, 0))  # where the strip of each vertex begins
    odd = (places - begins)[:-2] % 2 == 1
    whole = (a >= 0) & (b >= 0) & (c >= 0) & (a != b) & (b != c) & (a != c)
    return np.stack([np.where(odd, b, a), np.where(odd, a, b), c], axis=1)[whole]


def with_strips(model: Any) -> Any:
    """A trimesh scene in which what has triangle strips, and no faces, is a mesh."""
    import trimesh

    for name, points in list(model.geometry.items()):
        strips = (getattr(points, "metadata", None) or {}).get("_ply_raw", {}).get("tristrips")
        if strips is None or hasattr(points, "faces"):
            continue
        faces = np.concatenate([np.empty((0, 3), np.int64), *map(triangles_of_strips, _lists(strips["data"]))])
        colours = getattr(points, "colors", None)
        mesh = trimesh.Trimesh(
            points.vertices,
            faces,
            process=False,
            vertex_colors=colours if colours is not None and len(colours) else None,
            metadata=points.metadata,
        )
        model.geometry[name] = mesh
    return model


def _lists(data: Any) -> list[NDArray[np.int64]]:
    """The lists of indices, as trimesh keeps them: of text a dictionary, of binary numbers a structured array."""
    if isinstance(data, dict):
        rows = next(iter(data.values()))
    else:
        rows = data[data.dtype.names[0]]["f1"]
    return [np.asarray(row).reshape(-1).astype(np.int64) for row in rows]

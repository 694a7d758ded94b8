"""Triangle strips of PLY files, as Stanford's scans have them (`element tristrips`); trimesh reads them as points."""

from __future__ import annotations

from collections.abc import Iterable
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
        data = (getattr(points, "metadata", None) or {}).get("_ply_raw", {}).get("tristrips", {}).get("data")
        if data is None or hasattr(points, "faces"):
            continue
        colours = getattr(points, "colors", None)
        mesh = trimesh.Trimesh(
            points.vertices,
            triangles_of_strips(joined(_lists(data), len(points.vertices))),
            process=False,
            vertex_colors=colours if colours is not None and len(colours) else None,
            metadata=points.metadata,
        )
        model.geometry[name] = mesh
    return model


def _lists(data: Any) -> Iterable[NDArray[Any]]:
    """The lists of indices, as trimesh keeps them: of text a dictionary, of binary numbers a structured array."""
    rows = next(iter(data.values())) if isinstance(data, dict) else data[data.dtype.names[0]]["f1"]
    return (np.asarray(row).reshape(-1) for row in rows)


def joined(lists: Iterable[NDArray[Any]], vertices: int) -> NDArray[np.int64]:
    """Lists of indices as one, with -1 after each; so many vertices there are.

    The highest unsigned number is the -1 of whoever wrote it, unless there is a vertex of that number."""
    given = list(lists)
    if not given:
        return np.empty(0, np.int64)
    end = np.array([-1])
    strip = np.concatenate([row for one in given for row in (one, end)], dtype=np.int64, casting="unsafe")
    if given[0].dtype.kind == "u" and (highest := np.iinfo(given[0].dtype).max) >= vertices:
        strip[strip == highest] = -1
    return strip

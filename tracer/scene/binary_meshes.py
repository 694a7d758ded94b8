"""Binary STL and plain binary PLY files, read a part at a time: millions of triangles in the memory that they need.

STL repeats its corners for every triangle; each place is kept once.  What a PLY file has besides triangles, normals and
numbers that nobody asks for, as colours, places of textures, polygons and strips, is left to trimesh, which holds the
whole file several times.
"""

from __future__ import annotations

import os
import struct
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from tracer.scene.arrays import Float32, Float64, Int32, Report
from tracer.scene.distinct_points import DistinctPoints
from tracer.scene.files import open_regular
from tracer.scene.limits import MOST_PRIMITIVES
from tracer.scene.model import SceneError
from tracer.scene.ply import CORNERS, LONGEST_HEAD, Element, read_head

ROWS = 1 << 18
"""Triangles, or vertices, that are read at once."""

HEAD = 1024
"""Bytes of a file by which others may tell who wrote it."""

_STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
_FOR_TRIMESH = {"red", "green", "blue", "texture_u", "texture_v", "u", "v", "s", "t"}


@dataclass(frozen=True)
class BinaryMesh:
    """A mesh: vertices (k, 3), faces (n, 3), normals (k, 3) or None, and how the file begins; `place` (k,) numbers the
    places of vertices where they are known to differ."""

    vertices: Float32 | Float64
    faces: Int32
    normals: Float32 | Float64 | None
    head: bytes
    place: Int32 | None = None


def read_binary(path: Path, report: Report) -> BinaryMesh | None:
    """The mesh in a file; None for files of other kinds, which trimesh reads.

    `report` is given the part that is read, again and again, and may raise Cancelled.  Raises SceneError in one line
    for a file that is damaged, and OSError."""
    read = {".stl": _read_stl, ".ply": _read_ply}.get(path.suffix.lower())
    if read is None:
        return None
    try:
        with open_regular(path) as file, np.errstate(all="ignore"):
            return read(path, file, report)
    except ValueError:
        what = f"cannot be read as {path.suffix[1:].upper()}: it is damaged or incomplete"
        raise SceneError(f"{path}: {what}; repair or convert the file") from None


def is_plain(path: Path) -> bool:
    """Whether a file is one that is read so, as far as its head and its first face tell; raises OSError."""
    with open_regular(path) as file, suppress(ValueError):
        if path.suffix.lower() == ".stl":
            return bool(_stl_count(file))
        layout = _ply_layout(file.read(LONGEST_HEAD)) if path.suffix.lower() == ".ply" else None
        if layout is not None:
            file.seek(layout.begin + layout.vertices * layout.vertex.itemsize)
            return layout.all_triangles(_rows(file, layout.face, 1))
    return False


def _stl_count(file: BinaryIO) -> int:
    """How many triangles a binary STL file has; 0 for a text, and where it is damaged."""
    head = file.read(84)
    (count,) = struct.unpack("<I", head[80:]) if len(head) == 84 else (0,)
    return count if os.fstat(file.fileno()).st_size == 84 + _STL.itemsize * count else 0


def _read_stl(path: Path, file: BinaryIO, report: Report) -> BinaryMesh | None:
    count = _stl_count(file)
    if not count:
        return None
    _check_number(count, path)
    file.seek(0)
    head = file.read(HEAD)
    file.seek(84)
    places, faces = DistinctPoints(count // 2), np.empty((count, 3), np.int32)
    for start in range(0, count, ROWS):
        report(start / count)
        rows = _rows(file, _STL, min(ROWS, count - start))
        faces[start : start + len(rows)] = places.numbered(rows["corners"].reshape(-1, 3)).reshape(-1, 3)
    return BinaryMesh(places.points(), faces, None, head, np.arange(len(places), dtype=np.int32))


@dataclass(frozen=True)
class _PlyLayout:
    """Where everything is in a PLY file: vertices from `begin` on, then faces; and in which precision."""

    begin: int
    vertices: int
    faces: int
    vertex: np.dtype[Any]
    face: np.dtype[Any]
    coordinates: type
    normals: bool

    def all_triangles(self, rows: Any) -> bool:
        counts = [name for name in self.face.names or () if name.startswith("count")]
        return all(bool((rows[name] == 3).all()) for name in counts)


def _ply_layout(head: bytes) -> _PlyLayout | None:
    """What the head of a PLY file says; None where it has more than plain triangles.  Raises ValueError."""
    found = read_head(head, most=1 << 62)
    if found is None or any("TextureFile" in line for line in found.others):
        return None
    if [one.name for one in found.elements[:2]] != ["vertex", "face"]:
        return None
    vertex, face = found.elements[:2]
    row, coordinates, normals = _vertex_row(vertex)
    triangle = _triangle_row(face)
    if row is None or triangle is None or not vertex.number or not face.number:
        return None
    return _PlyLayout(found.begin, vertex.number, face.number, row, triangle, coordinates, normals)


def _read_ply(path: Path, file: BinaryIO, report: Report) -> BinaryMesh | None:
    head = file.read(LONGEST_HEAD)
    layout = _ply_layout(head)
    if layout is None:
        return None
    _check_number(layout.faces, path)
    _check_number(layout.vertices, path, "vertices")
    file.seek(layout.begin)
    everything = layout.vertices + layout.faces
    vertices: Float32 | Float64 = np.empty((layout.vertices, 3), layout.coordinates)
    normals = np.empty((layout.vertices, 3), np.float32) if layout.normals else None
    for start in range(0, layout.vertices, ROWS):
        report(start / everything)
        rows = _rows(file, layout.vertex, min(ROWS, layout.vertices - start))
        for axis, (name, of_normal) in enumerate(zip("xyz", ("nx", "ny", "nz"))):
            vertices[start : start + len(rows), axis] = rows[name]
            if normals is not None:
                normals[start : start + len(rows), axis] = rows[of_normal]
    faces = np.empty((layout.faces, 3), np.int32)
    for start in range(0, layout.faces, ROWS):
        report((layout.vertices + start) / everything)
        rows = _rows(file, layout.face, min(ROWS, layout.faces - start))
        if not layout.all_triangles(rows):
            return None  # polygons
        corners = rows["corners"]
        if corners.min() < 0 or corners.max() >= layout.vertices:
            raise SceneError(f"{path}: a triangle refers to a vertex that is not there; repair the file")
        faces[start : start + len(rows)] = corners
    return BinaryMesh(vertices, faces, normals, head[:HEAD])


def _check_number(count: int, path: Path, of: str = "triangles") -> None:
    if count > MOST_PRIMITIVES:
        raise SceneError(f"{path}: more than {MOST_PRIMITIVES} {of}; make it simpler")


def _rows(file: BinaryIO, kind: np.dtype[Any], count: int) -> Any:
    """The next rows of a file; raises ValueError where it ends before them.

    They are read, not mapped: a file that another program cuts short meanwhile must not end this one."""
    data = file.read(count * kind.itemsize)
    if len(data) != count * kind.itemsize:
        raise ValueError("it ends too soon")
    return np.frombuffer(data, kind)


def _vertex_row(vertex: Element) -> tuple[np.dtype[Any] | None, type, bool]:
    """How a vertex lies in the file, None where it has what trimesh reads; in which precision; whether with normals."""
    kinds = {one.name: one.kind for one in vertex.properties}
    plain = not vertex.has_lists and len(kinds) == len(vertex.properties) and not _FOR_TRIMESH & set(kinds)
    if not plain or not {"x", "y", "z"} <= set(kinds):
        return None, np.float32, False
    single = all(kinds[axis].str[1:] == "f4" for axis in "xyz")
    row = np.dtype([(one.name, one.kind) for one in vertex.properties])
    return row, np.float32 if single else np.float64, {"nx", "ny", "nz"} <= set(kinds)


def _triangle_row(face: Element) -> np.dtype[Any] | None:
    """How a triangle lies in the file; None where trimesh is to read faces."""
    fields: list[tuple[Any, ...]] = []
    for number, one in enumerate(face.properties):
        if one.count is None:
            if one.name in _FOR_TRIMESH:
                return None
            fields.append((f"other {number}", one.kind))
        elif one.name in CORNERS and one.kind.kind in "iu" and not any(field[0] == "corners" for field in fields):
            fields += [(f"count {number}", one.count), ("corners", one.kind, 3)]
        else:
            return None
    return np.dtype(fields) if any(field[0] == "corners" for field in fields) else None

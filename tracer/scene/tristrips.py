"""Triangle strips of PLY files, as Stanford's scans have them (`element tristrips`); trimesh reads them as points."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.scene.limits import MOST_PRIMITIVES


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
            triangles_of_strips(_joined(_lists(data), len(points.vertices))),
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


def _joined(lists: Iterable[NDArray[Any]], vertices: int) -> NDArray[np.int64]:
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


# --- lists of different lengths -----------------------------------------------------------------------

_LONGEST_HEAD = 1 << 16  # bytes
_KINDS = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip


@dataclass
class _Element:
    """What the head says of an element: in which line it begins, how many there are, and the words of each property."""

    line: int
    number: int
    properties: list[list[str]] = field(default_factory=list)

    @property
    def has_lists(self) -> bool:
        return any(words[1] == "list" for words in self.properties)


def one_strip(data: bytes) -> bytes:
    """A binary PLY file whose strips are several lists, with one list of all, as trimesh reads lists of one length.

    Any other file comes back as it is, also one with other lists before its strips.  Raises ValueError where the file
    ends too soon, or its head is damaged."""
    begin = data.find(b"\n", data.find(b"end_header", 0, _LONGEST_HEAD)) + 1
    lines = data[:begin].decode("latin-1").splitlines()
    if not lines or lines[0].strip() != "ply" or "format binary" not in lines[1] or "end_header" not in lines[-1]:
        return data
    order, elements = ">" if "big" in lines[1] else "<", _elements(lines)
    strips = elements.pop("tristrips", None)
    before = [one for one in elements.values() if strips is not None and one.line < strips.line]
    if strips is None or strips.number < 2 or any(one.has_lists for one in before):
        return data
    if len(strips.properties) != 1 or not strips.has_lists:
        return data
    start = begin + sum(one.number * sum(_kind(words[1], order).itemsize for words in one.properties) for one in before)
    _, _, count, index, name = strips.properties[0]
    rows, end = _rows(data, start, strips.number, _kind(count, order), _kind(index, order))
    vertices = elements["vertex"].number if "vertex" in elements else 0
    strip = np.minimum(_joined(rows, vertices), 2**31 - 1)
    lines[strips.line : strips.line + 2] = ["element tristrips 1", f"property list int int {name}"]
    head = "".join(f"{line}\n" for line in lines).encode("latin-1")
    one = np.concatenate([[len(strip)], strip]).astype(f"{order}i4")
    return b"".join([head, data[begin:start], one.tobytes(), data[end:]])


def _elements(lines: list[str]) -> dict[str, _Element]:
    elements: dict[str, _Element] = {}
    last = _Element(0, 0)
    for i, words in enumerate(line.split() for line in lines):
        if words[:1] == ["element"]:
            _, name, number = words
            last = elements[name] = _Element(i, int(number))
        elif words[:1] == ["property"]:
            last.properties.append(words)
    return elements


def _kind(name: str, order: str) -> np.dtype[Any]:
    if name not in _KINDS:
        raise ValueError(name)
    return np.dtype(order + _KINDS[name])


def _rows(
    data: bytes, at: int, number: int, count: np.dtype[Any], index: np.dtype[Any]
) -> tuple[list[NDArray[Any]], int]:
    """So many lists that begin at some byte, each after how many it holds; and the byte after them."""
    if count.kind == "f" or index.kind == "f" or number > MOST_PRIMITIVES:
        raise ValueError(number)
    rows = []
    for _ in range(number):
        (length,) = np.frombuffer(data, count, 1, at).tolist()
        if length < 0:
            raise ValueError(length)
        rows.append(np.frombuffer(data, index, length, at + count.itemsize))
        at += count.itemsize + length * index.itemsize
    return rows, at

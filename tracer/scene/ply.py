"""The head of a binary PLY file, and its lists as trimesh reads them: it takes all lists of an element to be as long as
its first, and triangle strips (`element tristrips`, as Stanford's scans have them) for points.

Faces of different lengths become triangles, strips become one list and then triangles, and lists of anything else, such
as the grid of a range scan, are left out.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.scene.limits import MOST_PRIMITIVES

LONGEST_HEAD = 1 << 16  # bytes
KINDS = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
CORNERS = ("vertex_indices", "vertex_index")

Places = NDArray[np.int64]


@dataclass(frozen=True)
class Property:
    """A number, or a list of them after how many there are."""

    name: str
    said: str  # its kind, as the head says it
    kind: np.dtype[Any]
    count: np.dtype[Any] | None = None


@dataclass
class Element:
    """What the head says of an element."""

    name: str
    number: int
    properties: list[Property] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)

    @property
    def has_lists(self) -> bool:
        return any(one.count is not None for one in self.properties)


@dataclass
class Head:
    """What the head of a binary file says: where its body begins, the order of bytes, < or >, all elements, and the
    lines that are of none."""

    begin: int
    order: str
    elements: list[Element] = field(default_factory=list)
    others: list[str] = field(default_factory=list)


def with_even_lists(data: bytes) -> bytes:
    """A binary PLY file as trimesh reads it, with all faces and strips.

    Any other file comes back as it is, also one whose lists are even already.  Raises ValueError where the file ends
    too soon, or its head is damaged."""
    found = read_head(data)
    if found is None:
        return data
    begin, order, elements, others = found.begin, found.order, found.elements, found.others
    vertices = next((one.number for one in elements if one.name == "vertex"), 0)
    if not any(one.has_lists for one in elements) or any(one.has_lists for one in elements if one.name == "vertex"):
        return data
    head, body, at, changed = others, [], begin, False
    for element in elements:
        end = _end_of_even(data, at, element)
        own, kept = element.lines, data[at:end]
        if element.has_lists and not (element.name == "face" and end is not None):
            starts, lengths, end = _places(data, at, element, order)
            kept = data[at:end]
            if element.name == "face":
                own, kept = _triangles(data, element, starts, lengths)
            elif element.name == "tristrips" and len(element.properties) == 1:
                own, kept = _one_strip(data, element, starts, lengths, vertices, order)
            else:
                own, kept = [], b""
            changed = True
        elif end is None:
            raise ValueError(element.name)
        head, at = [*head, *own], end
        body.append(kept)
    if not changed:
        return data
    return b"".join(["".join(f"{line}\n" for line in [*head, "end_header"]).encode("latin-1"), *body, data[at:]])


def read_head(data: bytes, most: int = MOST_PRIMITIVES) -> Head | None:
    """What the head of a binary PLY file says, None for any other file; raises ValueError where it is damaged, or names
    more than `most` of an element."""
    begin = data.find(b"\n", data.find(b"end_header", 0, LONGEST_HEAD)) + 1
    lines = data[:begin].decode("latin-1").splitlines()
    if len(lines) < 3 or lines[0].strip() != "ply" or "format binary" not in lines[1] or "end_header" not in lines[-1]:
        return None
    found = Head(begin, ">" if "big" in lines[1] else "<")
    for line in lines[:-1]:
        words = line.split()
        if words[:1] == ["element"]:
            _, name, number = words
            if not 0 <= int(number) <= most:
                raise ValueError(line)
            found.elements.append(Element(name, int(number), lines=[line]))
        elif words[:1] == ["property"]:
            if not found.elements:
                raise ValueError(f"{line}: of no element")
            found.elements[-1].properties.append(_property(words, found.order))
            found.elements[-1].lines.append(line)
        else:
            found.others.append(line)
    return found


def _property(words: list[str], order: str) -> Property:
    match words[1:]:
        case [said, name] if said in KINDS:
            return Property(name, said, np.dtype(order + KINDS[said]))
        case ["list", count, said, name] if said in KINDS and KINDS.get(count, "f")[0] != "f":
            return Property(name, said, np.dtype(order + KINDS[said]), np.dtype(order + KINDS[count]))
    raise ValueError(f"{' '.join(words)}: no such property")


# --- where everything is ------------------------------------------------------------------------------


def _end_of_even(data: bytes, at: int, element: Element) -> int | None:
    """The byte after an element whose lists are all as long as those of its first row; None where they are not."""
    fields: list[tuple[str, Any]] = []
    lengths = {}
    start = at
    for number, one in enumerate(element.properties if element.number else []):
        length = 1
        if one.count is not None:
            (length,) = np.frombuffer(data, one.count, 1, start).tolist()
            lengths[f"count {number}"] = length
            fields.append((f"count {number}", one.count))
            start += one.count.itemsize
        if length < 0 or length * one.kind.itemsize > len(data) - start:
            return None
        fields.append((f"{number}", (one.kind, (length,))))
        start += length * one.kind.itemsize
    end = at + element.number * (start - at)
    if end > len(data):
        return None
    rows = np.frombuffer(data, np.dtype(fields), element.number, at) if fields else None
    even = rows is None or all((rows[name] == length).all() for name, length in lengths.items())
    return end if even else None


def _places(data: bytes, at: int, element: Element, order: str) -> tuple[Places, Places, int]:
    """(rows, properties) where the numbers of each begin and how many they are, and the byte after the element."""
    byteorder: Any = "big" if order == ">" else "little"
    sizes = [
        (
            one.kind.itemsize,
            one.count.itemsize if one.count is not None else 0,
            one.count is not None and one.count.kind == "i",
        )
        for one in element.properties
    ]
    starts: list[int] = []
    lengths: list[int] = []
    for _ in range(element.number):
        for size, counted, signed in sizes:
            length = int.from_bytes(data[at : at + counted], byteorder, signed=signed) if counted else 1
            at += counted
            starts.append(at)
            lengths.append(length)
            at += length * size
            if length < 0 or at > len(data):
                raise ValueError(element.name)
    shape = element.number, len(sizes)
    return np.array(starts, np.int64).reshape(shape), np.array(lengths, np.int64).reshape(shape), at


def _numbers(data: bytes, places: Places, kind: np.dtype[Any]) -> NDArray[Any]:
    """The numbers that begin at these bytes."""
    single = np.frombuffer(data, np.uint8)[places[..., None] + np.arange(kind.itemsize)]
    return np.ascontiguousarray(single).view(kind)[..., 0]


# --- what becomes of them -------------------------------------------------------------------------------


def _triangles(data: bytes, element: Element, starts: Places, lengths: Places) -> tuple[list[str], bytes]:
    """Faces as triangles around their first corner, each with all else that its face has: head and bytes."""
    corners = next(n for n, one in enumerate(element.properties) if one.count is not None and one.name in CORNERS)
    sides = lengths[:, corners]
    number = np.maximum(sides - 2, 0)
    face = np.repeat(np.arange(len(sides)), number)
    place = np.arange(len(face)) - np.repeat(np.cumsum(number) - number, number)
    corner = np.stack([np.zeros_like(place), place + 1, place + 2], axis=1)  # of its face
    lines, columns = [f"element face {len(face)}"], []
    for n, one in enumerate(element.properties):
        size = one.kind.itemsize
        if one.count is None:
            lines.append(f"property {one.said} {one.name}")
            columns.append(_numbers(data, starts[face, n], one.kind)[:, None])
            continue
        each = 1 if n == corners else 2  # numbers for each corner: its vertex, or a place of the texture
        if not (lengths[:, n] == each * sides).all():
            continue
        parts = (each * corner[:, :, None] + np.arange(each)).reshape(len(face), -1)
        lines.append(f"property list uchar {one.said} {one.name}")
        columns += [np.full((len(face), 1), parts.shape[1], np.uint8)]
        columns += [_numbers(data, starts[face, n][:, None] + size * parts, one.kind)]
    rows = np.zeros(len(face), np.dtype([(str(n), (one.dtype, one.shape[1:])) for n, one in enumerate(columns)]))
    for n, column in enumerate(columns):
        rows[str(n)] = column
    return lines, rows.tobytes()


def _one_strip(
    data: bytes, element: Element, starts: Places, lengths: Places, vertices: int, order: str
) -> tuple[list[str], bytes]:
    """All strips as a single list: head and bytes."""
    (strips,), size = element.properties, element.properties[0].kind.itemsize
    if strips.count is None or strips.kind.kind == "f":
        raise ValueError(strips.name)
    number = lengths[:, 0]
    place = np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
    flat = _numbers(data, np.repeat(starts[:, 0], number) + size * place, strips.kind)
    strip = np.minimum(joined(np.split(flat, np.cumsum(number)[:-1]), vertices), 2**31 - 1)
    lines = ["element tristrips 1", f"property list int int {strips.name}"]
    return lines, np.concatenate([[len(strip)], strip]).astype(f"{order}i4").tobytes()


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

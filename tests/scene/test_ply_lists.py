"""Binary PLY files whose lists have different lengths."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tracer.scene.load import load_scene
from tracer.scene.model import SceneError
from tracer.scene.ply import with_even_lists

CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (0.0, 2.0, 1.0)]
STRIPS = ("tristrips", [[0, 1, 2, 3], [2, 3, 4]])
GRID = ("range_grid", [[0], [], [4, 1]])
EVEN = ("face", [[0, 1, 2], [1, 3, 2]])
MIXED = ("face", [[0, 1, 2], [0, 1], [0, 1, 3, 2], [2, 3, 4]])
OF_STRIPS, OF_EVEN = [(0, 1, 2), (2, 1, 3), (2, 3, 4)], [(0, 1, 2), (1, 3, 2)]
OF_MIXED = [(0, 1, 2), (0, 1, 3), (0, 3, 2), (2, 3, 4)]


def written(path: Path, order: str, *elements: tuple[str, list[list[int]]]) -> Path:
    head = f"ply\nformat binary_{'big' if order == '>' else 'little'}_endian 1.0\ncomment lists\nelement vertex 5\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    body = b"".join(struct.pack(f"{order}3f", *corner) for corner in CORNERS)
    for name, rows in elements:
        head += f"element {name} {len(rows)}\nproperty list uchar int vertex_indices\n"
        body += b"".join(struct.pack(f"{order}B{len(row)}i", len(row), *row) for row in rows)
    path.write_bytes(head.encode() + b"end_header\n" + body)
    return path


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize(
    ("elements", "faces"),
    [
        ([MIXED], OF_MIXED),
        ([GRID, STRIPS], OF_STRIPS),
        ([GRID, EVEN], OF_EVEN),
        ([GRID, MIXED], OF_MIXED),
        ([EVEN, STRIPS], OF_EVEN),
        ([MIXED, STRIPS], OF_MIXED),
        ([STRIPS, MIXED], OF_MIXED),
        ([STRIPS, GRID], OF_STRIPS),
    ],
)
def test_faces_and_strips_are_found_among_lists_of_all_lengths(tmp_path, order, elements, faces):
    found = load_scene(written(tmp_path / "a.ply", order, *elements)).objects[0].triangles.corners
    assert found.tolist() == [[list(CORNERS[corner]) for corner in face] for face in faces]


def test_what_is_even_is_left_alone(tmp_path):
    for elements in ([EVEN], [], [("face", [])]):
        data = written(tmp_path / "a.ply", "<", *elements).read_bytes()
        assert with_even_lists(data) is data
    assert with_even_lists(b"ply\nformat ascii 1.0\nend_header\n") == b"ply\nformat ascii 1.0\nend_header\n"


def test_each_triangle_has_what_its_face_has(tmp_path):
    """A colour before the list, and places of a texture after it, as of the corners."""
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 5\n" + "".join(f"property float {a}\n" for a in "xyz")
    head += "element face 2\n" + "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))
    head += "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
    body = b"".join(struct.pack("<3f", *corner) for corner in CORNERS)
    for color, row in (((255, 0, 0), (0, 1, 3, 2)), ((0, 0, 255), (2, 3, 4))):
        places = [place for corner in row for place in (0.1 * corner, 0.2)]
        body += struct.pack(f"<3BB{len(row)}i", *color, len(row), *row)
        body += struct.pack(f"<B{len(places)}f", len(places), *places)
    even = with_even_lists(head.encode() + body)
    begin = even.index(b"end_header\n") + 11 + 60
    row = np.dtype([("color", "u1", 3), ("n", "u1"), ("face", "<i4", 3), ("m", "u1"), ("places", "<f4", 6)])
    rows = np.frombuffer(even, row, -1, begin)
    assert (
        rows["face"].tolist() == [[0, 1, 3], [0, 3, 2], [2, 3, 4]] and set(rows["n"]) == {3} and set(rows["m"]) == {6}
    )
    assert rows["color"].tolist() == [[255, 0, 0], [255, 0, 0], [0, 0, 255]]
    assert np.allclose(rows["places"][:, ::2], 0.1 * rows["face"]) and np.allclose(rows["places"][:, 1::2], 0.2)
    (tmp_path / "even.ply").write_bytes(even)
    assert len(trimesh.load(tmp_path / "even.ply", process=False).faces) == 3


@pytest.mark.parametrize("elements", [[MIXED], [GRID, STRIPS], [GRID]])
@pytest.mark.parametrize("cut", [1, 6, 11])
def test_what_ends_too_soon_is_one_line(tmp_path, elements, cut):
    path = written(tmp_path / "a.ply", "<", *elements)
    path.write_bytes(path.read_bytes()[:-cut])
    with pytest.raises(SceneError, match=r"a\.ply: cannot be read as PLY: it is damaged or incomplete"):
        load_scene(path)

"""PLY files: lists of different lengths, triangle strips, and heads that are damaged."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tracer.scene.load import load_scene
from tracer.scene.mesh_options import AS_IN_FILE, IN_STUDIO
from tracer.scene.model import SceneError
from tracer.scene.ply import triangles_of_strips, with_even_lists

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


@pytest.mark.parametrize(
    "line", ["property", "property list list int x", "property list int", "property float", "property list float int x"]
)
def test_a_property_that_is_none_is_one_line(tmp_path, line):
    path = written(tmp_path / "a.ply", "<", MIXED)
    path.write_bytes(path.read_bytes().replace(b"property float z", line.encode()))
    with pytest.raises(SceneError, match=r"a\.ply: cannot be read as PLY: it is damaged or incomplete"):
        load_scene(path)


HEIGHT, WIDTH = 5, 7


def grid():
    """Vertices (n, 3), and a row of strips as a file has it."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    vertices = np.stack([x, y, np.sin(x + 2 * y)], axis=-1).reshape(-1, 3).astype(np.float32)
    strips = []
    for row in range(HEIGHT - 1):
        for here in range(row * WIDTH, row * WIDTH + WIDTH):
            strips += [here + WIDTH, here]
        strips.append(-1)
    return vertices, strips


def strips_of(fmt, vertices, strips, color=False):
    names = ["float x", "float y", "float z", *(["uchar red", "uchar green", "uchar blue"] if color else [])]
    head = f"ply\nformat {fmt} 1.0\nelement vertex {len(vertices)}\n" + "".join(f"property {n}\n" for n in names)
    head += "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    if fmt == "ascii":
        rows = [" ".join(f"{x:g}" for x in v) + (" 255 0 0" if color else "") for v in vertices.tolist()]
        return (head + "\n".join(rows) + f"\n{len(strips)} " + " ".join(map(str, strips)) + "\n").encode()
    order = "<" if "little" in fmt else ">"
    body = b"".join(struct.pack(f"{order}3f", *v) + (b"\xff\0\0" if color else b"") for v in vertices.tolist())
    return head.encode() + body + struct.pack(f"{order}{1 + len(strips)}i", len(strips), *strips)


def test_colours_of_strips_are_kept(tmp_path):
    vertices, strips = grid()
    (tmp_path / "a.ply").write_bytes(strips_of("binary_little_endian", vertices, strips, color=True))
    scene = load_scene(tmp_path / "a.ply")
    assert [material.diffuse for material in scene.materials] == [(1, 0, 0)]
    assert scene.triangle_count == 2 * (HEIGHT - 1) * (WIDTH - 1)
    assert (scene.objects[0].triangles.normals[:, 0, 2] > 0).all()


def test_strips_that_lead_on_or_end_at_once():
    # Where a vertex is named twice there is no triangle, but the turns go on.
    assert triangles_of_strips(np.array([0, 1, 2, 2, 3, 4])).tolist() == [[0, 1, 2], [3, 2, 4]]
    assert triangles_of_strips(np.array([0, 1, -1, 2, 3, 4, 5, -1, -1, 6])).tolist() == [[2, 3, 4], [4, 3, 5]]
    assert triangles_of_strips(np.array([1, 2])).shape == (0, 3)


def test_a_strip_that_names_no_vertex_is_one_line(tmp_path):
    vertices, _ = grid()
    (tmp_path / "a.ply").write_bytes(strips_of("ascii", vertices, [0, 1, 999]))
    with pytest.raises(Exception, match="refers to a vertex that is not there") as error:
        load_scene(tmp_path / "a.ply")
    assert "\n" not in str(error.value)


# --- as other programs write them -----------------------------------------------------------------------

FACES = [(0, 1, 2), (2, 1, 3), (2, 3, 4)]
"""Of the strips 0 1 2 3 and 2 3 4."""


def lists(path, fmt, kind, strips, after="", tail=b"", vertices=CORNERS):
    """Write a PLY file with a list for each strip, and what stands after them."""
    head = f"ply\nformat {fmt} 1.0\ncomment strips\nelement vertex {len(vertices)}\n"
    head += "property float x\nproperty float y\nproperty float z\n"
    head += f"element tristrips {len(strips)}\nproperty list uchar {kind} vertex_indices\n{after}end_header\n"
    if fmt == "ascii":
        rows = [" ".join(map(str, row)) for row in (*vertices, *([len(s), *s] for s in strips))]
        path.write_text(head + "\n".join(rows) + "\n")
        return path
    order, code = "<" if "little" in fmt else ">", {"int": "i", "uint": "I", "ushort": "H", "char": "b"}[kind]
    body = b"".join(struct.pack(f"{order}3f", *v) for v in vertices)
    body += b"".join(struct.pack(f"{order}B{len(s)}{code}", len(s), *s) for s in strips)
    path.write_bytes(head.encode() + body + tail)
    return path


def corners_of(path):
    return load_scene(path).objects[0].triangles.corners.tolist()


@pytest.mark.parametrize("fmt", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize(("kind", "end"), [("int", -1), ("uint", 2**32 - 1), ("ushort", 2**16 - 1), ("char", -1)])
@pytest.mark.parametrize("strips", [[[0, 1, 2, 3, None, 2, 3, 4, None]], [[0, 1, 2, 3], [], [2, 3, 4, None]]])
def test_strips_may_be_several_and_end_with_the_highest_number(tmp_path, fmt, kind, end, strips):
    strips = [[end if vertex is None else vertex for vertex in strip] for strip in strips]
    path = lists(tmp_path / "a.ply", fmt, kind, strips)
    assert corners_of(path) == [[list(CORNERS[vertex]) for vertex in face] for face in FACES]


def test_the_highest_number_may_be_a_vertex(tmp_path):
    many = [(float(k), 0.0, 0.0) for k in range(2**16 - 1)] + [(0.0, 1.0, 0.0)]
    path = lists(tmp_path / "a.ply", "binary_little_endian", "ushort", [[0, 1, 2**16 - 1], [1, 2]], vertices=many)
    assert corners_of(path) == [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]


def test_what_stands_after_strips_of_different_lengths_is_kept(tmp_path):
    after = "element face 1\nproperty list uchar int vertex_indices\n"
    tail = struct.pack("<B3i", 3, 0, 1, 4)
    path = lists(tmp_path / "a.ply", "binary_little_endian", "int", [[0, 1, 2, 3], [2, 3, 4]], after, tail)
    assert corners_of(path) == [[list(CORNERS[vertex]) for vertex in (0, 1, 4)]], "its faces are the mesh"


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize("strips", [[], [[]], [[0, 1]], [[], []]])
def test_strips_without_a_triangle_are_one_line_that_names_the_file(tmp_path, kind, strips):
    path = lists(tmp_path / "a.ply", kind, "int", strips)
    for options in (AS_IN_FILE, IN_STUDIO):
        scene = load_scene(path, meshes=options)
        assert scene.warnings[0].startswith(f"{path}: ") and "has no triangles" in scene.warnings[0]

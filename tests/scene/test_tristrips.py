"""Triangle strips of PLY files."""

from __future__ import annotations

import struct

import numpy as np
import pytest
import trimesh

from tracer.scene.load import load_scene
from tracer.scene.tristrips import triangles_of_strips

HEIGHT, WIDTH = 5, 7


def grid():
    """Vertices (n, 3), a row of strips as a file has it, and the faces that it stands for."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    vertices = np.stack([x, y, np.sin(x + 2 * y)], axis=-1).reshape(-1, 3).astype(np.float32)
    strips, faces = [], []
    for row in range(HEIGHT - 1):
        for column in range(WIDTH):
            strips += [row * WIDTH + column + WIDTH, row * WIDTH + column]
            if column:
                here = row * WIDTH + column
                faces += [(here - 1 + WIDTH, here - 1, here + WIDTH), (here + WIDTH, here - 1, here)]
        strips.append(-1)
    return vertices, strips, np.array(faces)


def written(fmt, vertices, strips, color=False):
    names = ["float x", "float y", "float z", *(["uchar red", "uchar green", "uchar blue"] if color else [])]
    head = f"ply\nformat {fmt} 1.0\nelement vertex {len(vertices)}\n" + "".join(f"property {n}\n" for n in names)
    head += "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    if fmt == "ascii":
        rows = [" ".join(f"{x:g}" for x in v) + (" 255 0 0" if color else "") for v in vertices.tolist()]
        return (head + "\n".join(rows) + f"\n{len(strips)} " + " ".join(map(str, strips)) + "\n").encode()
    order = "<" if "little" in fmt else ">"
    body = b"".join(struct.pack(f"{order}3f", *v) + (b"\xff\0\0" if color else b"") for v in vertices.tolist())
    return head.encode() + body + struct.pack(f"{order}{1 + len(strips)}i", len(strips), *strips)


@pytest.mark.parametrize("fmt", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_strips_are_the_same_mesh_as_faces(tmp_path, fmt):
    vertices, strips, faces = grid()
    vertices = vertices.round(3)
    (tmp_path / "strips.ply").write_bytes(written(fmt, vertices, strips))
    trimesh.Trimesh(vertices, faces, process=False).export(tmp_path / "faces.ply")
    ours, theirs = (load_scene(tmp_path / name).objects[0].triangles for name in ("strips.ply", "faces.ply"))
    assert len(ours) == len(theirs) == 2 * (HEIGHT - 1) * (WIDTH - 1)

    def turned(corners):  # each with its least corner first
        first = np.argmin(corners[..., 0] + 100 * corners[..., 1], axis=1)
        return np.stack([np.roll(c, -f, axis=0) for c, f in zip(corners, first, strict=True)])

    assert turned(ours.corners) == pytest.approx(turned(theirs.corners))
    assert (ours.normals[:, 0, 2] > 0).all()


def test_colours_of_strips_are_kept(tmp_path):
    vertices, strips, _ = grid()
    (tmp_path / "a.ply").write_bytes(written("binary_little_endian", vertices, strips, color=True))
    (material,) = load_scene(tmp_path / "a.ply").materials
    assert material.diffuse == (1, 0, 0)


def test_strips_that_lead_on_or_end_at_once():
    # Where a vertex is named twice there is no triangle, but the turns go on.
    assert triangles_of_strips(np.array([0, 1, 2, 2, 3, 4])).tolist() == [[0, 1, 2], [3, 2, 4]]
    assert triangles_of_strips(np.array([0, 1, -1, 2, 3, 4, 5, -1, -1, 6])).tolist() == [[2, 3, 4], [4, 3, 5]]
    assert triangles_of_strips(np.array([1, 2])).shape == (0, 3)


def test_a_strip_that_names_no_vertex_is_one_line(tmp_path):
    vertices, _, _ = grid()
    (tmp_path / "a.ply").write_bytes(written("ascii", vertices, [0, 1, 999]))
    with pytest.raises(Exception, match="refers to a vertex that is not there") as error:
        load_scene(tmp_path / "a.ply")
    assert "\n" not in str(error.value)

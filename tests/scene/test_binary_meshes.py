"""Binary STL and PLY files that are read a part at a time: the same scenes as trimesh reads, in less memory."""

from __future__ import annotations

import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tests.bench.large_scenes import write_ply, write_stl
from tests.bench.meshes import frequency_for
from tracer.scene import assembly, binary_meshes, crease, files, memory_check, meshes, pieces
from tracer.scene.binary_meshes import is_plain, read_binary
from tracer.scene.distinct_points import DistinctPoints
from tracer.scene.load import load_scene
from tracer.scene.mesh_options import AS_IN_FILE, IN_STUDIO
from tracer.scene.model import Cancelled, Scene, SceneError

AXES = ("x", "y", "z")
NORMALS = ("nx", "ny", "nz")


def ply(
    path: Path, order: str = "<", kind: str = "f4", normals: bool = False, faces=None, vertex=(), face=(), head=""
) -> Path:
    """A ball; `vertex` and `face` name further columns of bytes, the latter before the corners."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.vertices += 0.3
    columns = [(axis, kind) for axis in AXES] + [(axis, "f4") for axis in NORMALS if normals]
    rows = np.zeros(len(ball.vertices), [(name, order + as_) for name, as_ in columns] + [(n, "u1") for n in vertex])
    for axis in range(3):
        rows[AXES[axis]] = ball.vertices[:, axis]
        if normals:
            rows[NORMALS[axis]] = ball.vertex_normals[:, axis]
    faces = ball.faces if faces is None else np.asarray(faces)
    size = faces.shape[1]
    corners = np.zeros(len(faces), [*((name, "u1") for name in face), ("n", "u1"), ("corners", order + "u4", size)])
    corners["n"], corners["corners"] = size, faces
    said = {"f4": "float", "f8": "double"}
    lines = ["ply", f"format binary_{'big' if order == '>' else 'little'}_endian 1.0", *filter(None, [head])]
    lines += [f"element vertex {len(rows)}", *(f"property {said[as_]} {name}" for name, as_ in columns)]
    lines += [f"property uchar {name}" for name in vertex] + [f"element face {len(faces)}"]
    lines += [f"property uchar {name}" for name in face] + ["property list uchar uint vertex_indices", "end_header"]
    path.write_bytes("".join(f"{line}\n" for line in lines).encode() + rows.tobytes() + corners.tobytes())
    return path


def stl(path: Path) -> Path:
    trimesh.creation.icosphere(subdivisions=2).export(path)
    return path


def by_trimesh(path: Path, options, monkeypatch: pytest.MonkeyPatch) -> Scene:
    with monkeypatch.context() as patched:
        patched.setattr(meshes, "read_binary", lambda *_: None)
        return load_scene(path, meshes=options)


def assert_same(a: Scene, b: Scene) -> None:
    one, other = a.objects[0].triangles, b.objects[0].triangles
    for field in one.__dataclass_fields__:
        assert np.array_equal(getattr(one, field), getattr(other, field)), field
    assert a.objects[0].parts == b.objects[0].parts and np.array_equal(a.objects[0].part_of, b.objects[0].part_of)
    told = ("materials", "lights", "camera", "background", "warnings")
    assert all(getattr(a, name) == getattr(b, name) for name in told)


@pytest.mark.parametrize("rows", [1 << 18, 77])
@pytest.mark.parametrize("options", [AS_IN_FILE, IN_STUDIO])
def test_the_scene_is_the_one_that_trimesh_reads(tmp_path, monkeypatch, options, rows):
    monkeypatch.setattr(binary_meshes, "ROWS", rows)
    monkeypatch.setattr(crease, "BLOCK", rows)
    monkeypatch.setattr("tracer.scene.distinct_points._FEWEST", 8)
    paths = [
        stl(tmp_path / "a.stl"),
        ply(tmp_path / "a.ply"),
        ply(tmp_path / "b.ply", ">", "f8", normals=True),
        ply(tmp_path / "c.ply", normals=True, vertex=("quality",), face=("flags",)),
    ]
    for path in paths:
        assert read_binary(path, lambda done: None) is not None and is_plain(path)
        assert_same(load_scene(path, meshes=options), by_trimesh(path, options, monkeypatch))


@pytest.mark.parametrize(
    "other",
    [
        {"vertex": ("red", "green", "blue")},
        {"face": ("red", "green", "blue")},
        {"faces": [[0, 1, 2, 3], [2, 3, 4, 5]]},
        {"head": "comment TextureFile a.png"},
    ],
)
def test_what_else_a_file_has_is_left_to_trimesh(tmp_path, other):
    path = ply(tmp_path / "a.ply", **other)
    assert read_binary(path, lambda done: None) is None and not is_plain(path)
    assert load_scene(path).triangle_count > 0


def test_texts_and_damaged_heads_are_left_to_trimesh(tmp_path):
    (tmp_path / "a.stl").write_text("solid a\nendsolid a\n" + 100 * " ")
    (tmp_path / "b.stl").write_bytes(b"short")
    (tmp_path / "a.ply").write_text("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")
    (tmp_path / "b.ply").write_bytes(b"ply\n")
    for name in ("a.stl", "b.stl", "a.ply", "b.ply"):
        assert read_binary(tmp_path / name, lambda done: None) is None and not is_plain(tmp_path / name)


def test_what_is_wrong_is_one_line(tmp_path, monkeypatch):
    path = ply(tmp_path / "a.ply")
    data = path.read_bytes()
    path.write_bytes(data[:-1])
    with pytest.raises(SceneError, match=r"a\.ply: cannot be read as PLY: it is damaged or incomplete"):
        load_scene(path)
    path.write_bytes(data[:-4] + b"\xff\xff\xff\xff")
    with pytest.raises(SceneError, match=r"a\.ply: a triangle refers to a vertex that is not there"):
        load_scene(path)
    monkeypatch.setattr(binary_meshes, "MOST_PRIMITIVES", 300)
    for path in (stl(tmp_path / "a.stl"), ply(tmp_path / "b.ply")):
        with pytest.raises(SceneError, match=f"{path.name}: more than 300 triangles; make it simpler"):
            load_scene(path)


@pytest.mark.parametrize("line", [b"property float16 x\n", b"property list uchar int64 x\n"])
def test_a_head_of_unknown_types_is_one_line(tmp_path, line):
    path = ply(tmp_path / "a.ply")
    data = path.read_bytes()
    for where in (b"element vertex", b"property float x\n"):  # of no element, and of one
        path.write_bytes(data.replace(where, line + where, 1))
        assert not is_plain(path)
        with pytest.raises(SceneError, match=r"a\.ply: cannot be read as PLY: it is damaged or incomplete"):
            load_scene(path)


def test_a_file_that_turns_out_to_have_polygons_needs_the_memory_of_those(tmp_path, monkeypatch):
    path = ply(tmp_path / "a.ply", faces=[[0, 1, 2]])
    path.write_bytes(path.read_bytes().replace(b"face 1\n", b"face 2\n") + struct.pack("<B4i", 4, 2, 3, 4, 5))
    monkeypatch.delenv(memory_check.ANYHOW, raising=False)
    monkeypatch.setattr(memory_check, "_SMALL", 0)
    monkeypatch.setattr(memory_check, "available", lambda: memory_check.reading(path) + 1)
    assert is_plain(path)
    with pytest.raises(SceneError, match="of memory to be read"):
        load_scene(path)
    monkeypatch.setattr(memory_check, "available", lambda: memory_check.reading(path, whole=True) + 1)
    assert load_scene(path).triangle_count == 3


def test_a_file_that_becomes_shorter_meanwhile_is_one_line(tmp_path, monkeypatch):
    """Another program may be writing it: a mapped file would end this one."""
    monkeypatch.setattr(binary_meshes, "ROWS", 64)
    path = stl(tmp_path / "a.stl")

    def cut(what: str, fraction: float) -> None:
        if fraction > 0.1:
            path.open("r+b").truncate(4000)

    path.write_bytes(b"\0" * 80 + np.uint32(3200).tobytes() + 10 * path.read_bytes()[84:])
    with pytest.raises(SceneError, match=r"a\.stl: cannot be read as STL: it is damaged or incomplete"):
        load_scene(path, cut)


def test_a_file_may_be_larger_than_those_that_are_held_whole(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "MOST_BYTES", 1000)
    assert load_scene(stl(tmp_path / "a.stl")).triangle_count == 320


def test_reading_can_be_given_up_at_any_report(tmp_path, monkeypatch):
    monkeypatch.setattr(binary_meshes, "ROWS", 64)
    monkeypatch.setattr(crease, "BLOCK", 64)
    path, said = stl(tmp_path / "a.stl"), []
    load_scene(path, lambda what, done: said.append((what, done)), meshes=IN_STUDIO)
    fractions = [done for _, done in said]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    for word in ("Reading", "Smoothing", "Putting", "Setting"):
        assert any(what.startswith(word) for what, _ in said)
    assert sum(what.startswith("Reading") for what, _ in said) > 5
    for stop in range(len(said) - 1):
        count = iter(range(stop, -1, -1))

        def progress(what: str, done: float, count=count) -> None:
            if not next(count):
                raise Cancelled("enough")

        with pytest.raises(Cancelled):
            load_scene(path, progress, meshes=IN_STUDIO)


@pytest.mark.parametrize("write, most", [(write_stl, 340), (write_ply, 340)])
def test_few_bytes_are_held_for_each_triangle(tmp_path, monkeypatch, write, most):
    """As many as are left of a scene are 108; trimesh's way takes 660 for STL, 540 for PLY."""
    for module, name in ((binary_meshes, "ROWS"), (crease, "BLOCK"), (pieces, "BLOCK"), (assembly, "BLOCK")):
        monkeypatch.setattr(module, name, 1 << 12)
    monkeypatch.setattr("tracer.scene.studio._BLOCK", 1 << 12)
    monkeypatch.setattr("tracer.scene.up_axis.MOST_ASKED", 1 << 12)
    path = tmp_path / f"a.{write.__name__[-3:]}"
    write(path, frequency_for(40_000))
    load_scene(path, meshes=IN_STUDIO)  # whatever is imported and compiled
    tracemalloc.start()
    try:
        scene = load_scene(path, meshes=IN_STUDIO)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < most * scene.triangle_count


@pytest.mark.parametrize("expected", [0, 4000])
def test_places_are_numbered_in_the_order_in_which_they_are_met(monkeypatch, expected):
    monkeypatch.setattr("tracer.scene.distinct_points._FEWEST", 4)
    rng = np.random.default_rng(5)
    points = rng.integers(-6, 7, (3000, 3)).astype(np.float32)
    points[rng.random(points.shape) < 0.1] = -0.0
    points[::50] = np.inf
    places = DistinctPoints(expected)
    numbers = np.concatenate([places.numbered(points[i : i + 700]) for i in range(0, 3000, 700)])
    different, first, inverse = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    assert len(places) == len(different)
    assert np.array_equal(numbers, rank[inverse.reshape(-1)])
    assert np.array_equal(places.points()[numbers], points)

"""Scenes that need more memory than there is are refused before they are read; how large a file is, by its head."""

from __future__ import annotations

import json
import struct
import sys
from pathlib import Path

import numpy as np
import pytest

import tracer
from tests.commands import run
from tests.fuzz.seeds import seeds
from tests.platforms import linux_only
from tracer.scene import memory_check
from tracer.scene.load import load_visible_scene


def stl(path: Path, triangles: int) -> Path:
    """A file that says that it has so many; on the disk it is a hole."""
    with path.open("wb") as file:
        file.write(bytes(80) + struct.pack("<I", triangles))
        file.truncate(84 + 50 * triangles)
    return path


@pytest.fixture
def little(monkeypatch: pytest.MonkeyPatch) -> float:
    monkeypatch.delenv(memory_check.ANYHOW, raising=False)
    monkeypatch.setattr(memory_check, "available", lambda: 1e9)
    return 1e9


def test_a_mesh_that_is_too_large_is_one_line_before_it_is_read(little: float, tmp_path: Path, monkeypatch) -> None:
    path = stl(tmp_path / "large.stl", 10_000_000)
    monkeypatch.setattr("tracer.scene.load.load_mesh", lambda *_: pytest.fail("it is read"))
    needed = 10e6 * memory_check.READING_PLAIN
    with pytest.raises(tracer.SceneError) as refused:
        tracer.load_scene(path)
    said = str(refused.value)
    assert said.startswith(f"{path}: it needs about {needed / 1e9:.1f} GB of memory to be read, and 1.0 GB are free")
    assert f"{(needed - little) / 1e9:.1f} GB too little" in said and "--beyond-memory" in said
    assert len(said.splitlines()) == 1
    monkeypatch.setenv(memory_check.ANYHOW, "1")
    monkeypatch.setattr("tracer.scene.load.load_mesh", lambda *_: "read")
    assert tracer.load_scene(path) == "read"


def test_what_fits_while_it_is_read_may_be_too_large_to_be_shown(little: float, tmp_path: Path) -> None:
    path = tmp_path / "small.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert load_visible_scene(path).triangle_count == 1
    with pytest.raises(tracer.SceneError, match="GB of memory more to be shown, with its 9,000,000 triangles, and 1.0"):
        memory_check.check_showing(path, 9_000_000)


@pytest.mark.parametrize("name", ["a.ply", "b.ply", "b.stl", "a.gltf", "a.glb"])
def test_the_head_of_a_file_says_how_many_triangles_it_has(name: str, tmp_path: Path) -> None:
    from tests.fuzz.seeds import write_beside

    write_beside(tmp_path)
    (tmp_path / name).write_bytes(seeds()[name])
    said, scene = memory_check.triangles_of(tmp_path / name), tracer.load_scene(tmp_path / name)
    assert said in (None, scene.triangle_count)
    assert said is not None or name not in ("b.stl", "a.glb")


@pytest.mark.parametrize(("corners", "triangles"), [(3, 7), (4, 14)])
def test_faces_of_more_corners_are_more_triangles(corners: int, triangles: int, tmp_path: Path) -> None:
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    head += "property float z\nelement face 7\nproperty list uchar int vertex_indices\nend_header\n"
    face = struct.pack(f"<B{corners}i", corners, *range(corners))
    (tmp_path / "a.ply").write_bytes(head.encode() + np.eye(4, 3, dtype="<f4").tobytes() + 7 * face)
    assert (
        memory_check.triangles_of(tmp_path / "a.ply")
        == triangles
        == tracer.load_scene(tmp_path / "a.ply").triangle_count
    )


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.stl", b"solid"),
        ("a.ply", b"ply\nformat binary_little_endian 1.0\nelement face x\nend_header\n"),
        ("a.glb", b"glTF"),
        ("a.gltf", b"[" * 100_000),
        ("b.gltf", json.dumps({"meshes": [{"primitives": [{"attributes": {"POSITION": -9}}]}], "nodes": 1}).encode()),
        ("a.obj", b"f 1 2 3"),
    ],
)
def test_what_says_nothing_of_its_size_is_left_to_the_reader(name: str, data: bytes, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(data)
    assert memory_check.triangles_of(tmp_path / name) is None


@linux_only
def test_memory_is_what_is_left_of_the_least_of_all_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    there = memory_check.available()
    assert there is not None and there > 0
    monkeypatch.setattr(memory_check, "_of_group", lambda: 5.0)
    assert memory_check.available() == 5.0
    monkeypatch.setattr(memory_check, "of_limit", lambda: -7.0)
    assert memory_check.available() == 0.0


@linux_only
def test_elsewhere_a_library_tells_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("psutil")
    there, told = memory_check._of_system(), memory_check._elsewhere()
    assert there is not None and told is not None and abs(told - there) < 0.3 * there + 1e9
    monkeypatch.setattr(memory_check, "_field", lambda *_: None)
    told = memory_check._of_system()
    assert told is not None and abs(told - there) < 0.3 * there + 1e9
    monkeypatch.setitem(sys.modules, "psutil", None)
    assert memory_check._of_system() is None


def test_a_summary_builds_no_trees(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd) -> None:
    monkeypatch.setattr("tracer.geometry.world.World.__init__", lambda *_, **__: pytest.fail("a world is built"))
    path = tmp_path / "small.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert json.loads(run(capfd, "info", path, "--json")[1])["triangles"] == 1

"""Meshes of millions of triangles are worked on block by block: nothing of a scene depends on where these begin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tracer
from tests.bench.meshes import bumpy_sphere
from tests.fuzz.seeds import seeds, write_beside
from tracer.scene import assembly, crease, pieces
from tracer.scene.mesh_options import AS_IN_FILE, IN_STUDIO, MeshOptions
from viewer.util.resources import embedded_scenes


def in_blocks(monkeypatch: pytest.MonkeyPatch, size: int, path: Path, options: MeshOptions) -> tracer.Scene:
    with monkeypatch.context() as small:
        for module in (assembly, crease, pieces):
            small.setattr(module, "BLOCK", size)
        return tracer.load_scene(path, meshes=options)


@pytest.mark.parametrize("options", [AS_IN_FILE, IN_STUDIO])
@pytest.mark.parametrize("name", ["a.obj", "b.ply", "b.stl", "a.glb", "sphere.stl", "figure3"])
def test_a_scene_is_the_same_in_blocks_of_any_size(
    name: str, options: MeshOptions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_beside(tmp_path)
    path = tmp_path / name
    if name == "figure3":
        path = embedded_scenes()["figure3"]
    elif name == "sphere.stl":
        kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
        records = np.zeros(180, kind)
        records["corners"] = bumpy_sphere(3)
        records["corners"][7, 1] = np.nan
        records["corners"][9, 1] = records["corners"][9, 2]
        path.write_bytes(bytes(80) + np.uint32(180).tobytes() + records.tobytes())
    else:
        path.write_bytes(seeds()[name])
    whole = tracer.load_scene(path, meshes=options)
    for size in (1, 7):
        scene = in_blocks(monkeypatch, size, path, options)
        assert scene.warnings == whole.warnings and scene.camera == whole.camera
        for one, other in zip(scene.objects, whole.objects, strict=True):
            for field in one.triangles.__dataclass_fields__:
                found, wanted = getattr(one.triangles, field), getattr(other.triangles, field)
                assert found.dtype == wanted.dtype and np.array_equal(found, wanted), field
            assert one.parts == other.parts and np.array_equal(one.part_of, other.part_of)


def test_reading_a_mesh_can_be_cancelled_between_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_beside(tmp_path)
    path = tmp_path / "b.stl"
    path.write_bytes(seeds()["b.stl"])
    for wanted in ("Smoothing", "Putting"):

        def stop(what: str, _: float, wanted: str = wanted) -> None:
            if what.startswith(wanted):
                raise tracer.Cancelled

        with pytest.raises(tracer.Cancelled):
            tracer.load_scene(path, stop, meshes=IN_STUDIO)

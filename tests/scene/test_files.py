"""Which files a scene was read from, and which were missed."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from tests.commands import ROOM
from tracer.scene.files import Stamp, noting, stamp
from tracer.scene.load import load_scene
from tracer.scene.model import SceneError


def test_all_that_a_scene_names_is_noted(tmp_path: Path):
    room = tmp_path / "room.aff"
    Image.new("RGB", (2, 2)).save(tmp_path / "there.png")
    part = tmp_path / "part.aff"
    part.write_text("tt there.png\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\ntt gone.png\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n")
    room.write_text(ROOM + "\ni 0 part.aff\n")
    files: dict[Path, Stamp] = {}
    with noting(files):
        load_scene(room)
    assert files == {p: stamp(p) for p in (room, part, tmp_path / "there.png", tmp_path / "gone.png")}
    assert files[tmp_path / "gone.png"] is None

    part.write_text("p nonsense\n")
    files = {}
    with noting(files), pytest.raises(SceneError):
        load_scene(room)
    assert part in files, "also where it is broken"

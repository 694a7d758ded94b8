"""What arguments and names may not do to the terminal, and where scenes may read and pictures may be written."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.commands import CAMERA, ROOM, complaint, render, run


@pytest.fixture
def room(tmp_path: Path) -> Path:
    path = tmp_path / "room.aff"
    path.write_text(ROOM)
    return path


def test_a_camera_beyond_all_coordinates_is_one_line(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    camera = json.dumps(CAMERA | {"position": [1e300, 0, 0]})
    said = complaint(render(capfd, room, "-o", tmp_path / "a.png", "--camera", camera))
    assert "--camera: a camera's position lies within 1e+09" in said


def test_names_send_no_commands_to_the_terminal(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    assert "\x1b" not in complaint(run(capfd, "info", "\x1b[31mred.aff"))
    assert "\x1b" not in complaint(run(capfd, "render", room, "--size", "\x1b]0;title\x07"))
    named = tmp_path / "\x1b[31mred.aff"
    named.write_bytes(Path(room).read_bytes())
    code, out, err = run(capfd, "info", named)
    assert code == 0
    assert "\x1b" not in out + err
    assert r"\x1b[31mred.aff" in out
    code, out, err = render(capfd, named, "-o", tmp_path / "\x1b[31mred.png")
    assert code == 0
    assert "\x1b" not in out + err


def test_a_folder_that_a_scene_may_read_from(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    (tmp_path / "scene").mkdir()
    scene = tmp_path / "scene" / "a.aff"
    scene.write_text(Path(room).read_text() + f"i 0 ../{Path(room).name}\n")
    assert "lies outside of the scene's folder" in complaint(run(capfd, "info", scene))
    code, _, _ = run(capfd, "info", scene, "--folder", tmp_path)
    assert code == 0

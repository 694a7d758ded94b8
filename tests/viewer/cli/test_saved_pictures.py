"""A saved picture on the command line, in the place of a scene or of a camera."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.commands import CAMERA, ROOM, run
from tracer.scene.mesh_options import AS_IN_FILE, IN_STUDIO, MeshOptions
from viewer.cli.main import viewer_parser
from viewer.cli.options import mesh_options
from viewer.output import capture, commands
from viewer.state import codec
from viewer.state.view_state import ViewState


@pytest.fixture
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The room of `tests.commands` in a folder of its own, which is the current one."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "room.aff"
    path.write_text(ROOM)
    return path


@pytest.fixture
def saved(room: Path, capfd: pytest.CaptureFixture[str]) -> Path:
    options = ("--frame", 3, "--size", "48x32", "--camera", json.dumps(CAMERA), "--method", "none", "--view", "normal")
    assert run(capfd, "render", room, "-o", "saved.png", "--depth", 2, *options)[0] == 0
    return Path("saved.png")


def test_a_saved_picture_is_rendered_anew(saved: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for name in ("saved-rendered.png", "saved-rendered-2.png"):  # nothing is written over
        code, out, _ = run(capfd, "render", saved)
        assert code == 0 and out.rstrip().endswith(name)
        with Image.open(saved) as before, Image.open(name) as again:
            assert np.array_equal(np.asarray(before), np.asarray(again))
        assert capture.read(Path(name)) == capture.read(saved)


def test_options_change_what_they_name(saved: Path, capfd: pytest.CaptureFixture[str]) -> None:
    options = ("--frame", 7, "--view", "depth", "--size", "20x10", "--method", "paper")
    assert run(capfd, "render", saved, "-o", "other.png", *options)[0] == 0
    was, now = capture.read(saved), capture.read(Path("other.png"))
    assert (now.settings.width, now.settings.height) == (20, 10) and now.time == 7.0 and now.draw.view == "depth"
    assert now.settings.method == "paper" and now.settings.depth == was.settings.depth == 2
    assert now.camera == was.camera is not None
    assert run(capfd, "render", saved, "--buffers", "b.npz")[0] == 0
    assert not Path("saved-rendered.png").exists()


def test_its_lamps_come_back(room: Path, capfd: pytest.CaptureFixture[str]) -> None:
    size = ("--size", "16x16")
    assert run(capfd, "render", room, "-o", "lamps.png", *size, "--lamp-radius", 0.5, "--lamp-samples", 4)[0] == 0
    assert run(capfd, "render", "lamps.png", "-o", "again.png")[0] == 0
    assert run(capfd, "render", "lamps.png", "-o", "points.png", "--lamp-radius", 0)[0] == 0
    kept = [capture.read(Path(name)).settings for name in ("lamps.png", "again.png", "points.png")]
    assert [(s.lamp_radius, s.lamp_samples) for s in kept] == [(0.5, 4), (0.5, 4), (0.0, 4)]


def test_its_scene_is_told_of(saved: Path, room: Path, capfd: pytest.CaptureFixture[str]) -> None:
    of_picture, of_room = (run(capfd, "info", path, "--json") for path in (saved, room))
    assert of_picture[0] == 0 and json.loads(of_picture[1]) == json.loads(of_room[1])


def test_its_camera_is_taken_alone(saved: Path, room: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(capfd, "render", room, "-o", "other.png", "--size", "20x10", "--camera", saved)[0] == 0
    other = capture.read(Path("other.png"))
    assert other.camera.to_json() == CAMERA and other.time == 0.0 and other.draw.view == "color"
    tests = ("--primitive", 0, "--size", "32x32", "--steps", 2, "--camera", saved)
    assert run(capfd, "zoom", room, *tests)[0] == 0


def test_a_state_as_json_is_rendered_like_a_picture_that_carries_it(
    saved: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Alone, or all that a picture carries; options given beside it win."""
    state = capture.read(saved)
    Path("state.json").write_text(json.dumps(codec.state_to_json(state, of_picture=True)))
    Path("all.json").write_text(capture.read_carried(saved).text())
    for name in ("state", "all"):
        assert run(capfd, "render", f"{name}.json")[0] == 0
        with Image.open(saved) as before, Image.open(f"{name}-rendered.png") as again:
            assert np.array_equal(np.asarray(before), np.asarray(again))
    assert run(capfd, "render", "state.json", "-o", "depth.png", "--view", "depth", "--depth", 1)[0] == 0
    other = capture.read(Path("depth.png"))
    assert (other.draw.view, other.settings.depth, other.camera) == ("depth", 1, state.camera)
    by_hand = {"format": codec.FORMAT, "scene": "default", "settings": {"depth": 1, "width": 8, "height": 8}}
    Path("hand.json").write_text(json.dumps(by_hand))
    assert run(capfd, "render", "hand.json", "-o", "hand.png")[0] == 0
    damaged = (
        ("[]", "a state has a format"),
        ("{", "line 1 column 2"),
        ('{"scene": "default", "frames": []}', "a state has a format"),  # as results of runs are
        (json.dumps(by_hand | {"format": 99}), "its format is 99"),
        (json.dumps(by_hand | {"scene": ""}), "it names no scene"),
        (json.dumps(by_hand | {"settings": {"dept": 1}}), "settings.dept means nothing"),
        (json.dumps(by_hand | {"settings": {"depth": "1"}}), "settings.depth: expected a whole number, got text"),
        (json.dumps(by_hand | {"draw": {"view": "nope"}}), "draw.view: there is no 'nope'"),
    )
    for text, said in damaged:
        Path("damaged.json").write_text(text)
        code, _, errors = run(capfd, "render", "damaged.json")
        assert code == 1 and "damaged.json: holds no state" in errors and said in errors, errors
        assert errors.count("\n") == 1


def test_mistakes_are_one_line(saved: Path, room: Path, capfd: pytest.CaptureFixture[str]) -> None:
    Image.new("RGB", (4, 4)).save("plain.png")
    Path("broken.png").write_bytes(b"no picture")
    cases = [
        (("render", "plain.png"), "not one saved by Shadowcull"),
        (("render", "broken.png"), "cannot be read as a picture"),
        (("render", "gone.png"), "no such file"),
        (("render", room, "-o", "x.png", "--camera", "plain.png"), "--camera: plain.png"),
        (("zoom", room, "--primitive", "0", "--camera", "gone.png"), "--camera: gone.png: no such file"),
        (("bench", saved), "saved.png"),
        (("info", "plain.png"), "not one saved by Shadowcull"),
    ]
    for arguments, said in cases:
        code, _, errors = run(capfd, *arguments)
        assert code in (1, 2) and said in errors and errors.count("\n") == 1, errors
    room.unlink()
    code, _, errors = run(capfd, "render", saved)
    assert code == 1 and "its scene is gone" in errors and errors.count("\n") == 1


def test_its_tone_and_its_range_come_back_where_the_view_has_any(room: Path, capfd: pytest.CaptureFixture[str]) -> None:
    size = ("--size", "24x16")
    tone = ("--exposure", 1.5, "--white", 3, "--tone", "filmic")
    assert run(capfd, "render", room, "-o", "toned.png", *size, *tone)[0] == 0
    assert run(capfd, "render", room, "-o", "plain.png", *size)[0] == 0
    assert run(capfd, "render", "toned.png", "-o", "again.png")[0] == 0
    assert run(capfd, "render", "toned.png", "-o", "distances.png", "--view", "depth", "--range", "2:9")[0] == 0
    assert run(capfd, "render", "distances.png", "-o", "normals.png", "--view", "normal")[0] == 0
    assert run(capfd, "render", "distances.png", "-o", "distances-again.png")[0] == 0
    pixels = {path.stem: np.asarray(Image.open(path)) for path in Path().glob("*.png")}
    assert np.array_equal(pixels["toned"], pixels["again"]) and (pixels["toned"] != pixels["plain"]).any()
    assert np.array_equal(pixels["distances"], pixels["distances-again"])
    kept = {name: capture.read(Path(f"{name}.png")) for name in pixels}
    assert kept["again"].draw.tone.in_words() == "+1.5 EV, white 3, filmic" and kept["plain"].draw.tone.neutral
    printed = {
        name: run(capfd, "render", f"{name}.png", "--print-command")[1] for name in ("toned", "plain", "distances")
    }
    assert "--exposure 1.5 --white 3.0 --tone filmic" in printed["toned"] and "--range=2.0:9.0" in printed["distances"]
    assert not any(
        f"--{option}" in printed["plain"] for option in ("exposure", "white", "tone", "mark-clipped", "range")
    )
    assert run(capfd, "check", "toned.png", "plain.png", "distances.png")[0] == 0
    film = ("--frames", "0-0", *size, *tone)
    assert run(capfd, "film", room, "-o", "frames", *film)[0] == 0
    assert np.array_equal(np.asarray(Image.open("frames/0000.png")), pixels["toned"])
    code, _, said = run(capfd, "film", room, "-o", "none", *film, "--view", "normal")
    assert code == 1 and "--exposure does nothing in the view normal" in said
    assert (
        kept["distances"].draw.span == (2.0, 9.0)
        and kept["distances"].draw.tone.neutral
        and kept["normals"].draw.span is None
    )


@pytest.mark.parametrize("meshes", [AS_IN_FILE, IN_STUDIO, MeshOptions(True, "-z", 12.5), MeshOptions(False, "x", 0.0)])
def test_how_a_mesh_was_read_comes_back(meshes: MeshOptions) -> None:
    state = ViewState("/a.ply", meshes)
    assert mesh_options(viewer_parser().parse_args(["a.ply", *commands.mesh_options(meshes)])) == meshes
    assert set(commands.mesh_options(meshes)) <= set(commands.options(state))
    assert not set(commands.mesh_options(meshes)) & set(commands.options(ViewState("/a.aff", meshes)))
    data = codec.state_to_json(state)
    assert codec.state_from_json(data).meshes == meshes
    assert codec.state_from_json({k: v for k, v in data.items() if k != "meshes"}).meshes == AS_IN_FILE
    assert mesh_options(viewer_parser().parse_args(["a.ply", "--up", "-z"])) == MeshOptions(True, "-z")
    for bad in (5, {"up": 3}, {"up": "w"}, {"crease": "x"}, {"crease": 1e9}):
        with pytest.raises(ValueError, match="mesh|axis|up|crease") as error:
            codec.state_from_json(data | {"meshes": bad})
        assert "\n" not in str(error.value)

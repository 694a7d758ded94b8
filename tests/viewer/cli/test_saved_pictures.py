"""A saved picture on the command line, in the place of a scene or of a camera."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.commands import CAMERA, Run, pixels
from tracer.scene.mesh_options import AS_IN_FILE, IN_STUDIO, MeshOptions
from viewer.cli.main import viewer_parser
from viewer.cli.options import mesh_options
from viewer.output import capture, commands
from viewer.state import codec
from viewer.state.view_state import ViewState


@pytest.fixture
def saved(run: Run) -> Path:
    options = ("--frame", 3, "--size", "48x32", "--camera", json.dumps(CAMERA), "--method", "none", "--view", "normal")
    run.ok("render", "room.aff", "-o", "saved.png", "--depth", 2, *options)
    return Path("saved.png")


def test_a_saved_picture_is_rendered_anew(saved: Path, run: Run) -> None:
    for name in ("saved-rendered.png", "saved-rendered-2.png"):  # nothing is written over
        assert run.ok("render", saved).rstrip().endswith(name)
        assert np.array_equal(pixels(saved), pixels(name))
        assert capture.read(Path(name)) == capture.read(saved)
    assert json.loads(run.ok("info", saved, "--json")) == json.loads(run.ok("info", "room.aff", "--json"))


def test_options_change_what_they_name(saved: Path, run: Run) -> None:
    options = ("--frame", 7, "--view", "depth", "--size", "20x10", "--method", "paper")
    run.ok("render", saved, "-o", "other.png", *options)
    was, now = capture.read(saved), capture.read(Path("other.png"))
    assert (now.settings.width, now.settings.height) == (20, 10) and now.time == 7.0 and now.draw.view == "depth"
    assert now.settings.method == "paper" and now.settings.depth == was.settings.depth == 2
    assert now.camera == was.camera is not None
    run.ok("render", saved, "--buffers", "b.npz")
    assert not Path("saved-rendered.png").exists()


def test_its_lamps_come_back(run: Run) -> None:
    lamps = ("--size", "16x16", "--lamp-radius", 0.5, "--lamp-samples", 4)
    for scene, name, radius, options in (
        ("room.aff", "lamps.png", 0.5, lamps),
        ("lamps.png", "again.png", 0.5, ()),
        ("lamps.png", "points.png", 0.0, ("--lamp-radius", 0)),
    ):
        run.ok("render", scene, "-o", name, *options)
        kept = capture.read(Path(name)).settings
        assert (kept.lamp_radius, kept.lamp_samples) == (radius, 4)


def test_its_camera_is_taken_alone(saved: Path, run: Run) -> None:
    run.ok("render", "room.aff", "-o", "other.png", "--size", "20x10", "--camera", saved)
    other = capture.read(Path("other.png"))
    assert other.camera.to_json() == CAMERA and other.time == 0.0 and other.draw.view == "color"
    run.ok("zoom", "room.aff", "--primitive", 0, "--size", "32x32", "--steps", 2, "--camera", saved)


def test_a_state_as_json_is_rendered_like_a_picture_that_carries_it(saved: Path, run: Run) -> None:
    """Alone, or all that a picture carries; options given beside it win."""
    state = capture.read(saved)
    Path("state.json").write_text(json.dumps(codec.state_to_json(state, of_picture=True)))
    Path("all.json").write_text(capture.read_carried(saved).text())
    for name in ("state", "all"):
        run.ok("render", f"{name}.json")
        assert np.array_equal(pixels(saved), pixels(f"{name}-rendered.png"))
    run.ok("render", "state.json", "-o", "depth.png", "--view", "depth", "--depth", 1)
    other = capture.read(Path("depth.png"))
    assert (other.draw.view, other.settings.depth, other.camera) == ("depth", 1, state.camera)
    by_hand = {"format": codec.FORMAT, "scene": "default", "settings": {"depth": 1, "width": 8, "height": 8}}
    Path("hand.json").write_text(json.dumps(by_hand))
    run.ok("render", "hand.json", "-o", "hand.png")
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
        line = run.fails("render", "damaged.json")
        assert "damaged.json: holds no state" in line and said in line


def test_its_tone_and_its_range_come_back_where_the_view_has_any(run: Run) -> None:
    tone = ("--size", "24x16", "--exposure", 1.5, "--white", 3, "--tone", "filmic")
    for scene, name, *options in (
        ("room.aff", "toned", *tone),
        ("room.aff", "plain", "--size", "24x16"),
        ("toned.png", "again"),
        ("toned.png", "distances", "--view", "depth", "--range", "2:9"),
        ("distances.png", "normals", "--view", "normal"),
        ("distances.png", "distances-again"),
    ):
        run.ok("render", scene, "-o", f"{name}.png", *options)
    drawn = {path.stem: pixels(path) for path in Path().glob("*.png")}
    kept = {name: capture.read(Path(f"{name}.png")).draw for name in drawn}
    assert np.array_equal(drawn["toned"], drawn["again"]) and (drawn["toned"] != drawn["plain"]).any()
    assert np.array_equal(drawn["distances"], drawn["distances-again"])
    assert kept["again"].tone.in_words() == "+1.5 EV, white 3, filmic" and kept["plain"].tone.neutral
    assert kept["distances"].span == (2.0, 9.0) and kept["distances"].tone.neutral and kept["normals"].span is None
    names = "toned", "plain", "distances"
    toned, plain, distances = (run.ok("render", f"{name}.png", "--print-command") for name in names)
    assert "--exposure 1.5 --white 3.0 --tone filmic" in toned and "--range=2.0:9.0" in distances
    assert not any(f"--{option}" in plain for option in ("exposure", "white", "tone", "mark-clipped", "range"))
    run.ok("check", "toned.png", "plain.png", "distances.png")
    run.ok("film", "room.aff", "-o", "frames", "--frames", "0-0", *tone)
    assert np.array_equal(pixels("frames/0000.png"), drawn["toned"])


@pytest.mark.parametrize("meshes", [AS_IN_FILE, IN_STUDIO, MeshOptions(True, "-z", 12.5), MeshOptions(False, "x", 0.0)])
def test_how_a_mesh_was_read_comes_back(meshes: MeshOptions) -> None:
    state, words = ViewState("/a.ply", meshes), commands.mesh_options(meshes)
    assert mesh_options(viewer_parser().parse_args(["a.ply", *words])) == meshes
    assert set(words) <= set(commands.options(state))
    assert not set(words) & set(commands.options(ViewState("/a.aff", meshes)))
    data = codec.state_to_json(state)
    assert codec.state_from_json(data).meshes == meshes
    assert codec.state_from_json({k: v for k, v in data.items() if k != "meshes"}).meshes == AS_IN_FILE
    assert mesh_options(viewer_parser().parse_args(["a.ply", "--up", "-z"])) == MeshOptions(True, "-z")
    for bad in (5, {"up": 3}, {"up": "w"}, {"crease": "x"}, {"crease": 1e9}):
        with pytest.raises(ValueError, match="mesh|axis|up|crease") as error:
            codec.state_from_json(data | {"meshes": bad})
        assert "\n" not in str(error.value)

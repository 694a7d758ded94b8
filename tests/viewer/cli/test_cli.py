"""The command line: what it prints and writes, and that every mistake ends in one line."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from tests.commands import CAMERA, ROOM, complaint, render, run
from tests.terminal import Terminal
from tracer.frame import Settings
from tracer.scene.load import load_scene
from tracer.scene.mesh_options import IN_STUDIO, MeshOptions
from viewer.cli import main as command_line
from viewer.cli import pictures
from viewer.output import capture
from viewer.state.palette import BENEATH
from viewer.state.views import View
from viewer.views.color import TOO_BRIGHT

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def room(tmp_path: Path) -> Path:
    path = tmp_path / "room.aff"
    path.write_text(ROOM)
    return path


# --- info ------------------------------------------------------------------------------------------


def test_info_json_holds_the_promised_keys(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    code, out, _ = run(capfd, "info", room, "--json")
    facts = json.loads(out)
    assert code == 0
    assert list(facts) == [
        "triangles", "static_triangles", "dynamic_triangles", "spheres", "cones", "lights", "materials",
        "textures", "frames", "time", "bounds", "warnings", "light_kinds", "studio",
    ]  # fmt: skip
    assert facts["light_kinds"] == [{"kind": "point", "samples": 1, "falloff": "none", "lights": 2}]
    assert (facts["triangles"], facts["dynamic_triangles"], facts["spheres"]) == (3, 1, 1)
    assert (facts["lights"], facts["frames"], facts["time"]) == (2, 10, [0.0, 9.0])
    assert facts["studio"] is None


def test_info_as_a_table(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    code, out, _ = run(capfd, "info", room)
    assert code == 0
    assert "dynamic triangles" in out and "0 to 9 s" in out
    assert re.search(r"lights\W+2\W+point\W+2\W+materials", out)


def test_info_groups_lights_that_are_alike(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    spheres = "".join(f"lamp sphere at {x} 3 0 radius 0.1 samples 4\n" for x in range(5))
    room.write_text(ROOM + spheres + "lamp dome at 0 0 0 radius 9 samples 1 falloff inverse-square\n")
    code, out, _ = run(capfd, "info", room)
    assert code == 0
    for said in (r"lights\W+8\W+point", r"sphere, 4 samples\W+5", r"dome, 1 sample, falloff inverse square\W+1"):
        assert re.search(said, out), said
    kinds = json.loads(run(capfd, "info", room, "--json")[1])["light_kinds"]
    assert [(k["kind"], k["samples"], k["falloff"], k["lights"]) for k in kinds] == [
        ("point", 1, "none", 2),
        ("sphere", 4, "none", 5),
        ("dome", 1, "inverse square", 1),
    ]


@pytest.mark.parametrize("ending", [".obj", ".stl", ".glb"])
def test_info_says_what_a_studio_adds(capfd: pytest.CaptureFixture[str], tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"ball{ending}"
    trimesh.creation.icosphere(subdivisions=1).export(path)
    facts = json.loads(run(capfd, "info", path, "--json")[1])
    shown = load_scene(path, meshes=IN_STUDIO)
    assert facts["triangles"] + facts["studio"]["triangles"] == shown.triangle_count
    assert facts["studio"]["lights"] == len(shown.lights) != facts["lights"]
    code, out, _ = run(capfd, "info", path)
    assert code == 0 and "a studio adds 2 triangles, and 3 lamps in place of these lights" in out
    if ending == ".glb":  # which may have a camera
        model = trimesh.Scene(trimesh.creation.icosphere(subdivisions=1))
        model.camera_transform = trimesh.transformations.translation_matrix((0, 0, 5))
        model.export(path)
        code, out, _ = run(capfd, "info", path)
        assert code == 0 and "a studio adds" not in out


@pytest.mark.parametrize("command", [["render", "-o", "x.png"], ["bench"], ["zoom", "--primitive", "0"], []])
@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--lamp-radius", "-0.1", "-0.1 is not a number from 0 up"),
        ("--lamp-radius", "nan", "nan is not a number from"),
        ("--lamp-radius", "wide", "wide is not a number from"),
        ("--lamp-samples", "0", "0 is not a whole number from 1 to 1024"),
        ("--lamp-samples", "1025", "1025 is not a whole number from 1 to 1024"),
        ("--lamp-samples", "2.5", "2.5 is not a whole number"),
    ],
)
def test_lamps_that_cannot_be_are_said(
    capfd: pytest.CaptureFixture[str], room: Path, command: list[str], option: str, value: str, said: str
) -> None:
    arguments = [*command[:1], room, *command[1:], option, value]
    line = complaint(run(capfd, *arguments))
    assert f"argument {option}: {said}" in line


def test_the_window_is_given_the_lamps(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[tuple[Path | None, dict[str, object]]] = []

    def open_window(
        scene: Path | None, settings: dict[str, object], folders: Sequence[Path], meshes: MeshOptions
    ) -> int:
        opened.append((scene, settings))
        assert list(folders) == [] and meshes == IN_STUDIO
        return 0

    monkeypatch.setattr("viewer.cli.main.has_display", lambda: True)
    for arguments in ([str(room), "--lamp-radius", "0.1", "--lamp-samples", "9"], ["--lamp-radius", "0"], []):
        assert command_line.main(arguments, open_window) == 0
    assert opened == [(room, {"lamp_radius": 0.1, "lamp_samples": 9}), (None, {"lamp_radius": 0.0}), (None, {})]


@pytest.mark.parametrize(
    ("scene", "triangles", "dynamic", "lights", "frames"),
    [
        ("kitchen/kitchen.aff", 110_561, 7_218, 6, 800),
        ("robot/Robot.aff", 71_708, 62_490, 1, 800),
        ("museum/museum5.aff", 11_308, 1_024, 2, 300),
    ],
)
def test_info_of_bart(
    capfd: pytest.CaptureFixture[str], bart: Path, scene: str, triangles: int, dynamic: int, lights: int, frames: int
) -> None:
    code, out, _ = run(capfd, "info", bart / scene, "--json")
    facts = json.loads(out)
    assert code == 0
    assert (facts["triangles"], facts["dynamic_triangles"]) == (triangles, dynamic)
    assert (facts["lights"], facts["frames"]) == (lights, frames)


# --- render ----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_buffers_that_no_memory_holds_are_refused(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    out = tmp_path / "courtyard.npz"
    said = complaint(run(capfd, "render", "courtyard", "--buffers", out, "--size", "512x512"))
    assert "all buffers of 10,000 lights: too much for memory; give a --size of up to 26,843 pixels" in said
    said = complaint(run(capfd, "render", "courtyard", "-o", tmp_path / "lights.png", "--view", "lights"))
    assert "--view lights of 10,000 lights" in said
    assert not list(tmp_path.iterdir())


def test_a_light_among_too_many_is_looked_at_alone(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pictures = [tmp_path / name for name in ("all.png", "alone.png")]
    for output in pictures:
        assert render(capfd, room, "-o", output, "--view", "penumbra:1", "--lamp-radius", "0.5")[0] == 0
        monkeypatch.setattr("viewer.state.readings.MOST_TOGETHER", 1)
    shown = [np.asarray(Image.open(output)) for output in pictures]
    assert np.array_equal(*shown) and len(np.unique(shown[0].reshape(-1, 3), axis=0)) > 50


def test_render_writes_a_picture_that_remembers(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    output = tmp_path / "room.png"
    code, out, _ = render(capfd, room, "-o", output, "--frame", 3, "--warmup", 2, "--camera", json.dumps(CAMERA))
    assert code == 0
    assert out.rstrip().endswith(str(output))
    assert "traversal steps" in out and "shadow rays due" in out
    with Image.open(output) as image:
        assert (image.size, image.mode) == ((48, 32), "RGB")
    kept = capture.read(output)
    assert Path(kept.scene) == room
    assert kept.time == 3.0
    assert kept.camera.to_json() == CAMERA
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_buffers_have_the_promised_names_shapes_and_types(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    output = tmp_path / "room.npz"
    assert render(capfd, room, "--buffers", output, "--warmup", 0)[0] == 0
    with np.load(output) as npz:
        arrays = dict(npz)
    assert {name: (a.shape, a.dtype.name) for name, a in arrays.items()} == {
        "color": ((32, 48, 3), "float32"),
        "depth": ((32, 48), "float32"),
        "primitive": ((32, 48), "int32"),
        "cell": ((32, 48), "int32"),
        "occlusion_mode": ((32, 48), "uint8"),
        "shadow_mode": ((32, 48, 2), "uint8"),
        "lit": ((32, 48, 2), "bool"),
        "due": ((32, 48, 2), "bool"),
    }
    hit = arrays["primitive"] >= 0
    assert hit.any() and not hit.all()
    np.testing.assert_array_equal(np.isfinite(arrays["depth"]), hit)
    np.testing.assert_array_equal(arrays["occlusion_mode"] == 255, ~hit)
    assert not (arrays["lit"] & ~arrays["due"]).any()


def test_modes_are_the_same_beside_any_exact_method(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    pictures, arrays = {}, {}
    beside = {"none": "paper", "none+cache": "paper", "certified": "paper+rest", "none+rest": "paper+rest"}
    for method in ("paper", "paper+rest", *beside):
        paper = beside.get(method, method)
        for view in ("occlusion", "shadow:1", "pixel-count"):
            png, npz = tmp_path / "view.png", tmp_path / "room.npz"
            given = ("--view", view, "--method", method, "--frame", 4, "--warmup", 4, "-o", png, "--buffers", npz)
            assert render(capfd, room, *given)[0] == 0
            with Image.open(png) as image, np.load(npz) as found:
                pictures[method, view] = np.asarray(image)
                arrays[method] = {name: found[name] for name in ("occlusion_mode", "shadow_mode")}
            assert np.array_equal(pictures[method, view], pictures[paper, view]), (method, view)
        for name, expected in arrays[paper].items():
            assert np.array_equal(arrays[method][name], expected), (method, name)
    assert {2, 3} <= set(np.unique(arrays["none"]["shadow_mode"])) and 2 in arrays["none"]["occlusion_mode"]


def test_verified_buffers_say_what_is_wrong(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Figure 4 in frame 20, where culling misses a shadow."""
    output, unculled = tmp_path / "paper.npz", tmp_path / "none.npz"
    where = ("--size", "128x128", "--threads", 1, "--frame", 20)
    given = ("--buffers", output, "--warmup", 20, "--verify", "--method", "paper")
    code, out, _ = run(capfd, "render", "figure4", *given, *where)
    assert code == 0
    assert run(capfd, "render", "figure4", "--buffers", unculled, "--method", "none", *where)[0] == 0
    with np.load(output) as npz, np.load(unculled) as none:
        arrays = dict(npz)
        np.testing.assert_array_equal(arrays["reference"], none["color"])
        assert "reference" not in none and "wrong" not in none
    assert (arrays["wrong"].shape, arrays["wrong"].dtype.name) == ((128, 128), "int32")
    differs = (arrays["color"] != arrays["reference"]).any(axis=-1)
    np.testing.assert_array_equal(arrays["wrong"] > 0, differs)
    row = next(line for line in out.splitlines() if "wrong answers" in line)
    assert int(row.split()[-2].replace(",", "")) == arrays["wrong"].sum() > 0


def test_cuts_of_lights_take_an_error_and_tell_it(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    lamps = ("--lamp-radius", 0.5, "--lamp-samples", 64, "--method", "lightcuts")
    code, out, errors = render(capfd, room, "-o", tmp_path / "a.png", *lamps, "--lightcuts-error", 0.3, "--verify")
    said = " ".join(out.split())
    assert code == 0 and "stand for 128 samples of 2 lights" in said and "by 30 % of the light" in said, errors
    assert "Half of the pixels are wrong by less than" in said
    few = (*lamps, "--lightcuts-nodes", 3, "--view", "cuts")
    code, out, errors = render(capfd, room, "-o", tmp_path / "b.png", *few)
    assert code == 0 and "3 at most" in " ".join(out.split()), errors
    code, _, errors = render(capfd, room, "-o", tmp_path / "c.png", "--method", "none", "--view", "cuts")
    assert code != 0 and "clusters" in errors


def test_slices_and_cells_are_drawn_by_methods_that_have_them(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    path = tmp_path / "slice.png"
    code, out, errors = render(capfd, room, "-o", path, "--view", "voxels:1", "--slice", "x:0.7", "--legend")
    assert code == 0 and "method voxels" in out, errors
    with Image.open(path) as image:
        draw = json.loads(image.text[capture.CHUNK])["state"]["draw"]
    assert (draw["view"], draw["light"], draw["slice"]) == ("voxels", 1, [0, 0.7])
    code, out, _ = run(capfd, "render", path, "--print-command")
    assert code == 0 and "--view voxels:1" in out and "--slice x:0.7" in out
    code, out, errors = render(capfd, room, "-o", path, "--view", "cell-lights", "--range", "0:2")
    assert code == 0 and "method lie-exact" in out, errors
    lazy = "--view", "tree", "--accelerator", "kdtree-lazy", "--method", "none"
    drawn = []
    for more in ((), (), ("--slice", "x:0.9")):
        code, _, errors = render(capfd, room, "-o", path, *lazy, "--legend", *more)
        assert code == 0, errors
        with Image.open(path) as image:
            drawn.append(np.asarray(image))
    assert (drawn[0] == drawn[1]).all() and (drawn[0] != drawn[2]).any()
    for wrong, said in (
        (("--view", "tree"), "bvh8 builds all of its tree before rays come; give --accelerator kdtree-lazy"),
        (("--view", "voxels", "--method", "none"), "not with the method none; give --method voxels"),
        (("--view", "cell-lights", "--method", "paper"), "give --method lie-exact"),
        (("--slice", "x:0.1"), "--slice does nothing in the view color; it is for voxels, tree"),
        (("--view", "voxels", "--slice", "q:0.1"), "is not a slice"),
    ):
        code, _, errors = render(capfd, room, "-o", path, *wrong)
        assert code != 0 and said in errors, errors


def test_what_moves_makes_no_tree_wait(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "room.aff"
    path.write_text(ROOM)
    scene = load_scene(path)
    static = len(scene.objects[0].triangles) + len(scene.objects[0].quadrics)
    assert static < scene.primitive_count
    monkeypatch.setattr(pictures, "LARGE", static - 1)
    pictures.check_tree(Settings(), View.TREE, scene)
    monkeypatch.setattr(pictures, "LARGE", static)
    with pytest.raises(ValueError, match="before rays come"):
        pictures.check_tree(Settings(), View.TREE, scene)


def test_views_of_what_is_wrong_verify_by_themselves(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    drawn = {}
    output = tmp_path / "view.png"
    where = ("figure4", "-o", output, "--size", "128x128", "--threads", 1, "--frame", 20, "--warmup", 20)
    for view in ("difference", "wipe:0", "wipe:1", "wipe:.25", "color"):
        method = ("--method", "paper") if view == "color" else ()  # which views of what is wrong choose by themselves
        code, out, _ = run(capfd, "render", *where, "--view", view, *method)
        assert code == 0 and ("wrong answers" in out) == (view != "color")
        with Image.open(output) as image:
            drawn[view] = np.asarray(image)
            kept = json.loads(image.text[capture.CHUNK])["state"]
        assert kept["settings"]["verify"] is False
        assert kept["draw"]["view"] == view.partition(":")[0]
    assert kept["draw"]["wipe"] == 0.5
    wrong = (drawn["difference"] == (255, 0, 255)).all(axis=-1)
    ring = (drawn["wipe:1"] == (255, 0, 255)).all(axis=-1)
    beneath = np.abs(drawn["difference"] - BENEATH * drawn["color"])[~(ring | wrong)]
    assert wrong.any() and len(beneath) and beneath.max() <= 1
    np.testing.assert_array_equal(drawn["wipe:1"][~ring], drawn["color"][~ring])
    assert (drawn["wipe:0"][wrong] != drawn["color"][wrong]).any(axis=-1).all()
    np.testing.assert_array_equal(drawn["wipe:.25"][:, :32], drawn["wipe:1"][:, :32])
    np.testing.assert_array_equal(drawn["wipe:.25"][:, 33:], drawn["wipe:0"][:, 33:])
    assert run(capfd, "render", *where, "--view", "wipe:1", "--no-marks")[0] == 0
    with Image.open(output) as image:
        np.testing.assert_array_equal(np.asarray(image), drawn["color"])


def test_warm_up_makes_culling_act(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    """The first frame has no history; the third culls."""
    culled = []
    for warm_up in (0, 2):
        output = tmp_path / f"{warm_up}.png"
        given = ("-o", output, "--frame", 4, "--warmup", warm_up, "--method", "paper")
        assert render(capfd, room, *given)[0] == 0
        with Image.open(output) as image:
            image.load()
            culled.append(json.loads(image.text[capture.CHUNK])["statistics"]["shadow"])
    assert culled[0]["culled"] + culled[0]["dynamic_only"] == 0
    assert culled[1]["culled"] + culled[1]["dynamic_only"] > 0


def test_warm_up_is_shorter_where_the_animation_starts(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    code, _, err = render(capfd, room, "-o", tmp_path / "x.png", "--frame", 1, "--warmup", 5)
    assert code == 0
    assert "--warmup 5: only one frame comes before this one" in err


@pytest.mark.parametrize(
    "view",
    ["color", "occlusion", "shadow:1", "primitive", "depth", "normal", "pixel-count"],
)
def test_every_view_makes_a_picture(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, view: str) -> None:
    output = tmp_path / "view.png"
    assert render(capfd, room, "-o", output, "--frame", 2, "--warmup", 2, "--view", view)[0] == 0
    with Image.open(output) as image:
        assert len(image.getcolors(48 * 32) or []) > 3


def test_time_and_frame_are_the_same_moment(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    pixels = []
    for name, moment in (("f", ("--frame", 4)), ("t", ("--time", 4.0))):
        output = tmp_path / f"{name}.png"
        assert render(capfd, room, "-o", output, *moment, "--warmup", 3)[0] == 0
        with Image.open(output) as image:
            pixels.append(np.asarray(image))
    np.testing.assert_array_equal(*pixels)


def test_a_scene_is_known_by_its_name(capfd: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capfd, "info", "default", "--json")
    facts = json.loads(out)
    assert code == 0
    assert facts["triangles"] >= 20_000 and facts["lights"] >= 4 and facts["frames"] == 200
    assert run(capfd, "info", "--json") == (0, out, "")


# --- mistakes --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-o", "OUT/x.gif"], "unknown kind of file"),
        (["-o", "OUT/none/x.png"], "there is no folder"),
        (["-o", "OUT"], "unknown kind of file"),
        (["--buffers", "OUT/x.zip"], "unknown kind of file; --buffers writes .npz"),
        ([], "nothing to write"),
        (["-o", "OUT/x.png", "--frame", "10"], "frame numbers are 0 to 9"),
        (["-o", "OUT/x.png", "--frame", "-1"], "frame numbers are 0 to 9"),
        (["-o", "OUT/x.png", "--frame", "two"], "two is not a whole number"),
        (["-o", "OUT/x.png", "--time", "nan"], "nan is not a number"),
        (["-o", "OUT/x.png", "--time", "9.5"], "time runs from 0 to 9"),
        (["-o", "OUT/x.png", "--frame", "1", "--time", "1"], "not allowed with"),
        (["-o", "OUT/x.png", "--size", "big"], "is not a size"),
        (["-o", "OUT/x.png", "--size", "0x10"], "is not a size"),
        (["-o", "OUT/x.png", "--size", "999999x999999"], "more than"),
        (["-o", "OUT/x.png", "--samples", "0"], "0 is not a whole number from 1 to 4096"),
        (["-o", "OUT/x.png", "--method", "magic"], "invalid choice: 'magic'"),
        (["-o", "OUT/x.png", "--method", "certfied"], "invalid choice: 'certfied': did you mean 'certified'?"),
        (["-o", "OUT/x.png", "--view", "heat"], "'heat' is not a view"),
        (["-o", "OUT/x.png", "--view", "certificat"], "'certificat' is not a view: did you mean certificate:LIGHT?"),
        (
            ["-o", "OUT/x.png", "--view", "fate:0", "--method", "lightcuts"],
            "single lights have no rays; give --method paper",
        ),
        (
            ["-o", "OUT/x.png", "--view", "cuts", "--method", "auto"],
            "auto makes no clusters of lights; give --method light",
        ),
        (["-o", "OUT/x.png", "--view", "shadow:7"], "lights are 0 to 1"),
        (["-o", "OUT/x.png", "--view", "depth:1"], "is not a view"),
        (["-o", "OUT/x.png", "--view", "difference:1"], "is not a view"),
        (["-o", "OUT/x.png", "--view", "wipe:half"], "is not a view; give wipe:PART: half is not a number from 0 to 1"),
        (["-o", "OUT/x.png", "--view", "wipe:1.5"], "1.5 is not a number from 0 to 1"),
        (["-o", "OUT/x.png", "--camera", "{bad"], '--camera: {bad is not JSON; give a camera like {"position"'),
        (["-o", "OUT/x.png", "--camera", "{}"], "--camera: a camera's position"),
        (["-o", "OUT/x.png", "--camera", "nowhere.json"], "neither JSON nor a file"),
        (["-o", "OUT/x.png", "--camera", "[1, 2]"], "neither JSON nor a file"),
        (["-o", "OUT/x.png", "--zoom-factor", "0.5"], "argument --zoom-factor: 0.5 is not a number from 1 up"),
        (["-o", "OUT/x.png", "--zoom-factor", "nan"], "argument --zoom-factor: nan is not a number from"),
        (["-o", "OUT/x.png", "--zoom-factor", "much"], "argument --zoom-factor: much is not a number from"),
        (["-o", "OUT/x.png", "--warm", "3"], "unrecognized arguments"),
        (["-o", "OUT/x.png", "--warmup", "-3"], "-3 is not a whole number from 0 to"),
        (["-o", "OUT/x.png", "--wurmup", "3"], "unrecognized arguments: --wurmup 3: did you mean '--warmup'?"),
        (["-o", "OUT/x.png", "--telepathy"], "unrecognized arguments: --telepathy (see"),
    ],
)
def test_mistakes_end_in_one_line(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, arguments: list[str], said: str
) -> None:
    result = run(capfd, "render", room, *(a.replace("OUT", str(tmp_path)) for a in arguments))
    assert said in complaint(result)
    assert [p.name for p in tmp_path.iterdir()] == ["room.aff"]


def test_errors_in_a_scene_name_file_and_line(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "bad.aff"
    path.write_text("b 0 0 0\ns 0 0 zero 1\n")
    for command in (["info"], ["render", "-o", tmp_path / "x.png"]):
        assert f"{path}:2" in complaint(run(capfd, *command, path))


@pytest.mark.parametrize("command", ["info", "render", "bench", "zoom"])
def test_a_missing_file_is_missed_first(capfd: pytest.CaptureFixture[str], tmp_path: Path, command: str) -> None:
    """Before what else is not given, such as -o."""
    assert "no.aff: no such file" in complaint(run(capfd, command, tmp_path / "no.aff"))
    assert "unknown kind of scene" in complaint(run(capfd, command, ROOT / "README.md"))


def test_a_file_like_it_is_asked_about(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    (room.parent / "rooom.txt").write_text("")
    wrong = room.with_name("rooom.aff")
    assert f"{wrong}: no such file: did you mean '{room}'?" in complaint(run(capfd, "info", wrong))


def test_a_long_name_is_not_broken(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    path = room.parent / f"{'long-' * 20}name.aff"
    room.rename(path)
    code, out, _ = run(capfd, "info", path)
    assert code == 0 and out.splitlines()[0] == str(path)


def test_a_scene_with_nothing_in_it(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "empty.aff"
    path.write_text("v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 hither 1 resolution 8 8\nl 0 1 0\n")
    assert "nothing to see" in complaint(run(capfd, "render", path, "-o", tmp_path / "x.png"))
    assert run(capfd, "info", path, "--json")[0] == 0


def test_an_output_that_cannot_be_written_is_known_before_tracing(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    def trace(*_: object) -> None:
        raise AssertionError("nothing may be traced")

    monkeypatch.setattr(Path, "touch", refuse)
    monkeypatch.setattr("viewer.cli.render.Renderer", trace)
    assert "cannot be written to: Permission denied" in complaint(render(capfd, room, "-o", tmp_path / "x.png"))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["rendr", "x.aff"], "did you mean 'render'?"),
        (["inof"], "did you mean 'info'?"),
        (["info", "figur4"], "figur4: no such file, and no scene of the program: did you mean 'figure4'?"),
        (["frobnicate"], "the commands are render, film, bench"),
        (["--frame", "3"], "unrecognized arguments"),
    ],
)
def test_a_mistyped_command(capfd: pytest.CaptureFixture[str], arguments: list[str], said: str) -> None:
    assert said in complaint(run(capfd, *arguments))


def test_help_shows_examples(capfd: pytest.CaptureFixture[str]) -> None:
    for arguments in (["--help"], ["render", "--help"], ["bench", "--help"], ["zoom", "--help"], ["info", "-h"]):
        code, out, err = run(capfd, *arguments)
        assert (code, err) == (0, "")
        assert "examples:\n  shadowcull" in out


# --- without a display, and stopping ---------------------------------------------------------------


def without_display() -> dict[str, str]:
    return {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}


def shadowcull(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "viewer", *map(str, arguments)]


@pytest.mark.parametrize("stale", [False, True])
def test_the_window_without_a_display(room: Path, stale: bool) -> None:
    environment = without_display() | ({"DISPLAY": ":4711"} if stale else {})
    done = subprocess.run(shadowcull(room), cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "no display" in done.stderr and f"shadowcull render {room}" in done.stderr


@pytest.mark.slow
def test_a_picture_instead_of_the_window(room: Path, tmp_path: Path) -> None:
    """What `make run` does where there is no display."""
    environment = without_display() | {"PYTHONPATH": str(ROOT)}
    command = shadowcull("--or-picture", room)
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr.splitlines()[0] == "shadowcull: no display; rendering to files instead"
    for said in ("out/first-light.png", "out/figure-1.svg", "traversal steps saved, average", "speed-up over none"):
        assert said in done.stdout
    with Image.open(tmp_path / "out/first-light.png") as image:
        assert image.size == (640, 480)
    due = re.search(r"shadow rays due\D*([\d,]+)", done.stdout)
    assert due is not None and due[1] in (tmp_path / "out/figure-1.svg").read_text()


@pytest.mark.slow
def test_ctrl_c_ends_what_is_done_instead_of_the_window(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in set(os.environ) - set(without_display()):
        monkeypatch.delenv(name)
    terminal = Terminal("--or-picture")
    terminal.interrupt_once(r"frame ([2-9]|1\d) of 20")  # which of them are shown depends on the speed
    assert terminal.end() == 130 and "cancelled after" in terminal.said


def test_figure_1_of_a_frame(room: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Alone, or beside a picture; with none it says what would be culled."""
    for method, said in (("paper", ">culled<"), ("none", ">would be culled<"), ("certified", ">Certificates<")):
        file = tmp_path / f"{method}.svg"
        code, out, _ = run(
            capfd, "render", room, "--figure1", file, "--size", "32x24", "--method", method, "--repeat", "1"
        )
        assert code == 0 and out.splitlines()[-1] == str(file)
        due = re.search(r"shadow rays due\D*([\d,]+)", out)
        assert due is not None and f">{due[1]}<" in file.read_text() and said in file.read_text()
    code, _, error = run(capfd, "render", room, "--figure1", tmp_path / "no.png")
    assert code == 1 and "--figure1 writes .svg" in error and error.count("\n") == 1


@pytest.mark.slow
def test_ctrl_c_ends_a_rendering(room: Path, tmp_path: Path) -> None:
    output = tmp_path / "never.png"
    terminal = Terminal("render", str(room), "-o", str(output), "--size", "4000x4000", "--frame", "9", "--warmup", "9")
    terminal.interrupt_once("warming up, frame 1 of 9")
    assert (terminal.end(), terminal.said.splitlines()[-1]) == (130, "shadowcull: cancelled")
    assert not output.exists()


@pytest.mark.slow
def test_output_that_nobody_reads(room: Path) -> None:
    """`shadowcull info ... | true` is no fault to complain of."""
    command = f"{sys.executable} -m viewer info {room} | true"
    done = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, text=True)
    assert done.stderr == ""


def test_a_legend_is_drawn_where_it_is_wanted(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    drawn = {}
    for name, options in (("plain", []), ("legend", ["--legend"])):
        output = tmp_path / f"{name}.png"
        where = ("-o", output, "--size", "320x240", "--view", "occlusion")
        code, _, error = run(capfd, "render", room, *where, *options)
        assert code == 0 and "legend" not in error
        with Image.open(output) as image:
            drawn[name] = np.asarray(image)
    rows, columns = np.nonzero((drawn["plain"] != drawn["legend"]).any(axis=-1))
    assert len(rows) and rows.min() > 60 and columns.max() < 300, "it lies in the lower left corner"
    for size, view, why in (("40x30", "occlusion", "too small"), ("320x240", "color", "needs none")):
        options = ("--size", size, "--view", view, "--legend")
        code, _, error = run(capfd, "render", room, "-o", tmp_path / "none.png", *options)
        assert code == 0 and why in error


def test_exposure_and_tone_are_those_of_the_picture_alone(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    def written(name: str, *options: object) -> tuple[np.ndarray, np.ndarray]:
        path, buffers = tmp_path / f"{name}.png", tmp_path / f"{name}.npz"
        code, _, said = run(capfd, "render", room, "--size", "24x16", "-o", path, "--buffers", buffers, *options)
        assert code == 0, said
        return np.asarray(Image.open(path)), np.load(buffers)["color"]

    plain, traced = written("plain")
    assert np.array_equal(plain, np.round(np.clip(traced, 0.0, 1.0) * 255.0).astype(np.uint8))
    neutral, _ = written("neutral", "--exposure", 0, "--white", 1, "--tone", "none")
    assert np.array_equal(neutral, plain)
    bright, color = written("bright", "--exposure", 1)
    assert np.array_equal(color, traced), "buffers are as they were traced"
    assert np.array_equal(bright, np.round(np.clip(2.0 * traced, 0.0, 1.0) * 255.0).astype(np.uint8))
    marked, _ = written("marked", "--exposure", 5, "--mark-clipped")
    red = (marked == np.round(np.multiply(255.0, TOO_BRIGHT))).all(axis=-1)
    assert red.any() and (32.0 * traced[red] > 1.0).any(axis=-1).all()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--tone", "sepia"), "sepia is not one of none, reinhard, filmic, srgb"),
        (("--exposure", "17"), "17 is not a number from -16 to 16"),
        (("--white", "0"), "0 is not a number from 0.01 to 1000"),
        (("--range", "5:2", "--view", "depth"), "'5:2' is not a range; give the smaller number and the larger one"),
        (("--range", "much", "--view", "depth"), "'much' is not a range"),
        (("--range", "0:5"), "--range does nothing in the view color; it is for depth, saved, cost, lights"),
        (("--range", "0:5", "--view", "cost:share"), "in the view cost:share"),
        (
            ("--exposure", "1", "--view", "normal"),
            "--exposure does nothing in the view normal; it is for color, ",
        ),
        (("--mark-clipped", "--view", "depth"), "--mark-clipped does nothing in the view depth; it is for color, wipe"),
    ],
)
def test_options_of_display_that_cannot_be(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, options: tuple[str, ...], said: str
) -> None:
    code, _, error = run(capfd, "render", room, "-o", tmp_path / "none.png", *options)
    assert code != 0 and said in error and len(error.splitlines()) == 1
    assert not (tmp_path / "none.png").exists()

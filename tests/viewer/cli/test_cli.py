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
from viewer.state.views import View
from viewer.views.color import TOO_BRIGHT

ROOT = Path(__file__).resolve().parents[3]
MAGENTA = (255, 0, 255)


@pytest.fixture
def room(tmp_path: Path) -> Path:
    path = tmp_path / "room.aff"
    path.write_text(ROOM)
    return path


def pixels(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image)


# --- info ------------------------------------------------------------------------------------------


def test_info_says_what_a_scene_holds(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    spheres = "".join(f"lamp sphere at {x} 3 0 radius 0.1 samples 4\n" for x in range(5))
    room.write_text(ROOM + spheres + "lamp dome at 0 0 0 radius 9 samples 1 falloff inverse-square\n")
    code, out, _ = run(capfd, "info", room, "--json")
    facts = json.loads(out)
    assert code == 0
    assert list(facts) == [
        "triangles", "static_triangles", "dynamic_triangles", "spheres", "cones", "lights", "materials",
        "textures", "frames", "time", "bounds", "warnings", "light_kinds", "studio",
    ]  # fmt: skip
    assert (facts["triangles"], facts["dynamic_triangles"], facts["spheres"]) == (3, 1, 1)
    assert (facts["lights"], facts["frames"], facts["time"], facts["studio"]) == (8, 10, [0.0, 9.0], None)
    assert [(k["kind"], k["samples"], k["falloff"], k["lights"]) for k in facts["light_kinds"]] == [
        ("point", 1, "none", 2),
        ("sphere", 4, "none", 5),
        ("dome", 1, "inverse square", 1),
    ]
    code, out, _ = run(capfd, "info", room)
    assert code == 0 and "dynamic triangles" in out and "0 to 9 s" in out
    for said in (r"lights\W+8\W+point", r"sphere, 4 samples\W+5", r"dome, 1 sample, falloff inverse square\W+1"):
        assert re.search(said, out), said
    code, out, _ = run(capfd, "info", "default", "--json")
    facts = json.loads(out)
    assert facts["triangles"] >= 20_000 and facts["lights"] >= 4 and facts["frames"] == 200
    assert run(capfd, "info", "--json") == (0, out, ""), "it is the default"


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


# --- render ----------------------------------------------------------------------------------------


def test_render_writes_a_picture_that_remembers(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    output = tmp_path / "room.png"
    code, out, _ = render(capfd, room, "-o", output, "--frame", 3, "--warmup", 2, "--camera", json.dumps(CAMERA))
    assert code == 0
    assert out.rstrip().endswith(str(output))
    assert "Shadow rays" in out and "All steps" in out
    with Image.open(output) as image:
        assert (image.size, image.mode) == ((48, 32), "RGB")
    kept = capture.read(output)
    assert (Path(kept.scene), kept.time, kept.camera.to_json()) == (room, 3.0, CAMERA)
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]
    code, _, err = render(capfd, room, "-o", tmp_path / "time.png", "--time", 3.0, "--warmup", 5, "--camera", output)
    assert code == 0 and np.array_equal(pixels(tmp_path / "time.png"), pixels(output)), "the same moment"
    assert "--warmup 5: only 3 frames come before this one" in err


def test_buffers_have_the_promised_names_shapes_and_types(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    output = tmp_path / "room.npz"
    assert render(capfd, room, "--buffers", output, "--warmup", 0)[0] == 0
    with np.load(output) as npz:
        arrays = dict(npz)
    image, lights = (32, 48), (32, 48, 2)
    assert {name: (a.shape, a.dtype.name) for name, a in arrays.items()} == {
        "color": ((32, 48, 3), "float32"), "depth": (image, "float32"), "primitive": (image, "int32"),
        "cell": (image, "int32"), "occlusion_mode": (image, "uint8"), "shadow_mode": (lights, "uint8"),
        "lit": (lights, "bool"), "due": (lights, "bool"),
    }  # fmt: skip
    hit = arrays["primitive"] >= 0
    assert hit.any() and not hit.all()
    np.testing.assert_array_equal(np.isfinite(arrays["depth"]), hit)
    np.testing.assert_array_equal(arrays["occlusion_mode"] == 255, ~hit)
    assert not (arrays["lit"] & ~arrays["due"]).any()


@pytest.mark.slow
def test_buffers_that_no_memory_holds_are_refused(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    said = complaint(run(capfd, "render", "courtyard", "--buffers", tmp_path / "a.npz"))
    assert "all buffers with 10,000 lights: not enough memory; make the picture 26,843 pixels at most" in said
    said = complaint(run(capfd, "render", "courtyard", "-o", tmp_path / "lights.png", "--view", "lights"))
    assert "the view lights with 10,000 lights" in said
    assert not list(tmp_path.iterdir())


def test_a_light_among_too_many_is_looked_at_alone(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = []
    for output in (tmp_path / "all.png", tmp_path / "alone.png"):
        assert render(capfd, room, "-o", output, "--view", "penumbra:1", "--lamp-radius", "0.5")[0] == 0
        shown.append(pixels(output))
        monkeypatch.setattr("viewer.state.views.MOST_TOGETHER", 1)
    assert np.array_equal(*shown) and len(np.unique(shown[0].reshape(-1, 3), axis=0)) > 50


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
    wrong = re.search(r"Wrong answers\D*([\d,]+)", out)
    assert wrong is not None and int(wrong[1].replace(",", "")) == arrays["wrong"].sum() > 0


def test_slices_and_cells_are_drawn_by_methods_that_have_them(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    path = tmp_path / "slice.png"
    code, out, errors = render(capfd, room, "-o", path, "--view", "voxels:1", "--slice", "x:0.7", "--legend")
    assert code == 0 and "method voxels" in out, errors
    draw = capture.read(path).draw
    assert (draw.view, draw.light, draw.slice) == ("voxels", 1, (0, 0.7))
    code, out, _ = run(capfd, "render", path, "--print-command")
    assert code == 0 and "--view voxels:1" in out and "--slice x:0.7" in out
    code, out, errors = render(capfd, room, "-o", path, "--view", "cell-lights", "--range", "0:2")
    assert code == 0 and "method lie-exact" in out, errors
    drawn = []
    for more in ((), (), ("--slice", "x:0.9")):
        view = ("--view", "tree", "--accelerator", "kdtree-lazy", "--method", "none", "--legend", *more)
        assert render(capfd, room, "-o", path, *view)[0] == 0
        drawn.append(pixels(path))
    assert (drawn[0] == drawn[1]).all() and (drawn[0] != drawn[2]).any()


def test_what_moves_makes_no_tree_wait(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene(room)
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
        assert code == 0 and ("Wrong answers" in out) == (view != "color")
        drawn[view], kept = pixels(output), capture.read(output)
        assert kept.settings.verify is False and kept.draw.view == view.partition(":")[0]
    wrong = (drawn["difference"] == MAGENTA).all(axis=-1)
    assert wrong.any() and (drawn["wipe:0"][wrong] != drawn["color"][wrong]).any(axis=-1).all()
    np.testing.assert_array_equal(drawn["wipe:.25"][:, :32], drawn["wipe:1"][:, :32])
    np.testing.assert_array_equal(drawn["wipe:.25"][:, 33:], drawn["wipe:0"][:, 33:])
    assert run(capfd, "render", *where, "--view", "wipe:1", "--no-marks")[0] == 0
    np.testing.assert_array_equal(pixels(output), drawn["color"])


@pytest.mark.parametrize("view", ["occlusion", "shadow:1", "primitive", "depth", "normal", "pixel-count", "cuts"])
def test_every_view_makes_a_picture(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, view: str) -> None:
    output = tmp_path / "view.png"
    lamps = ("--lamp-radius", 0.5, "--lamp-samples", 64, "--lightcuts-error", 0.3) if view == "cuts" else ()
    assert render(capfd, room, "-o", output, "--frame", 2, "--warmup", 2, "--view", view, *lamps)[0] == 0
    assert len(np.unique(pixels(output).reshape(-1, 3), axis=0)) > 3


def test_a_legend_is_drawn_where_it_is_wanted(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    output, drawn = tmp_path / "view.png", []
    for size, view, legend, said in (
        ("320x240", "occlusion", (), ""),
        ("320x240", "occlusion", ("--legend",), ""),
        ("40x30", "occlusion", ("--legend",), "no legend: the picture is too small for it"),
        ("320x240", "color", ("--legend",), "no legend: the view color needs none"),
    ):
        code, _, errors = run(capfd, "render", room, "-o", output, "--size", size, "--view", view, *legend)
        assert code == 0 and said in errors and bool(said) == ("legend" in errors)
        drawn.append(pixels(output))
    rows, columns = np.nonzero((drawn[0] != drawn[1]).any(axis=-1))
    assert len(rows) and rows.min() > 60 and columns.max() < 300, "it lies in the lower left corner"


def test_exposure_and_tone_are_those_of_the_picture_alone(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    picture, buffers, colors = tmp_path / "a.png", tmp_path / "a.npz", []
    for exposure, more in ((0, ()), (1, ()), (5, ("--mark-clipped",))):
        given = ("--size", "24x16", "-o", picture, "--buffers", buffers, "--exposure", exposure, *more)
        assert run(capfd, "render", room, *given)[0] == 0
        colors.append(np.load(buffers)["color"])
        assert np.array_equal(colors[0], colors[-1]), "buffers are as they were traced"
        if not more:
            exposed = np.clip(2.0**exposure * colors[0], 0.0, 1.0) * 255.0
            assert np.array_equal(pixels(picture), np.round(exposed).astype(np.uint8))
    red = (pixels(picture) == np.round(np.multiply(255.0, TOO_BRIGHT))).all(axis=-1)
    assert red.any() and (32.0 * colors[0][red] > 1.0).any(axis=-1).all()


def test_figure_1_of_a_frame(room: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Alone, or beside a picture; with none it says what would be culled."""
    for method, said in (("paper", ">culled<"), ("none", ">would be culled<"), ("certified", ">Certificates<")):
        file = tmp_path / f"{method}.svg"
        given = ("--figure1", file, "--size", "32x24", "--method", method, "--repeat", "1")
        code, out, _ = run(capfd, "render", room, *given)
        assert code == 0 and out.splitlines()[-1] == str(file)
        due = re.search(r"Due\D*([\d,]+)", out)
        assert due is not None and f">{due[1]}<" in file.read_text() and said in file.read_text()


# --- mistakes --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-o", "OUT/x.gif"], "unknown kind of file"),
        (["-o", "OUT/none/x.png"], "there is no folder"),
        (["--buffers", "OUT/x.zip"], "unknown kind of file; --buffers writes .npz"),
        (["--figure1", "OUT/x.png"], "--figure1 writes .svg"),
        ([], "nothing to write"),
        (["--frame", "10"], "frame numbers are 0 to 9"),
        (["--frame", "two"], "two is not a whole number"),
        (["--time", "nan"], "nan is not a number"),
        (["--time", "9.5"], "time runs from 0 to 9"),
        (["--frame", "1", "--time", "1"], "not allowed with"),
        (["--size", "big"], "is not a size"),
        (["--size", "999999x999999"], "too many: 67,108,864 at most"),
        (["--samples", "0"], "0 is not a whole number from 1 to 4096"),
        (["--lamp-samples", "2.5"], "argument --lamp-samples: 2.5 is not a whole number from 1 to 1024"),
        (["--method", "magic"], "invalid choice: 'magic'"),
        (["--method", "paper,none"], "invalid choice: 'paper;none'"),
        (["--method", "certfied"], "invalid choice: 'certfied': did you mean 'certified'?"),
        (["--accelerator", "kdtre"], "kdtre is not one of bvh8, kdtree, kdtree-lazy: did you mean 'kdtree'?"),
        (["--view", "heat"], "'heat' is not a view; the views are color, occlusion, shadow"),
        (["--view", "certificat"], "'certificat' is not a view: did you mean certificate:LIGHT?"),
        (["--view", "fate:0", "--method", "lightcuts"], "single lights have no rays; give --method paper"),
        (["--view", "cuts", "--method", "auto"], "the method auto has nothing for it; give --method lightcuts"),
        (["--view", "tree"], "bvh8 builds all of its tree before rays come; give --accelerator kdtree-lazy"),
        (["--view", "voxels", "--method", "none"], "the method none has nothing for it; give --method voxels"),
        (["--view", "shadow:7"], "lights are 0 to 1"),
        (["--view", "depth:1"], "is not a view"),
        (["--view", "wipe:half"], "is not a view; give wipe:PART: half is not a number from 0 to 1"),
        (["--slice", "x:0.1"], "--slice does nothing in the view color; it is for voxels, tree"),
        (["--view", "voxels", "--slice", "q:0.1"], "is not a slice"),
        (["--range", "5:2", "--view", "depth"], "'5:2' is not a range; give the smaller number and the larger one"),
        (["--range", "0:5"], "--range does nothing in the view color; it is for depth, saved, cost, lights"),
        (["--range", "0:5", "--view", "cost:share"], "in the view cost:share"),
        (["--exposure", "1", "--view", "normal"], "--exposure does nothing in the view normal; it is for color, "),
        (["--camera", "{bad"], '--camera: {bad is not JSON; give a camera like {"position"'),
        (["--camera", "{}"], "--camera: a camera's position"),
        (["--camera", json.dumps(CAMERA | {"position": [1e300, 0, 0]})], "a camera's position lies within 1e+09"),
        (["--camera", "nowhere.json"], "neither JSON nor a file"),
        (["--hide", "flier"], "--hide flier: no object of this name; there is "),
        (["--make-static", "flyer"], "'flyer' is not an object and a time"),
        (["--hide-primitive", "9"], "--hide-primitive 9: the scene has the primitives 0 to 3"),
        (["--without-light", "2"], "--without-light 2: the scene's lights are 0 to 1"),
        (["--warm", "3"], "unrecognized arguments"),
        (["--warmup", "-3"], "-3 is not a whole number from 0 to"),
        (["--wurmup", "3"], "unrecognized arguments: --wurmup 3: did you mean '--warmup'?"),
        (["--telepathy"], "unrecognized arguments: --telepathy (see"),
        (["--size", "\x1b]0;title\x07"], r"\x1b]0;title\x07"),
    ],
)
def test_mistakes_end_in_one_line(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path, arguments: list[str], said: str
) -> None:
    output = [] if not arguments or any("OUT" in word for word in arguments) else ["-o", "OUT/x.png"]
    result = run(capfd, "render", room, *(a.replace("OUT", str(tmp_path)) for a in [*output, *arguments]))
    assert said in complaint(result) and "\x1b" not in complaint(result)
    assert [p.name for p in tmp_path.iterdir()] == ["room.aff"]


@pytest.mark.parametrize("command", ["info", "render", "bench", "zoom"])
def test_a_missing_file_is_missed_first(capfd: pytest.CaptureFixture[str], tmp_path: Path, command: str) -> None:
    """Before what else is not given, such as -o."""
    assert "no.aff: no such file" in complaint(run(capfd, command, tmp_path / "no.aff"))
    assert "unknown kind of scene" in complaint(run(capfd, command, ROOT / "README.md"))


def test_errors_in_a_scene_name_file_and_line(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    bad, empty = tmp_path / "bad.aff", tmp_path / "empty.aff"
    bad.write_text("b 0 0 0\ns 0 0 zero 1\n")
    for command in (["info"], ["render", "-o", tmp_path / "x.png"]):
        assert f"{bad}:2" in complaint(run(capfd, *command, bad))
    empty.write_text("v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 hither 1 resolution 8 8\nl 0 1 0\n")
    assert "nothing to see" in complaint(run(capfd, "render", empty, "-o", tmp_path / "x.png"))
    assert run(capfd, "info", empty, "--json")[0] == 0


def test_a_scene_reads_from_its_folder_and_those_that_are_named(
    capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path
) -> None:
    (tmp_path / "scene").mkdir()
    scene = tmp_path / "scene" / "a.aff"
    scene.write_text(f"{ROOM}i 0 ../room.aff\n")
    assert "lies outside of the scene's folder" in complaint(run(capfd, "info", scene))
    assert run(capfd, "info", scene, "--folder", tmp_path)[0] == 0


def test_names_are_neither_broken_nor_obeyed(capfd: pytest.CaptureFixture[str], room: Path, tmp_path: Path) -> None:
    long, red = tmp_path / f"{'long-' * 20}name.aff", tmp_path / "\x1b[31mred.aff"
    long.write_text(ROOM)
    code, out, _ = run(capfd, "info", long)
    assert code == 0 and out.splitlines()[0] == str(long)
    assert "\x1b" not in complaint(run(capfd, "info", red))
    red.write_text(ROOM)
    for result in (run(capfd, "info", red), render(capfd, red, "-o", tmp_path / "\x1b[31mred.png")):
        assert result[0] == 0 and "\x1b" not in result[1] + result[2] and r"\x1b[31mred" in result[1]


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
        (["info", "figur4"], "figur4: no such file, and no scene of the program: did you mean 'figure4'?"),
        (["info", "ROOM/rooom.aff"], "rooom.aff: no such file: did you mean '"),
        (["frobnicate"], "the commands are render, film, bench"),
        (["--frame", "3"], "unrecognized arguments"),
        (["ROOM/room.aff", "--lamp-samples", "0"], "argument --lamp-samples: 0 is not a whole number from 1 to 1024"),
    ],
)
def test_a_mistyped_command(capfd: pytest.CaptureFixture[str], room: Path, arguments: list[str], said: str) -> None:
    assert said in complaint(run(capfd, *(word.replace("ROOM", str(room.parent)) for word in arguments)))


def test_help_shows_examples(capfd: pytest.CaptureFixture[str]) -> None:
    for command in ([], *([name] for name in command_line.COMMANDS)):
        code, out, err = run(capfd, *command, "--help")
        assert (code, err) == (0, "")
        assert "examples:\n  shadowcull" in out


# --- the window, without a display, and stopping ---------------------------------------------------


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
    command = [sys.executable, str(ROOT / "tools/run.py"), str(room)]
    done = subprocess.run(command, cwd=tmp_path, env=without_display(), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr.splitlines()[0] == "shadowcull: no display; rendering to files instead"
    for said in ("out/first-light.png", "out/figure-1.svg", "traversal steps saved, average", "speed-up over none"):
        assert said in done.stdout
    assert pixels(tmp_path / "out/first-light.png").shape == (480, 640, 3)
    due = re.search(r"Due\D*([\d,]+)", done.stdout)
    assert due is not None and due[1] in (tmp_path / "out/figure-1.svg").read_text()


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

"""The command line: what it prints and writes, and how it ends."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from tests.commands import CAMERA, ROOM, Run, pixels, stop_at
from tracer.scene.load import load_scene
from tracer.scene.mesh_options import IN_STUDIO
from viewer.cli import main as command_line
from viewer.output import capture
from viewer.state.palette import BENEATH
from viewer.views.color import TOO_BRIGHT

ROOT = Path(__file__).resolve().parents[3]
MAGENTA = (255, 0, 255)
ROOM_48 = ("render", "room.aff", "--size", "48x32", "--threads", 1)
FIGURE_4 = ("render", "figure4", "--size", "128x128", "--threads", 1, "--frame", 20)
"""Where culling misses a shadow, after the frames before it."""


# --- info ------------------------------------------------------------------------------------------


def test_info_says_what_a_scene_holds(run: Run) -> None:
    spheres = "".join(f"lamp sphere at {x} 3 0 radius 0.1 samples 4\n" for x in range(5))
    Path("room.aff").write_text(ROOM + spheres + "lamp dome at 0 0 0 radius 9 samples 1 falloff inverse-square\n")
    facts = json.loads(run.ok("info", "room.aff", "--json"))
    assert list(facts) == [
        "triangles", "static_triangles", "dynamic_triangles", "spheres", "cones", "lights", "materials",
        "textures", "frames", "time", "bounds", "warnings", "light_kinds", "studio",
    ]  # fmt: skip
    assert (facts["triangles"], facts["dynamic_triangles"], facts["spheres"]) == (3, 1, 1)
    assert (facts["lights"], facts["frames"], facts["time"], facts["studio"]) == (8, 10, [0.0, 9.0], None)
    assert [(k["kind"], k["samples"], k["falloff"], k["lights"]) for k in facts["light_kinds"]] == [
        ("point", 1, "none", 2), ("sphere", 4, "none", 5), ("dome", 1, "inverse square", 1),
    ]  # fmt: skip
    out = run.ok("info", "room.aff")
    assert "dynamic triangles" in out and "0 to 9 s" in out
    for said in (r"lights\W+8\W+point", r"sphere, 4 samples\W+5", r"dome, 1 sample, falloff inverse square\W+1"):
        assert re.search(said, out), said
    out = run.ok("info", "default", "--json")
    facts = json.loads(out)
    assert facts["triangles"] >= 20_000 and facts["lights"] >= 4 and facts["frames"] == 200
    assert run("info", "--json") == (0, out, ""), "it is the default"


@pytest.mark.parametrize("ending", [".obj", ".stl", ".glb"])
def test_info_says_what_a_studio_adds(run: Run, ending: str) -> None:
    path, model = Path(f"ball{ending}"), trimesh.Scene(trimesh.creation.icosphere(subdivisions=1))
    model.export(path)
    facts = json.loads(run.ok("info", path, "--json"))
    shown = load_scene(path, meshes=IN_STUDIO)
    assert facts["triangles"] + facts["studio"]["triangles"] == shown.triangle_count
    assert facts["studio"]["lights"] == len(shown.lights) != facts["lights"]
    assert "a studio adds 2 triangles, and 3 lamps in place of these lights" in run.ok("info", path)
    if ending == ".glb":  # which may have a camera
        model.camera_transform = trimesh.transformations.translation_matrix((0, 0, 5))
        model.export(path)
        assert "a studio adds" not in run.ok("info", path)


# --- render ----------------------------------------------------------------------------------------


def test_render_writes_a_picture_that_remembers(run: Run) -> None:
    out = run.ok(*ROOM_48, "-o", "room.png", "--frame", 3, "--warmup", 2, "--camera", json.dumps(CAMERA))
    assert out.rstrip().endswith("room.png") and "Shadow rays" in out and "All steps" in out
    with Image.open("room.png") as image:
        assert (image.size, image.mode) == ((48, 32), "RGB")
    kept = capture.read(Path("room.png"))
    assert (Path(kept.scene), kept.time, kept.camera.to_json()) == (Path("room.aff").resolve(), 3.0, CAMERA)
    assert {path.name for path in Path().iterdir()} == {"room.aff", "room.png"}
    code, _, err = run(*ROOM_48, "-o", "time.png", "--time", 3.0, "--warmup", 5, "--camera", "room.png")
    assert code == 0 and np.array_equal(pixels("time.png"), pixels("room.png")), "the same moment"
    assert "--warmup 5: only 3 frames come before this one" in err


def test_buffers_have_the_promised_names_shapes_and_types(run: Run) -> None:
    run.ok(*ROOM_48, "--buffers", "room.npz", "--warmup", 0)
    with np.load("room.npz") as npz:
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


def test_buffers_that_no_memory_holds_are_refused(run: Run) -> None:
    Path("room.aff").write_text(ROOM + 9_998 * "l 0 5 0 0.01 0.01 0.01\n")
    said = run.fails("render", "room.aff", "--buffers", "a.npz", "--size", "640x480")
    assert "all buffers with 10,000 lights: not enough memory; make the picture 26,843 pixels at most" in said
    said = run.fails("render", "room.aff", "-o", "lights.png", "--view", "lights", "--size", "640x480")
    assert "the view lights with 10,000 lights" in said
    assert [path.name for path in Path().iterdir()] == ["room.aff"]


def test_a_light_among_too_many_is_looked_at_alone(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for output in ("all.png", "alone.png"):
        run.ok(*ROOM_48, "-o", output, "--view", "penumbra:1", "--lamp-radius", "0.5")
        monkeypatch.setattr("viewer.state.views.MOST_TOGETHER", 1)
    shown = pixels("alone.png")
    assert np.array_equal(pixels("all.png"), shown) and len(np.unique(shown.reshape(-1, 3), axis=0)) > 50


def test_verified_buffers_say_what_is_wrong(run: Run) -> None:
    out = run.ok(*FIGURE_4, "--buffers", "paper.npz", "--warmup", 20, "--verify", "--method", "paper")
    run.ok(*FIGURE_4, "--buffers", "none.npz", "--method", "none")
    with np.load("paper.npz") as npz, np.load("none.npz") as none:
        arrays = dict(npz)
        np.testing.assert_array_equal(arrays["reference"], none["color"])
        assert "reference" not in none and "wrong" not in none
    assert (arrays["wrong"].shape, arrays["wrong"].dtype.name) == ((128, 128), "int32")
    differs = (arrays["color"] != arrays["reference"]).any(axis=-1)
    np.testing.assert_array_equal(arrays["wrong"] > 0, differs)
    wrong = re.search(r"Wrong answers\D*([\d,]+)", out)
    assert wrong is not None and int(wrong[1].replace(",", "")) == arrays["wrong"].sum() > 0


def test_views_are_drawn_by_methods_that_have_them(run: Run) -> None:
    out = run.ok(*ROOM_48, "-o", "slice.png", "--view", "voxels:1", "--slice", "x:0.7", "--legend")
    draw = capture.read(Path("slice.png")).draw
    assert "method voxels" in out and (draw.view, draw.light, draw.slice) == ("voxels", 1, (0, 0.7))
    out = run.ok("render", "slice.png", "--print-command")
    assert "--view voxels:1" in out and "--slice x:0.7" in out
    assert "method lie-exact" in run.ok(*ROOM_48, "-o", "lights.png", "--view", "cell-lights", "--range", "0:2")
    lamps = ("--lamp-radius", 0.5, "--lamp-samples", 64, "--lightcuts-error", 0.3)
    for view, more in (("primitive", ()), ("pixel-count", ()), ("cuts", lamps)):
        run.ok(*ROOM_48, "-o", f"{view}.png", "--frame", 2, "--warmup", 2, "--view", view, *more)
        assert len(np.unique(pixels(f"{view}.png").reshape(-1, 3), axis=0)) > 3


def test_views_of_what_is_wrong_verify_by_themselves(run: Run) -> None:
    drawn, where = {}, (*FIGURE_4, "-o", "view.png", "--warmup", 20)
    for view in ("difference", "wipe:0", "wipe:1", "wipe:.25", "color"):
        method = ("--method", "paper") if view == "color" else ()  # which views of what is wrong choose by themselves
        assert ("Wrong answers" in run.ok(*where, "--view", view, *method)) == (view != "color")
        drawn[view], kept = pixels("view.png"), capture.read(Path("view.png"))
        assert kept.settings.verify is False and kept.draw.view == view.partition(":")[0]
    wrong, ring = ((drawn[view] == MAGENTA).all(axis=-1) for view in ("difference", "wipe:1"))
    beneath = np.abs(drawn["difference"] - BENEATH * drawn["color"])[~(ring | wrong)]
    assert wrong.any() and len(beneath) and beneath.max() <= 1
    np.testing.assert_array_equal(drawn["wipe:1"][~ring], drawn["color"][~ring])
    assert (drawn["wipe:0"][wrong] != drawn["color"][wrong]).any(axis=-1).all()
    np.testing.assert_array_equal(drawn["wipe:.25"][:, :32], drawn["wipe:1"][:, :32])
    np.testing.assert_array_equal(drawn["wipe:.25"][:, 33:], drawn["wipe:0"][:, 33:])
    run.ok(*where, "--view", "wipe:1", "--no-marks")
    np.testing.assert_array_equal(pixels("view.png"), drawn["color"])


def test_warm_up_makes_culling_act(run: Run) -> None:
    """The first frame has no history; the third culls."""
    saved = []
    for warm_up in (0, 2):
        run.ok(*ROOM_48, "-o", "a.png", "--frame", 4, "--warmup", warm_up, "--method", "paper")
        shadow = capture.read_carried(Path("a.png")).statistics["shadow"]
        saved.append(shadow["culled"] + shadow["dynamic_only"])
    assert saved[0] == 0 < saved[1]


def test_a_legend_is_drawn_where_it_is_wanted(run: Run) -> None:
    drawn = []
    for size, view, legend, said in (
        ("320x240", "occlusion", (), ""),
        ("320x240", "occlusion", ("--legend",), ""),
        ("40x30", "occlusion", ("--legend",), "no legend: the picture is too small for it"),
        ("320x240", "color", ("--legend",), "no legend: the view color needs none"),
    ):
        code, _, errors = run("render", "room.aff", "-o", "view.png", "--size", size, "--view", view, *legend)
        assert code == 0 and said in errors and bool(said) == ("legend" in errors)
        drawn.append(pixels("view.png"))
    rows, columns = np.nonzero((drawn[0] != drawn[1]).any(axis=-1))
    assert len(rows) and rows.min() > 60 and columns.max() < 300, "it lies in the lower left corner"


def test_exposure_and_tone_are_those_of_the_picture_alone(run: Run) -> None:
    colors = []
    for exposure, more in ((0, ()), (1, ()), (5, ("--mark-clipped",))):
        outputs = ("-o", "a.png", "--buffers", "a.npz")
        run.ok("render", "room.aff", "--size", "24x16", *outputs, "--exposure", exposure, *more)
        colors.append(np.load("a.npz")["color"])
        assert np.array_equal(colors[0], colors[-1]), "buffers are as they were traced"
        if not more:
            exposed = np.clip(2.0**exposure * colors[0], 0.0, 1.0) * 255.0
            assert np.array_equal(pixels("a.png"), np.round(exposed).astype(np.uint8))
    red = (pixels("a.png") == np.round(np.multiply(255.0, TOO_BRIGHT))).all(axis=-1)
    assert red.any() and (32.0 * colors[0][red] > 1.0).any(axis=-1).all()


def test_figure_1_of_a_frame(run: Run) -> None:
    """Alone, or beside a picture; with none it says what would be culled."""
    for method, said in (("paper", ">culled<"), ("none", ">would be culled<"), ("certified", ">Certificates<")):
        file = Path(f"{method}.svg")
        out = run.ok("render", "room.aff", "--figure1", file, "--size", "32x24", "--method", method, "--repeat", "1")
        due = re.search(r"Due\D*([\d,]+)", out)
        assert out.splitlines()[-1] == str(file)
        assert due is not None and f">{due[1]}<" in file.read_text() and said in file.read_text()


# --- the window, without a display, and stopping ---------------------------------------------------


def test_the_window_is_given_the_lamps(monkeypatch: pytest.MonkeyPatch) -> None:
    opened = []

    def open_window(scene: Path | None, settings: dict[str, object], *folders_and_meshes: object) -> int:
        opened.append((scene, settings))
        assert folders_and_meshes == ([], IN_STUDIO)
        return 0

    monkeypatch.setattr("viewer.cli.main.has_display", lambda: True)
    for arguments in (["room.aff", "--lamp-radius", "0.1", "--lamp-samples", "9"], ["--lamp-radius", "0"], []):
        assert command_line.main(arguments, open_window) == 0
    lamps = {"lamp_radius": 0.1, "lamp_samples": 9}
    assert opened == [(Path("room.aff"), lamps), (None, {"lamp_radius": 0.0}), (None, {})]


def test_the_window_without_a_display(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    for stale in ("", ":4711"):
        monkeypatch.setenv("DISPLAY", stale)
        code, _, said = run("room.aff")
        assert code == 2 and said.count("\n") == 1
        assert "no display" in said and "shadowcull render room.aff" in said


@pytest.mark.slow
def test_a_picture_instead_of_the_window(room: Path) -> None:
    """What `make run` does where there is no display; Ctrl-C ends the measuring that comes last."""
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    command, unbuffered = [sys.executable, str(ROOT / "tools/run.py"), str(room)], {"PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(command, env=environment | unbuffered, stdout=-1, stderr=-1, text=True)
    assert process.stdout is not None
    printed = list(iter(process.stdout.readline, "out/figure-1.svg\n"))
    time.sleep(0.5)  # until it measures, which takes longer
    process.send_signal(signal.SIGINT)
    said = process.communicate()[1]
    assert process.returncode == 130 and "cancelled" in said and "Traceback" not in said, said
    assert said.splitlines()[0] == "shadowcull: no display; rendering to files instead"
    out = "".join(printed)
    assert printed[-1] == "out/first-light.png\n" and "Shadow rays" in out
    assert pixels("out/first-light.png").shape == (480, 640, 3)
    due = re.search(r"Due\D*([\d,]+)", out)
    assert due is not None and due[1] in Path("out/figure-1.svg").read_text()


def test_ctrl_c_ends_a_rendering_within_a_frame(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    stop_at(monkeypatch, lambda label, done: label.startswith("warming up, frame 1 of 9"))
    began = time.monotonic()
    said = run("render", "room.aff", "-o", "never.png", "--size", "4000x4000", "--frame", 9, "--warmup", 9)
    assert said == (130, "", "shadowcull: cancelled\n") and not Path("never.png").exists()
    assert time.monotonic() - began < 10.0


@pytest.mark.slow
def test_output_that_nobody_reads(room: Path) -> None:
    """`shadowcull info ... | true` is no fault to complain of."""
    command = f"{sys.executable} -m viewer info {room} | true"
    done = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, text=True)
    assert done.stderr == ""

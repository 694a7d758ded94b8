"""Mistakes on the command line: each ends in one line, and nothing is written."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.commands import CAMERA, ROOM, complaint, render, run
from viewer.cli import main as command_line

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-o", "OUT/x.gif"], "unknown kind of file"),
        (["-o", "OUT/none/x.png"], "there is no folder"),
        (["-o", "OUT"], "unknown kind of file"),
        (["--buffers", "OUT/x.zip"], "unknown kind of file; --buffers writes .npz"),
        (["--figure1", "OUT/x.png"], "--figure1 writes .svg"),
        ([], "nothing to write"),
        (["--frame", "10"], "frame numbers are 0 to 9"),
        (["--frame", "-1"], "frame numbers are 0 to 9"),
        (["--frame", "two"], "two is not a whole number"),
        (["--time", "nan"], "nan is not a number"),
        (["--time", "9.5"], "time runs from 0 to 9"),
        (["--frame", "1", "--time", "1"], "not allowed with"),
        (["--size", "big"], "is not a size"),
        (["--size", "0x10"], "is not a size"),
        (["--size", "999999x999999"], "too many: 67,108,864 at most"),
        (["--samples", "0"], "0 is not a whole number from 1 to 4096"),
        (["--lamp-radius", "-0.1"], "argument --lamp-radius: -0.1 is not a number from 0 up"),
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
        (["--view", "cell-lights", "--method", "paper"], "give --method lie-exact"),
        (["--view", "shadow:7"], "lights are 0 to 1"),
        (["--view", "depth:1"], "is not a view"),
        (["--view", "wipe:half"], "is not a view; give wipe:PART: half is not a number from 0 to 1"),
        (["--slice", "x:0.1"], "--slice does nothing in the view color; it is for voxels, tree"),
        (["--view", "voxels", "--slice", "q:0.1"], "is not a slice"),
        (["--tone", "sepia"], "sepia is not one of none, reinhard, filmic, srgb"),
        (["--white", "0"], "0 is not a number from 0.01 to 1000"),
        (["--range", "5:2", "--view", "depth"], "'5:2' is not a range; give the smaller number and the larger one"),
        (["--range", "0:5"], "--range does nothing in the view color; it is for depth, saved, cost, lights"),
        (["--range", "0:5", "--view", "cost:share"], "in the view cost:share"),
        (["--exposure", "1", "--view", "normal"], "--exposure does nothing in the view normal; it is for color, "),
        (["--mark-clipped", "--view", "depth"], "--mark-clipped does nothing in the view depth; it is for color, wipe"),
        (["--camera", "{bad"], '--camera: {bad is not JSON; give a camera like {"position"'),
        (["--camera", "{}"], "--camera: a camera's position"),
        (["--camera", json.dumps(CAMERA | {"position": [1e300, 0, 0]})], "a camera's position lies within 1e+09"),
        (["--camera", "nowhere.json"], "neither JSON nor a file"),
        (["--hide", "flier"], "--hide flier: no object of this name; there is "),
        (["--make-static", "flyer"], "'flyer' is not an object and a time"),
        (["--hide-primitive", "9"], "--hide-primitive 9: the scene has the primitives 0 to 3"),
        (["--make-static", "room=1"], "no moving object of this name; there is flyer"),
        (["--make-moving", "flyer"], "no static object of this name"),
        (["--move-light", "0"], "give them like 2=1.5,3,-0.5"),
        (["--move-light", "0=1.1e9,0,5"], "a place within 1e+09 of the origin"),
        (["--move-light", "0=nan,0,5"], "a place within 1e+09 of the origin"),
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

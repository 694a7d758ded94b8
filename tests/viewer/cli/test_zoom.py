"""The command `zoom`, from its words to its files."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from PIL import Image

from tests.commands import complaint, run
from tests.terminal import Terminal
from tracer.experiments.zoom import STILL_FRAMES
from viewer.__main__ import main
from viewer.state.plans import parse_factors

FIGURE_4 = ["zoom", "figure4", "--primitive", "0", "--size", "128x128", "--threads", "1"]


def test_figure_4_in_tables_and_files(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """With factor 4 the shadow comes when the primitive is examined again; with 64 it is missing to the end."""
    files = {kind: tmp_path / f"zoom.{kind}" for kind in ("json", "csv", "png")}
    outputs = ["--json", files["json"], "--csv", files["csv"], "--plot", files["png"]]
    assert main([*FIGURE_4, "--factors", "4,64", "--steps", "20", "--lamp-radius", "0", *map(str, outputs)]) == 0
    out, err = capfd.readouterr()
    assert err == ""

    results = json.loads(files["json"].read_text())
    assert (results["lamp_radius"], results["lamp_samples"]) == (0.0, None)
    four, sixty_four = results["approaches"]
    assert [a["factor"] for a in (four, sixty_four)] == [4.0, 64.0]
    wrong = [[step["wrong_of_primitive"] for step in a["steps"]] for a in (four, sixty_four)]
    anew = next(s["number"] for s in four["steps"] if {"light": None, "before": "FULLY_RENDERED", "after": "INIT"}
                in s["changes"])  # fmt: skip
    assert wrong[0][anew] > 0 and not any(wrong[0][anew + 1 :])
    assert wrong[1][-1] > 0 and wrong[1] == sorted(wrong[1])

    rows = list(csv.DictReader(files["csv"].open()))
    assert len(rows) == 2 * (STILL_FRAMES + 20)
    assert [int(row["wrong_of_primitive"]) for row in rows] == wrong[0] + wrong[1]
    assert rows[anew + 1]["shadow_0"] == "PARTIAL_SHADOW"
    assert rows[anew + 1]["changes"] == "init → fully rendered; light 0: non shadow → partial shadow"

    lines = out.splitlines()
    assert any(f" {anew} │" in line and " init " in line for line in lines)
    assert not any(line.strip("│ ").startswith("64") and "→ init" in line for line in lines), (
        "it is never examined anew"
    )
    with Image.open(files["png"]) as plot:
        assert plot.size == (1920, 1080)


def test_a_pixel_chooses_the_primitive_and_a_camera_the_start(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    camera = json.dumps({"position": [0, 0, 10], "direction": [0, 0, -1], "angle": 30})
    place = ["--pixel", "16,16", "--camera", camera, "--size", "32x32", "--steps", "2", "--factors", "4"]
    assert main(["zoom", "figure4", *place, "--ratio", "0.5", "--json", str(tmp_path / "z.json")]) == 0
    results = json.loads((tmp_path / "z.json").read_text())
    assert results["primitive"] == 0
    distances = [step["distance"] for step in results["approaches"][0]["steps"]]
    assert distances == pytest.approx([10.0] * STILL_FRAMES + [5.0, 2.5], rel=1e-5)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--primitive", "7"], "the scene's are 0 to 1"),
        (["--primitive", "1", "--camera", '{"position": [0, 0, 20], "direction": [0, 0, 1]}'], "is not to be seen"),
        (["--pixel", "0,0"], "shows no primitive"),
        (["--primitive", "0", "--frame", "99"], "frame numbers are 0 to 59"),
        ([], "towards which primitive? give --pixel X,Y"),
        (["--primitive", "-1"], "-1 is not a whole number from 0"),
        (["--pixel", "middle"], "is not a pixel"),
        (["--primitive", "0", "--pixel", "1,1"], "not allowed with"),
        (["--primitive", "0", "--factors", "4,zero"], "not zoom factors"),
        (["--primitive", "0", "--ratio", "1.5"], "argument --ratio: 1.5 is not a number from 0.001 to 0.9999"),
        (["--primitive", "0", "--zoom-factor", "4"], "unrecognized arguments"),
        (["--pixel", "32,0"], "32 × 32 pixels"),
        (["--primitive", "0", "--ratio", "0.5", "--steps", "50"], "go fewer"),
        (["--primitive", "0", "--factors", "2,3,4,5,6,7,8"], "these are 7 zoom factors; give 6 at most"),
        (["--primitive", "0", "--plot", "OUT/plot.gif"], "unknown kind of plot"),
        (["--primitive", "0", "--json", "OUT/none/z.json"], "there is no folder"),
        (["--primitive", "0", "--json", "OUT/z", "--csv", "OUT/z"], "a file of its own"),
    ],
)
def test_mistakes_end_in_one_line_and_before_any_work_where_words_alone_tell(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, arguments: list[str], said: str
) -> None:
    def work(*_: object) -> None:
        raise AssertionError("nothing may be read or traced")

    of_scene = ("the scene's", "to be seen", "shows no", "frame numbers")
    if not any(words in said for words in of_scene):
        monkeypatch.setattr("viewer.cli.options.load_visible_scene", work)
    words = [a.replace("OUT", str(tmp_path)) for a in arguments]
    assert said in complaint(run(capfd, "zoom", "figure4", "--size", "32x32", *words))
    assert not list(tmp_path.iterdir())


def test_a_primitive_that_is_not_there_is_known_before_any_tracing(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(*_: object) -> None:
        raise AssertionError("nothing may be compiled or traced")

    monkeypatch.setattr("viewer.cli.options.prepare_kernels", work)
    line = complaint(run(capfd, "zoom", "figure4", "--primitive", "7"))
    assert "there is no primitive 7; the scene's are 0 to 1" in line


def test_ctrl_c_keeps_the_steps_that_are_done(tmp_path: Path) -> None:
    output = tmp_path / "zoom.json"
    terminal = Terminal(*FIGURE_4, "--ratio", "0.9999", "--steps", "9999", "--json", str(output))
    terminal.interrupt_once(r"step ([3-9]|\d{2,})\b")
    assert terminal.end() == 130
    steps = json.loads(output.read_text())["approaches"][0]["steps"]
    assert 3 < len(steps) < 9999
    assert f"cancelled after {len(steps)} of " in terminal.said
    assert "128 × 128, 0.000 s, towards primitive 0" in terminal.said


@pytest.mark.parametrize(
    ("text", "factors"), [("4", [4.0]), ("4,16", [4.0, 16.0]), (" 4, 2.5 ,4", [4.0, 2.5]), ("9 25", [9.0, 25.0])]
)
def test_factors_are_read_as_people_type_them(text: str, factors: list[float]) -> None:
    assert parse_factors(text) == factors


@pytest.mark.parametrize("text", ["", "four", "4,,x", "nan", "inf", "0", "-4"])
def test_what_are_no_factors(text: str) -> None:
    with pytest.raises(ValueError, match="not zoom factors"):
        parse_factors(text)


def test_a_primitive_never_seen_whole_is_told(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """The figure's edge cuts through it in every step."""
    camera = '{"position": [0, 0, 1], "direction": [0, 0, -1], "angle": 20}'
    aim = ["--primitive", "0", "--camera", camera, "--steps", "2"]
    assert main(["zoom", "figure4", "--size", "32x32", *aim]) == 0
    assert "primitive 0: never fully rendered, so it" in capfd.readouterr().err

"""The command `zoom`, from its words to its files."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from PIL import Image

from tests.commands import complaint, run
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
    assert rows[anew + 1]["changes"] == "init → fully rendered; light 0: non-shadow → partial shadow"

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


READ, TRACED = "viewer.cli.options.load_visible_scene", "viewer.cli.options.prepare_kernels"


@pytest.mark.parametrize(
    ("arguments", "said", "never"),
    [
        ([], "towards which primitive? give --pixel X,Y", READ),
        (["--primitive", "-1"], "-1 is not a whole number from 0", READ),
        (["--pixel", "middle"], "is not a pixel", READ),
        (["--primitive", "0", "--pixel", "1,1"], "not allowed with", READ),
        (["--primitive", "0", "--factors", "4,zero"], "not zoom factors", READ),
        (["--primitive", "0", "--ratio", "1.5"], "argument --ratio: 1.5 is not a number from 0.001 to 0.9999", READ),
        (["--primitive", "0", "--zoom-factor", "4"], "unrecognized arguments", READ),
        (["--pixel", "32,0"], "32 × 32 pixels", READ),
        (["--primitive", "0", "--ratio", "0.5", "--steps", "50"], "go fewer", READ),
        (["--primitive", "0", "--factors", "2,3,4,5,6,7,8"], "these are 7 zoom factors; give 6 at most", READ),
        (["--primitive", "0", "--json", "gone/z.json"], "there is no folder", READ),
        (["--primitive", "7"], "there is no primitive 7; the scene's are 0 to 1", TRACED),
        (["--primitive", "0", "--frame", "99"], "frame numbers are 0 to 59", TRACED),
        (["--primitive", "1", "--camera", '{"position": [0, 0, 20], "direction": [0, 0, 1]}'], "is not to be seen", ""),
        (["--pixel", "0,0"], "shows no primitive", ""),
    ],
)
def test_mistakes_end_in_one_line_and_before_any_work_where_words_alone_tell(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, arguments: list[str], said: str, never: str
) -> None:
    def work(*_: object) -> None:
        raise AssertionError(never)

    if never:
        monkeypatch.setattr(never, work)
    assert said in complaint(run(capfd, "zoom", "figure4", "--size", "32x32", *arguments))


def test_factors_are_read_as_people_type_them() -> None:
    read = {"4": [4.0], "4,16": [4.0, 16.0], " 4, 2.5 ,4": [4.0, 2.5], "9 25": [9.0, 25.0]}
    assert {text: parse_factors(text) for text in read} == read
    for text in ("", "four", "4,,x", "nan", "inf", "0", "-4"):
        with pytest.raises(ValueError, match="not zoom factors"):
            parse_factors(text)


def test_a_primitive_never_seen_whole_is_told(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """The figure's edge cuts through it in every step."""
    camera = '{"position": [0, 0, 1], "direction": [0, 0, -1], "angle": 20}'
    aim = ["--primitive", "0", "--camera", camera, "--steps", "2"]
    assert main(["zoom", "figure4", "--size", "32x32", *aim]) == 0
    assert "primitive 0: never fully rendered, so it" in capfd.readouterr().err

"""The command `zoom`, from its words to its files."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from PIL import Image

from tests.commands import Run
from tracer.experiments.zoom import STILL_FRAMES
from viewer.state.plans import parse_factors

FIGURE_4 = ["zoom", "figure4", "--primitive", "0", "--size", "128x128", "--threads", "1"]


def test_figure_4_in_tables_and_files(run: Run) -> None:
    """With factor 4 the shadow comes when the primitive is examined again; with 64 it is missing to the end."""
    files = {kind: Path(f"zoom.{kind}") for kind in ("json", "csv", "png")}
    outputs = ["--json", files["json"], "--csv", files["csv"], "--plot", files["png"]]
    code, out, err = run(*FIGURE_4, "--factors", "4,64", "--steps", "20", "--lamp-radius", "0", *outputs)
    assert (code, err) == (0, "")

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
    examined = [line for line in lines if line.strip("│ ").startswith("64") and "→ init" in line]
    assert not examined, "it is never examined anew"
    with Image.open(files["png"]) as plot:
        assert plot.size == (1920, 1080)


def test_a_pixel_chooses_the_primitive_and_a_camera_the_start(run: Run) -> None:
    camera = json.dumps({"position": [0, 0, 10], "direction": [0, 0, -1], "angle": 30})
    place = ["--pixel", "16,16", "--camera", camera, "--size", "32x32", "--steps", "2", "--factors", "4"]
    run.ok("zoom", "figure4", *place, "--ratio", "0.5", "--json", "z.json")
    results = json.loads(Path("z.json").read_text())
    assert results["primitive"] == 0
    distances = [step["distance"] for step in results["approaches"][0]["steps"]]
    assert distances == pytest.approx([10.0] * STILL_FRAMES + [5.0, 2.5], rel=1e-5)


def test_factors_are_read_as_people_type_them() -> None:
    read = {"4": [4.0], "4,16": [4.0, 16.0], " 4, 2.5 ,4": [4.0, 2.5], "9 25": [9.0, 25.0]}
    assert {text: parse_factors(text) for text in read} == read
    for text in ("", "four", "4,,x", "nan", "inf", "0", "-4"):
        with pytest.raises(ValueError, match="not zoom factors"):
            parse_factors(text)


def test_a_primitive_never_seen_whole_is_told(run: Run) -> None:
    """The figure's edge cuts through it in every step."""
    camera = '{"position": [0, 0, 1], "direction": [0, 0, -1], "angle": 20}'
    aim = ["--primitive", "0", "--camera", camera, "--steps", "2"]
    code, _, err = run("zoom", "figure4", "--size", "32x32", *aim)
    assert code == 0 and "primitive 0: never fully rendered, so it" in err

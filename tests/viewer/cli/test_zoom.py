"""The command `zoom`, from its words to its files."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.sweeps import cases
from tests.terminal import Terminal
from tracer.experiments.zoom import STILL_FRAMES, Approach, Change, Results, Step
from tracer.scene.model import Camera
from viewer.__main__ import main
from viewer.output import figures
from viewer.output.reports import changes_in_words, happenings, modes_in_words
from viewer.output.run_figures import zoom_figure
from viewer.state.plans import MOST_FACTORS, parse_factors

ROOT = Path(__file__).resolve().parents[3]
FIGURE_4 = ["zoom", "figure4", "--primitive", "0", "--size", "128x128", "--threads", "1"]


def complaint(capfd: pytest.CaptureFixture[str], *arguments: object) -> str:
    """The one line that a failed command says."""
    try:
        code = main([str(a) for a in arguments])
    except SystemExit as end:
        code = int(end.code or 0)
    out, err = capfd.readouterr()
    assert code != 0 and out == ""
    assert err.startswith("shadowcull: error: ") and err.count("\n") == 1, err
    return err


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
    assert any(f" {anew} │" in line and line.rstrip("│ ").endswith(" init") for line in lines)
    assert any(line.strip("│ ").startswith("4 ") and f"step {wrong[0].index(2)} to {anew}" in line for line in lines)
    assert any(line.strip("│ ").startswith("64") and "never" in line for line in lines)
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
        ([], "towards which primitive? give --pixel X,Y"),
        (["--primitive", "7"], "the scene's are 0 to 1"),
        (["--primitive", "1", "--camera", '{"position": [0, 0, 20], "direction": [0, 0, 1]}'], "is not to be seen"),
        (["--primitive", "-1"], "-1 is not a whole number from 0"),
        (["--pixel", "0,0"], "shows no primitive"),
        (["--pixel", "middle"], "is not a pixel"),
        (["--primitive", "0", "--pixel", "1,1"], "not allowed with"),
        (["--primitive", "0", "--factors", "4,zero"], "not zoom factors"),
        (["--primitive", "0", "--factors", "0.5"], "not zoom factors"),
        (["--primitive", "0", "--ratio", "1.5"], "argument --ratio: 1.5 is not a number from 0.001 to 0.9999"),
        (["--primitive", "0", "--frame", "99"], "frame numbers are 0 to 59"),
        (["--primitive", "0", "--zoom-factor", "4"], "unrecognized arguments"),
    ],
)
def test_mistakes_end_in_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    words = [a.replace("OUT", str(tmp_path)) for a in arguments]
    assert said in complaint(capfd, "zoom", "figure4", "--size", "32x32", *words)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--pixel", "32,0"], "32 × 32 pixels"),
        (["--primitive", "0", "--ratio", "0.5", "--steps", "50"], "go fewer"),
        (["--primitive", "0", "--factors", "2,3,4,5,6,7,8"], "these are 7 zoom factors; give 6 at most"),
        (["--primitive", "0", "--plot", "OUT/plot.gif"], "unknown kind of plot"),
        (["--primitive", "0", "--json", "OUT/none/z.json"], "there is no folder"),
        (["--primitive", "0", "--json", "OUT/z", "--csv", "OUT/z"], "a file of its own"),
    ],
)
def test_what_the_words_alone_tell_is_known_before_any_work(
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    said: str,
) -> None:
    def work(*_: object) -> None:
        raise AssertionError("nothing may be read or traced")

    monkeypatch.setattr("viewer.cli.options.load_visible_scene", work)
    words = [a.replace("OUT", str(tmp_path)) for a in arguments]
    assert said in complaint(capfd, "zoom", "figure4", "--size", "32x32", *words)
    assert not list(tmp_path.iterdir())


def test_a_primitive_that_is_not_there_is_known_before_any_tracing(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(*_: object) -> None:
        raise AssertionError("nothing may be compiled or traced")

    monkeypatch.setattr("viewer.cli.options.prepare_kernels", work)
    assert "there is no primitive 7; the scene's are 0 to 1" in complaint(capfd, "zoom", "figure4", "--primitive", "7")


def test_ctrl_c_keeps_the_steps_that_are_done(tmp_path: Path) -> None:
    output = tmp_path / "zoom.json"
    terminal = Terminal(*FIGURE_4, "--ratio", "0.9999", "--steps", "9999", "--json", str(output))
    terminal.interrupt_once(r"step ([3-9]|\d{2,})\b")
    assert terminal.end() == 130
    steps = json.loads(output.read_text())["approaches"][0]["steps"]
    assert 3 < len(steps) < 9999
    assert f"cancelled after {len(steps)} of " in terminal.said
    assert "towards primitive 0, 128 × 128" in terminal.said


@pytest.mark.parametrize(
    ("text", "factors"), [("4", [4.0]), ("4,16", [4.0, 16.0]), (" 4, 2.5 ,4", [4.0, 2.5]), ("9 25", [9.0, 25.0])]
)
def test_factors_are_read_as_people_type_them(text: str, factors: list[float]) -> None:
    assert parse_factors(text) == factors


@pytest.mark.parametrize("text", ["", "four", "4,,x", "nan", "inf", "0", "-4"])
def test_what_are_no_factors(text: str) -> None:
    with pytest.raises(ValueError, match="not zoom factors"):
        parse_factors(text)


def step(number: int, wrong: int = 0, changes: tuple[Change, ...] = ()) -> Step:
    camera = Camera((0, 0, 5), (0, 0, -1))
    return Step(number, 5.0, camera, 10, 10, "INIT", ["INIT"], list(changes), wrong, wrong, 10, 0, 0)


def test_lights_that_change_alike_are_told_together() -> None:
    changes = [
        Change(None, "INIT", "FULLY_RENDERED"),
        Change(0, "INIT", "NON_SHADOW"),
        Change(1, "INIT", "FULL_SHADOW"),
        Change(3, "INIT", "NON_SHADOW"),
    ]
    assert changes_in_words(changes) == [
        "init → fully rendered",
        "lights 0, 3: init → non shadow",
        "light 1: init → full shadow",
    ]
    assert modes_in_words(changes) == "fully rendered, lights 0, 3: non shadow, light 1: full shadow"


def test_only_steps_where_something_happens_are_told() -> None:
    change = Change(None, "FULLY_RENDERED", "INIT")
    steps = [
        step(0),
        step(1, wrong=2),
        step(2, wrong=2),
        step(3, wrong=3),
        step(4),
        step(5),
        step(6, changes=(change,)),
    ]
    assert [s.number for s in happenings(Approach(4.0, steps))] == [1, 3, 4, 6]


def test_a_figure_draws_the_counts_and_the_wrong_pixels() -> None:
    change = Change(None, "FULLY_RENDERED", "INIT")
    steps = [step(0), step(1, wrong=2), step(2, wrong=3, changes=(change,)), step(3)]
    steps = [replace(s, pixels=10 + s.number, highest=[5, 5, 12, 12][s.number]) for s in steps]
    figure = zoom_figure(Results("s.aff", (8, 8), 0, 0.0, (0, 0, 0), 0.9, approaches=[Approach(4.0, steps)]))
    counts, wrong, told = figure.axes
    drawn = {line.get_label(): list(zip(line.get_xdata(), line.get_ydata())) for line in counts.get_lines()}
    assert drawn["the primitive's pixels"] == [(0, 10), (1, 11), (2, 12), (3, 13)]
    assert drawn["zoom factor × highest count"] == [(0, 20), (1, 20), (2, 48), (3, 48)]
    assert drawn["its modes change"] == [(2, 12)]
    assert [bar.get_height() for bar in wrong.patches] == [0, 2, 3, 0]
    assert told.texts[0].get_text() == "step 2: init"
    figure.draw_without_rendering()
    ticks = [*counts.yaxis.get_majorticklabels(), *counts.yaxis.get_minorticklabels()]
    said = {tick.get_text() for tick in ticks} - {""}
    assert "10" in said and all(text.replace(",", "").isdigit() for text in said)


@pytest.mark.parametrize("highest", [0, 5])
def test_a_primitive_never_seen_whole_is_told_in_the_figure(highest: int) -> None:
    steps = [replace(step(n), pixels=10, highest=highest * n) for n in range(3)]
    figure = zoom_figure(Results("s.aff", (8, 8), 0, 0.0, (0, 0, 0), 0.9, approaches=[Approach(4.0, steps)]))
    assert ("Never fully rendered, so it" in figure.get_suptitle()) == (highest == 0)


def test_a_primitive_never_seen_whole_is_told(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """The figure's edge cuts through it in every step."""
    camera = '{"position": [0, 0, 1], "direction": [0, 0, -1], "angle": 20}'
    aim = ["--primitive", "0", "--camera", camera, "--steps", "2"]
    assert main(["zoom", "figure4", "--size", "32x32", *aim]) == 0
    assert "primitive 0: never fully rendered, so it" in capfd.readouterr().err


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("factors", cases((1, 4, MOST_FACTORS), range(1, MOST_FACTORS + 1)))
def test_a_figure_of_many_changes_of_many_lights_keeps_its_room(tmp_path: Path, factors: int) -> None:
    results = busy_results(factors, lights=6)
    figure = zoom_figure(results)
    figures.save(figure, tmp_path / "zoom.png")
    figure.draw_without_rendering()
    for counts, wrong, told in np.reshape(figure.axes, (3, factors)).T:
        assert counts.bbox.height > 0.3 * figure.bbox.height
        assert wrong.bbox.height > 0.1 * figure.bbox.height
        (text,) = told.texts
        *lines, rest = text.get_text().splitlines()
        named = sum(line.startswith("step ") for line in lines)
        assert named > 0 and rest == f"and {len(results.approaches[0].steps) - named} more"
        box = text.get_window_extent()
        assert box.y0 >= figure.legends[0].get_window_extent().y1 and box.y1 < wrong.bbox.y0
        assert box.x1 <= figure.bbox.x1
    titles = [panel.title.get_window_extent() for panel in figure.axes[:factors]]
    assert all(left.x1 < right.x0 for left, right in pairwise(titles))


def test_too_many_factors_for_a_figure_are_said() -> None:
    with pytest.raises(ValueError, match=r"^7 zoom factors cannot be drawn side by side, only 6$"):
        zoom_figure(busy_results(7, lights=1))


def busy_results(factors: int, lights: int) -> Results:
    """Each step changes the modes of all lights, in two groups, and every third that of the primitive."""
    approaches = []
    for k in range(factors):
        steps = []
        for n in range(30):
            modes = ("NON_SHADOW", "PARTIAL_SHADOW")
            changes = [Change(i, modes[(n + i) % 2], modes[(n + i + 1) % 2]) for i in range(lights)]
            if n % 3 == 0:
                changes.insert(0, Change(None, "FULLY_RENDERED", "INIT"))
            pixels = 10 * 2 ** (n // 3)
            steps.append(replace(step(n, n % 4, tuple(changes)), pixels=pixels, highest=max(10, pixels // 2)))
        approaches.append(Approach(4.0**k, steps))
    return Results("hall.aff", (512, 512), 1234, 0.0, (0, 0, 0), 0.94, approaches=approaches)


def test_a_figure_of_nothing_and_of_nothing_that_changes() -> None:
    results = Results("s.aff", (8, 8), 0, 0.0, (0, 0, 0), 0.9, approaches=[Approach(4.0)])
    with pytest.raises(ValueError, match="nothing to plot"):
        zoom_figure(results)
    results.approaches[0].steps = [step(0), step(1)]
    counts, wrong, _ = zoom_figure(results).axes
    assert counts.get_yscale() == "log"
    assert [bar.get_height() for bar in wrong.patches] == [0, 0]

"""`figure` draws methods side by side, and `check` says of figures and pictures whether they are still true."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.commands import ROOM, Run, pixels
from tracer.culling.fate import Fate
from viewer.cli.console import Work
from viewer.output import capture
from viewer.state.palette import FATES

SIZE = ("--size", "64x48", "--threads", 1)


def verdict(run: Run, *files: object) -> tuple[int, list[str]]:
    code, out, errors = run("check", *files)
    assert errors == ""
    return code, out.splitlines()


def test_pictures_stay_true_until_something_changes(run: Run) -> None:
    modes = ("--view", "shadow:1", "--frame", 5, "--warmup", 4, "--legend", "--caption", "A {view}")
    run.ok("render", "room.aff", "-o", "modes.png", *SIZE, *modes)
    run.ok("render", "room.aff", "-o", "plain.png", *SIZE, "--samples", 3)
    code, lines = verdict(run, "modes.png", "plain.png")
    assert code == 0 and [line.split(": ")[:2] for line in lines] == [["modes.png", "true"], ["plain.png", "true"]]
    assert all("bit for bit" in line for line in lines)

    capture.write(Path("edited.png"), pixels("plain.png") ^ 1, capture.read_carried(Path("plain.png")).text())
    code, (line,) = verdict(run, "edited.png")
    assert code == 1 and "FALSE: 3,072 of 3,072 pixels differ, by 1 of 255" in line and "the file's own pixels" in line

    Path("room.aff").write_text(ROOM.replace("l 2 4 3 1 1 1", "l 2 5 3 1 1 1").replace("f 0.8 0.6", "f 0.7 0.6"))
    code, lines = verdict(run, "modes.png", "plain.png")
    assert code == 1 and all("changed since: the scene's materials and lights" in line for line in lines)
    assert all("FALSE" in line and "pixels differ" in line for line in lines)

    Path("room.aff").write_text(ROOM)
    carried = capture.read_carried(Path("plain.png"))
    carried = replace(carried, made=replace(carried.made, version="0.0.1"))
    capture.write(Path("old.png"), pixels("plain.png"), carried.text())
    assert verdict(run, "old.png")[0] == 0, "another version that makes the same picture"
    carried.state["settings"]["depth"] = 0
    capture.write(Path("old.png"), pixels("plain.png"), carried.text())
    code, (line,) = verdict(run, "old.png")
    assert code == 1 and "the version, 0.0.1 then" in line


@pytest.mark.parametrize("method", ["paper", "none"])
def test_what_culling_saves_stands_above_the_picture_and_comes_back(run: Run, method: str) -> None:
    wanted = "render", "room.aff", *SIZE, "--method", method, "--repeat", 1
    said = "1.10 × as fast as none"
    run.ok(*wanted, "-o", "plain.png")
    run.ok(*wanted, "-o", "savings.png", f"--savings={said}")
    run.ok(*wanted, "-o", "counted.png", "--savings")
    plain, both, counted = (pixels(name) for name in ("plain.png", "savings.png", "counted.png"))
    height = len(plain)
    assert np.array_equal(both[-height:], plain) and np.array_equal(counted[-height:], plain)
    if method == "paper":  # with none it is dim
        bar = np.round(255.0 * np.array(FATES[Fate.TRACED].color))
        assert (both[:-height] == bar).all(-1).any(), "no part of the bar is seen"
    code, lines = verdict(run, "savings.png", "counted.png")
    assert code == 0 and all("true" in line for line in lines), lines
    for name, shown in (("savings.png", True), ("plain.png", False)):
        words = run.ok("render", name, "--print-command")
        assert (said in words) == shown == ("--savings" in words)


def test_what_cannot_be_told_is_not_true(run: Run) -> None:
    run.ok("render", "room.aff", "-o", "a.png", *SIZE)
    carried = capture.read_carried(Path("a.png"))
    unknown = {"warmup": {"unknown": "its modes were learnt elsewhere"}, "draw": {"view": "occlusion"}}
    said = {"window.png": "panels", "unknown.png": "learnt elsewhere", "gone.png": "its scene is gone",
            "damaged.png": "warmup.of_path: expected a whole number, got text",
            "figure.png": "its figure is damaged"}  # fmt: skip
    changes: list[dict[str, Any]] = [
        {"window": True}, {"state": carried.state | unknown}, {"state": carried.state | {"scene": "/gone/gone.aff"}},
        {"state": carried.state | {"warmup": {"of_path": "many"}}}, {"figure": {}},
    ]  # fmt: skip
    for name, change in zip(said, changes, strict=True):
        capture.write(Path(name), pixels("a.png"), replace(carried, **change).text())
    code, lines = verdict(run, *said)
    assert code == 1 and len(lines) == len(said)
    for line, (name, words) in zip(lines, said.items()):
        assert line.startswith(f"{name}: unknown: ") and words in line, line
    certificates = ("--view", "certificate:0", "--method", "certified", "--size", "64x48")
    run.ok("render", "room.aff", "-o", "one.png", *certificates, "--threads", 1)
    run.ok("render", "room.aff", "-o", "two.png", *certificates, "--threads", 2)
    code, lines = verdict(run, "one.png", "two.png")
    assert "one.png: true" in lines[0] and "two.png: unknown" in lines[1] and "threads" in lines[1]


def test_files_that_cannot_be_checked_are_errors(run: Run) -> None:
    run.ok("render", "room.aff", "-o", "good.png", *SIZE)
    Path("folder").mkdir()
    Image.new("RGB", (4, 4)).save("plain.png")
    Path("other.pdf").write_bytes(b"%PDF-1.4")
    Path("cut.png").write_bytes(Path("good.png").read_bytes()[:-40])
    assert "cut.png: cannot be read as a picture: it is cut off" in run.fails("render", "cut.png")
    said = {
        "cut.png": "cannot be read as a picture: it is cut off",
        "plain.png": "a picture, but not one saved by Shadowcull",
        "other.pdf": "a PDF, but not a figure of Shadowcull",
        "none.png": "no such file",
        "none.exr": "no such file",
        "folder": "it is a folder, not a file",
        "room.aff": "check reads PNG and EXR pictures, and figures as PNG or PDF",
    }
    code, out, errors = run("check", *said, "good.png")
    assert code == 1 and out.startswith("good.png: true") and out.count("\n") == 1, "one is checked"
    for line, (name, words) in zip(errors.splitlines(), said.items(), strict=True):
        assert line.startswith(f"shadowcull: error: {name}: ") and words in line, line


@pytest.mark.parametrize("ending", [".png", ".pdf"])
def test_a_figure_compares_methods_and_can_be_checked(run: Run, ending: str, monkeypatch: pytest.MonkeyPatch) -> None:
    options = ("--methods", "none,paper", "--crops", "4,4,20,8", "--frame", 3, "--warmup", 3, "--exposure", -1)
    if ending == ".pdf":
        options = ("--methods", "none,paper", "--view", "cost", "--range", "1:5", "--frame", 3)
    out = run.ok("figure", "room.aff", "-o", f"figure{ending}", *SIZE, *options)
    assert "shadow rays due" in out and "pixels that differ" in out
    heard: list[str] = []
    with monkeypatch.context() as patch:
        patch.setattr(Work, "count", lambda self, label, done, total: heard.append(label))
        code, (line,) = verdict(run, f"figure{ending}")
    assert code == 0 and line.startswith(f"figure{ending}: true"), line
    frames = 4 if ending == ".png" else 1
    assert f"figure{ending}, paper, frame {frames} of {frames}" in heard
    Path("room.aff").write_text(ROOM.replace("l -3 4 2", "l -3 3 2"))
    code, (line,) = verdict(run, f"figure{ending}")
    assert code == 1 and "the scene's lights" in line
    if ending == ".png":
        assert capture.read(Path("figure.png")).time == 3.0, "the window goes there"

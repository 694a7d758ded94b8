"""The command `shrink`, from the JSON of a find to a folder, and what others make of that."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.commands import Run, stop_at
from tests.marbles import write_marbles

ROOT = Path(__file__).resolve().parents[3]
FILES = {"scene.aff", "wrong.json", "wrong.png", "test_wrong.py"}


@pytest.fixture
def command(run: Run, room: Path) -> list[str]:
    """The words that shrink the worst find of a hunt."""
    write_marbles(Path())
    search = ("--frames", "0-24", "--step", 6, "--size", "96x96", "--depth", 2, "--threads", 1, "--keep", 1)
    run.ok("hunt", "marbles.aff", *search, "-o", "finds")
    words = shlex.split(json.loads(Path("finds/find-1.json").read_text())["shrink"])
    words[words.index("--before") + 1] = "finds/find-1.json"
    return words[1:]


def test_a_find_becomes_a_folder_that_shows_it(run: Run, command: list[str]) -> None:
    out = run.ok(*command)
    folder = Path("find-1-shrunk")
    assert "failed: " in out or "failed, " in out
    assert "6 primitives, 2 lights, 1 frame: 2 primitives, 1 light, 1 frame are left" in out
    assert {path.name for path in folder.iterdir()} == FILES
    assert ": true: " in run.ok("check", folder / "wrong.png")
    told = json.loads((folder / "wrong.json").read_text())
    explain = shlex.split(told["explain"])[1:]
    explain[explain.index("--before") + 1] = str(folder / "wrong.json")
    assert "(wrong)" in run.ok(*explain)

    words = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", str(folder / "test_wrong.py")]
    done = subprocess.run(words, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True)
    assert done.returncode == 1 and "1 failed" in done.stdout and "AssertionError" in done.stdout

    again = shlex.split(told["shrink"])[1:]
    again[again.index("--before") + 1] = str(folder / "wrong.json")
    assert "2 primitives, 1 light, 1 frame: nothing of it can be left out" in run.ok(*again)
    assert "is in use already" in run.fails(*command)


def test_mistakes_are_told_in_a_line(run: Run, command: list[str]) -> None:
    pixel = command.index("--pixel") + 1
    assert "--pixel 96,0: the picture is 96 x 96" in run.fails(*command[:pixel], "96,0", *command[pixel + 1 :])
    said = run.fails(*command[:pixel], "0,0", *command[pixel + 1 :])
    assert "pixel 0,0 is not wrong: by paper, after 1 frame, no shadow answer is wrong" in said
    assert not list(Path("find-1-shrunk").iterdir())


def test_ctrl_c_keeps_what_is_left_by_then(run: Run, command: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    stop_at(monkeypatch, lambda label, done: "primitives" in label)
    code, out, err = run(*command)
    assert code == 130 and "these are kept" in err and " are left, after " in out
    assert {path.name for path in Path("find-1-shrunk").iterdir()} == FILES

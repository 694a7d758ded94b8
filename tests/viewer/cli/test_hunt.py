"""The command `hunt`, from its words to its files, and what other commands make of these."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from tests.commands import Run, stop_at
from tests.marbles import write_marbles

SEARCH = ("--frames", "0-24", "--step", 6, "--size", "96x96", "--depth", 2, "--threads", 1)


@pytest.fixture(autouse=True)
def marbles(room: Path) -> None:
    write_marbles(Path())


def test_finds_are_written_checked_and_explained(run: Run) -> None:
    out = run.ok("hunt", "marbles.aff", *SEARCH, "--around", 2, "--keep", 1, "-o", "wrong")
    assert "marbles.aff, 96 × 96, method Paper: the worst wrong pixels" in out
    names = {path.name for path in Path("wrong").iterdir()}
    assert names == {"find-1.png", "find-1.json", "hunt.json"}
    told = json.loads(Path("wrong/hunt.json").read_text())
    assert told["frames"] == 7 and told["pixels"] == 7 * 96 * 96 and told["wrong_pixels"] > 0
    assert f"{told['pixels']:,} pixels of 7 frames compared: {told['wrong_pixels']:,} " in out
    find = json.loads(Path("wrong/find-1.json").read_text())
    assert find["difference"] == told["finds"][0]["difference"] > 0

    assert ": true: " in run.ok("check", "wrong/find-1.png")

    command = shlex.split(find["explain"])
    assert command[:2] == ["shadowcull", "explain"]
    command[command.index("--before") + 1] = "wrong/find-1.json"
    out = run.ok(*command[1:])
    assert "(wrong)" in out and f"light {find['light']}" in out

    assert "is in use already (" in run.fails("hunt", "marbles.aff", *SEARCH, "-o", "wrong")


def test_ctrl_c_while_figures_are_drawn_keeps_the_findings(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    stop_at(monkeypatch, lambda label, done: label.startswith("figure"))
    code, _, err = run("hunt", "marbles.aff", *SEARCH, "--keep", 2, "-o", "wrong")
    assert code == 130 and "the figures from here on are not drawn" in err
    names = {path.name for path in Path("wrong").iterdir()}
    assert {"find-1.json", "hunt.json"} <= names and not any(name.endswith(".png") for name in names)


def test_frames_before_are_part_of_a_picture(run: Run) -> None:
    """A picture after one frame, as after `--warmup`, is checked, and its command makes it again."""
    before = json.dumps([[0.0, None]])
    picture = ("--frame", 24, "--size", "96x96", "--method", "paper")
    run.ok("render", "marbles.aff", "-o", "after.png", *picture, "--before", before)
    run.ok("render", "marbles.aff", "-o", "first.png", *picture)
    assert Path("after.png").read_bytes() != Path("first.png").read_bytes()
    assert "true" in run.ok("check", "after.png")
    words = shlex.split(run.ok("render", "after.png", "--print-command"))
    assert json.loads(words[words.index("--before") + 1]) == [[0.0, None]]


def test_an_exact_method_has_nothing_wrong(run: Run) -> None:
    assert (
        run.ok("hunt", "marbles.aff", *SEARCH, "--method", "none").strip()
        == f"{5 * 96 * 96:,} pixels of 5 frames compared: none is wrong"
    )
    one = ("--frames", "5", "--size", "96x96", "--method", "none", "--threads", 1)
    assert f"{96 * 96:,} pixels of 1 frame compared" in run.ok("hunt", "marbles.aff", *one)

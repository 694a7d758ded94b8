"""The command `hunt`, from its words to its files, and what other commands make of these."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from tests.commands import complaint, run
from tests.marbles import write_marbles
from viewer.cli.console import Work

SEARCH = ("--frames", "0-24", "--step", 6, "--size", "96x96", "--depth", 2, "--threads", 1)


@pytest.fixture(autouse=True)
def marbles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_marbles(tmp_path)


def test_finds_are_written_checked_and_explained(capfd: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capfd, "hunt", "marbles.aff", *SEARCH, "--around", 2, "--keep", 1, "-o", "wrong")
    assert code == 0 and "marbles.aff, 96 × 96, method paper: the worst wrong pixels" in out
    names = {path.name for path in Path("wrong").iterdir()}
    assert names == {"find-1.png", "find-1.json", "hunt.json"}
    told = json.loads(Path("wrong/hunt.json").read_text())
    assert told["frames"] == 7 and told["pixels"] == 7 * 96 * 96 and told["wrong_pixels"] > 0
    assert f"{told['pixels']:,} pixels of 7 frames compared: {told['wrong_pixels']:,} " in out
    find = json.loads(Path("wrong/find-1.json").read_text())
    assert find["difference"] == told["finds"][0]["difference"] > 0

    code, out, _ = run(capfd, "check", "wrong/find-1.png")
    assert code == 0 and ": true: " in out

    command = shlex.split(find["explain"])
    assert command[:2] == ["shadowcull", "explain"]
    command[command.index("--before") + 1] = "wrong/find-1.json"
    code, out, _ = run(capfd, *command[1:])
    assert code == 0 and "(wrong)" in out and f"light {find['light']}" in out

    again = run(capfd, "hunt", "marbles.aff", *SEARCH, "-o", "wrong")
    assert "has counterexamples already" in complaint(again)


def test_ctrl_c_while_figures_are_drawn_keeps_the_findings(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        Work, "count", lambda work, label, *_: setattr(work, "stopped", work.stopped or label.startswith("figure"))
    )
    code, _, err = run(capfd, "hunt", "marbles.aff", *SEARCH, "--keep", 2, "-o", "wrong")
    assert code == 130 and "the figures from here on are not drawn" in err
    names = {path.name for path in Path("wrong").iterdir()}
    assert {"find-1.json", "hunt.json"} <= names and not any(name.endswith(".png") for name in names)


def test_frames_before_are_part_of_a_picture(capfd: pytest.CaptureFixture[str]) -> None:
    """A picture after one frame, as after `--warmup`, is checked, and its command makes it again."""
    before = json.dumps([[0.0, None]])
    picture = ("--frame", 24, "--size", "96x96", "--method", "paper")
    assert run(capfd, "render", "marbles.aff", "-o", "after.png", *picture, "--before", before)[0] == 0
    assert run(capfd, "render", "marbles.aff", "-o", "first.png", *picture)[0] == 0
    assert Path("after.png").read_bytes() != Path("first.png").read_bytes()
    code, out, _ = run(capfd, "check", "after.png")
    assert code == 0 and "true" in out
    code, out, _ = run(capfd, "render", "after.png", "--print-command")
    words = shlex.split(out)
    assert code == 0 and json.loads(words[words.index("--before") + 1]) == [[0.0, None]]


def test_an_exact_method_and_words_that_are_not_understood(capfd: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capfd, "hunt", "marbles.aff", *SEARCH, "--method", "none")
    assert code == 0 and out.strip() == f"{5 * 96 * 96:,} pixels of 5 frames compared: none is wrong"
    one = ("--frames", "5", "--size", "96x96", "--method", "none", "--threads", 1)
    code, out, _ = run(capfd, "hunt", "marbles.aff", *one)
    assert code == 0 and f"{96 * 96:,} pixels of 1 frame compared" in out, "a single frame"
    for arguments, said in (
        (("--frames", "50-99"), "the scene's frame numbers are 0 to 59"),
        (("--method", "luck"), "invalid choice: 'luck'"),
        (("--radius", "-1"), "is not a number from 0 to 100"),
        (("--keep", "0"), "is not a whole number from 1 to 1000"),
    ):
        assert said in complaint(run(capfd, "hunt", "marbles.aff", *arguments))
    assert "not understood" in complaint(run(capfd, "explain", "marbles.aff", "--pixel", "1,1", "--before", "[1]"))

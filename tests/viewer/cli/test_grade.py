"""The command `grade`: a method in a file, as the page about it shows, and what may be wrong with such a file."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.commands import Run, stop_at
from tracer.method import unregister
from viewer.cli.grade import OWN

PAGE = Path(__file__).resolve().parents[3] / "docs" / "grade.md"
QUICK = ("--scene", "room.aff", "--frames", 4, "--size", "72x48", "--depth", 0)


@pytest.fixture
def mine(monkeypatch: pytest.MonkeyPatch) -> str:
    """The method of the page, in a file, which is graded in this process."""
    (shown,) = re.findall(r"^```py\n(.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    Path("mine.py").write_text(shown)
    monkeypatch.setenv(OWN, "1")
    return "mine.py"


def test_the_method_of_the_page_gets_its_card(run: Run, mine: str) -> None:
    try:
        small = ("--scene", "figure4", "--frames", 4, "--size", "160x160", "--depth", 0)
        out = run.ok("grade", mine, *small, "-o", "card.json", "-o", "card.md")
    finally:
        unregister("mine")
    card = json.loads(Path("card.json").read_text())
    assert not card["exact"] and card["claims_exact"] and "Wrong, though it claims to be exact: " in out
    assert [row["change"] for row in card["rows"] if row["counted"]["wrong"]] == ["the camera moves"]
    assert card["worst"]["left"] in out and card["worst"]["scene"] in Path("card.md").read_text()


def test_ctrl_c_keeps_the_trials_that_are_done(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    stop_at(monkeypatch, lambda label, done: "lights move: frame 2" in label)
    code, out, err = run("grade", "none", *QUICK, "-o", "card.json")
    assert code == 130 and "these are kept" in err and "The card is not whole" in out
    assert [row["change"] for row in json.loads(Path("card.json").read_text())["rows"]] == ["nothing moves"]


KERNEL = """\
from tracer.methods.interface import ShadowMethod, Stage
from tracer.runtime.kernels import native_callback
from tracer.simd import i64_at

@native_callback
def choose(data, call, light, count, counts):
    {}

class Mine(ShadowMethod):
    def stages(self, frame, worker, learns):
        return [Stage(choose=choose)]
"""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "mine.py: no such file"),
        ("import numpy\n1 / 0\n", "mine.py: line 2: ZeroDivisionError: division by zero"),
        ("def f(:\n", "mine.py: line 1: SyntaxError"),
        ("x = 1\n", "mine.py: one subclass of tracer.methods.interface.ShadowMethod is needed, not none"),
        (KERNEL.format("nothing()"), "mine.py: line 7: a kernel does not compile: NameError: name 'nothing'"),
        (KERNEL.replace("[Stage(choose=choose)]", "worker.x").format("pass"), "mine.py: line 11: AttributeError: "),
    ],
)
def test_a_bad_file_is_told_in_a_line(run: Run, mine: str, text: str | None, said: str) -> None:
    path = Path(mine)
    path.unlink() if text is None else path.write_text(text)
    try:
        assert said in run.fails("grade", mine, *QUICK)
    finally:
        if text is not None and "class Mine" in text:
            unregister("mine")


def test_a_kernel_that_crashes_ends_another_process(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("mine.py").write_text(KERNEL.format("i64_at(8)[0] = 1"))
    assert "mine.py: a kernel has crashed (SIGSEGV)" in run.fails("grade", "mine.py", *QUICK)

"""The README's scripts run as they are printed, and what its pages show and tell is there."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tracer
from tracer import experiment

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text()
CERTIFIED = ROOT / "docs" / "certified-cells.md"
PAGES = (ROOT / "README.md", ROOT / "ARCHITECTURE.md", CERTIFIED)
SCENE = ROOT / "assets" / "scenes" / "figure4.aff"


def script(section: str, **replaced: str) -> str:
    """The Python block of a section; each word to replace must be in it just once."""
    parts = dict(part.split("\n", 1) for part in README.split("\n## ")[1:])
    code, _, rest = parts[section].partition("```python\n")[2].partition("```\n")
    assert code and "```python" not in rest
    for old, new in replaced.items():
        assert code.count(old) == 1, f"{old!r} is not once in the README's section {section!r}"
        code = code.replace(old, new)
    return code


def run(folder: Path, code: str, *arguments: object) -> str:
    """Run a script in a folder of its own; returns what it prints."""
    (folder / "script.py").write_text(code)
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "script.py", *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_from_python(tmp_path: Path) -> None:
    code = script("From Python", **{'"kitchen.aff"': repr(str(SCENE))})
    assert run(tmp_path, code + "\nprint(frame.color.shape, frame.statistics.shadow.due)").startswith("(512, 512, 3) ")


def test_table_1_from_python(tmp_path: Path) -> None:
    code = script("Table 1 from Python", **{"SIZE, FRAMES = 512, 100": "SIZE, FRAMES = 48, 7"})
    heading, *lines = run(tmp_path, code, SCENE).splitlines()
    columns = ["method", "steps saved (most, frame)", "tests saved (most, frame)", "extra/pixel", "wrong"]
    assert re.split(" {2,}", heading) == columns

    scene = tracer.load_scene(SCENE)
    settings = tracer.Settings(width=48, height=48, accelerator="kdtree", verify=True)
    *_, results = experiment.run(scene, settings, ["paper"], experiment.path_times(scene, 7))
    rows = experiment.table(results)
    assert rows[1].most_steps > 0.0
    for line, row in zip(lines, rows, strict=True):
        steps = f"{row.average_steps:.1%} ({row.most_steps:.1%}, {row.most_steps_frame})"
        tests = f"{row.average_tests:.1%} ({row.most_tests:.1%}, {row.most_tests_frame})"
        assert re.split(" {2,}", line) == [row.method, steps, tests, f"{row.extra_tests_per_pixel:.3f}", str(row.wrong)]

    with Image.open(tmp_path / "table1.png") as image:
        assert image.size == (1350, 900)
        blue = np.all(np.abs(np.asarray(image.convert("RGB"), int) - (0x1F, 0x77, 0xB4)) < 8, axis=-1)
    for half in np.split(blue, 2):  # each panel has its curve, all the way across
        assert np.ptp(np.nonzero(half.any(axis=0))) > 800


def test_commands_have_the_options_that_are_shown() -> None:
    shown: dict[str, set[str]] = {}
    text = README + CERTIFIED.read_text().replace("\\\n", " ")
    for command, rest in re.findall(r"^shadowcull ([a-z]+) ([^#\n]*)", text, re.MULTILINE):
        shown.setdefault(command, set()).update(re.findall(r"--[a-z-]+", rest))
    assert {"render", "bench", "zoom", "info"} <= set(shown)
    for command, options in shown.items():
        line = [sys.executable, "-m", "viewer", command, "--help"]
        told = subprocess.run(line, cwd=ROOT, capture_output=True, text=True).stdout
        assert options <= set(re.findall(r"--[a-z-]+", told.partition("examples:")[0])), command


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if target.startswith("https://"):
            continue
        path, _, heading = target.partition("#")
        there = (page.parent / path) if path else page
        assert there.is_file(), target
        if heading:
            headings = re.findall(r"^#+ (.*)$", there.read_text(), re.MULTILINE)
            assert heading in [re.sub(r"[^a-z0-9-]", "", h.lower().replace(" ", "-")) for h in headings], target


def test_certified_cells_are_told_with_the_numbers_they_have() -> None:
    rows = re.findall(r"^\| `(\w+)\.(\w+)` \| (.*?) \|", CERTIFIED.read_text(), re.MULTILINE)
    assert len(rows) > 10
    for module, name, value in rows:
        assert value == repr(getattr(importlib.import_module(f"tracer.culling.certified.{module}"), name)), name

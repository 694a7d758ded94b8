"""README and documentation are true: examples run, links lead somewhere, commands, options and targets exist."""

from __future__ import annotations

import argparse
import importlib
import re
import runpy
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

import tracer
from tests.scenes import loaded
from tests.sweeps import ALL
from tracer.experiments import experiment
from tracer.experiments.study import read_study
from tracer.method import additions, bases, unregister
from tracer.scene.load import load_scene
from viewer.__main__ import main
from viewer.cli.main import COMMANDS
from viewer.cli.sweep import RESULTS
from viewer.services.controller import Controller
from viewer.state.preferences import Preferences
from viewer.state.views import View
from viewer.util.resources import embedded_scenes
from viewer.window import commands
from viewer.window.keyboard import Keyboard
from viewer.window.ui import Ui

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
README, PYTHON, CERTIFIED, GLOSSARY = (
    ROOT / "README.md",
    DOCS / "python.md",
    DOCS / "certified-cells.md",
    DOCS / "glossary.md",
)
PAGES = (README, ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.rglob("*.md")))
PROVING = (
    "tracer.geometry",
    "tracer.visibility",
    "tracer.neighbours",
    "tracer.neighbours.certified",
    "tracer.neighbours.area_lights",
)
LONGEST = 150  # lines of the README
SCENE = ROOT / "assets" / "scenes" / "figure4.aff"

each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a language, in their order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)


def shell_lines(page: Path) -> list[str]:
    """The commands that a page shows, each in one line and without its comment."""
    text = "".join(blocks(page, "sh")).replace("\\\n", " ")
    return [line for line in (line.partition(" #")[0].strip() for line in text.splitlines()) if line]


def test_readme_is_short() -> None:
    assert len(README.read_text().splitlines()) <= LONGEST


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python")], ids=lambda page: page.name)
def test_examples_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each page is one script, run in the project's folder; what takes arguments is a script of its own."""
    script = tmp_path / f"{page.stem}.py"
    script.write_text("\n".join(block for block in blocks(page, "python") if "sys.argv" not in block))
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(tracer, "load_scene", lambda path: loaded(ROOT / path))  # the same scene on many pages
    known = {kind.name for kind in (*bases(measures=True), *additions(measures=True))}
    try:
        runpy.run_path(str(script), run_name="__main__")
    finally:
        for kind in bases(measures=True):
            if kind.name not in known:
                unregister(kind.name)
    assert capsys.readouterr().out


def test_table_1_from_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (code,) = (block for block in blocks(PYTHON, "python") if "sys.argv" in block)
    size = "SIZE, FRAMES = 512, 100"
    assert code.count(size) == 1
    (tmp_path / "script.py").write_text(code.replace(size, "SIZE, FRAMES = 48, 7"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["script.py", str(SCENE)])
    runpy.run_path("script.py", run_name="__main__")
    heading, *lines = capsys.readouterr().out.splitlines()
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


class Accepted(BaseException):
    """A command line was understood; nothing more is to be done with it."""


def test_commands_are_accepted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every `shadowcull` line of every page goes through the parser of its command."""
    parse = argparse.ArgumentParser.parse_args

    def parse_only(parser: argparse.ArgumentParser, arguments: list[str]) -> None:
        parse(parser, arguments)
        raise Accepted

    monkeypatch.setattr(argparse.ArgumentParser, "parse_args", parse_only)
    shown = {line for page in PAGES for line in shell_lines(page) if line.startswith("shadowcull")}
    assert {"render", "bench", "zoom", "explain", "info"} <= {word for line in shown for word in line.split()[1:2]}
    for line in sorted(shown):
        with pytest.raises(Accepted):
            main(shlex.split(line)[1:])


def test_options_in_the_text_exist(capsys: pytest.CaptureFixture[str]) -> None:
    """Options that the text names, as in `--verify`, are options of some command."""
    known = {"--help", "--version"}
    for command in COMMANDS:
        with pytest.raises(SystemExit):
            main([command, "--help"])
        known |= set(re.findall(r"--[a-z-]+", capsys.readouterr().out))
    pages = ("viewer", "command-line", "sweeps", "shrink", "grade", "steps", "methods", "results")
    for page in (README, *(DOCS / f"{name}.md" for name in pages)):
        named = set(re.findall(r"`[^`\n]*?(--[a-z-]+)", page.read_text()))
        assert named <= known, page


def test_lamps_are_read_as_shown(tmp_path: Path) -> None:
    (shown,) = re.findall(r"^```\n(lamp.*?)^```", (DOCS / "scenes.md").read_text(), re.MULTILINE | re.DOTALL)
    path = tmp_path / "shown.aff"
    path.write_text(f"v from 0 0 5 at 0 0 0\np 3 0 0 0 1 0 0 0 1 0\n{shown}")
    scene = load_scene(path)
    assert [light.kind for light in scene.lights] == ["sphere", "rectangle", "dome", "point"]
    assert scene.warnings == ()


def test_studies_are_read(tmp_path: Path) -> None:
    """Those that come with the documentation, and the one that a page shows."""
    studies = sorted((DOCS / "studies").glob("*.toml"))
    assert studies and all(read_study(path, embedded_scenes()).methods[0] == "none" for path in studies)
    (shown,) = blocks(DOCS / "sweeps.md", "toml")
    (tmp_path / "kitchen").mkdir()
    (tmp_path / "kitchen/kitchen.aff").touch()
    (tmp_path / "study.toml").write_text(shown)
    study = read_study(tmp_path / "study.toml", embedded_scenes())
    assert len(study.settings) == 4 and study.seeds == (1, 2, 3) and study.shake == 0.01


def test_results_of_studies_do_not_dirty_a_clone() -> None:
    ignored = (ROOT / ".gitignore").read_text().splitlines()
    assert f"*{RESULTS}/" in ignored


@each_page
def test_targets_and_files_exist(page: Path) -> None:
    """Of `make`, and of the project's folders."""
    text = page.read_text()
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    shown = re.findall(r"`make ([a-z-]+)", text) + re.findall(r"^make ([a-z-]+)", "\n".join(shell_lines(page)), re.M)
    assert set(shown) <= targets
    for path in re.findall(r"`((?:tracer|viewer|shaders|tests|tools|docs|assets)/[\w./-]*)`", text):
        assert (ROOT / path).exists(), path


def test_files_that_the_architecture_names_exist() -> None:
    there = {path.name for folder in ("tracer", "viewer", "tools") for path in (ROOT / folder).rglob("*.py")}
    there |= {path.name for path in ROOT.glob("*.py")}
    assert set(re.findall(r"\w+\.py\b", (ROOT / "ARCHITECTURE.md").read_text())) <= there


def test_keys_of_the_window_are_told() -> None:
    """Each key of a command is in the table of keys."""
    table = "".join(re.findall(r"^\| (`.*?) \|", (DOCS / "viewer.md").read_text(), re.MULTILINE))
    told = set(re.findall(r"`([^`]+)`", table))
    told |= {f"Alt+{n}" for n in range(2, 9)}
    shown = {"RightArrow": "→", "LeftArrow": "←", "Ctrl+Equal": "+", "Ctrl+Minus": "-", "Ctrl+0": "0"}
    shown |= {"Period": ".", "Comma": ",", "Shift+Period": "Shift+."}
    ui, keyboard = Ui(Controller(Preferences())), Keyboard()
    try:
        keys = {shown.get(command.key) or keyboard.label(command.key) for command in commands.build(ui) if command.key}
    finally:
        ui.controller.close()
    assert len(keys) > 30
    assert keys <= told, keys - told


def test_the_table_of_views_says_what_each_declares() -> None:
    table = "".join(f"| `{view.key}` | {view.label} | {view.help} |\n" for view in View)
    assert f"|---|---|---|\n{table}\n" in (DOCS / "viewer.md").read_text(), f"docs/viewer.md has to say:\n{table}"


def test_lines_of_the_sources_are_there() -> None:
    """What CONTRIBUTING shows as the lines that make a view or a command are lines of those files."""
    shown = 0
    for part in "".join(blocks(ROOT / "CONTRIBUTING.md", "diff")).split("+++ b/")[1:]:
        path, *lines = part.splitlines()
        source = (ROOT / path).read_text().splitlines()
        missing = [line for line in lines if line.removeprefix("+") not in source]
        assert not missing, path
        shown += len(lines)
    assert shown > 15


@each_page
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


def test_every_page_is_reachable() -> None:
    """From the README or from a table of contents, and those from each other."""
    trees = [index.parent / entry for index in DOCS.rglob("index.md") for entry in _entries(index)]
    pages = {page for kind in ("md", "ipynb") for page in DOCS.rglob(f"*.{kind}")} - {DOCS / "index.md"}
    assert sorted(trees) == sorted(page.with_suffix("") for page in pages)


@pytest.mark.skipif(not ALL, reason="left to make test-all; what they call is in examples of pages, too")
def test_notebooks_say_what_they_keep() -> None:
    """Each runs, and prints and shows what the documentation shows of it, up to figures that differ from run to run."""
    command = [sys.executable, ROOT / "tools" / "notebooks.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def _entries(index: Path) -> list[str]:
    return [line for block in blocks(index, r"\{toctree\}") for line in block.splitlines() if re.match(r"[a-z]", line)]


def test_the_glossary_leads_to_the_sources() -> None:
    """Each file is there, and each name is in its file."""
    rows = re.findall(r"^\| (?!term|---)(.*?) \| (.*?) \| (.*?) \| (.*?) \|$", GLOSSARY.read_text(), re.MULTILINE)
    assert len(rows) > 40
    for term, _, where, _ in rows:
        path, *names = re.findall(r"`([^`]+)`", where)
        source = ROOT / path
        assert source.exists(), f"{term}: {path}"
        text = source.read_text() if source.is_file() else "".join(p.read_text() for p in source.rglob("*.py"))
        for name in names:
            assert re.search(rf"\b{re.escape(name)}\b", text), f"{term}: {name} is not in {path}"


def test_the_citation_is_of_this_program() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    about = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors", "references"} <= set(citation)
    assert citation["version"] == about["version"]
    assert citation["license"] == about["license"]
    assert f"## {citation['version']} ({citation['date-released']})" in (ROOT / "CHANGELOG.md").read_text()


def is_module(name: str) -> bool:
    return (ROOT / f"{name.replace('.', '/')}.py").exists()


def test_certified_cells_are_told_with_the_numbers_they_have() -> None:
    rows = re.findall(r"^\| `([\w.]+)\.(\w+)` \| (.*?) \|", CERTIFIED.read_text(), re.MULTILINE)
    assert len(rows) > 10
    for module, name, value in rows:
        (found,) = (f"{package}.{module}" for package in PROVING if is_module(f"{package}.{module}"))
        assert value == repr(getattr(importlib.import_module(found), name)), name


def test_the_table_of_settings_is_that_of_their_declarations() -> None:
    page = runpy.run_path(str(ROOT / "tools" / "settings_table.py"))["page"]()
    assert (DOCS / "settings.md").read_text(encoding="utf-8") == page, "make settings"

"""Benchmarks: each starts, and what they write into the documentation is a result.  Whether their figures are to be
trusted, they say themselves."""

from __future__ import annotations

import difflib
import importlib
import json
import sys
from collections import Counter
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.bench import results
from tests.bench import results_tables as tables
from tests.bench.counters import copy_without_counters
from tests.bench.results import PARTS, ROOT, main, written

MODULES = sorted(path.stem for path in Path(results.__file__).parent.glob("*.py"))
SERVERS = ("frame_server", "motion_server", "window_server")  # started by others, with no options of their own


@pytest.mark.parametrize("name", MODULES)
def test_each_starts_and_knows_its_options(name: str, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    try:
        module = importlib.import_module(f"tests.bench.{name}")
    except ModuleNotFoundError:
        if find_spec("embreex"):
            raise
        pytest.skip("there is no Embree for this machine")
    if hasattr(module, "main") and name not in SERVERS:
        monkeypatch.setattr(sys, "argv", [name, "--help"])
        with pytest.raises(SystemExit) as stop:
            module.main()
        assert stop.value.code == 0 and "usage" in capsys.readouterr().out


def test_the_lines_that_count_are_taken_out_and_nothing_else(tmp_path: Path) -> None:
    copy, counting = copy_without_counters(ROOT, tmp_path), Counter[str]()
    for path in sorted((ROOT / "tracer").rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        before, after = path.read_text().splitlines(), (copy / name).read_text().splitlines()
        compile("\n".join(after), name, "exec")
        if before != after:
            changed = [line for line in difflib.ndiff(before, after) if line[:2] in ("- ", "+ ")]
            assert all("steps" in line or "STEPS" in line or "TESTS" in line for line in changed if line[0] == "-"), (
                name
            )
            assert name == "tracer/geometry/kdtree/tree.py" or not any(line[0] == "+" for line in changed), name
            counting[name.split("/")[1]] += len(changed)
    assert set(counting) == {"geometry", "culling", "visibility", "neighbours", "methods"} and counting.total() > 40


# --- tables of the documentation ------------------------------------------------------------------------


def run(steps: list[int], certificates: list[int], wrong: int = 0) -> tables.Figures:
    """What `bench` writes of two frames in which `none` takes 100 steps and 50 tests."""
    none = {
        "shadow_traversal_steps": [100, 100],
        "shadow_intersection_tests": [50, 50],
        "certificate_steps": [0, 0],
        "certificate_tests": [0, 0],
        "shadow_rays_due": [1_500_000, 500_000],
        "occlusion_tests": [0, 0],
        "wrong": [0, 0],
    }
    paper = none | {
        "shadow_traversal_steps": steps,
        "certificate_steps": certificates,
        "occlusion_tests": [8, 24],
        "wrong": [wrong, 0],
    }
    return {"frames": [0, 1], "size": [4, 4], "methods": {"none": none, "paper": paper}}


def test_table_1_gives_averages_and_the_most_of_frames_with_all_that_counts_against_a_method() -> None:
    kitchen, robot = run([80, 50], [10, 10], wrong=20), run([130, 100], [0, 0])
    table = tables.table_1({"kitchen": kitchen, "robot": robot}).splitlines()
    assert table[2] == (
        "| BART Kitchen, here | −25.0 % (−40.0 %) | −0.0 % (−0.0 %) | 1.000 | 20 of 2 million (0.001 %) |"
    )
    assert table[3].startswith("| BART Kitchen, paper | −19.8 % (−59.5 %) | −24.5 % (−59.8 %) | 0.173 |")
    assert table[4].startswith("| BART Robot, here | +15.0 % (−0.0 %) |") and "none of 2 million" in table[4]


def test_each_table_has_a_place_of_its_own_on_its_page() -> None:
    for name, part in PARTS.items():
        page = (ROOT / "docs" / f"{part.page}.md").read_text()
        once = written(page, name, "| new |\n")
        assert once.count("| new |") == 1 and written(once, name, "| new |\n") == once
        assert [line for line in once.splitlines() if line.startswith("#")] == [
            line for line in page.splitlines() if line.startswith("#")
        ]


def test_what_was_measured_quickly_is_never_taken_for_a_result(tmp_path, monkeypatch, capsys) -> None:
    with pytest.raises(SystemExit):
        main(["--quick", "--write"])
    assert "is no result" in capsys.readouterr().err
    commands = []

    def run_it(command: list[str], **_):
        commands.append(command)
        Path(command[-1]).write_text(json.dumps({"runs": len(commands)}))
        return SimpleNamespace(returncode=0)

    page = tmp_path / "docs" / "performance.md"
    page.parent.mkdir()
    page.write_text("<!-- make results: lamps -->\n<!-- end of what is measured -->\n")
    monkeypatch.setattr(results, "ROOT", tmp_path)
    monkeypatch.setattr(results, "SCENES", ())
    monkeypatch.setattr(results, "subprocess", SimpleNamespace(run=run_it, DEVNULL=None))
    part = results.Part("performance", ("lamps",), lambda runs: f"| {runs[0]['runs']} |\n")
    monkeypatch.setitem(PARTS, "lamps", part)
    assert main(["--only", "lamps", "--quick"]) == 0
    assert main(["--only", "lamps", "--resume", "--write"]) == 0
    assert ["--size" in command for command in commands] == [True, False]
    assert "| 2 |" in page.read_text()

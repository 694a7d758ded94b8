"""Tables of the documentation, made of what benchmarks write."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.bench import results
from tests.bench import results_tables as tables
from tests.bench.results import PARTS, ROOT, main, written


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


def test_table_1_gives_averages_and_the_most_of_frames_with_all_that_counts_against_a_method():
    kitchen, robot = run([80, 50], [10, 10], wrong=20), run([130, 100], [0, 0])
    table = tables.table_1({"kitchen": kitchen, "robot": robot}).splitlines()
    assert table[2] == (
        "| BART Kitchen, here | −25.0 % (−40.0 %) | −0.0 % (−0.0 %) | 1.000 | 20 of 2 million (0.001 %) |"
    )
    assert table[3].startswith("| BART Kitchen, paper | −19.8 % (−59.5 %) | −24.5 % (−59.8 %) | 0.173 |")
    assert table[4].startswith("| BART Robot, here | +15.0 % (−0.0 %) |") and "none of 2 million" in table[4]


def test_methods_are_listed_without_the_one_they_are_compared_with():
    (row,) = tables.all_methods({"kitchen": run([80, 50], [0, 0], wrong=1234)}).splitlines()[2:]
    assert row == "| `paper` | −35.0 %, −0.0 %; 1,234 |"


def test_rows_and_headings_of_each_table_are_of_one_length():
    contest = {"kind": "", "time": 1.0, "ratio": {"median": 1.5}}
    contest |= {f"{who}_million_rays": {"median": 20.0} for who in ("ours", "embree")}
    frame = {"seconds": {method: {"2": 0.05, "1": 0.1} for method in ("none", "paper")}}
    frame["embree"] = {"seconds": {"all rays": {"1": [0.1, 0.2, 0.2], "2": [0.1]}}}
    scene = {
        "scene": "/bart/kitchen.aff",
        "rays": [contest | {"kind": kind} for kind in tables.KINDS],
        "frames": [frame],
    }
    found = {"total": 2.0, "low": 1.5, "high": 2.5}
    lamp = {"scene": "museum5.aff", "lamp_radius": 0.03, "seconds": {"none": [1.0]}, "known": {"certified": 0.5}}
    lamp["speed_up"] = {"certified": found, "free": found}
    path = {"scene": "Robot.aff", "accelerator": "bvh8", "method": "auto", "frames": [1], "seconds": {"none": [0.1]}}
    path |= {"total": 0.9, "best": 0.8, "worst": 1.1, "processor": {"total": 0.95}}
    measured = ("ssim_median", "ssim_p5", "frames_per_second", "settle", "saved", "saved_whole", "wrong", "wrong_whole")
    moving = {name: 1.0 for name in measured}
    moving |= {f"baseline_{name}": 0.5 for name in moving}
    made = [
        tables.rays({"scenes": [scene]}),
        tables.frames({"scenes": [scene]}),
        tables.lamps({"runs": [lamp]}),
        tables.times([{"scenes": [path]}]),
        tables.motion({"scenes": {"default": moving}}),
    ]
    for table in made:
        lines = table.splitlines()
        assert len(lines) > 2 and len({line.count("|") for line in lines}) == 1, table
    assert "| `none` | 100 (100 to 100) | 50 (50 to 50) |" in made[1] and "2.00 | 2.00 |" in made[1]
    assert "Museum, 3 cm | 1,000 | 2.00 (1.50 to 2.50) | 50 % | 2.00" in made[2]


def test_each_table_has_a_place_of_its_own_on_its_page():
    for name, part in PARTS.items():
        page = (ROOT / "docs" / f"{part.page}.md").read_text()
        once = written(page, name, "| new |\n")
        assert once.count("| new |") == 1 and written(once, name, "| new |\n") == once
        assert [line for line in once.splitlines() if line.startswith("#")] == [
            line for line in page.splitlines() if line.startswith("#")
        ]
    with pytest.raises(ValueError, match="no place for 'table-9'"):
        written("# Results\n", "table-9", "")


def test_what_was_measured_quickly_is_never_written(capsys):
    with pytest.raises(SystemExit):
        main(["--quick", "--write"])
    assert "is no result" in capsys.readouterr().err


def test_going_on_never_takes_what_was_measured_quickly_for_a_result(tmp_path, monkeypatch):
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
    assert main(["--only", "lamps", "--quick", "--resume"]) == 0 and len(commands) == 2


def test_a_table_of_methods_takes_the_place_of_that_of_its_scene_alone():
    from tests.bench.methods import BEGIN, END, with_tables

    page = f"before\n{BEGIN}\n**Kitchen, 8 × 8**\n\n| a |\n\n**Office, 8 × 8**\n\n| b |\n\n{END}after\n"
    assert with_tables(page, []) == page
    one = with_tables(page, ["**Kitchen, 4 × 4**\n\n| c |\n", "**Courtyard, 4 × 4**\n\n| d |\n"])
    tables = f"\n**Kitchen, 4 × 4**\n\n| c |\n\n**Office, 8 × 8**\n\n| b |\n\n**Courtyard, 4 × 4**\n\n| d |\n\n{END}"
    assert one == f"before\n{BEGIN}{tables}after\n"

"""The command `bench`, from its words to its files."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from viewer.bench import frame_range
from viewer.cli import main


def test_bench_writes_an_entry_per_frame_and_prints_the_table(tmp_path: Path, capsys):
    figures, lines = tmp_path / "figures.json", tmp_path / "table.csv"
    command = ["bench", "figure4", "--path-frames", "6", "--frames", "1:5", "--size", "48x32", "--verify"]
    assert main([*command, "--methods", "none,paper", "--json", str(figures), "--csv", str(lines)]) == 0
    results = json.loads(figures.read_text())
    assert set(results) == {"scene", "size", "frames", "methods"}
    assert results["size"] == [48, 32]
    assert results["frames"] == [1, 2, 3, 4]
    assert all(len(values) == 4 for method in results["methods"].values() for values in method.values())
    none, paper = results["methods"]["none"], results["methods"]["paper"]
    assert set(none) == {
        "shadow_rays_due",
        "shadow_rays_culled",
        "shadow_rays_dynamic_only",
        "shadow_traversal_steps",
        "shadow_intersection_tests",
        "occlusion_tests",
        "certificate_steps",
        "certificate_tests",
        "wrong",
        "frame_seconds",
    }
    assert sum(paper["shadow_traversal_steps"]) < sum(none["shadow_traversal_steps"])
    rows = list(csv.DictReader(lines.open()))
    assert [row["method"] for row in rows] == ["none", "paper"]
    saved = [1 - p / n for n, p in zip(none["shadow_traversal_steps"], paper["shadow_traversal_steps"], strict=True)]
    assert float(rows[1]["average_steps"]) == pytest.approx(sum(saved) / 4)
    assert f"{sum(saved) / 4:.1%}" in capsys.readouterr().out


@pytest.mark.parametrize(
    "text, numbers", [(None, range(10)), ("2:5", range(2, 5)), (":3", range(3)), ("7:", range(7, 10))]
)
def test_frames_are_a_range_of_the_path(text, numbers):
    assert frame_range(text, 10) == numbers


@pytest.mark.parametrize(
    "wrong",
    [
        ["--frames", "5:2"],
        ["--frames", "0:99"],
        ["--frames", "three"],
        ["--methods", "telepathy"],
        ["--zoom-factor", "0"],
    ],
)
def test_mistakes_are_one_line(wrong, capsys):
    assert main(["bench", "figure4", "--path-frames", "6", "--size", "16x16", *wrong]) != 0
    assert len(capsys.readouterr().err.strip().splitlines()) == 1

"""The command `bench`, from its words to its files."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

from tests.commands import Run, stop_at
from tests.terminal import Terminal
from tracer.experiments import figures
from tracer.util.version import program_version

SMALL = ["bench", "figure4", "--path-frames", "6", "--size", "48x32"]


def bench(run: Run, *options: str) -> tuple[dict, str]:
    """The JSON of a small run, and what it prints."""
    out = run.ok(*SMALL, *options, "--json", "figures.json")
    return json.loads(Path("figures.json").read_text()), out


def printed_row(out: str, method: str) -> list[str]:
    """The cells of a method's line, without its name."""
    line = next(line for line in out.splitlines() if re.match(rf"│ {re.escape(method)} +│", line))
    return [cell.strip() for cell in line.strip("│").split("│")][1:]


def test_bench_writes_an_entry_per_frame_and_prints_the_table(run: Run) -> None:
    more = ["--frames", "1:5", "--verify", "--methods", "none, paper"]
    results, out = bench(run, *more, "--csv", "table.csv", "--plot", "plot.svg")
    assert list(results)[:4] == ["scene", "size", "frames", "methods"]
    assert Path("plot.svg").read_text().startswith("<?xml")
    assert "figure4.aff, 48 × 32, frames 1 to 4 of 6" in out and "no speed-up is given" in out
    whole, timed = bench(run)
    assert results["times"] == whole["times"][1:5] and results["path_frames"] == 6
    assert (results["planned_frames"], results["stopped"]) == (4, False)
    assert "figure4.aff, 48 × 32, frames 0 to 5 of 6" in timed and "speed-up" in timed and "no speed-up" not in timed
    assert "wrong" not in timed
    shared = {"depth": 10, "zoom_factor": 4.0, "symmetric": False, "accelerator": "kdtree", "threads": 0}
    shared |= {"lamp_radius": None, "lamp_samples": None}
    assert results["settings"] == {**shared, "verify": True} and whole["settings"] == {**shared, "verify": False}
    assert results["version"] == program_version()
    assert {len(v) for figures in ("build_seconds", "memory_bytes") for v in results[figures].values()} == {4}
    assert results["size"] == [48, 32] and results["frames"] == [1, 2, 3, 4]
    assert list(results["methods"]) == ["none", "paper"]
    none, paper = results["methods"]["none"], results["methods"]["paper"]
    figures = "shadow_rays_due shadow_rays_culled shadow_rays_dynamic_only shadow_traversal_steps "
    figures += "shadow_intersection_tests occlusion_tests certificate_steps certificate_tests wrong frame_seconds"
    for method in (none, paper):
        assert list(method) == figures.split() and {len(values) for values in method.values()} == {4}
    assert sum(paper["shadow_traversal_steps"]) < sum(none["shadow_traversal_steps"])
    rows = list(csv.DictReader(Path("table.csv").read_text().splitlines()))
    assert [row["method"] for row in rows] == ["none", "paper"]
    average, most = [], []
    for work, name in (("steps", "traversal_steps"), ("tests", "intersection_tests")):
        saved = [1 - p / n for n, p in zip(none[f"shadow_{name}"], paper[f"shadow_{name}"], strict=True)]
        frame = 1 + saved.index(max(saved))
        assert float(rows[1][f"average_{work}"]) == pytest.approx(sum(saved) / 4)
        assert float(rows[1][f"most_{work}"]) == pytest.approx(max(saved))
        assert int(rows[1][f"most_{work}_frame"]) == frame
        average.append(f"{sum(saved) / 4:.1%}")
        most.append(f"{max(saved):.1%} ({frame})")
    wrong, due = sum(paper["wrong"]), sum(paper["shadow_rays_due"])
    extra = sum(paper["occlusion_tests"]) / (4 * 48 * 32)
    row = printed_row(out, "paper")
    assert row[1:4] == [*average, f"{wrong:,} ({wrong / due:.3%})"] and row[5:8] == [*most, f"{extra:.3f}"]


def test_options_of_the_paper_reach_it(run: Run) -> None:
    """Tests in both directions are more of them; modes that are soon learnt anew save less than those kept."""
    usual, symmetric = (bench(run, *more)[0]["methods"] for more in ([], ["--symmetric"]))
    assert sum(symmetric["paper"]["occlusion_tests"]) > sum(usual["paper"]["occlusion_tests"])
    assert not any(symmetric["none"]["occlusion_tests"])
    soon, never = (bench(run, "--zoom-factor", factor)[0]["methods"]["paper"] for factor in ("1", "1e9"))
    assert sum(soon["shadow_traversal_steps"]) > sum(never["shadow_traversal_steps"])


def test_a_file_that_fails_takes_nothing_else_along(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError("plot.png: not written: No space left on device")

    monkeypatch.setattr(figures, "file_of", full)
    code, out, err = run(*SMALL, "--plot", "plot.png", "--json", "figures.json", "--csv", "table.csv")
    assert code == 1 and printed_row(out, "paper")
    assert err == "shadowcull: error: plot.png: not written: No space left on device\n"
    assert {path.name for path in Path().iterdir()} == {"room.aff", "figures.json", "table.csv"}


def test_cancelled_before_any_frame_is_done_there_is_nothing_to_keep(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    stop_at(monkeypatch, lambda label, done: True)
    assert run(*SMALL, "--json", "figures.json") == (130, "", "shadowcull: cancelled\n")
    assert [path.name for path in Path().iterdir()] == ["room.aff"]


# --- on a terminal ---------------------------------------------------------------------------------


def test_progress_is_shown_and_ctrl_c_keeps_whole_frames(room: Path, tmp_path: Path) -> None:
    """Frame, method, time gone and time left, and the table in their place when it ends."""
    paths = {kind: tmp_path / f"figures.{kind}" for kind in ("json", "csv", "pdf")}
    files = ["--json", str(paths["json"]), "--csv", str(paths["csv"]), "--plot", str(paths["pdf"])]
    terminal = Terminal("bench", str(room), "--path-frames", "100000", "--size", "64x64", "--threads", "1", *files)
    traced = r"of 100000, None \(trace all\) "  # the one that is being traced
    terminal.interrupt_once(rf"(?s){traced}.*frame \d{{2,}} of 100000, Paper \S+ 0:00:0[1-9] \d+:\d\d:\d\d left")
    assert terminal.end() == 130
    said = terminal.said
    shown = re.findall(r"frame (\d+) of 100000, (?:None \(trace all\)|Paper) \S+ \d:\d\d:\d\d \d+:\d\d:\d\d left", said)
    assert len(set(shown)) > 1 and list(map(int, shown)) == sorted(map(int, shown))
    assert "│ paper" in said[said.rindex(" left") :]
    told = re.search(r"cancelled after (\d+) of 100000 frames; these are kept", terminal.said)
    assert told is not None
    done, results = int(told[1]), json.loads(paths["json"].read_text())
    assert (results["frames"], results["planned_frames"], results["stopped"]) == ([*range(done)], 100000, True)
    assert {len(values) for one in results["methods"].values() for values in one.values()} == {done}
    assert f"room.aff, 64 × 64, frames 0 to {done - 1} of 100000, stopped" in terminal.said
    assert {path for path in tmp_path.iterdir() if path.stat().st_size} == {room, *paths.values()}
    assert len([*tmp_path.iterdir()]) == 4


def test_all_methods_have_a_line_each(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    monkeypatch.setattr(
        "viewer.cli.bench.line_up", lambda lights: asked.append(lights) or ["none", "paper", "certified"]
    )
    results, out = bench(run, "--methods", "all, paper+rest,paper", "--frames", ":3")
    assert list(results["methods"]) == ["none", "paper", "certified", "paper+rest"] and len(asked) == 1
    assert all(printed_row(out, name) for name in results["methods"])
    assert max(results["memory_bytes"]["certified"]) > max(results["memory_bytes"]["none"]) == 0

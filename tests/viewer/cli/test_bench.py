"""The command `bench`, from its words to its files."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

from tests.commands import complaint, run
from tests.terminal import Terminal
from tracer.experiments import figures
from tracer.version import program_version
from viewer.__main__ import main
from viewer.cli.console import Work

SMALL = ["bench", "figure4", "--path-frames", "6", "--size", "48x32"]


def bench(folder: Path, *options: str) -> dict:
    """The JSON of a small run."""
    path = folder / "figures.json"
    assert main([*SMALL, *options, "--json", str(path)]) == 0
    return json.loads(path.read_text())


def printed_row(out: str, method: str) -> list[str]:
    """The cells of a method's line, without its name."""
    line = next(line for line in out.splitlines() if re.match(rf"│ {re.escape(method)} +│", line))
    return [cell.strip() for cell in line.strip("│").split("│")][1:]


def test_bench_writes_an_entry_per_frame_and_prints_the_table(tmp_path: Path, capsys):
    lines, plot = tmp_path / "table.csv", tmp_path / "plot.svg"
    more = ["--frames", "1:5", "--verify", "--methods", "none, paper"]
    results = bench(tmp_path, *more, "--csv", str(lines), "--plot", str(plot))
    assert list(results)[:4] == ["scene", "size", "frames", "methods"] and plot.read_text().startswith("<?xml")
    out = capsys.readouterr().out
    assert "figure4.aff, 48 × 32, frames 1 to 4 of 6" in out and "no speed-up is told" in out
    whole = bench(tmp_path)
    assert results["times"] == whole["times"][1:5] and results["path_frames"] == 6
    assert (results["planned_frames"], results["stopped"]) == (4, False)
    timed = capsys.readouterr().out
    assert "figure4.aff, 48 × 32, frames 0 to 5 of 6" in timed and "no speed-up" not in timed
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
    rows = list(csv.DictReader(lines.open()))
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
    assert printed_row(out, "paper")[1:7] == [*average, f"{wrong:,} ({wrong / due:.3%})", *most, f"{extra:.3f}"]


def test_options_of_the_paper_reach_it(tmp_path: Path):
    """Tests in both directions are more of them; modes that are soon learnt anew save less than those kept."""
    usual, symmetric = (bench(tmp_path, *more)["methods"] for more in ([], ["--symmetric"]))
    assert sum(symmetric["paper"]["occlusion_tests"]) > sum(usual["paper"]["occlusion_tests"])
    assert not any(symmetric["none"]["occlusion_tests"])
    soon, never = (bench(tmp_path, "--zoom-factor", factor)["methods"]["paper"] for factor in ("1", "1e9"))
    assert sum(soon["shadow_traversal_steps"]) > sum(never["shadow_traversal_steps"])


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (["--frames", "5:2"], "give A:B, the frames A to B - 1 of the 6 there are"),
        (["--frames", "1-4"], "--frames 1-4: give A:B"),
        (["--zoom-factor", "0"], "argument --zoom-factor: 0 is not a number from 1 up"),
        (["--method", "none"], "unrecognized arguments: --method none"),
        (["--methods", "telepathy"], "argument --methods: invalid choice: 'telepathy'; it is one of none"),
        (["--methods", "all,telepathy"], "+lightbuffer, +cache-directions, +cache-tile, +packets16, +packets1; or all"),
        (["--methods", ""], "argument --methods: invalid choice: ''"),
        (["--methods", "papr,paper,certifed"],
         "invalid choice: 'papr': did you mean 'paper'? 'certifed': did you mean 'certified'? (see"),
        (["--methods", "papr,all,telepathy"], "'papr': did you mean 'paper'? 'telepathy'; it is one of none"),
        (["--accelerator", "kdtree-lasy"], "kdtree-lazy: did you mean 'kdtree-lazy'?"),
        (["--accelerator", "grid"], "grid is not one of bvh8, kdtree"),
        (["--methd", "paper"], "unrecognized arguments: --methd paper: did you mean '--methods'?"),
        (["--lamp-sample=4"], "unrecognized arguments: --lamp-sample=4: did you mean '--lamp-samples'?"),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(wrong, said, capfd):
    assert said in complaint(run(capfd, *SMALL, *wrong))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (["--plot", "OUT/plot.gif"], "plot.gif: unknown kind of plot; give one of .png .svg .pdf"),
        (["--plot", "OUT/plot"], "unknown kind of plot"),
        (["--plot", "OUT/none/plot.png"], "there is no folder"),
        (["--json", "OUT"], "a folder"),
        (["--csv", "OUT/same", "--json", "OUT/same"], "a file of its own"),
        (["--methods", "none", "--plot", "OUT/plot.png"], "nothing to compare with none"),
    ],
)
def test_files_that_cannot_be_are_known_before_any_work(wrong, said, tmp_path: Path, capfd, monkeypatch):
    def work(*_: object) -> None:
        raise AssertionError("nothing may be read or traced")

    monkeypatch.setattr("viewer.cli.options.load_visible_scene", work)
    assert said in complaint(run(capfd, *SMALL, *(word.replace("OUT", str(tmp_path)) for word in wrong)))
    assert not list(tmp_path.iterdir())


def test_a_file_that_fails_takes_nothing_else_along(tmp_path: Path, capsys, monkeypatch):
    def full(*_: object) -> None:
        raise OSError("plot.png: not written: No space left on device")

    monkeypatch.setattr(figures, "file_of", full)
    paths = [tmp_path / name for name in ("plot.png", "figures.json", "table.csv")]
    assert main([*SMALL, "--plot", str(paths[0]), "--json", str(paths[1]), "--csv", str(paths[2])]) == 1
    out, err = capsys.readouterr()
    assert printed_row(out, "paper") and err == "shadowcull: error: plot.png: not written: No space left on device\n"
    assert [path.exists() for path in paths] == [False, True, True]


def test_cancelled_before_any_frame_is_done_there_is_nothing_to_keep(tmp_path: Path, capsys, monkeypatch):
    monkeypatch.setattr(Work, "count", lambda work, *_: setattr(work, "stopped", True))
    assert main([*SMALL, "--json", str(tmp_path / "figures.json")]) == 130
    assert capsys.readouterr() == ("", "shadowcull: cancelled\n")
    assert not list(tmp_path.iterdir())


# --- on a terminal ---------------------------------------------------------------------------------


def test_progress_shows_frame_method_time_gone_and_time_left():
    terminal = Terminal("bench", "default", "--frames", ":8", "--size", "160x160")
    *_, said = terminal.lines()
    assert terminal.end() == 0
    shown = re.findall(r"frame (\d) of 8, (?:none|paper) \S+ (\d:\d\d:\d\d) (\d:\d\d:\d\d) left", said)
    assert len({frame for frame, _, _ in shown}) > 2
    assert "of 8, none " in said and "of 8, paper " in said, "the one that is being traced"
    assert [frame for frame, _, _ in shown] == sorted(frame for frame, _, _ in shown)
    assert shown[-1][1] > "0:00:00"
    assert "│ paper" in said[said.rindex(" left") :]


def test_ctrl_c_keeps_whole_frames(tmp_path: Path):
    paths = {kind: tmp_path / f"figures.{kind}" for kind in ("json", "csv", "pdf")}
    files = ["--json", str(paths["json"]), "--csv", str(paths["csv"]), "--plot", str(paths["pdf"])]
    terminal = Terminal("bench", "default", "--path-frames", "100000", "--size", "64x64", *files)
    terminal.interrupt_once(r"frame ([3-9]|\d{2,}) of 100000")
    assert terminal.end() == 130
    told = re.search(r"cancelled after (\d+) of 100000 frames; these are kept", terminal.said)
    assert told is not None
    done, results = int(told[1]), json.loads(paths["json"].read_text())
    assert (results["frames"], results["planned_frames"], results["stopped"]) == ([*range(done)], 100000, True)
    assert {len(values) for one in results["methods"].values() for values in one.values()} == {done}
    assert f"default.aff, 64 × 64, frames 0 to {done - 1} of 100000, stopped" in terminal.said
    assert sorted(tmp_path.iterdir()) == sorted(paths.values()) and all(p.stat().st_size for p in paths.values())


def test_all_methods_have_a_line_each(tmp_path: Path, capsys) -> None:
    results = bench(tmp_path, "--methods", "all, paper+rest,paper", "--frames", ":3")
    assert {"none", "paper", "certified", "free", "certified+cache", "paper+rest"} <= set(results["methods"])
    out = capsys.readouterr().out
    assert all(printed_row(out, name) for name in results["methods"])
    assert max(results["memory_bytes"]["certified"]) > max(results["memory_bytes"]["none"]) == 0

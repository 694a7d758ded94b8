"""Results of runs, as files."""

from __future__ import annotations

import csv
import json
from datetime import datetime
from pathlib import Path

import pytest
from PIL import Image

from tests.viewer.desk import Desk
from viewer.output import exports


class FakeRun:
    results = None


@pytest.mark.slow
def test_results_are_written_beside_the_pictures(figure4: Desk, tmp_path: Path) -> None:
    desk, folder = figure4, tmp_path / "pictures"
    desk.runs.export(FakeRun(), ".json")
    assert desk.said == "there is nothing to save yet"
    desk.runs.start_experiment()
    desk.run_to_its_end()
    desk.c.selection.select((0.5, 0.5))
    desk.runs.start_zoom_test()
    desk.run_to_its_end()
    for run in (desk.runs.experiment, desk.runs.zoom_test):
        for ending in exports.ENDINGS:
            desk.runs.export(run, ending)
    desk.rest()
    files = sorted(path.name for path in folder.iterdir())
    kinds = [name.rsplit("-", 6)[0] + Path(name).suffix for name in files]
    assert kinds == [f"figure4-{kind}{ending}" for kind in ("experiment", "zoom-test") for ending in
                     (".csv", ".json", ".png")]  # fmt: skip
    experiment_csv, experiment_json, _, zoom_csv, zoom_json, _ = (folder / name for name in files)
    assert [row["method"] for row in csv.DictReader(experiment_csv.open())] == ["none", "paper"]
    written = json.loads(experiment_json.read_text())
    assert written.pop("version")
    assert written == desk.runs.experiment.results.to_dict()
    assert len(list(csv.DictReader(zoom_csv.open()))) == desk.runs.zoom_test.frames
    assert len(json.loads(zoom_json.read_text())["approaches"]) == 2
    for name in (files[2], files[5]):
        with Image.open(folder / name) as plot:
            assert plot.size == (1920, 1080)


def test_what_is_there_can_be_saved_while_a_run_goes_on(desk: Desk, tmp_path: Path) -> None:
    desk.runs.experiment_plan.frames = 5000
    desk.runs.start_experiment()
    run = desk.runs.experiment
    desk.until(lambda: run.results is not None and len(run.results.frames) > 3)
    there = run.results.to_dict()
    desk.runs.export(run, ".json")
    desk.until(lambda: not desk.c.captures.busy)
    (file,) = (tmp_path / "pictures").iterdir()
    kept = json.loads(file.read_text())
    assert len(there["frames"]) <= len(kept["frames"]) < 5000
    assert all(
        len(values) == len(kept["frames"]) for figures in kept["methods"].values() for values in figures.values()
    )
    assert desk.runs.current is run and not run.stopping, "saving has disturbed it"
    desk.runs.stop()
    desk.run_to_its_end()


def test_what_cannot_be_written_is_one_line(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    desk.c.preferences.screenshot_folder = str(tmp_path / "file")
    desk.runs.experiment_plan.methods = set()
    desk.runs.start_experiment()
    desk.run_to_its_end()
    desk.runs.export(desk.runs.experiment, ".json")
    desk.rest()
    assert desk.c.notices.message.error and "nothing saved: cannot write to" in desk.said
    desk.c.preferences.screenshot_folder = str(tmp_path / "pictures")
    desk.runs.export(desk.runs.experiment, ".png")  # the reference alone
    desk.rest()
    assert desk.c.notices.message.error and "nothing to plot" in desk.said
    assert not list((tmp_path / "pictures").iterdir())


def test_a_name_that_is_taken_gets_a_number(tmp_path: Path) -> None:
    now = datetime(2024, 5, 31, 14, 5, 9)

    def save() -> str:
        return exports.save(tmp_path, "room-experiment", ".csv", lambda path: path.write_text("saved"), now).name

    stem = "room-experiment-2024-05-31-14-05-09"
    assert [save(), save(), save()] == [f"{stem}.csv", f"{stem}-2.csv", f"{stem}-3.csv"]

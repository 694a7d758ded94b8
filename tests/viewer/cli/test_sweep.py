"""Studies by two processes: the figures are those of one, to the bit, whoever dies meanwhile."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import psutil
import pyarrow.parquet as pq
import pytest

from tests.commands import ROOM, Run, stop_at
from tests.marbles import write_marbles
from tests.sweeps import cases
from tracer.experiments import experiment
from tracer.experiments import sweep as sweeping
from tracer.experiments.cluster import Cluster, local_cluster
from tracer.frame import Frame
from tracer.scene import fingerprint
from tracer.scene.load import load_scene
from tracer.settings import Settings
from viewer.cli import sweep

METHODS = cases(("none", "paper", "certified"), ("none", "paper", "cells", "certified", "certified+cache"))
STUDY = f"""\
title = "A room"
scenes = ["room.aff"]
methods = {[*METHODS]}
sizes = ["40x30", "24x18"]
[path]
first = 3
last = 6
[settings]
verify = true
"""
FRAMES = 2 * 4 * len(METHODS)
TASKS = 2 * (4 + len(METHODS) - 1)  # frames of none, which does not depend on those before, may be traced apart
WAIT = 60.0


@pytest.fixture(autouse=True)
def study(room: Path) -> None:
    Path("study.toml").write_text(STUDY)


@pytest.fixture(scope="module")
def two_workers() -> Iterator[Cluster]:
    with local_cluster(2) as cluster:
        yield cluster


@pytest.fixture
def shared(two_workers: Cluster, monkeypatch: pytest.MonkeyPatch) -> Cluster:
    """Commands use the processes that are there."""

    @contextmanager
    def there(workers: int) -> Iterator[Cluster]:
        yield two_workers

    monkeypatch.setattr(sweep, "local_cluster", there)
    return two_workers


def rows(folder: str = "study-results") -> list[dict[str, Any]]:
    return pq.read_table(Path(folder) / "results.parquet").to_pylist()


def until(holds: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + WAIT
    while not holds():
        assert time.monotonic() < end, f"{what} never happened"
        time.sleep(0.02)


def test_figures_are_those_of_bench_also_when_a_process_dies(
    shared: Cluster, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = load_scene(write_marbles(Path()))
    Path("study.toml").write_text(STUDY.replace("room.aff", "marbles.aff").replace("40x30", "40x40"))
    until(lambda: len(shared.process_ids()) == shared.started() == 2, "two workers")
    for number in (os.getpid(), *shared.process_ids()):
        listening = [c.laddr.ip for c in psutil.Process(number).net_connections("inet") if c.status == "LISTEN"]
        assert listening and set(listening) == {"127.0.0.1"}, "no other machine can reach them"

    before, add = set(shared.process_ids()), sweeping.Store.add
    killed: list[int] = []

    def add_and_kill(store: sweeping.Store, some: list) -> Path:
        if not killed:
            killed.append(shared.process_ids()[0])
            os.kill(killed[0], signal.SIGKILL)
        return add(store, some)

    monkeypatch.setattr(sweeping.Store, "add", add_and_kill)
    code, out, err = run("sweep", "study.toml", "--workers", 2)
    assert code == 0 and killed and killed[0] in before and killed[0] not in shared.process_ids(), err
    assert f"process {killed[0]} has died" in err and METHODS[-1] in out

    found = {(row["width"], row["method"], row["frame"]): row for row in rows()}
    assert len(found) == len(rows()) == 2 * len(METHODS) * 4
    times = experiment.path_times(scene)
    for width, height in ((40, 40), (24, 18)):
        pictures: dict[tuple[str, int], str] = {}

        def keep(number: int, method: str, frame: Frame, pictures: dict[tuple[str, int], str] = pictures) -> None:
            pictures[method, number] = fingerprint.of_pixels(frame.color)

        settings = Settings(width=width, height=height, verify=True, accelerator="kdtree", threads=1)
        results = list(experiment.run(scene, settings, list(METHODS), times, range(3, 7), on_frame=keep))[-1]
        for method in METHODS:
            for place, number in enumerate(range(3, 7)):
                row = found[width, method, number]
                for name in set(experiment.FIGURES) - {"frame_seconds"}:
                    assert row[name] == results.methods[method][name][place], (method, number, name)
                assert row["picture"] == pictures[method, number] and row["time"] == times[number]
        for method, figure in (("paper", "shadow_rays_dynamic_only"), ("certified", "certificate_tests")):
            first, *later = results.methods[method][figure]
            assert set(later) != {first}, "else nothing would depend on history"


def test_a_sweep_that_was_stopped_goes_on(shared: Cluster, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as stopped:
        stop_at(stopped, lambda label, done: done >= 3)
        code, out, err = run("sweep", "study.toml")
        assert code == 130 and "these are kept" in err
    first = {(row["task"], row["frame"]): row for row in rows()}
    assert 3 <= len(first) < FRAMES

    Path("study.toml").write_text(STUDY.replace('"40x30", ', ""))  # fewer sizes: a change, but nothing is wrong with it
    code, out, err = run("sweep", "study.toml")
    assert code == 0 and "the study has changed: sizes: - 40x30" in err and "40×30" not in out
    Path("study.toml").write_text(STUDY)
    run.ok("sweep", "study.toml")
    every = {(row["task"], row["frame"]): row for row in rows()}
    assert len(every) == FRAMES and first.items() <= every.items(), "what was kept has stayed, times and all"
    assert not list(Path("study-results/parts").iterdir())

    monkeypatch.setattr(sweep, "local_cluster", None)  # nothing is missing, so that nobody is asked
    code, out, err = run("sweep", "study.toml")
    assert code == 0 and f"{FRAMES} of {FRAMES} frames are kept in study-results; nothing is missing" in err

    Path("room.aff").write_text(ROOM.replace("l 2 4 3", "l 2 4 4"))
    line = run.fails("sweep", "study.toml")
    assert "room.aff: other lights; give another --output, or --anew" in line


def test_seeds_shake_the_camera_and_a_warmup_cuts_paths(shared: Cluster, run: Run) -> None:
    more = 'seeds = [1, 2]\nshake = 0.02\nwarmup = 2\nmethods = ["none", "paper"]\nsizes = ["24x18"]\n'
    Path("study.toml").write_text('scenes = ["room.aff"]\n' + more + "[path]\nfirst = 0\nlast = 4\n")
    run.ok("sweep", "study.toml")
    found = {(row["seed"], row["method"], row["frame"]): row for row in rows()}
    assert len(found) == 20 and len({row["task"] for row in found.values()}) == 20, "each frame is a task"
    assert found[1, "none", 2]["picture"] != found[2, "none", 2]["picture"]
    scene = load_scene("room.aff")
    study = sweeping.Study(Path("study.toml"), "", {}, ("paper",), (), (1,), 0.02)
    settings = Settings(width=24, height=18, method="paper", accelerator="kdtree", threads=1)
    task = sweeping.Task("room.aff", "", settings, 1, study.shake, 10, 0.0)
    before = tuple((n, scene.frame_time(n)) for n in (2, 3))
    renderer = sweeping.rows_of(replace(task, frames=((4, scene.frame_time(4)),), before=before), scene)
    alone = next(renderer)
    assert all(alone[name] == found[1, "paper", 4][name] for name in sweeping.SAME)


def test_another_version_does_not_take_part(shared: Cluster, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tracer.experiments.remote_jobs.program_version", lambda: "9.9")
    code, _, err = run("sweep", "study.toml")
    assert code == 1 and f"{TASKS} tasks failed, the first of them room.aff" in err and "not 9.9" in err
    assert not (Path("study-results") / "results.parquet").exists()


def test_a_scheduler_that_is_not_there_is_one_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tracer.experiments.cluster.CONNECT", 0.3)
    line = run.fails("sweep", "study.toml", "--scheduler", "tcp://127.0.0.1:9")
    assert "--scheduler tcp://127.0.0.1:9: no Dask scheduler answers there" in line


@pytest.mark.slow
def test_processes_end_with_the_one_that_started_them() -> None:
    code = (
        "import time\n"
        "from tracer.experiments.cluster import local_cluster\n"
        "if __name__ == '__main__':\n"
        "    with local_cluster(1) as cluster:\n"
        "        while not cluster.started(): time.sleep(0.05)\n"
        "        print('started', flush=True)\n"
        "        time.sleep(600)\n"
    )
    Path("client.py").write_text(code)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with subprocess.Popen([sys.executable, "client.py"], env=environment, stdout=subprocess.PIPE, text=True) as client:
        assert client.stdout is not None and client.stdout.readline() == "started\n"
        children = psutil.Process(client.pid).children(recursive=True)
        assert children
        client.kill()
        until(lambda: not any(c.is_running() and c.status() != psutil.STATUS_ZOMBIE for c in children), "their end")

"""The command `sweep`: a study by several processes, kept frame by frame, and what it found as a table.

Ctrl-C ends it at once: what is traced is kept, and the same command goes on from there."""

from __future__ import annotations

import math
import os
import time
from argparse import Namespace
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table

from tracer.experiments.cluster import Cluster, check_dask, connected, local_cluster
from tracer.experiments.experiment import REFERENCE
from tracer.experiments.study import Study, read_study
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.mesh_options import IN_STUDIO
from tracer.scene.model import Cancelled, Scene
from tracer.util.text import printable
from viewer.cli import options
from viewer.cli.arguments import INTERRUPTED, Parser, count
from viewer.cli.console import Work, columns_help, fitted, listed, print_table, terminal_width, working
from viewer.output.reports import METHOD, Column
from viewer.state import terms
from viewer.util import numbers
from viewer.util.resources import embedded_scenes

if TYPE_CHECKING:  # these need pyarrow
    from tracer.experiments.sweep import Plan, Report
    from tracer.experiments.sweep_store import Store
    from tracer.experiments.sweep_summary import Line

RESULTS = "-results"
"""What the folder of a study's results is called after it."""


COLUMNS: tuple[Column[Line], ...] = (
    Column("steps saved", "traversal steps of shadow rays saved against none, certificates included; ± over seeds",
           lambda line: _saved(line, line.steps, line.spread)),
    Column("speed-up", "processor time of all frames by none over that of the method",
           lambda line: "" if math.isnan(line.speed_up) else f"{line.speed_up:.2f}"),
    Column("median ms", "processor time of a frame, the median, in milliseconds of one thread",
           lambda line: "" if math.isnan(line.seconds) else f"{1000 * line.seconds:,.1f}"),
    Column("wrong", "wrong answers, where frames are verified",
           lambda line: f"{line.wrong:,}" if line.verified else ""),
    Column("tests saved", "intersection tests saved, in the same way", lambda line: _saved(line, line.tests)),
    Column("rays saved", f"shadow rays {terms.MEANINGS[terms.SAVED]}",
           lambda line: "" if line.method == REFERENCE else f"{line.known:.1%}"),
    Column("frames", "frames that are traced", lambda line: f"{line.frames:,}"),
)  # fmt: skip
"""What a table says of a line."""


def _saved(line: Line, value: float, spread: float = math.nan) -> str:
    if line.method == REFERENCE or math.isnan(value):
        return ""
    return numbers.saved(value, None if math.isnan(spread) else spread)


EPILOG = f"""\
examples:
  shadowcull sweep study.toml
  shadowcull sweep study.toml --workers 8
  shadowcull sweep study.toml --scheduler tcp://10.0.0.1:8786
  shadowcull sweep study.toml --table

A study is a TOML file:

  title = "Three rooms"
  scenes = ["default", "office", "kitchen/kitchen.aff"]  # of the program, or files beside the study
  methods = ["none", "paper", "certified"]
  sizes = ["256x256", "512x512"]
  seeds = [1, 2, 3]    # each traces all of it
  shake = 0.01         # and moves the camera aside, by up to this part of the scene's diagonal
  warmup = 20          # a method that learns sees only so many frames before each, which are then independent
  [path]
  frames = 100         # resample the animation
  first = 0
  last = 49
  [settings]           # a value, or a list of them: depth, symmetric, zoom_factor, verify, accelerator, lamp_radius,
  depth = [2, 10]      # lamp_samples, certificates, certificate_seconds, certificate_memory, lightcuts_error,
                       # lightcuts_nodes, light_buffer_side, light_buffer_memory

Every frame is kept as soon as it is traced, as a row of Parquet in the folder of results, and the same command again
traces only what is missing. Methods that learn trace their whole path in one task unless there is a warmup; all other
frames are tasks of their own, with one thread each. Times are processor times. Workers of a Dask scheduler need the
same version of Shadowcull. Needs Dask and PyArrow: install shadowcull[sweep].

{columns_help(COLUMNS)}"""


def parser() -> Parser:
    description = "Trace all combinations of a study in several processes, and keep every frame as a row."
    parser = Parser("sweep", description, EPILOG)
    add = parser.add_argument
    add("study", type=Path, metavar="STUDY.toml", help="what to trace; see below")
    help_ = "the folder of the results (default: beside the study, STUDY-results)"
    add("-o", "--output", type=Path, metavar="DIR", help=help_)
    who = parser.add_mutually_exclusive_group().add_argument
    help_ = "how many processes of this machine work, with one thread each (default: one on each core)"
    who("--workers", type=count(1, 1024), metavar="N", help=help_)
    help_ = "use the workers of the Dask scheduler at this address, such as tcp://10.0.0.1:8786"
    who("--scheduler", metavar="ADDRESS", help=help_)
    add("--table", action="store_true", help="trace nothing; print the table of what there is")
    add("--anew", action="store_true", help="throw away what there is, and trace all of it")
    return parser


def run(given: Namespace) -> int:
    """Trace what is missing of a study, and print its table.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished."""
    path = given.study
    check_dask()
    from tracer.experiments import sweep as sweeping
    from tracer.experiments.sweep_store import Store
    from tracer.experiments.sweep_summary import summary

    study = read_study(path, embedded_scenes())
    store = Store(given.output or path.with_name(path.stem + RESULTS))
    if given.table and not store.folder.is_dir():
        raise OSError(f"{store.folder}: no results yet; leave out --table to trace the study")
    report: Report | None = sweeping.Report()
    with working() as work:
        scenes = _scenes(study, work)
        if given.table:
            plan = sweeping.planned(study, scenes, store)
        else:
            store.lock()
            try:
                if given.anew:
                    store.clear()
                plan = sweeping.planned(study, scenes, store)
                report = _trace(plan, store, given, work)
            finally:
                store.unlock()
    lines = summary(store.read(), (key for task in plan.tasks for key in sweeping.frames_of(task)))
    if lines:
        for table in tables(study, [replace(line, scene=study.label(line.scene)) for line in lines], terminal_width()):
            print_table(table)
    if not given.table and store.results.exists():
        print(printable(store.results))
    if report is None:
        return INTERRUPTED
    if report.unequal:
        task, number, names = report.unequal[0]
        raise OSError(
            f"{len(report.unequal)} frames were not the same when they were traced again, the first of them frame "
            f"{number} of {task.in_words()}: {names}; what was kept first has stayed"
        )
    if report.failures:
        raise OSError(sweeping.in_words(report.failures))
    return 0


def _scenes(study: Study, work: Work) -> dict[str, Scene]:
    """Read the scenes of a study, once; whoever traces gets them from here."""
    found = {}
    for file in study.scenes.values():
        check_scene_file(file)
    for name, file in study.scenes.items():
        found[name] = load_visible_scene(file, work.progress, study.folders, IN_STUDIO)
        for warning in found[name].warnings:
            work.note(f"warning: {warning}")
    return found


def _trace(plan: Plan, store: Store, given: Namespace, work: Work) -> Report | None:
    """Trace what is missing; returns what came of it, None where it was cancelled."""
    from tracer.experiments import sweep as sweeping

    for change in plan.changes:
        work.note(f"the study has changed: {change}")
    missing, done = plan.missing, plan.done
    if done:
        goes_on = "going on from there" if missing else "nothing is missing"
        work.note(f"{done:,} of {plan.frames:,} frames are kept in {store.folder}; {goes_on}")
    if given.scheduler is None:
        for lights, accelerator in {(len(plan.scenes[t.scene].lights), t.settings.accelerator) for t in missing}:
            methods = {task.settings.method for task in missing if task.settings.accelerator == accelerator}
            options.prepare_kernels(work, lights, accelerator, *methods)
    store.set_study(sweeping.identity(plan.study, plan.scenes))
    try:
        if not missing:
            return sweeping.Report()
        with _cluster_of(given, len(missing)) as cluster:
            watch = _Watch(cluster, work)

            def on_progress(now: int) -> None:
                nonlocal done
                done = now
                work.count(f"frame {min(now + 1, plan.frames):,} of {plan.frames:,}, {watch}", now, plan.frames)

            on_progress(done)
            report = sweeping.sweep(plan, store, cluster, work.cancelled, on_progress)
            watch.look()
            return report
    except Cancelled:
        work.note(f"cancelled after {done:,} of {plan.frames:,} frames; these are kept, and the same command goes on")
        return None
    finally:
        store.merge()


def _cluster_of(options: Namespace, tasks: int) -> AbstractContextManager[Cluster]:
    """Start the processes that the options ask for; no more of this machine than there are tasks."""
    if options.scheduler is not None:
        return connected(options.scheduler)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return local_cluster(min(options.workers or cores, max(tasks, 1)))


class _Watch:
    """Says how many processes there are, and when one has died; it looks once a second."""

    def __init__(self, cluster: Cluster, work: Work) -> None:
        self._cluster, self._work = cluster, work
        self._known, self._said, self._next = set(cluster.process_ids()), "", 0.0

    def look(self) -> None:
        """Note which processes have died since, and how many there are."""
        now, started, size = set(self._cluster.process_ids()), self._cluster.started(), self._cluster.size()
        for number in self._known - now:
            self._work.note(f"process {number} has died; another takes its place, and does its task again")
        self._known, self._next = now, time.monotonic() + 1.0
        working = f"{started} of {size} workers" if started < size else numbers.several(size, "worker")
        self._said = working if started else "waiting for workers"

    def __str__(self) -> str:
        if time.monotonic() >= self._next:
            self.look()
        return self._said


def tables(study: Study, lines: list[Line], width: int | None) -> Sequence[Table]:
    """Return a table for each scene and combination of settings, for a terminal so wide; None is any width."""
    parts: dict[tuple[str, str], list[Line]] = {}
    for line in lines:
        parts.setdefault((line.scene, line.settings), []).append(line)
    verified = all(line.verified for line in lines)
    caption = "saved against none; verify = true counts wrong answers; sweep --help says what the columns mean"

    def made(columns: Sequence[Column[Line]]) -> list[Table]:
        found = [listed([*names, *columns], some, _title(*part), "", _size) for part, some in parts.items()]
        found[-1].caption = caption
        return found

    def _title(scene: str, settings: str) -> str:
        return printable(": ".join(filter(None, (study.title, ", ".join(filter(None, (scene, settings)))))))

    names = [Column("size", "", _size), METHOD]
    return fitted([column for column in COLUMNS if verified or column.heading != "wrong"], made, width)


def _size(line: Line) -> str:
    return f"{line.width}×{line.height}"

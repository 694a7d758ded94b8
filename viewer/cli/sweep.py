"""The command `sweep`: a study by several processes, kept frame by frame, and what it found as a table and a plot.

Ctrl-C ends it at once: what is traced is kept, and the same command goes on from there.
"""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tracer.experiments.cluster import check_dask
from tracer.experiments.study import Study, read_study
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.mesh_options import IN_STUDIO
from tracer.scene.model import Cancelled, Scene
from viewer.cli import sweep_table
from viewer.cli.console import Work, print_table, terminal_width, working
from viewer.cli.processes import Watch, cluster_of
from viewer.cli.tracing_options import prepare_kernels
from viewer.util.files import check_writable
from viewer.util.messages import printable
from viewer.util.resources import embedded_scenes

if TYPE_CHECKING:  # these need pyarrow
    from tracer.experiments.sweep import Plan, Report
    from tracer.experiments.sweep_store import Store
    from tracer.experiments.sweep_summary import Line

RESULTS = "-results"
"""What the folder of a study's results is called after it."""


def sweep(path: Path, options: Namespace) -> bool:
    """Trace what is missing of a study, print its table, draw it; returns whether it was not stopped before its end.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished."""
    check_dask()
    from tracer.experiments import sweep as sweeping
    from tracer.experiments.sweep_store import Store

    study = read_study(path, embedded_scenes())
    if options.plot is not None:
        from viewer.output.figures import check_ending

        check_ending(options.plot)
        check_writable(options.plot)
    store = Store(options.output or path.with_name(path.stem + RESULTS))
    if options.table and not store.folder.is_dir():
        raise OSError(f"{store.folder}: no results yet; leave out --table to trace the study")
    whole, report = True, sweeping.Report()
    with working() as work:
        scenes = _scenes(study, work)
        if not options.table:
            store.lock()
            try:
                if options.anew:
                    store.clear()
                plan = sweeping.planned(study, scenes, store)
                whole, report = _trace(plan, store, options, work)
            finally:
                store.unlock()
        else:
            plan = sweeping.planned(study, scenes, store)
    lines = _summary(plan, store)
    if lines:
        for table in sweep_table.tables(study, lines, terminal_width()):
            print_table(table)
    if options.plot is not None:
        _plot(study, lines, options.plot)
    if not options.table and store.results.exists():
        print(printable(store.results))
    _check(report)
    return whole


def _scenes(study: Study, work: Work) -> dict[str, Scene]:
    """The scenes of a study, read once; whoever traces gets them from here."""
    found = {}
    for file in study.scenes.values():
        check_scene_file(file)
    for name, file in study.scenes.items():
        found[name] = load_visible_scene(file, work.progress, study.folders, IN_STUDIO)
        for warning in found[name].warnings:
            work.note(f"warning: {warning}")
    return found


def _trace(plan: Plan, store: Store, options: Namespace, work: Work) -> tuple[bool, Report]:
    """Trace what is missing; returns whether it was not stopped, and what came of it."""
    from tracer.experiments import sweep as sweeping

    report = sweeping.Report()
    for change in plan.changes:
        work.note(f"the study has changed: {change}")
    missing = plan.missing
    if not missing:
        work.note(f"nothing is missing: all {plan.frames:,} frames are kept in {store.folder}")
        store.set_study(sweeping.identity(plan.study, plan.scenes))
        store.merge()
        return True, report
    if plan.done:
        work.note(f"{plan.done:,} of {plan.frames:,} frames are kept; going on from there")
    if options.scheduler is None:
        for lights, accelerator in {(len(plan.scenes[t.scene].lights), t.settings.accelerator) for t in missing}:
            methods = {task.settings.method for task in missing if task.settings.accelerator == accelerator}
            prepare_kernels(work, lights, accelerator, *methods)
    store.set_study(sweeping.identity(plan.study, plan.scenes))
    done = plan.done
    try:
        with cluster_of(options, len(missing)) as cluster:
            watch = Watch(cluster, work)

            def on_progress(now: int) -> None:
                nonlocal done
                done = now
                watch.look()
                work.count(f"frame {min(now + 1, plan.frames):,} of {plan.frames:,}, {watch}", now, plan.frames)

            on_progress(done)
            report = sweeping.sweep(plan, store, cluster, work.cancelled, on_progress)
            watch.look(at_once=True)
            return True, report
    except Cancelled:
        work.note(f"cancelled after {done:,} of {plan.frames:,} frames; these are kept, and the same command goes on")
        return False, report
    finally:
        store.merge()


def _summary(plan: Plan, store: Store) -> list[Line]:
    from tracer.experiments.sweep import frames_of
    from tracer.experiments.sweep_summary import summary

    lines = summary(store.read(), (key for task in plan.tasks for key in frames_of(task)))
    return [replace(line, scene=plan.study.label(line.scene)) for line in lines]


def _plot(study: Study, lines: list[Line], path: Path) -> None:
    from viewer.output.figures import save
    from viewer.output.sweep_figure import sweep_figure

    try:
        figure = sweep_figure(study.title, lines)
    except ValueError as error:
        raise ValueError(f"--plot: {error}") from None
    save(figure, path)
    print(printable(path))


def _check(report: Report) -> None:
    """Raise OSError, in one line, where not everything went well."""
    from tracer.experiments.sweep import in_words

    if report.unequal:
        task, number, names = report.unequal[0]
        raise OSError(
            f"{len(report.unequal)} frames were not the same when they were traced again, the first of them frame "
            f"{number} of {task.in_words()}: {names}; what was kept first has stayed"
        )
    if report.failures:
        raise OSError(in_words(report.failures))

"""The command `bench`: a path of frames by several methods, as the paper's Table 1.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

from tracer.experiments import experiment
from tracer.experiments.experiment import REFERENCE, Results
from tracer.experiments.lamp_experiment import kinds_of_lamps
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.method import line_up
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Cancelled, Scene
from viewer.cli import lamp_bench
from viewer.cli.bench_table import bench_table
from viewer.cli.console import Work, print_table, terminal_width, working
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.tracing_options import prepare_kernels, tracing_settings
from viewer.output import exports
from viewer.output.reports import leaders

ALL = "all"  # methods that are worth comparing in the scene


def bench(path: Path, options: Namespace) -> bool:
    """Run an experiment, print its table and write its files; returns whether it was not stopped before its end.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished.
    """
    check_scene_file(path)
    radii, samples = options.lamp_radius or [None], options.lamp_samples or [None]
    options.lamp_radius, options.lamp_samples = radii[0], samples[0]
    settings = tracing_settings(options)
    methods = experiment.with_reference([method for method in options.methods if method != ALL])
    wanted = exports.wanted_files(options)
    if "plot" in wanted and methods == [REFERENCE] and ALL not in options.methods:
        raise ValueError(f"--plot: nothing to compare with {REFERENCE}; give another of --methods")
    by_lamps = len(radii) * len(samples) > 1
    if by_lamps and "plot" in wanted:
        raise ValueError("--plot: it draws one kind of lamps; give one --lamp-radius and one --lamp-samples")
    with working() as work:
        scene = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        if ALL in options.methods:  # and those that are named besides
            methods = experiment.with_reference([*line_up(len(scene.lights)), *methods])
        times = experiment.path_times(scene, options.path_frames)
        numbers = frame_range(options.frames, len(times))
        prepare_kernels(work, len(scene.lights), options.accelerator, *methods)
        if by_lamps:
            return _bench_lamps(scene, settings, methods, (radii, samples), times, numbers, work, wanted)
        results = _run(scene, settings, methods, times, numbers, work)
        finished = len(results.frames) == len(numbers)
        if not finished:
            work.note(f"cancelled after {len(results.frames)} of {len(numbers)} frames; the table is of these")
        failures = exports.write_files(exports.experiment_writers(options.verify), results, wanted)
    print_table(bench_table(results, options.verify, terminal_width()))
    for line in leaders(experiment.table(results), timed=not options.verify):
        print(line)
    if failures:
        raise OSError("; ".join(failures))
    return finished


def _bench_lamps(
    scene: Scene,
    settings: Settings,
    methods: list[str],
    lamps: tuple[Sequence[float | None], Sequence[int | None]],
    times: list[float],
    numbers: range,
    work: Work,
    wanted: dict[str, Path],
) -> bool:
    """Measure every kind of lamps; print the table, write the files, and return whether it went on to its end."""
    kinds = kinds_of_lamps(scene, *lamps)
    results = lamp_bench.run(scene, settings, methods, kinds, times, numbers, work)
    finished = len(results.runs) == len(kinds) and len(results.runs[-1].frames) == len(numbers)
    if not finished:
        work.note(f"cancelled in lamps {len(results.runs)} of {len(kinds)}; the table is of the frames that are done")
    failures = exports.write_files(exports.LAMP_WRITERS, results, wanted)
    print_table(lamp_bench.lamp_table(results, terminal_width()))
    if failures:
        raise OSError("; ".join(failures))
    return finished


def _run(
    scene: Scene, settings: Settings, methods: list[str], times: list[float], numbers: range, work: Work
) -> Results:
    """The results of all frames, or of those done when `work` was cancelled; raises Cancelled where there are none."""
    world = World(scene, times[0], settings.accelerator, work.progress)
    total, done = len(numbers) * len(methods), 0

    def show() -> None:
        frame, turn = divmod(min(done, total - 1), len(methods))
        method = experiment.in_turn(methods, frame)[turn]
        work.count(f"frame {frame + 1} of {len(numbers)}, {method}", done, total)

    def on_frame(number: int, method: str, frame: Frame) -> None:
        nonlocal done
        done += 1
        show()

    show()
    results = None
    for grown in experiment.run(
        scene, settings, methods, times, numbers, cancel=work.cancelled, world=world, on_frame=on_frame
    ):
        results = grown
    if results is None:
        raise Cancelled("cancelled")
    return results


def frame_range(text: str | None, count: int) -> range:
    """`A:B`, the frames A to B - 1 of a path of `count`; either may be left out."""
    if text is None:
        return range(count)
    first, colon, last = text.partition(":")
    try:
        numbers = range(int(first or 0), int(last or count))
    except ValueError:
        numbers = range(0)
    if not colon or not numbers or not 0 <= numbers.start < numbers.stop <= count:
        raise ValueError(f"--frames {text}: give A:B, the frames A to B - 1 of the {count} there are")
    return numbers

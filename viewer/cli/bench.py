"""The command `bench`: a path of frames by several methods, as the paper's Table 1.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from tracer import experiment
from tracer.experiment import REFERENCE, Results
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.lamp_experiment import kinds_of_lamps
from tracer.method import line_up
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Cancelled, Scene
from viewer.cli import lamp_bench
from viewer.cli.console import Work, print_table, working
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.tracing_options import prepare_kernels, tracing_settings
from viewer.output import exports
from viewer.output.reports import LINES, WRONG, frames_in_words, leaders
from viewer.util.messages import printable

ALL = "all"  # methods that are worth comparing in the scene
MOST_COLUMNS = 5  # of methods
# What columns are called where methods have lines; the other figures are left to the files.
_COLUMNS = {
    "traversal steps saved, average": "steps\nsaved",
    "intersection tests saved, average": "tests\nsaved",
    WRONG: "wrong",
    "time of a frame, median": "a frame",
    "time of all frames": "all\nframes",
    "  of it preparing": "preparing",
    "speed-up over none, all frames": "speed-\nup",
    "memory of the method": "memory",
}


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
    print_table(_table(results, options.verify))
    for line in leaders(experiment.table(results)):
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
    print_table(lamp_bench.lamp_table(results))
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
        frame = min(done // len(methods), len(numbers) - 1) + 1
        work.count(f"frame {frame} of {len(numbers)}, {', '.join(methods)}", done, total)

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


def _table(results: Results, verified: bool) -> Table:
    """A column for each of a few methods, which fits terminals of 80 columns, or else a line for each."""
    width, height = results.size
    title = (
        f"Work of shadow rays\n{printable(Path(results.scene).name)}, {width} × {height}, {frames_in_words(results)}"
    )
    table = Table(title=title, title_justify="left", title_style="bold", caption_justify="left")
    rows = experiment.table(results)
    lines = [line for line in LINES if verified or line[0] != WRONG]
    if len(rows) <= MOST_COLUMNS:
        table.add_column("")
        for row in rows:
            table.add_column(row.method.replace("+", "\n+"), justify="right")
        for heading, cell in lines:
            table.add_row(heading, *(cell(row) for row in rows))
    else:
        table.add_column("method", no_wrap=True)
        shown = [(_COLUMNS[heading], cell) for heading, cell in lines if heading in _COLUMNS]
        for heading, _ in shown:
            table.add_column(heading, justify="right")
        for row in rows:
            table.add_row(row.method, *(cell(row) for _, cell in shown))
    table.caption = "times include verifying" if verified else "--verify counts wrong answers"
    return table

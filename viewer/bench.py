"""The command `bench`: a path of frames by several methods, as the paper's Table 1.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

import csv
import io
import json
from argparse import Namespace
from collections.abc import Callable
from dataclasses import astuple, fields
from functools import partial
from pathlib import Path

from rich.table import Table

from tracer import experiment
from tracer.experiment import REFERENCE, Results, Row
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.scene.load import load_visible_scene
from tracer.scene.model import Cancelled, Scene
from viewer.console import Work, print_table, working
from viewer.headless import prepare_kernels, tracing_settings
from viewer.outputs import check_outputs, write_each, write_text


def bench(path: Path, options: Namespace) -> bool:
    """Run an experiment, print its table and write its files; returns whether it was not stopped before its end.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished.
    """
    settings = tracing_settings(options)
    methods = experiment.with_reference(options.methods)
    writers = _writers(options, methods)
    with working() as work:
        scene = load_visible_scene(path, work.progress)
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        times = experiment.path_times(scene, options.path_frames)
        numbers = frame_range(options.frames, len(times))
        prepare_kernels(work, len(scene.lights))
        results = _run(scene, settings, methods, times, numbers, work)
        finished = len(results.frames) == len(numbers)
        if not finished:
            work.note(f"cancelled after {len(results.frames)} of {len(numbers)} frames; the table is of these")
        failures = write_each(partial(write, results) for write in writers)
    print_table(_table(results, options.verify))
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


_Writer = Callable[[Results], None]


def _writers(options: Namespace, methods: list[str]) -> list[_Writer]:
    """What writes each file that was asked for; raises ValueError and OSError for one that cannot be."""
    writers: list[_Writer] = []
    if options.json is not None:
        writers.append(lambda results: write_text(options.json, json.dumps(results.to_dict())))
    if options.csv is not None:
        writers.append(lambda results: write_text(options.csv, csv_text(results)))
    if options.plot is not None:
        from viewer import figures  # loads matplotlib

        figures.check_ending(options.plot)
        if methods == [REFERENCE]:
            raise ValueError(f"--plot: nothing to compare with {REFERENCE}; give another of --methods")
        writers.append(lambda results: figures.save(figures.savings_figure(results, options.verify), options.plot))
    check_outputs({"--json": options.json, "--csv": options.csv, "--plot": options.plot})
    return writers


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
    """A column per method, so that it fits terminals of 80 columns."""
    width, height = results.size
    title = f"{Path(results.scene).name}, {len(results.frames)} frames, {width} x {height}: work of shadow rays"
    table = Table(title=title, title_justify="left", title_style="bold", caption_justify="left")
    rows = experiment.table(results)
    table.add_column("")
    for row in rows:
        table.add_column(row.method, justify="right")
    for heading, cell in LINES:
        if verified or heading != WRONG:
            table.add_row(heading, *(cell(row) for row in rows))
    table.caption = "times include verifying" if verified else "--verify counts wrong answers"
    return table


def _saved(text: str) -> Callable[[Row], str]:
    """A cell of what a method saves, for the reference empty."""
    return lambda row: text.format(row) if row.method != REFERENCE else ""


WRONG = "wrong answers (of rays due)"
LINES: tuple[tuple[str, Callable[[Row], str]], ...] = (
    ("traversal steps saved, average", _saved("{0.average_steps:.1%}")),
    ("  most (frame)", _saved("{0.most_steps:.1%} ({0.most_steps_frame})")),
    ("intersection tests saved, average", _saved("{0.average_tests:.1%}")),
    ("  most (frame)", _saved("{0.most_tests:.1%} ({0.most_tests_frame})")),
    ("extra occlusion tests per pixel", lambda row: f"{row.extra_tests_per_pixel:.3f}"),
    (WRONG, lambda row: f"{row.wrong:,} ({row.wrong_part:.3%})"),
    ("time of a frame, median", lambda row: f"{1000.0 * row.frame_seconds:,.0f} ms"),
)
"""The table's lines: what each is called, and what it says of a method; WRONG means nothing unless verified."""


def csv_text(results: Results) -> str:
    """The table as CSV, parts of 1 and seconds as they are."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([f.name for f in fields(Row)])
    writer.writerows(astuple(row) for row in experiment.table(results))
    return text.getvalue()

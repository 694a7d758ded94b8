"""The command `bench`: a path of frames by several methods, as the paper's Table 1.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

import csv
import io
import json
from argparse import Namespace
from dataclasses import astuple, fields
from pathlib import Path
from typing import BinaryIO

from rich.table import Table

from tracer import experiment
from tracer.experiment import Results, Row
from tracer.scene.load import load_visible_scene
from tracer.scene.model import Cancelled
from viewer.console import print_table, working
from viewer.headless import prepare_kernels, tracing_settings
from viewer.outputs import check_writable, write_whole


def bench(path: Path, options: Namespace) -> None:
    """Run an experiment and print its table; raises SceneError, ValueError, OSError, or Cancelled before any frame."""
    settings = tracing_settings(options)
    methods = experiment.with_reference(options.methods)
    for output in (options.json, options.csv):
        if output is not None:
            check_writable(output)
    results = None
    with working() as work:
        scene = load_visible_scene(path, work.progress)
        times = experiment.path_times(scene, options.path_frames)
        numbers = frame_range(options.frames, len(times))
        prepare_kernels(work, len(scene.lights))
        for results in experiment.run(scene, settings, methods, times, numbers, work.progress, work.cancelled):
            done = len(results.frames)
            if done < len(numbers):
                work.progress(f"frame {done + 1} of {len(numbers)}, by {', '.join(methods)}", done / len(numbers))
    if results is None:
        raise Cancelled("cancelled")
    if len(results.frames) < len(numbers):
        work.note(f"cancelled after {len(results.frames)} of {len(numbers)} frames; the table is of these")
    print_table(_table(results, options.verify))
    if options.json is not None:
        _write_text(options.json, json.dumps(results.to_dict()))
    if options.csv is not None:
        _write_text(options.csv, _csv(results))


def _write_text(path: Path, text: str) -> None:
    def write(file: BinaryIO) -> None:
        file.write(text.encode())

    write_whole(path, write)


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
    width, height = results.size
    title = f"{Path(results.scene).name}, {len(results.frames)} frames, {width} x {height}: work of shadow rays saved"
    table = Table(title=title, title_justify="left", title_style="bold")
    table.add_column("method")
    for heading in ("steps", "most (frame)", "tests", "most (frame)", "extra/pixel", "wrong", "frame"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.caption = "saved on average and at most; extra occlusion tests; median time of a frame"
    if verified:
        table.caption += ", verifying included"
    for row in experiment.table(results):
        table.add_row(*_cells(row, verified))
    return table


def _cells(row: Row, verified: bool) -> list[str]:
    return [
        row.method,
        f"{row.average_steps:.1%}",
        f"{row.most_steps:.1%} ({row.most_steps_frame})",
        f"{row.average_tests:.1%}",
        f"{row.most_tests:.1%} ({row.most_tests_frame})",
        f"{row.extra_tests_per_pixel:.3f}",
        f"{row.wrong:,} ({row.wrong_part:.3%})" if verified else "?",
        f"{1000.0 * row.frame_seconds:,.0f} ms",
    ]


def _csv(results: Results) -> str:
    """The table as CSV, parts of 1 and seconds as they are."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([f.name for f in fields(Row)])
    writer.writerows(astuple(row) for row in experiment.table(results))
    return text.getvalue()

"""Results of runs as files: every figure as JSON, the table as CSV, the plot as a picture.

They are what the commands `bench` and `zoom` write, under a name that tells what and when, and never
over a file that is there.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

from tracer import experiment, zoom
from viewer.bench import csv_text as experiment_csv
from viewer.outputs import reserve, write_text
from viewer.zoom import csv_text as zoom_csv

ENDINGS = (".json", ".csv", ".png")

_drawing = threading.Lock()  # matplotlib's settings are global while a figure is drawn


def write_experiment(results: experiment.Results, verified: bool, path: Path) -> None:
    """Into a file of one of ENDINGS; raises OSError, and ValueError where there is nothing to plot."""
    if path.suffix == ".json":
        write_text(path, json.dumps(results.to_dict()))
    elif path.suffix == ".csv":
        write_text(path, experiment_csv(results))
    else:
        from viewer import figures  # loads matplotlib

        with _drawing:
            figures.save(figures.savings_figure(results, verified), path)


def write_zoom_test(results: zoom.Results, path: Path) -> None:
    """Into a file of one of ENDINGS; raises OSError."""
    if path.suffix == ".json":
        write_text(path, json.dumps(results.to_dict()))
    elif path.suffix == ".csv":
        write_text(path, zoom_csv(results))
    else:
        from viewer import figures  # loads matplotlib

        with _drawing:
            figures.save(figures.zoom_figure(results), path)


def save(folder: Path, name: str, ending: str, write: Callable[[Path], None], now: datetime | None = None) -> Path:
    """Let `write` make a new file, `name` with date, time and ending, in a folder that is made if need be; its path.

    A name that is taken gets a number.  Raises OSError in one line, and what `write` raises; then no file is left.
    """
    stem = f"{name}-{now or datetime.now():%Y-%m-%d-%H-%M-%S}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path = reserve(folder, stem, ending)
    except OSError as error:
        raise OSError(f"nothing saved: cannot write to {folder}: {error.strerror or error}") from None
    try:
        write(path)
    except BaseException:
        path.unlink(missing_ok=True)
        raise
    return path

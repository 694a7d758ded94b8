"""Results of runs as files: every figure as JSON, the table as CSV, the plot as a picture.

The commands `bench` and `zoom` write them where their options say; the window under a name that tells
what and when, and never over a file that is there.
"""

from __future__ import annotations

import json
import threading
from argparse import Namespace
from collections.abc import Callable, Mapping
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from tracer.experiments import experiment, lamp_experiment, zoom
from tracer.version import program_version
from viewer.output import reports
from viewer.util.files import check_outputs, write_each, write_new, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from viewer.output.filmstrip import Filmstrip

Results = TypeVar("Results", experiment.Results, lamp_experiment.LampResults, zoom.Results)
Writers = Mapping[str, Callable[[Results, Path], None]]
"""What writes each kind of file; raises OSError in one line, and ValueError where there is nothing to plot."""

ENDINGS = {".json": "json", ".csv": "csv", ".png": "plot"}
"""The window's files, by their endings; the commands have an option of each kind's name."""

_drawing = threading.Lock()  # matplotlib's settings are global while a figure is drawn


def _writers(csv_text: Callable[[Results], str], figure: Callable[[Results], Figure]) -> Writers[Results]:
    return {
        "json": lambda results, path: write_text(path, json_text(results.to_dict())),
        "csv": lambda results, path: write_text(path, csv_text(results)),
        "plot": lambda results, path: _plot(partial(figure, results), path),
    }


def json_text(figures: dict[str, Any]) -> str:
    """Every figure, and which version of the program found them."""
    return json.dumps(figures | {"version": program_version()})


def _plot(draw: Callable[[], Figure], path: Path) -> None:
    from viewer.output import figures  # loads matplotlib

    with _drawing:
        figures.save(draw(), path)


def _savings_figure(verified: bool, results: experiment.Results) -> Figure:
    from viewer.output import figures

    return figures.savings_figure(results, verified)


def _zoom_figure(results: zoom.Results) -> Figure:
    from viewer.output.zoom_figure import zoom_figure

    return zoom_figure(results)


def experiment_writers(verified: bool) -> Writers[experiment.Results]:
    return _writers(reports.experiment_csv, partial(_savings_figure, verified))


LAMP_WRITERS: Writers[lamp_experiment.LampResults] = {
    "json": lambda results, path: write_text(path, json_text(results.to_dict())),
    "csv": lambda results, path: write_text(path, reports.lamp_csv(results)),
}

ZOOM_WRITERS: Writers[zoom.Results] = _writers(reports.zoom_csv, _zoom_figure)


def wanted_files(options: Namespace) -> dict[str, Path]:
    """The files of a command's options, by kind; raises ValueError or OSError where they cannot all be written."""
    wanted = {kind: getattr(options, kind) for kind in ENDINGS.values()}
    if wanted["plot"] is not None:
        from viewer.output import figures  # loads matplotlib

        figures.check_ending(wanted["plot"])
    check_outputs({f"--{kind}": path for kind, path in wanted.items()})
    return {kind: path for kind, path in wanted.items() if path is not None}


def write_files(writers: Writers[Results], results: Results, wanted: Mapping[str, Path]) -> list[str]:
    """Write each kind of file that is wanted; returns why some could not be."""
    return write_each(partial(writers[kind], results, path) for kind, path in wanted.items())


def write_film(film: Filmstrip, results: zoom.Results, path: Path) -> None:
    """The filmstrip of a zoom test, as a picture; raises OSError, and ValueError where there is nothing to draw."""

    def draw() -> Figure:
        from viewer.output.film_figure import film_figure

        return film_figure(film, results)

    _plot(draw, path)


def save(folder: Path, name: str, ending: str, write: Callable[[Path], None], now: datetime | None = None) -> Path:
    """Let `write` make a new file, `name` with date, time and ending, in a folder that is made if need be; its path.

    A name that is taken gets a number.  Raises OSError in one line, and what `write` raises; then no file is left.
    """
    stem = f"{name}-{now or datetime.now():%Y-%m-%d-%H-%M-%S}"
    try:
        return write_new(folder, stem, ending, write)
    except OSError as error:
        raise OSError(f"nothing saved: {error}") from None

"""Results as files: every figure as JSON, tables as CSV, plots as pictures.

The commands `bench` and `zoom` write them where their options say; the window under a name that tells what and when,
and never over a file that is there."""

from __future__ import annotations

import csv
import io
import json
import os
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tracer.experiments import experiment, zoom
from tracer.util.version import program_version
from viewer.output import reports
from viewer.state.scene_rows import COLUMNS, Table, Values
from viewer.util.files import check_writable, whole_file, write_bytes, write_new, write_text

if TYPE_CHECKING:
    from tracer.experiments.filmstrip import Filmstrip

Results = experiment.Results | zoom.Results

ENDINGS = {".json": "json", ".csv": "csv", ".png": "plot"}
"""The window's files, by their endings; the commands have an option of each kind's name."""


def write(results: Results, path: Path, kind: str = "") -> None:
    """Write results as one of ENDINGS' kinds, by default that of the file's ending.

    Raises OSError in one line, and ValueError where there is nothing to plot."""
    kind = kind or ENDINGS[path.suffix]
    if kind == "json":
        write_json(path, results.to_dict())
    elif kind == "csv":
        write_csv(path, *reports.table_of(results))
    else:
        from tracer.experiments import figures  # loads matplotlib

        if isinstance(results, zoom.Results):
            figure = figures.zoom_figure(results)
        else:
            figure = figures.savings_figure(results)
        write_bytes(path, figures.file_of(figure, path.suffix))


def write_json(path: Path, figures: Mapping[str, Any], indent: int | None = None) -> None:
    """Write figures, and which version of the program found them; raises OSError in one line."""
    write_text(path, json.dumps({**figures, "version": program_version()}, indent=indent))


def write_film(film: Filmstrip, results: zoom.Results, path: Path) -> None:
    """Write the filmstrip of a zoom test, as a picture; raises as `write`."""
    from tracer.experiments import figures

    write_bytes(path, figures.file_of(figures.film_figure(film, results), path.suffix))


def wanted_files(options: Namespace) -> dict[str, Path]:
    """Return the files of a command's options, by kind; raises ValueError or OSError where they cannot all be
    written."""
    wanted = {kind: path for kind in ENDINGS.values() if (path := getattr(options, kind)) is not None}
    if "plot" in wanted:
        from tracer.experiments import figures

        figures.check_ending(wanted["plot"])
    for path in wanted.values():
        check_writable(path)
    if len({os.path.realpath(path) for path in wanted.values()}) < len(wanted):
        raise ValueError(f"{', '.join(f'--{kind}' for kind in wanted)}: give each a file of its own")
    return wanted


def write_files(results: Results, wanted: Mapping[str, Path]) -> list[str]:
    """Write each kind of file that is wanted; returns why some could not be, which take no others along."""
    failures = []
    for kind, path in wanted.items():
        try:
            write(results, path, kind)
        except (OSError, ValueError) as error:
            failures.append(str(error))
    return failures


def save(folder: Path, name: str, ending: str, write: Callable[[Path], None], now: datetime | None = None) -> Path:
    """Let `write` make a new file, `name` with date, time and ending, in a folder that is made if need be; its path.

    A name that is taken gets a number.  Raises OSError in one line, and what `write` raises; then no file is left."""
    try:
        return write_new(folder, f"{name}-{now or datetime.now():%Y-%m-%d-%H-%M-%S}", ending, write)
    except OSError as error:
        raise OSError(f"nothing saved: {error}") from None


# --- CSV -------------------------------------------------------------------------------------------


def write_csv(path: Path, headings: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a table, row by row, as there may be millions; raises OSError in one line."""
    with whole_file(path) as (_, file):
        text = io.TextIOWrapper(file, "utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(headings)
        writer.writerows(rows)
        text.detach()


def write_rows(table: Table, rows: NDArray[np.int32], path: Path) -> None:
    """Write these rows of a table of the scene, in their order, under its columns' titles; what is not known is empty.

    Raises OSError in one line."""
    columns = ((column.title, table.columns.get(column.name)) for column in COLUMNS[table.level])
    known = {title: values for title, values in columns if values is not None}
    write_csv(path, list(known), zip(*(_cells(values, rows) for values in known.values()), strict=True))


def _cells(values: Values, rows: NDArray[np.int32]) -> Iterator[str]:
    """Give the texts of a column one after another, as there may be millions."""
    numbers = values.numbers[rows]
    if values.words is not None:
        return map((*values.words, "").__getitem__, numbers)  # -1 finds the last of them
    if numbers.dtype.kind == "f":
        return (f"{number:.2f}" if number == number else "" for number in numbers)
    return map(str, numbers)

"""Rows of a table as CSV, written some at a time, as there may be millions."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from viewer.state.scene_rows import COLUMNS, Table, Values
from viewer.util.files import write_whole

_AT_ONCE = 1 << 14


def write_rows(table: Table, rows: NDArray[np.int32], path: Path) -> None:
    """Write these rows of a table, in their order, with its columns' titles; what is not known is left empty.

    Raises OSError in one line."""
    columns = [(column.title, table.columns.get(column.name)) for column in COLUMNS[table.level]]
    known = [(title, values) for title, values in columns if values is not None]

    def write(file: BinaryIO) -> None:
        text = io.StringIO(newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([title for title, _ in known])
        for start in range(0, len(rows), _AT_ONCE):
            some = rows[start : start + _AT_ONCE]
            writer.writerows(zip(*(_cells(values, some) for _, values in known), strict=True))
            file.write(text.getvalue().encode())
            text.seek(0)
            text.truncate()
        file.write(text.getvalue().encode())

    write_whole(path, write)


def _cells(values: Values, rows: NDArray[np.int32]) -> list[str]:
    numbers = values.numbers[rows]
    if values.words is not None:
        words = [*values.words, ""]  # -1 finds the last of them
        return [words[code] for code in numbers.tolist()]
    if numbers.dtype.kind == "f":
        return [f"{number:.2f}" if number == number else "" for number in numbers.tolist()]
    return [str(number) for number in numbers.tolist()]

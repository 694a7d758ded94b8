"""The rows of a table that are seen, and in which order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viewer.state.row_filter import FilterError, matching
from viewer.state.scene_rows import Table


@dataclass(frozen=True)
class Order:
    """What is asked of a level: the text of its filter, and the column that its rows are sorted by."""

    text: str = ""
    column: str = ""
    descending: bool = False


@dataclass(frozen=True)
class Listing:
    """A table, and the numbers of its rows that are seen, in their order, (rows,) int32; `problem` says why the filter
    is not understood, "" where it is."""

    table: Table
    rows: NDArray[np.int32]
    order: Order
    problem: str = ""


def listed(table: Table, order: Order, before: Listing | None) -> Listing:
    """The rows of a table in this order.  Those that stand equal keep the order that they had before; where the filter
    is not understood, those are seen that were before."""
    try:
        found, problem = matching(table, order.text), ""
    except FilterError as error:
        found, problem = np.ones(table.rows, np.bool_), str(error)
        if before is not None and before.table.rows == table.rows:
            found = np.zeros(table.rows, np.bool_)
            found[before.rows] = True
    rows = np.flatnonzero(found).astype(np.int32)
    values = table.columns.get(order.column)
    same = before is not None and before.order.column == order.column and before.order.descending == order.descending
    if same and before is not None and len(before.rows) == len(rows) and found[before.rows].all():
        rows = before.rows
    if values is None:
        return Listing(table, rows, order, problem)
    keys = values.keys[rows]
    if order.descending:
        keys = -keys.astype(np.int64) if keys.dtype.kind in "iu" else -keys  # NaN stays last
        if values.words is not None:
            keys[values.numbers[rows] < 0] = len(values.words)
    return Listing(table, rows[np.argsort(keys, kind="stable")], order, problem)

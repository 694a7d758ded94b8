"""Which rows of a table are to be seen, by what is typed above it, and in which order.

All that is typed must hold.  A word finds rows that have it in a name, a number alone the primitive of that number.
`pixels>100`, `share<=50` and `number:10-20` compare; `object:wall`, `mode:full_shadow` and `is:dynamic` look into one
column; `object="left wall"` is the whole name.  A `-` in front finds the others.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from viewer.state.scene_rows import COLUMNS, Level, Table, Values

HINTS = {
    Level.PRIMITIVES: "wall   pixels>100   mode:full_shadow   share<50   -is:dynamic",
    Level.OBJECTS: "wall   pixels>100   rendered>0   share<50   -is:dynamic",
}
HELP = """All of what you type must hold:
  wall    rows with this in a name
  1234    the primitive with this number
  pixels>100   share<=50   number:10-20    by number
  object:wall   material:glass   kind:sphere    by word
  mode:full_shadow   occlusion:init   shadow:non    by mode
  is:seen   is:unseen   is:dynamic   is:wrong   is:hidden
  object="left wall"    the whole name
  -is:seen    all others"""
_MODES = ("occlusion", "shadow")
_TOKEN = re.compile(r'(?:[^\s"]|"[^"]*"?)+')
_COMPARISON = re.compile(r"^([a-zA-Z_]+)(>=|<=|>|<|=|:)(.*)$", re.DOTALL)
_RANGE = re.compile(r"^([\d.]+)-([\d.]+)$")
_OPERATORS: dict[str, Callable[[NDArray, float], NDArray]] = {
    ">": operator.gt, "<": operator.lt, ">=": operator.ge, "<=": operator.le, "=": operator.eq, ":": operator.eq,
}  # fmt: skip
_WHEN_KNOWN = {
    "wrong": "wrong answers are known while frames are verified",
    "occlusion": "this picture has no modes",
    "shadow": "this picture has no modes for this light",
}


class FilterError(ValueError):
    """What was typed is not understood; the message is one line that says what, and what to do."""


def matching(table: Table, text: str) -> NDArray[np.bool_]:
    """(rows,) the rows that are to be seen; raises FilterError."""
    found = np.ones(table.rows, np.bool_)
    for token in _TOKEN.findall(text):
        turned = len(token) > 1 and token[0] == "-"
        one = _holds(table, token[1:] if turned else token)
        found &= ~one if turned else one
    return found


def _holds(table: Table, token: str) -> NDArray[np.bool_]:
    comparison = _COMPARISON.match(token)
    if comparison is None:
        return _anywhere(table, token.replace('"', ""))
    name, comparing, wanted = comparison[1].lower(), comparison[2], comparison[3].replace('"', "")
    if not wanted:
        raise FilterError(f"{name}{comparing} needs a value")
    if name == "is":
        return _state(table, wanted.lower())
    if name == "mode" and table.level is Level.PRIMITIVES:
        return _modes(table, [mode for mode in _MODES if table.columns.get(mode) is not None], wanted)
    values = _column(table, name)
    if values.words is None:
        return _number(values, comparing, wanted)
    if comparing not in (":", "="):
        raise FilterError(f"{name} is a word: write {name}:{wanted}")
    if name in _MODES:
        return _modes(table, [name], wanted)
    folded = wanted.casefold()
    if comparing == ":":
        return _with(values, [folded in word.casefold() for word in values.words])
    return _with(values, [folded == word.replace('"', "").casefold() for word in values.words])


def _column(table: Table, name: str) -> Values:
    known = [column.name for column in COLUMNS[table.level]]
    if name not in known:
        close = get_close_matches(name, known, 1)
        hint = f"do you mean {close[0]}?" if close else f"there are {', '.join(known)}"
        raise FilterError(f"no column is called {name}: {hint}")
    values = table.columns.get(name)
    if values is None:
        raise FilterError(_WHEN_KNOWN.get(name, "shadow rays are not counted yet"))
    return values


def _anywhere(table: Table, word: str) -> NDArray[np.bool_]:
    """The primitive of this number, or rows with the word in a name."""
    if table.level is Level.PRIMITIVES and word.isdecimal():
        return np.arange(table.rows) == _as_number(word)
    found = np.zeros(table.rows, np.bool_)
    for name in ("object", "kind", "material", "texture"):
        values = table.columns.get(name)
        if values is not None and values.words:
            found |= _with(values, [word.casefold() in one.casefold() for one in values.words])
    return found


def _with(values: Values, wanted: Sequence[bool]) -> NDArray[np.bool_]:
    """Rows whose word is one of those wanted."""
    return np.array([*wanted, False], np.bool_)[values.numbers]  # -1 finds the last of them


def _modes(table: Table, names: Sequence[str], wanted: str) -> NDArray[np.bool_]:
    """Rows with a mode like this in one of these columns."""
    columns = [_column(table, name) for name in names or _MODES]
    known = {word for values in columns for word in values.words or ()}
    like = {word for word in known if re.sub(r"[_-]", " ", wanted.casefold()) in word}
    if not like:
        raise FilterError(f"no mode is called {wanted}: there are {', '.join(sorted(known))}")
    return np.logical_or.reduce([_with(values, [word in like for word in values.words or ()]) for values in columns])


def _number(values: Values, comparing: str, wanted: str) -> NDArray[np.bool_]:
    between = _RANGE.match(wanted)
    if between is not None and comparing in (":", "="):
        low, high = _as_number(between[1]), _as_number(between[2])
        return (values.numbers >= low) & (values.numbers <= high)
    return np.asarray(_OPERATORS[comparing](values.numbers, _as_number(wanted)), np.bool_)


def _as_number(text: str) -> float:
    try:
        return float(text.rstrip("%"))
    except ValueError:
        raise FilterError(f"{text} is no number") from None


_STATES: dict[str, tuple[str, Callable[[NDArray], NDArray]]] = {  # a column, and which of its numbers
    "seen": ("pixels", lambda pixels: pixels > 0),
    "unseen": ("pixels", lambda pixels: pixels == 0),
    "wrong": ("wrong", lambda wrong: wrong > 0),
    "dynamic": ("motion", lambda motion: motion == 1),
    "static": ("motion", lambda motion: motion == 0),
    "hidden": ("hidden", lambda hidden: hidden == 1),
    "shown": ("hidden", lambda hidden: hidden == 0),
}


def _state(table: Table, wanted: str) -> NDArray[np.bool_]:
    """Rows of which something is true."""
    if wanted not in _STATES:
        raise FilterError(f"is:{wanted} is not known: there are {', '.join(_STATES)}")
    name, holds = _STATES[wanted]
    values = table.columns[name] if name in ("motion", "hidden") else _column(table, name)
    assert values is not None
    return np.asarray(holds(values.numbers), np.bool_)


# --- the rows that are seen, in their order ---------------------------------------------------------


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

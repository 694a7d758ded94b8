"""Which rows of a table are to be seen, by what is typed above it (`HELP`), and in which order."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from tracer.util.text import mode_in_words
from viewer.state.scene_rows import COLUMNS, Level, Table, Values

HINT = "wall   pixels>100   is:dynamic"
HELP = """All of what you type must hold:
  wall    rows with this in a name
  1234    the primitive with this number
  pixels>100   share<=50   number:10-20    by number
  object:wall   material:glass   kind:sphere    by word
  occlusion:init   shadow:full_shadow    by mode
  is:seen   is:unseen   is:dynamic   is:wrong   is:hidden
  object="left wall"    the whole name
  -is:seen    all others"""
_MODES = ("occlusion", "shadow")
_STATES = {
    "seen": "pixels>0", "unseen": "pixels=0", "wrong": "wrong>0", "dynamic": "motion=dynamic",
    "static": "motion=static", "hidden": "hidden=hidden", "shown": "hidden=shown",
}  # fmt: skip
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


@dataclass(frozen=True)
class Order:
    """What is asked of a level: the text of its filter, and the column that its rows are sorted by."""

    text: str = ""
    column: str = ""
    descending: bool = False


def listed(table: Table, order: Order) -> NDArray[np.int32]:
    """The numbers of the rows that are seen, in their order; raises FilterError."""
    rows = np.flatnonzero(matching(table, order.text)).astype(np.int32)
    values = table.columns.get(order.column)
    if values is None:
        return rows
    keys = values.keys[rows]
    return rows[np.argsort(-keys if order.descending else keys, kind="stable")]


def matching(table: Table, text: str) -> NDArray[np.bool_]:
    """(rows,) the rows that are to be seen; raises FilterError."""
    found = np.ones(table.rows, np.bool_)
    for token in _TOKEN.findall(text):
        negated = len(token) > 1 and token[0] == "-"
        found &= _holds(table, token[negated:]) != negated
    return found


def _holds(table: Table, token: str) -> NDArray[np.bool_]:
    comparison = _COMPARISON.match(token)
    if comparison is None:
        return _anywhere(table, token.replace('"', ""))
    name, sign, wanted = comparison[1].lower(), comparison[2], comparison[3].replace('"', "")
    if not wanted:
        raise FilterError(f"{name}{sign} needs a value")
    if name == "is":
        if wanted.lower() not in _STATES:
            raise FilterError(f"is:{wanted} is not known: there are {', '.join(_STATES)}")
        return _holds(table, _STATES[wanted.lower()])
    values = _column(table, name)
    if values.words is None:
        return _compares(values, sign, wanted)
    if sign not in (":", "="):
        raise FilterError(f"{name} is a word: write {name}:{wanted}")
    if name in _MODES:
        wanted = mode_in_words(wanted.replace("-", "_"))
        if not any(wanted.casefold() in word for word in values.words):
            raise FilterError(f"no mode is called {wanted}: there are {', '.join(sorted(values.words))}")
    return _has_word(values, wanted, whole=sign == "=")


def _column(table: Table, name: str) -> Values:
    known = [column.name for column in COLUMNS[table.level]]
    if name not in known and name not in table.columns:
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
    named = (table.columns.get(name) for name in ("object", "kind", "material", "texture"))
    return np.logical_or.reduce([_has_word(values, word) for values in named if values is not None])


def _has_word(values: Values, wanted: str, whole: bool = False) -> NDArray[np.bool_]:
    """Rows whose word has this in it, or is it as a `whole`."""
    wanted, words = wanted.casefold(), [word.replace('"', "").casefold() for word in values.words or ()]
    holds = [wanted == word if whole else wanted in word for word in words]
    return np.array([*holds, False], np.bool_)[values.numbers]  # -1 finds the last of them


def _compares(values: Values, sign: str, wanted: str) -> NDArray[np.bool_]:
    between = _RANGE.match(wanted)
    if between is not None and sign in (":", "="):
        low, high = _as_number(between[1]), _as_number(between[2])
        return (values.numbers >= low) & (values.numbers <= high)
    return np.asarray(_OPERATORS[sign](values.numbers, _as_number(wanted)), np.bool_)


def _as_number(text: str) -> float:
    try:
        return float(text.rstrip("%"))
    except ValueError:
        raise FilterError(f"{text} is no number") from None

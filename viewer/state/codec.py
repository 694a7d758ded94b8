"""Values of declared types as JSON and back: states, preferences, presets, and what saved pictures carry.

msgspec reads the types of dataclasses, tuples, enums and sets, and says in one line what does not fit.  What a stored
value lacks keeps what it has in the value that it is read onto, and what it has too much is ignored, so that other
versions' files can be read."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import fields
from functools import reduce
from operator import getitem
from typing import Any, TypeVar, get_args, get_origin

import msgspec
import numpy as np

from tracer.util.setting import NEVER, PICTURES, Setting, kinds_in_words, settings_of
from viewer.state.draw_options import DrawOptions
from viewer.state.view_state import ViewState

T = TypeVar("T")
FORMAT = 2
"""Of saved states: version 0.2 wrote format 1."""


def to_json(value: Any) -> Any:
    """Return a value as dictionaries, lists, numbers and words."""
    return _with_lists(msgspec.to_builtins(value, enc_hook=_plain, order="deterministic"))


def from_json(data: Any, kind: type[T], what: str = "it") -> T:
    """Return the inverse of `to_json`; raises ValueError, in one line, on anything else."""
    try:
        return msgspec.convert(data, kind)
    except (msgspec.ValidationError, OverflowError, RecursionError) as error:
        said, _, place = str(error).partition(" - at ")
        where = place.strip("`").removeprefix("$").lstrip(".")
        said = re.sub(r"`(.*?)`", kinds_in_words, said[:1].lower() + said[1:])
        said = said.replace("invalid enum value", "there is no")
        raise ValueError(f"{what} is damaged: {f'{where}: ' if where else ''}{said}") from None


def text(value: Any, indent: int | None = None) -> str:
    """Return a value as the text of JSON; infinities are written as Python does."""
    return json.dumps(to_json(value), indent=indent)


def from_text(text: str | bytes) -> Any:
    """Return what the text of JSON says; raises ValueError, in one line."""
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("its JSON is nested too deeply") from None


def forgiven(data: Any, kind: Any, default: Any) -> Any:
    """Return what stored data has of a type: of lists and dictionaries what is right of them, else the default."""
    try:
        return msgspec.convert(data, kind)
    except (msgspec.ValidationError, OverflowError, RecursionError):
        pass
    parts = get_args(kind)
    if isinstance(data, list) and get_origin(kind) is list:
        return [item for item in (forgiven(one, parts[0], None) for one in data) if item is not None]
    if isinstance(data, dict) and get_origin(kind) is dict:
        found = {name: forgiven(value, parts[1], None) for name, value in data.items()}
        return {name: value for name, value in found.items() if value is not None}
    return default


def _onto(base: dict[str, Any], data: Mapping[str, Any]) -> dict[str, Any]:
    """Dictionaries go into dictionaries; all else takes the place of what was there."""
    inner = {
        name: _onto(base[name], value)
        for name, value in data.items()
        if isinstance(value, Mapping) and isinstance(base.get(name), dict)
    }
    return {**base, **data, **inner}


def _with_lists(data: Any) -> Any:
    """Lists in the place of tuples, so that what is stored is equal to what is read again."""
    if isinstance(data, dict):
        return {name: _with_lists(value) for name, value in data.items()}
    return [_with_lists(value) for value in data] if isinstance(data, (list, tuple)) else data


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    return str(value)


# --- states ----------------------------------------------------------------------------------------


def state_to_json(state: ViewState, of_picture: bool = False) -> dict[str, Any]:
    """Return what is stored of a state; `of_picture`: with what it takes to make the same picture on any machine."""
    data = _without(to_json(state), (NEVER,) if of_picture else (NEVER, PICTURES))
    del data["compare"]
    if of_picture:
        del data["pace"]  # which is how a window got there
    return {"format": FORMAT, **data}


def state_from_json(data: Any, onto: ViewState | None = None, drawn: Mapping[str, Any] | None = None) -> ViewState:
    """Return a stored state; what it lacks is as in `onto`.  Raises ValueError, in one line.

    `drawn` is what version 0.2 kept beside it of how its picture was drawn."""
    if not isinstance(data, Mapping):
        raise ValueError("no saved state in it")
    today = _of_today(data, drawn) if "draw" not in data and (drawn or "view" in data) else data
    stored = {name: value for name, value in today.items() if name != "compare"}
    whole = _onto(to_json(onto or ViewState()), _without(stored, (NEVER,)))
    return from_json(whole, ViewState, "its saved state").validated()


def state_from_file(data: Any) -> ViewState:
    """Return the state of a file that holds nothing else; raises ValueError, in one line.

    People write such files by hand as well, so that a name that means nothing is a mistake."""
    if not isinstance(data, Mapping) or "format" not in data:
        raise ValueError("a state has a format, a scene, and what of settings and draw is not as usual")
    if data["format"] != FORMAT:
        raise ValueError(f"its format is {data['format']}, and this version knows {FORMAT}")
    if not data.get("scene"):
        raise ValueError("it names no scene")
    for name in _unknown({"format": FORMAT, **to_json(ViewState())}, data):
        raise ValueError(f"{name} means nothing in a state")
    return state_from_json(data)


def _unknown(known: Mapping[str, Any], data: Mapping[str, Any], within: str = "") -> Iterator[str]:
    """The names in stored data that are none of what is known."""
    for name, value in data.items():
        if name not in known:
            yield within + name
        elif isinstance(value, Mapping) and isinstance(known[name], Mapping):
            yield from _unknown(known[name], value, f"{within}{name}.")


def remembered(state: ViewState) -> dict[str, Any]:
    """Return what a window that is started later takes over of a state."""
    found, data = to_json(state), dict[str, Any]()
    for one in _REMEMBERED:
        value = reduce(getitem, _names(one), found)
        data = _onto(data, _nested(one, value))
    return data


def recalled(data: Any) -> ViewState:
    """Return the state that a window starts with; what is wrong with what is stored has its default."""
    state = ViewState.in_window()
    for one in _REMEMBERED:
        with suppress(ValueError, LookupError, TypeError):  # what is stored may be anything
            state = state_from_json(_nested(one, reduce(getitem, _names(one), data)), state)
    return state


_REMEMBERED = tuple(one for one in settings_of(ViewState) if one.remembered and one.stored != NEVER)


def _names(one: Setting) -> tuple[str, ...]:
    return (*one.within, one.name)


def _nested(one: Setting, value: Any) -> dict[str, Any]:
    """Return a value of a setting as it stands in a state."""
    for name in reversed(_names(one)):
        value = {name: value}
    return value


def _without(data: dict[str, Any], stored: tuple[str, ...]) -> dict[str, Any]:
    """Return a state without the settings that are stored like this."""
    for one in settings_of(ViewState):
        inner: Any = data
        for name in one.within:
            inner = inner.get(name) if isinstance(inner, dict) else None
        if one.stored in stored and isinstance(inner, dict):
            inner.pop(one.name, None)
    return data


def _of_today(data: Mapping[str, Any], picture: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """What version 0.2 wrote of a state, and of how its picture was drawn and what came before it, as it is today."""
    try:
        picture = dict(picture or {})
        style = dict(picture.get("style", {}))
        draw = {name: data[name] for name in ("view", "light", "wipe", "tone", "slice") if name in data}
        draw |= {name: style[name] for name in _STYLE if name in style}
        draw |= {"mark_wrong": style.get("marked", True)}
        if data.get("span") is not None:
            draw["spans"] = [[data.get("view", "color"), data["span"]]]
        if style.get("legend") is not None:
            draw |= {"legend": True, "legend_at": style["legend"]}
        of_machine = {name: picture[name] for name in ("accelerator", "threads") if name in picture}
        warmup = {new: picture[old] for old, new in _WARMUP.items() if old in picture}
        return {
            **{name: data[name] for name in ("scene", "time", "meshes", "edits") if name in data},
            "camera": None if data.get("follow") else data["camera"],
            "settings": {**dict(data.get("settings", {})), **of_machine},
            "draw": draw,
            "warmup": warmup,
        }
    except KeyError as error:
        raise ValueError(f"its saved state lacks {error}") from None
    except (TypeError, ValueError):
        raise ValueError("its saved state is damaged") from None


_STYLE = {one.name for one in fields(DrawOptions)} - {"legend"}  # which was its place, if there was one
_WARMUP = {"before": "frames", "warmup": "of_path", "repeats": "repeats", "modes": "modes", "history": "unknown"}

"""Edits of the scene (`tracer.scene.edits`) in words and as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.limits import LARGEST
from viewer.util.json_numbers import finite, whole


def to_json(edits: Edits) -> dict[str, Any]:
    """What there is of edits; nothing for none."""
    values: dict[str, Any] = {
        "lights_off": sorted(edits.lights_off),
        "moved_lights": [[number, list(place)] for number, place in edits.moved_lights],
        "hidden": sorted(edits.hidden),
        "hidden_primitives": sorted(edits.hidden_primitives),
        "static": [[name, time] for name, time in edits.static],
        "moving": sorted(edits.moving),
    }
    return {name: value for name, value in values.items() if value}


def from_json(data: Any) -> Edits:
    """The inverse of `to_json`; raises ValueError, in one line, on anything else."""
    if not isinstance(data, Mapping) or not all(_is_list(value) for value in data.values()):
        raise ValueError("its edits of the scene are damaged")
    try:
        return Edits(
            frozenset(_number(n) for n in data.get("lights_off", ())),
            tuple(sorted({_number(n): _place(place) for n, place in data.get("moved_lights", ())}.items())),
            frozenset(_name(n) for n in data.get("hidden", ())),
            frozenset(_number(n) for n in data.get("hidden_primitives", ())),
            tuple(sorted({_name(name): finite(time) for name, time in data.get("static", ())}.items())),
            frozenset(_name(n) for n in data.get("moving", ())),
        )
    except (TypeError, ValueError):
        raise ValueError("its edits of the scene are damaged") from None


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def _number(value: Any) -> int:
    if whole(value) < 0:
        raise ValueError("a number in it is below 0")
    return whole(value)


def _name(value: Any) -> str:
    if type(value) is not str:
        raise ValueError(value)
    return value


def _place(value: Any) -> tuple[float, float, float]:
    x, y, z = (finite(part) for part in value)
    if max(abs(x), abs(y), abs(z)) > LARGEST:
        raise ValueError(value)
    return x, y, z


def differences(before: Edits, after: Edits) -> dict[str, str]:
    """What has changed from the one to the other: for each target, in a few words, what it is now."""
    changed: dict[str, str] = {}
    for number in sorted(before.lights_off ^ after.lights_off):
        changed[f"edits.light {number}"] = f"light {number} {'off' if number in after.lights_off else 'on'}"
    for number, place in _other(dict(before.moved_lights), dict(after.moved_lights)):
        changed[f"edits.place of light {number}"] = f"light {number} {'moved' if place else 'where it was'}"
    for name in sorted(before.hidden ^ after.hidden):
        changed[f"edits.{name}"] = f"{name} {'hidden' if name in after.hidden else 'shown'}"
    for number in sorted(before.hidden_primitives ^ after.hidden_primitives):
        hidden = number in after.hidden_primitives
        changed[f"edits.primitive {number}"] = f"primitive {number} {'hidden' if hidden else 'shown'}"
    for name, time in _other(dict(before.static), dict(after.static)):
        changed[f"edits.rest of {name}"] = f"{name} {'moving' if time is None else 'static'}"
    for name in sorted(before.moving ^ after.moving):
        changed[f"edits.rest of {name}"] = f"{name} {'moving' if name in after.moving else 'static'}"
    return changed


def _other(before: dict[Any, Any], after: dict[Any, Any]) -> Iterable[tuple[Any, Any]]:
    """What is otherwise, and how it is now, None where nothing is said of it any more."""
    return ((key, after.get(key)) for key in sorted(before.keys() | after.keys()) if before.get(key) != after.get(key))


def one_by_one(edits: Edits) -> list[tuple[str, Edits]]:
    """Each edit in a few words, and all others without it."""
    without = [
        *(edits.with_light(number, True) for number in edits.lights_off),
        *(edits.with_light_at(number, None) for number, _ in edits.moved_lights),
        *(edits.with_thing(name, True) for name in edits.hidden),
        *(edits.with_primitive(number, True) for number in edits.hidden_primitives),
        *(edits.with_static(name, None) for name, _ in edits.static),
        *(edits.with_moving(name, False) for name in edits.moving),
    ]
    return sorted(((" and ".join(differences(one, edits).values()), one) for one in without), key=lambda pair: pair[0])


def as_options(edits: Edits) -> list[str]:
    """The options of a command line that ask for these edits, to the bit."""
    return [
        *(f"--without-light={number}" for number in sorted(edits.lights_off)),
        *(f"--move-light={number}={','.join(repr(part) for part in place)}" for number, place in edits.moved_lights),
        *(f"--hide={name}" for name in sorted(edits.hidden)),
        *(f"--hide-primitive={number}" for number in sorted(edits.hidden_primitives)),
        *(f"--make-static={name}={time!r}" for name, time in edits.static),
        *(f"--make-moving={name}" for name in sorted(edits.moving)),
    ]


def in_words(edits: Edits) -> list[str]:
    """Each edit in a few words."""
    return list(differences(NO_EDITS, edits).values())

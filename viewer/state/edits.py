"""Edits of the scene (`tracer.scene.edits`) in words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from tracer.scene.edits import NO_EDITS, Edits


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

"""Options that edit the scene before it is traced: what if a light were off, an object were not there?"""

from __future__ import annotations

import argparse
import math
from argparse import Namespace
from typing import TYPE_CHECKING, Any

from viewer.cli.argument_types import count

if TYPE_CHECKING:
    from tracer.scene.edits import Edits
    from tracer.scene.model import Scene

_NUMBER = count(0, 2**31 - 1)
_SHOWN = 8  # names that a message lists, at most


def add_edits(parser: argparse.ArgumentParser) -> None:
    """All of them; each may be given several times."""

    def add(name: str, metavar: str, help_: str, kind: Any = str) -> None:
        parser.add_argument(name, type=kind, action="append", default=[], metavar=metavar, help=help_)

    add("--without-light", "N", "switch off this light; edits may be given several times", _NUMBER)
    add("--move-light", "N=X,Y,Z", "put this light elsewhere", _moved)
    add("--hide", "NAME", "hide this object, by its name in the Inspector")
    add("--hide-primitive", "N", "hide this primitive alone", _NUMBER)
    add("--make-static", "NAME=T", "let an object that moves stay where it is at T seconds, as static geometry", _at)
    add("--make-moving", "NAME", "let a static object be one that could move; it stays where it is")


def _moved(text: str) -> tuple[int, tuple[float, float, float]]:
    from tracer.scene.limits import LARGEST

    number, equals, place = text.partition("=")
    try:
        x, y, z = (float(part) for part in place.split(","))
        found = int(number), (x, y, z)
    except ValueError:
        found = -1, (0.0, 0.0, 0.0)
    if not equals or found[0] < 0:
        raise argparse.ArgumentTypeError(f"{text!r} is no light and place; give them like 2=1.5,3,-0.5")
    if not all(abs(part) <= LARGEST for part in found[1]):
        raise argparse.ArgumentTypeError(f"{text!r}: a light is within {LARGEST:g} of the origin along each axis")
    return found


def _at(text: str) -> tuple[str, float]:
    name, equals, time = text.rpartition("=")
    try:
        found = float(time)
    except ValueError:
        found = math.nan
    if not equals or not name or not math.isfinite(found):
        raise argparse.ArgumentTypeError(f"{text!r} is no object and time; give them like train=2.5")
    return name, found


def edits_of(options: Namespace) -> Edits:
    """What the options ask for."""
    from tracer.scene.edits import Edits

    return Edits(
        frozenset(options.without_light),
        tuple(sorted(dict(options.move_light).items())),
        frozenset(options.hide),
        frozenset(options.hide_primitive),
        tuple(sorted(dict(options.make_static).items())),
        frozenset(options.make_moving),
    )


def edited_scene(scene: Scene, options: Namespace) -> Scene:
    """The scene as the options edit it; raises ValueError, in one line, for what the scene does not have."""
    from tracer.scene.edits import edited
    from tracer.scene.things import things

    edits = edits_of(options)
    known = {thing.name: thing.moves for thing in things(scene)}
    for option, name in [("--hide", n) for n in edits.hidden] + [("--make-moving", n) for n in edits.moving]:
        _check(option, name, [n for n in known if option == "--hide" or not known[n]])
    for name, _ in edits.static:
        _check("--make-static", name, [n for n in known if known[n]])
    numbers = [("--without-light", n) for n in edits.lights_off] + [("--move-light", n) for n, _ in edits.moved_lights]
    for option, number in numbers:
        if number >= len(scene.lights):
            raise ValueError(f"{option} {number}: the scene has {_lights(len(scene.lights))}")
    for number in edits.hidden_primitives:
        if number >= scene.primitive_count:
            raise ValueError(
                f"--hide-primitive {number}: the scene has the primitives 0 to {scene.primitive_count - 1}"
            )
    return edited(scene, edits).scene


def light_index(options: Namespace, option: str, number: int, scene: Scene) -> int:
    """Which of the lights of the scene, as it is edited, has this number in its file.

    Raises ValueError, in one line, where none has."""
    from viewer.views.legend import lights_in_words

    edits = edits_of(options)
    index = edits.light_index(number)
    if index is None:
        raise ValueError(f"{option}{number}: this light is switched off (--without-light {number})")
    if index >= len(scene.lights):
        raise ValueError(f"{option}{number}: {lights_in_words(len(scene.lights) + len(edits.lights_off))}")
    return index


def _lights(number: int) -> str:
    return f"the lights 0 to {number - 1}" if number > 1 else "the light 0" if number else "no lights"


def _check(option: str, name: str, known: list[str]) -> None:
    if name in known:
        return
    kind = {"--make-static": "object that moves", "--make-moving": "static object"}.get(option, "object")
    some = ", ".join(known[:_SHOWN]) + (f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else "")
    raise ValueError(f"{option} {name}: no {kind} of this name" + (f"; there is {some}" if known else ""))


def defaults(edits: Edits) -> dict[str, Any]:
    """Edits, such as those of a saved picture, by the names of the options."""
    return {
        "without_light": sorted(edits.lights_off),
        "move_light": list(edits.moved_lights),
        "hide": sorted(edits.hidden),
        "hide_primitive": sorted(edits.hidden_primitives),
        "make_static": list(edits.static),
        "make_moving": sorted(edits.moving),
    }

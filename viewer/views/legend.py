"""What a legend consists of: the colours of a view, what each stands for, and how much of the frame has it.

The window draws it into the picture, or beside it, and a saved picture may carry it; `legend_layout` says where its
parts lie.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from tracer.scene.lights import Light, number_of
from viewer.state.palette import Color
from viewer.util.numbers import count


class NoteKind(Enum):
    """How a note is meant."""

    PLAIN = "a fact"
    GOOD = "all is well"
    WARNING = "take care"


@dataclass(frozen=True)
class Entry:
    """A line: a colour, or none, what it stands for, a value for each of the legend's columns, and more in words.

    Where it is `quiet`, its values name what is below them; the colour may have `stripes` of another."""

    name: str
    color: Color | None = None
    values: tuple[str, ...] = ()
    meaning: str = ""
    quiet: bool = False
    stripes: Color | None = None


@dataclass(frozen=True)
class Scale:
    """The colour map as a bar, and what its ends and its middle stand for; `reverse` begins with its last colour, and
    `signed` is that of a signed difference."""

    low: str
    high: str
    middle: str = ""
    reverse: bool = False
    signed: bool = False


@dataclass(frozen=True)
class Note:
    """A sentence below the rest."""

    text: str
    kind: NoteKind = NoteKind.PLAIN


@dataclass(frozen=True)
class Legend:
    """A title, names of the columns of values, and the rest as far as there is any; `facts` come after the colours."""

    title: str
    columns: tuple[str, ...] = ()
    entries: tuple[Entry, ...] = ()
    scale: Scale | None = None
    facts: tuple[Entry, ...] = ()
    notes: tuple[Note, ...] = ()


def fact(name: str, value: str, meaning: str = "") -> Entry:
    """Return a line without a colour."""
    return Entry(name, None, (value,), meaning)


def counts_scale(most: int, span: tuple[float, float] | None) -> Scale:
    """Return the scale of a count: over what was chosen, or up to the most that there is."""
    if span is not None:
        return Scale(f"{span[0]:.4g}", f"{span[1]:.4g}")
    return Scale("0", count(most), count(most // 2) if most % 2 == 0 else "")


def light_in_words(number: int, name: str) -> str:
    """Return a light by its number, and its name where that says more: light 2 (lamp)."""
    said = f"light {number}"
    return said if name in ("", said) else f"{said} ({name})"


def named_light(lights: Sequence[Light], light: int) -> str:
    """Return the same of one of a scene's lights; its number is that in the scene as it was read, whichever are off."""
    return light_in_words(number_of(lights, light), lights[light].name if light < len(lights) else "")


def lights_in_words(lights: int) -> str:
    """Return what numbers the lights of a scene have."""
    if lights == 0:
        return "the scene has no lights"
    return "the scene has one light, number 0" if lights == 1 else f"the scene's lights are 0 to {lights - 1}"

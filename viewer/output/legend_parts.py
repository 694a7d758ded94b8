"""What a legend consists of, and what is chosen of its view."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from tracer.scene.lights import Light, named_light
from viewer.state.slices import MIDDLE, Slice
from viewer.state.tone import NEUTRAL
from viewer.state.tone import Tone as DisplayTone
from viewer.state.views import Arrival, Color

ARRIVAL_NAMES = {
    Arrival.AWAY: "faces away",
    Arrival.DARK: "fully dark",
    Arrival.FEW: "penumbra, at most half",
    Arrival.MOST: "penumbra, more than half",
    Arrival.LIT: "fully lit",
    Arrival.UNKNOWN: "not known yet",
}
"""What a pixel has of a light, in words."""


class Tone(Enum):
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
    tone: Tone = Tone.PLAIN


@dataclass(frozen=True)
class Legend:
    """A title, names of the columns of values, and the rest as far as there is any; `facts` come after the colours."""

    title: str
    columns: tuple[str, ...] = ()
    entries: tuple[Entry, ...] = ()
    scale: Scale | None = None
    facts: tuple[Entry, ...] = ()
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True)
class Chosen:
    """What else is chosen of a view: its light, of these of the scene, whether wrong pixels are marked, shares of rays,
    the range of its numbers, the tone of its picture, whether what this clips is marked, and the slice through
    space."""

    light: int = 0
    lights: tuple[Light, ...] = ()
    marked: bool = True
    shares: bool = False
    span: tuple[float, float] | None = None
    tone: DisplayTone = NEUTRAL
    clipping: bool = False
    cut: Slice = MIDDLE

    @property
    def light_in_words(self) -> str:
        return named_light(self.lights, self.light)


AS_USUAL = Chosen()

"""Kinds of views: flat colours for classes, modes among them, and counts on the colour map.

The file of such a view says which classes there are, or what is counted, and what each pixel has of it.  Its pixels,
the rows of its legend, its values and its words follow from that."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import has_shadow_mode, shadow_mode
from tracer.frame import Frame
from tracer.method import Method, title_of
from viewer.state import terms
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import GREY, Class
from viewer.state.views import has_modes_of_cells
from viewer.util.numbers import count, percent
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, hits, once, single
from viewer.views.legend import Entry, Legend, Note, NoteKind, Scale, fact
from viewer.views.paint import by_class, by_number, in_range


class ClassView(DrawnView):
    """A view of classes in flat colours."""

    is_flat = True
    what: ClassVar[str] = ""
    """What is classified."""
    classes: ClassVar[tuple[Class, ...]] = ()
    """In the order of the legend."""
    stripe: ClassVar[int] = 0
    """Pixels across which a stripe goes, where classes have stripes."""

    def __init__(self) -> None:
        stripes = [one.stripes or one.color for one in self.classes] if self.stripe else []
        self.palette = np.asarray([*(one.color for one in self.classes), *stripes], np.float32)

    def find(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        """Return the class of each pixel (h, w), as its place among `classes`; any for a miss."""
        raise NotImplementedError

    def found(self, frame: Frame, draw: DrawOptions) -> NDArray[np.uint8]:
        """Return the same, found once."""
        return once(frame, (self.what, draw.light), lambda: self.find(frame, draw.light))

    def cells(self, frame: Frame) -> NDArray[np.int32] | None:
        """Return the cells (h, w) between which there are lines, if there are any."""
        return None

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        return by_class(frame, draw, self.found(frame, draw), self.palette, self.stripe, self.cells(frame))

    def counted(self, frame: Frame, draw: DrawOptions) -> list[int]:
        """Count the pixels of each class that hit something."""
        counts: list[int] = np.bincount(self.found(frame, draw)[hits(frame)], minlength=len(self.classes)).tolist()
        return counts

    def entries(
        self, pixels: Sequence[int], second: Sequence[str] = (), listed: Iterable[int] | None = None
    ) -> tuple[Entry, ...]:
        """Say how many pixels are of each class, or of those that are `listed`; `second` are values of a second
        column."""
        seen = sum(pixels)
        return tuple(
            Entry(
                one.name, one.color, (percent(pixels[k], seen), *second[k : k + 1]),
                f"{one.meaning}. {count(pixels[k])} pixels", stripes=one.stripes,
            )
            for k, one in enumerate(self.classes)
            if listed is None or k in listed
        )  # fmt: skip

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(self.found(frame, draw), self.what, hits(frame), classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        name = self.classes[self.found(frame, draw)[y, x]].name
        return tuple(re.split(": |, ", name) if re.search(": |, ", name) else name.split())


class ModeView(ClassView):
    """A view of modes, which units carry: primitives or cells."""

    of_modes = True

    def of_units(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        """Return the class of each unit (n,)."""
        raise NotImplementedError

    def find(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        of_units = self.of_units(frame, light)
        return of_units[frame.unit] if len(of_units) else np.zeros(frame.unit.shape, np.uint8)

    def mode_legend(self, frame: Frame, draw: DrawOptions, title: str, facts: tuple[Entry, ...]) -> Legend:
        """Count pixels and units; the primitives of dynamic objects that rest follow, so that none is missed."""
        units = np.bincount(self.of_units(frame, draw.light), minlength=len(self.classes)).tolist()
        entries = self.entries(self.counted(frame, draw), [count(n) for n in units])
        named = "cells" if has_modes_of_cells(frame) else "primitives"
        return Legend(title, ("pixels", named), (*entries, *at_rest(frame)), facts=facts)


def filled_in(frame: Frame) -> tuple[Note, ...]:
    """Return what is said of a picture of which only a part has been shaded."""
    return () if frame.shaded is None else (Note("Pixels that are not shaded yet show the nearest one that is."),)


def at_rest(frame: Frame) -> tuple[Entry, ...]:
    """Count the primitives of dynamic objects that are not dynamic."""
    resting = frame.statistics.resting
    if not resting:
        return ()
    counted = f"with {title_of(frame.settings.method)} they count as static, and are in the rows above"
    meaning = f"{count(resting)} primitives of dynamic objects that rest: {counted}"
    return (Entry("dynamic, at rest", None, ("", count(resting)), meaning),)


def shadow_modes(frame: Frame, light: int) -> NDArray[np.uint8]:
    """Return the ShadowMode of each unit (n,); INIT for a light that culling does not cover."""
    known = has_shadow_mode(frame.modes, light)
    return shadow_mode(frame.modes, light) if known else np.zeros(len(frame.modes), np.uint8)


def not_culled(title: str) -> Legend:
    """Return the legend of a light that culling does not cover."""
    why = "There are too many lights for this one to be culled: all its shadow rays are traced."
    return Legend(title, notes=(Note(why, NoteKind.WARNING),))


_CULLED = (
    (terms.CULLED, "full_shadow", "of the rays due: those of fully rendered primitives in full shadow"),
    (
        terms.DYNAMIC_ONLY, "non_shadow",
        "of the rays due: those of fully rendered primitives in non-shadow, tested against dynamic objects only",
    ),
)  # fmt: skip


def culled_by_modes(frame: Frame, light: int | None = None, number: int | None = None) -> tuple[Entry, ...]:
    """Say what the paper's method would cull of this frame's shadow rays: of one light, and of all."""
    said, columns = frame.statistics.by_modes, {"all lights": frame.statistics.by_modes_in_all}
    if not said:
        return ()
    if light is not None and light < len(said) > 1:
        columns = {f"light {number}": said[light]} | columns
    part = frame.statistics.part
    name = "shadow rays, all bounces"
    name += "" if Method.parse(frame.settings.method).uses_modes else ", if by modes"
    name += f", {percent(part, 1.0)} shaded" if part < 1.0 else ""
    tip = "of this frame, at all bounces, by the modes after the frame before: what the paper's method saves"
    rows = (
        Entry(term, None, tuple(percent(getattr(one, which), one.due) for one in columns.values()), meaning)
        for term, which, meaning in _CULLED
    )
    return (Entry(name, None, tuple(columns), tip, quiet=True), *rows)


class CountView(DrawnView):
    """A map of a count, of lights or of clusters of them, which is not known everywhere."""

    has_range = True
    what: ClassVar[str] = ""
    """What is counted."""
    heading: ClassVar[str] = ""
    """The title of the legend."""
    each: ClassVar[str] = ""
    """What is counted at each pixel, in more words."""
    has_cells: ClassVar[bool] = False
    """Whether there are lines between cells."""

    def find(self, frame: Frame) -> NDArray[np.int32]:
        """Return the count at each pixel (h, w), -1 where it is not known."""
        return frame.layers[self.shows]

    def of_what(self, frame: Frame) -> str:
        """Say out of how many the mean is."""
        return f"of {count(frame.lights)} lights"

    def facts(self, frame: Frame) -> tuple[Entry, ...]:
        """Say more in the legend."""
        return ()

    def notes(self, frame: Frame) -> tuple[Note, ...]:
        """Say what is to be noted."""
        return ()

    def seen(self, frame: Frame) -> NDArray[np.bool_]:
        """Find the pixels that hit something and whose count is known."""
        return hits(frame) & (self.find(frame) >= 0)

    def span(self, frame: Frame) -> tuple[float, float]:
        return once(frame, self.what, lambda: (0.0, float(max(1, int(self.find(frame).max(initial=0))))))

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        found = self.find(frame)
        cells = frame.cell if self.has_cells else None
        return by_number(frame, draw, in_range(found, draw.span or self.span(frame)), found >= 0, cells)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        seen, (low, high) = self.seen(frame), draw.span or self.span(frame)
        mean = float(self.find(frame)[seen].mean()) if seen.any() else 0.0
        unknown = (Entry("not known yet", GREY),) if (hits(frame) & ~seen).any() else ()
        middle = f"{high / 2.0:.0f}" if draw.span is None and high % 2 == 0 else ""
        facts = (fact("per pixel", f"{mean:.4g} {self.of_what(frame)}", self.each), *self.facts(frame))
        scale = Scale(f"{low:.4g}", f"{high:.4g}", middle)
        return Legend(self.heading, (), unknown, scale, facts, self.notes(frame))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(self.find(frame), self.what, self.seen(frame))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        found = int(self.find(frame)[y, x])
        return ("?",) if found < 0 else self.known_words(frame, found, x, y)

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Lines:
        """Return what it shows of a pixel where it is known."""
        return (str(found),)

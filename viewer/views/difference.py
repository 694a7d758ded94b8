"""Pixels with wrong shadow answers, and what a verified frame says of them."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.statistics import CutErrors
from viewer.state import terms, verified
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import WRONG
from viewer.state.views import Record
from viewer.util.numbers import count, percent
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, is_shaded, once, shaded_pixels, single
from viewer.views.color import dimmed
from viewer.views.legend import Entry, Legend, Note, NoteKind, fact
from viewer.views.paint import by_color, in_bytes

RING_DIMMING = 0.65
"""Brightness of the rings around wrong pixels, against that of the pixels."""

_ERRORS = (
    "by what part of its light a pixel differs from the picture by all lights; darker ones than 1/64 as if that bright"
)
_VISIBLE = "those whose 8-bit colour is wrong: an answer deep in reflections may change nothing that a screen shows"
_LARGEST = "between a channel of a wrong pixel's colour and the right one, also where both are too bright for a screen"


class Difference(DrawnView):
    label = "Difference"
    key = "8"
    also = "wrong"
    help = "Pixels with a wrong shadow answer; where all answers are right, the picture is shown, dimmed."
    records = Record.VERIFY
    shows = "wrong"
    shows_picture = everywhere = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        marks = wrong_marks(frame, draw.magnified)
        pixels = by_color(frame, draw, dimmed(frame, draw.tone, draw.beneath), everywhere=True)
        if draw.mark_wrong:
            pixels[marks == Mark.RING] = in_bytes(np.float32(RING_DIMMING) * np.asarray(WRONG, np.float32))
        pixels[marks == Mark.WRONG] = in_bytes(WRONG)
        return pixels

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        return legend_of_wrong(frame, self.label, terms.WRONG_PIXELS, True)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(verified.known(frame.wrong), "wrong answers", shaded_pixels(frame))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        return (f"{int(verified.known(frame.wrong)[y, x])} wrong",) if is_shaded(frame, x, y) else ("?",)


def legend_of_wrong(frame: Frame, label: str, name: str, colored: bool) -> Legend:
    """Say what is wrong in the frame, or of what it is said that nothing is."""
    statistics, found = frame.statistics, verified.known(frame.statistics.wrong)
    pixels = f"{count(found.pixels)} ({percent(found.pixels, found.shaded)})"
    color = WRONG if colored else None
    entries = (Entry(verified.named(name, found), color, (pixels,), terms.MEANINGS[terms.WRONG_PIXELS]),)
    largest, seen = verified.largest_difference(frame)
    of_pixels = (
        fact("visible on a screen", count(seen), _VISIBLE),
        fact("largest difference", f"{255.0 * largest:.3g} of 255", _LARGEST),
    )
    cuts = statistics.cuts
    if cuts is not None and cuts.errors is not None:
        return Legend(label, (), entries, facts=(*of_pixels, *_cut_errors(cuts.errors)))
    if found.answers:
        answers = f"{count(found.answers)} ({percent(found.answers, found.due)} of those due)"
        tip = f"{terms.MEANINGS[terms.WRONG]}: {verified.share(found)}"
        facts = (*of_pixels, fact(verified.named(terms.WRONG, found), answers, tip))
        notes = (Note(verified.of_what(statistics)),) if statistics.part < 1.0 else ()
        return Legend(label, (), entries, facts=facts, notes=notes)
    said = f"{verified.in_words(statistics)}."
    return Legend(label, (), entries, notes=(Note(said, NoteKind.PLAIN if found.untraced else NoteKind.WARNING),))


def _cut_errors(errors: CutErrors) -> tuple[Entry, ...]:
    """Say what is wrong in pictures by clusters of lights, of which no answer is wrong."""
    parts = (("half of the pixels", errors.median), ("95 % of them", errors.most_of), ("all of them", errors.most))
    return tuple(fact(f"{name} differ by", f"{100.0 * error:.2g} % at most", _ERRORS) for name, error in parts)


class Mark(IntEnum):
    """What is drawn at a pixel."""

    NONE = 0
    RING = 1
    WRONG = 2


def wrong_marks(frame: Frame, magnified: int = 1) -> NDArray[np.uint8]:
    """Return the marks of wrong pixels.  Raises ValueError where the frame was not verified."""
    wrong = verified.known(frame.wrong) > 0
    return once(frame, ("marks", magnified), lambda: marks(wrong, magnified))


def ringed(frame: Frame) -> Pixels:
    """Return the traced picture of a verified frame, (h, w, 3) uint8, with rings around wrong pixels."""
    pixels = in_bytes(frame.color)
    pixels[wrong_marks(frame) == Mark.RING] = in_bytes(WRONG)
    return pixels


def marks(wrong: NDArray[np.bool_], magnified: int = 1) -> NDArray[np.uint8]:
    """Return the Mark of each pixel (h, w): these ones, and a ring around each, or around each crowd.

    The rings grow with the picture, so that a lone pixel is found in any; they are so much smaller where each pixel
    is shown as `magnified` of the screen's."""
    if not wrong.any():
        return np.zeros(wrong.shape, np.uint8)
    side = max(wrong.shape)
    sizes = max(3, round(side / 200)), max(1, round(side / 1500))
    radius, thickness = (max(1, round(size / magnified)) for size in sizes)
    ring = _within(wrong, radius + thickness) & ~_within(wrong, radius)
    return np.where(wrong, np.uint8(Mark.WRONG), ring.astype(np.uint8))


def _within(pixels: NDArray[np.bool_], radius: int) -> NDArray[np.bool_]:
    """Find where one of some pixels is at most `radius` pixels away."""
    wide = [pixels]  # by how far to the left and right
    for k in range(1, radius + 1):
        wider = wide[-1].copy()
        wider[:, k:] |= pixels[:, :-k]
        wider[:, :-k] |= pixels[:, k:]
        wide.append(wider)
    near = wide[radius].copy()
    for k in range(1, radius + 1):
        row = wide[math.isqrt(radius * (radius + 1) - k * k)]
        near[k:] |= row[:-k]
        near[:-k] |= row[k:]
    return near


VIEW = Difference()

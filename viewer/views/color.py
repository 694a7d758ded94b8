"""The traced picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions, Tone, clipped, toned
from viewer.state.palette import hex_color
from viewer.util.numbers import count, percent
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values
from viewer.views.legend import Entry, Legend
from viewer.views.paint import by_color, checkered

CHANNELS = ("red", "green", "blue")
TOO_BRIGHT, BLACK = hex_color("FF3B30"), hex_color("2F7BFF")
"""Stripes over pixels of which the screen cuts something off, where these are marked."""
STRIPE = 4


class Color(DrawnView):
    label = "Colour"
    key = "1"
    help = "The traced picture."
    shows_picture = shows_clipped = everywhere = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        return by_color(frame, draw, displayed(frame.color, draw), everywhere=True)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        """Say how much of the picture the screen cuts off, where that is marked."""
        if not draw.clipping:
            return None
        (bright, black), words = clipped(frame.color, draw.tone), draw.tone.in_words()
        rows = (
            ("too bright", TOO_BRIGHT, bright, "red, green or blue is brighter than the screen's"),
            ("black", BLACK, black, "all channels are 0"),
        )
        entries = tuple(
            Entry(name, color, (percent(n, frame.primitive.size),), f"{meaning}: {count(n)} pixels")
            for name, color, where, meaning in rows
            for n in (int(where.sum()),)
        )
        return Legend(f"Clipped pixels{f', {words}' if words else ''}", ("pixels",), entries)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return Values(frame.color, CHANNELS, np.ones(frame.primitive.shape, np.bool_))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        return tuple(f"{channel:.3f}" for channel in frame.color[y, x])


def displayed(color: NDArray[np.float32], draw: DrawOptions) -> NDArray[np.float32]:
    """Return traced colours (h, w, 3) by their tone, with stripes where the screen cuts them off if that is marked."""
    shown = toned(color, draw.tone)
    if draw.clipping:
        (bright, black), shown = clipped(color, draw.tone), shown.copy()
        stripes = checkered(bright.shape, STRIPE) == 0
        shown[bright & stripes] = TOO_BRIGHT
        shown[black & stripes] = BLACK
    return shown


def dimmed(frame: Frame, tone: Tone, brightness: float) -> NDArray[np.float32]:
    """Return the picture (h, w, 3), so bright, for what is drawn over it."""
    return brightness * np.clip(toned(frame.color, tone), 0.0, 1.0)


VIEW = Color()

"""Primitives, each in a colour of its own."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.util.numbers import count
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, hits, single
from viewer.views.legend import Legend, fact
from viewer.views.paint import by_class


class Primitive(DrawnView):
    label = "Primitives"
    key = "4"
    help = "Every primitive in a colour of its own."
    is_flat = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        colors = _colors(1 << int(frame.primitive.max(initial=0)).bit_length())
        return by_class(frame, draw, frame.primitive, colors)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        seen = int(np.count_nonzero(np.bincount(frame.primitive[hits(frame)])))
        return Legend(self.label, facts=(fact("in view, each in a colour of its own", count(seen)),))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(frame.primitive, "primitive", hits(frame), classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        return (str(int(frame.primitive[y, x])),)


@lru_cache(2)
def _colors(primitives: int) -> NDArray[np.float32]:
    """Return the colours (n, 3) of so many primitives: its number, well mixed, picks hue, strength and brightness."""
    n = np.arange(1, primitives + 1, dtype=np.uint32)
    n = (n ^ (n >> np.uint32(16))) * np.uint32(0x7FEB352D)  # lowbias32, an integer hash
    n = (n ^ (n >> np.uint32(15))) * np.uint32(0x846CA68B)
    n ^= n >> np.uint32(16)
    third = np.array([0.0, 2.0, 1.0], np.float32) / 3.0
    turn = ((n & 65535) / 65536.0)[:, None] + third
    hue = np.clip(np.abs((turn % 1.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0)
    strength = (0.35 + 0.5 * ((n >> 16) & 255) / 255.0)[:, None]
    brightness = (0.6 + 0.4 * ((n >> 24) & 255) / 255.0)[:, None]
    return ((1.0 + strength * (hue - 1.0)) * brightness).astype(np.float32)


VIEW = Primitive()

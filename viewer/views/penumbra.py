"""How much of one light reaches each pixel."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import ShadowMode
from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import FACES_AWAY, SHADOW, UNKNOWN, Class, hex_color
from viewer.state.views import Record
from viewer.util.numbers import count, percent
from viewer.views.base import Lights, Lines, Pixels, Values, hits, is_shaded, shaded_pixels, single
from viewer.views.kinds import ClassView
from viewer.views.legend import Legend, fact
from viewer.views.paint import by_color


class Arrival(IntEnum):
    """How much of a light reaches a pixel."""

    LIT = 0
    MOST = 1
    FEW = 2
    DARK = 3
    AWAY = 4
    UNKNOWN = 5


class Penumbra(ClassView):
    label = "Penumbra"
    key = "J"
    help = (
        "How many samples of the chosen light reach each pixel: all are lit, none is dark, and between them lies the "
        "penumbra. A point has one sample, and no penumbra."
    )
    records = Record.LIGHTS
    of_light = True
    shows = "asked"
    what = "share of the light"
    classes = (
        Class("fully lit", SHADOW[ShadowMode.NON_SHADOW].color, "all samples that it faces reach it"),
        Class(
            "penumbra, more than half", hex_color("F5BE82"),
            "more than half of the samples that it faces reach it, but not all",
        ),
        Class(
            "penumbra, at most half", hex_color("8F3F00"),
            "some samples reach it, but at most half of those that it faces",
        ),
        Class("fully dark", SHADOW[ShadowMode.FULL_SHADOW].color, "no sample of the light reaches it"),
        Class("faces away", FACES_AWAY, "the surface faces away from all of the light"),
        Class("not known yet", UNKNOWN, "this pixel has not been shaded yet"),
    )  # fmt: skip
    """In the penumbra, colours go from that of FEW, where hardly a sample arrives, to that of MOST."""

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return super().can_draw(frame, light) and frame.only_light in (None, light)

    def find(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        asked, reached = samples_of(frame, light)
        found = np.where(2 * reached.astype(np.int32) > asked, np.uint8(Arrival.MOST), np.uint8(Arrival.FEW))
        found[reached == asked] = Arrival.LIT
        found[reached == 0] = Arrival.DARK
        found[asked == 0] = Arrival.AWAY
        found[~shaded_pixels(frame)] = Arrival.UNKNOWN
        return found

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        found, few, most = self.found(frame, draw), self.palette[Arrival.FEW], self.palette[Arrival.MOST]
        colors, between = self.palette[found], np.isin(found, (Arrival.FEW, Arrival.MOST))
        share = _reaching(frame, draw.light)[between].astype(np.float32)[:, None]
        colors[between] = few + share * (most - few)
        return by_color(frame, draw, colors, draw.shading)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        pixels, (asked, reached) = self.counted(frame, draw), samples_of(frame, draw.light)
        between = np.isin(self.found(frame, draw), (Arrival.FEW, Arrival.MOST))
        facts = [fact("samples", count(int(asked.max(initial=0))), "of the light, that a pixel faces at most")]
        if faced := int(asked[between].sum()):
            share = percent(int(reached[between].sum()) / faced, 1.0)
            tip = "of the samples that pixels in the penumbra face, those that reach them"
            facts.append(fact("light in the penumbra", share, tip))
        listed = range(len(Arrival) if pixels[Arrival.UNKNOWN] else Arrival.UNKNOWN)
        return Legend(self.title(draw, lights), ("pixels",), self.entries(pixels, listed=listed), facts=tuple(facts))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        known = hits(frame) & shaded_pixels(frame) & (samples_of(frame, draw.light)[0] > 0)
        return single(_reaching(frame, draw.light), self.what, known)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        asked, reached = samples_of(frame, draw.light)
        return (f"{int(reached[y, x])} of {int(asked[y, x])}",) if is_shaded(frame, x, y) else ("?",)


def samples_of(frame: Frame, light: int) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """Return the samples (h, w) of a light that each pixel faces, and those of them that reach it: 0 where it is not
    known yet.  Raises ValueError for a frame without that record."""
    if frame.asked is None or frame.reached is None or frame.only_light not in (None, light):
        raise ValueError("the frame did not record which samples of its lights reach its pixels")
    column = light if frame.only_light is None else 0
    return frame.asked[..., column], frame.reached[..., column]


def _reaching(frame: Frame, light: int) -> NDArray[np.float64]:
    """Return the part (h, w) of the samples of a light that each pixel faces which reach it."""
    asked, reached = samples_of(frame, light)
    return reached / np.maximum(asked, 1)


VIEW = Penumbra()

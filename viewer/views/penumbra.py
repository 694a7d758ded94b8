"""How much of one light reaches each pixel."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import ShadowMode
from tracer.frame import Frame
from tracer.scene.lights import named_light
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import FACES_AWAY, SHADOW_COLORS, UNKNOWN, Color, hex_color
from viewer.state.views import Record
from viewer.util.numbers import count, percent
from viewer.views.base import (
    NOT_RECORDED,
    FrameView,
    Lights,
    Pixels,
    Values,
    Words,
    hits,
    is_shaded,
    shaded_pixels,
    single,
)  # fmt: skip
from viewer.views.legend import Entry, Legend, fact
from viewer.views.paint import by_color


class Arrival(IntEnum):
    """How much of a light reaches a pixel."""

    AWAY = 0
    DARK = 1
    FEW = 2
    MOST = 3
    LIT = 4
    UNKNOWN = 5


ARRIVALS: dict[Arrival, tuple[str, Color, str]] = {
    Arrival.AWAY: ("faces away", FACES_AWAY, "the surface faces away from all of the light"),
    Arrival.DARK: ("fully dark", SHADOW_COLORS[ShadowMode.FULL_SHADOW], "no sample of the light reaches it"),
    Arrival.FEW: (
        "penumbra, at most half", hex_color("8F3F00"), "some samples reach it, but at most half of those that it faces",
    ),
    Arrival.MOST: (
        "penumbra, more than half", hex_color("F5BE82"),
        "more than half of the samples that it faces reach it, but not all",
    ),
    Arrival.LIT: ("fully lit", SHADOW_COLORS[ShadowMode.NON_SHADOW], "all samples that it faces reach it"),
    Arrival.UNKNOWN: ("not known yet", UNKNOWN, "this pixel has not been shaded yet"),
}  # fmt: skip
"""Names, colours and meanings; in the penumbra, colours go from that of FEW, where hardly a sample arrives, to that of
MOST."""

_PALETTE = np.asarray([color for _, color, _ in ARRIVALS.values()], np.float32)
_SHARE = "of the samples that pixels in the penumbra face, those that reach them"


class Penumbra(FrameView):
    label = "Penumbra"
    key = "J"
    help = (
        "How many samples of the chosen light reach each pixel: all are lit, none is dark, and between them lies the "
        "penumbra. A point has one sample, and no penumbra."
    )
    records = Record.LIGHTS
    of_light = is_flat = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return frame.asked is not None and frame.only_light in (None, light)

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        asked, reached = samples_of(frame, draw.light)
        found = arrivals(frame, draw.light)
        colors, between = _PALETTE[found], (found == Arrival.FEW) | (found == Arrival.MOST)
        share = (reached[between] / asked[between].astype(np.float32))[:, None]
        colors[between] = _PALETTE[Arrival.FEW] + share * (_PALETTE[Arrival.MOST] - _PALETTE[Arrival.FEW])
        return by_color(frame, draw, colors, draw.shading)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        hit, found, (asked, reached) = hits(frame), arrivals(frame, draw.light), samples_of(frame, draw.light)
        pixels, seen = np.bincount(found[hit], minlength=len(Arrival)), int(hit.sum())
        between = (found == Arrival.FEW) | (found == Arrival.MOST)
        entries = tuple(
            Entry(name, color, (percent(pixels[one], seen),), f"{meaning}. {count(pixels[one])} pixels")
            for one, (name, color, meaning) in reversed(ARRIVALS.items())
            if pixels[one] or one is not Arrival.UNKNOWN
        )
        facts = [fact("samples", count(int(asked.max(initial=0))), "of the light, that a pixel faces at most")]
        faced = int(asked[between].sum())
        if faced:
            facts.append(fact("light in the penumbra", percent(int(reached[between].sum()) / faced, 1.0), _SHARE))
        title = f"{self.label}, {named_light(lights, draw.light)}"
        return Legend(title, ("pixels",), entries, facts=tuple(facts))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        asked, reached = samples_of(frame, draw.light)
        known = hits(frame) & shaded_pixels(frame) & (asked > 0)
        return single(reached / np.maximum(asked, 1), "share of the light", known)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        asked, reached = samples_of(frame, draw.light)
        return (f"{int(reached[y, x])} of {int(asked[y, x])}",) if is_shaded(frame, x, y) else ("?",)


def samples_of(frame: Frame, light: int) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """Return the samples (h, w) of a light that each pixel faces, and those of them that reach it: 0 where it is not
    known yet.  Raises ValueError for a frame without that record."""
    if frame.asked is None or frame.reached is None or frame.only_light not in (None, light):
        raise ValueError(NOT_RECORDED[Record.LIGHTS])
    column = light if frame.only_light is None else 0
    return frame.asked[..., column], frame.reached[..., column]


def arrivals(frame: Frame, light: int) -> NDArray[np.uint8]:
    """Return the Arrival of a light at each pixel (h, w).  Raises ValueError for a frame without that record."""
    asked, reached = samples_of(frame, light)
    found = np.where(2 * reached.astype(np.int32) > asked, np.uint8(Arrival.MOST), np.uint8(Arrival.FEW))
    found[reached == asked] = Arrival.LIT
    found[reached == 0] = Arrival.DARK
    found[asked == 0] = Arrival.AWAY
    found[~shaded_pixels(frame)] = Arrival.UNKNOWN
    return found


VIEW = Penumbra()

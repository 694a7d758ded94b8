"""The colours of modes, certificates and fates, and what each stands for: declared once, for all that shows them.

The colours of modes are those of Okabe and Ito, which every kind of colour-blindness tells apart, and greys do too."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.inspect.reasons import WHY_NOT_CULLED
from tracer.util.text import mode_in_words
from viewer.state import terms

Color = tuple[float, float, float]


def hex_color(code: str) -> Color:
    """Return a colour by its six hexadecimal digits."""
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (0, 2, 4))
    return red, green, blue


BACKGROUND = hex_color("16181D")
DARK, LIGHT = (0.05, 0.06, 0.08), (0.93, 0.94, 0.96)
"""The ground of words that stand on a picture, and the words."""
HELD = (0.42, 0.70, 0.96)
"""What the pointer holds there."""
GREY = hex_color("5C616C")
UNKNOWN = hex_color("868C97")
"""What is not known of a pixel yet."""
CANDIDATES = hex_color("56B4E9")
"""A few primitives that can block the light, which rays are tested against."""
PATH = (0.36, 0.93, 0.72)
"""A reflected or refracted ray."""
FACES_AWAY = hex_color("3C3A72")
"""A surface that faces away from the light."""


class Class(NamedTuple):
    """Something that is shown in a colour of its own: its name, what it means, and the colour of stripes that it may
    have."""

    name: str
    color: Color
    meaning: str
    stripes: Color | None = None


class Certificate(IntEnum):
    """What is proved of a cell and a light, in the place that a shadow mode has in a word."""

    NONE = 0
    FULL = 1
    LIT = 2
    CANDIDATES = 3


OCCLUSION = {
    mode: Class(mode_in_words(mode.name), color, meaning)
    for mode, color, meaning in (
        (OcclusionMode.INIT, GREY, "not seen yet, or to be examined again"),
        (OcclusionMode.PARTIALLY_OCCLUDED, hex_color("E69F00"), "something hides a part of it in this frame"),
        (OcclusionMode.FULLY_RENDERED, hex_color("009E73"), "fully rendered: culled by its shadow modes"),
        (OcclusionMode.DYNAMIC, hex_color("CC79A7"), "it moves, or could move: never culled"),
    )
}
SHADOW = {
    mode: Class(mode_in_words(mode.name), color, meaning)
    for mode, color, meaning in (
        (ShadowMode.INIT, GREY, "no shadow ray yet"),
        (ShadowMode.FULL_SHADOW, hex_color("0072B2"), "every shadow ray was blocked: culled once fully rendered"),
        (
            ShadowMode.NON_SHADOW, hex_color("F0E442"),
            "no shadow ray was blocked: tested against dynamic objects only once fully rendered",
        ),
        (ShadowMode.PARTIAL_SHADOW, hex_color("D55E00"), "some were blocked: always traced"),
    )
}  # fmt: skip
BLOCKED, LIT, PARTLY_LIT = (
    SHADOW[mode].color for mode in (ShadowMode.FULL_SHADOW, ShadowMode.NON_SHADOW, ShadowMode.PARTIAL_SHADOW)
)
"""Of what lies in shadow, of what is lit, and of what is both."""
CERTIFICATES = {
    found: Class(found.name.lower(), color, meaning)
    for found, color, meaning in (
        (Certificate.NONE, GREY, "nothing is proved, or the light is behind it: its shadow rays are traced"),
        (Certificate.FULL, BLOCKED, "all of it is in the shadow of static geometry: its shadow rays are culled"),
        (Certificate.LIT, LIT, "nothing static is between it and the light: tested against dynamic objects only"),
        (
            Certificate.CANDIDATES, CANDIDATES,
            "only a few primitives can block the light: tested against these and dynamic objects",
        ),
    )
}  # fmt: skip

_BY_PAPER = "with the paper's method, {} of a fully rendered primitive (§2.4)"


def _not_culled(fate: Fate, why: str, color: Color) -> Class:
    return Class(f"{terms.TRACED}: {why}", color, f"traced: {WHY_NOT_CULLED[fate]}")


FATES = {
    Fate.NONE: Class("not known yet", UNKNOWN, "this pixel has not been shaded yet"),
    Fate.FACES_AWAY: Class(
        "faces away", FACES_AWAY, "no shadow ray is due: the surface faces away from the light",
    ),
    Fate.CULLED: Class(
        terms.CULLED, BLOCKED,
        f"not traced, as its answer is known: {_BY_PAPER.format('FULL_SHADOW')}",
    ),
    Fate.DYNAMIC_ONLY: Class(
        terms.DYNAMIC_ONLY, LIT,
        f"tested against dynamic objects only: {_BY_PAPER.format('NON_SHADOW')}",
    ),
    Fate.CANDIDATES: Class(
        terms.CANDIDATES_ONLY, CANDIDATES,
        "tested against the few static primitives that can block it, and dynamic objects",
    ),
    Fate.CACHED: Class(terms.CACHE_HITS, hex_color("8ACBF3"), "blocked by what blocked the last ray from here"),
    Fate.PARTLY_OCCLUDED: _not_culled(
        Fate.PARTLY_OCCLUDED, "partially occluded", OCCLUSION[OcclusionMode.PARTIALLY_OCCLUDED].color
    ),
    Fate.PARTIAL_SHADOW: _not_culled(Fate.PARTIAL_SHADOW, "partly in shadow", PARTLY_LIT),
    Fate.NOT_SEEN_WHOLE: _not_culled(Fate.NOT_SEEN_WHOLE, "not seen whole yet", OCCLUSION[OcclusionMode.INIT].color),
    Fate.DYNAMIC: _not_culled(Fate.DYNAMIC, "dynamic", OCCLUSION[OcclusionMode.DYNAMIC].color),
    Fate.TRACED: Class(terms.TRACED, hex_color("D3D6DC"), "traced through the whole scene"),
}  # fmt: skip
"""What becomes of shadow rays; one that a mode brings about has the mode's colour.  TRACED also stands for all
traced."""
FATE_WOULD: dict[Fate, str] = {
    Fate.CULLED: "would be culled",
    Fate.DYNAMIC_ONLY: "… dynamic only",
    Fate.TRACED: "traced in any case",
}
"""What fates that rays would have by the paper's method are called where nothing is culled."""


def label_color(color: Color) -> Color:
    """Of words that stand on this colour: dark on bright ones, else light."""
    red, green, blue = color
    return (0.96, 0.97, 0.98) if 0.3 * red + 0.6 * green + 0.1 * blue < 0.45 else DARK


def fate_palette(shown: Fate | None = None) -> list[Color]:
    """The colours of all fates in their order; where one is to stand out, all but its own are dimmed.

    TRACED stands for all traced."""

    def stands_out(fate: Fate) -> bool:
        return shown in (None, fate) or (shown is Fate.TRACED and fate.is_traced)

    def dimmed(color: Color) -> Color:
        red, green, blue = (OTHERS * part + (1.0 - OTHERS) * dark for part, dark in zip(color, BACKGROUND, strict=True))
        return red, green, blue

    return [one.color if stands_out(fate) else dimmed(one.color) for fate, one in FATES.items()]


OTHERS = 0.18
"""How much is left of the colours of other fates than the one that is to stand out."""

WRONG = hex_color("FF00FF")
"""A pixel with a wrong shadow answer: a colour of no other view, as pure as no shaded one gets."""

BENEATH = 0.3
"""Brightness of the traced picture beneath the difference."""

WIPE_LINE = hex_color("F2F4F7")

LESS, SAME, MORE = hex_color("C08CFF"), hex_color("1B1D22"), hex_color("B5D84A")
"""In a signed difference: where B has less than A, the same, and more."""

# Viridis (even to the eye, in greys and to the colour-blind) as a polynomial of degree 6, constant term first.
_VIRIDIS = np.array(
    [
        [0.2777273272234177, 0.005407344544966578, 0.3340998053353061],
        [0.1050930431085774, 1.404613529898575, 1.384590162594685],
        [-0.3308618287255563, 0.214847559468213, 0.09509516302823659],
        [-4.634230498983486, -5.799100973351585, -19.33244095627987],
        [6.228269936347081, 14.17993336680509, 56.69055260068105],
        [4.776384997670288, -13.74514537774601, -65.35303263337234],
        [-5.435455855934631, 4.645852612178535, 26.3124352495832],
    ]
)


def color_map(steps: int = 256) -> NDArray[np.float32]:
    """(steps, 3) float32 colours from the lowest value to the highest."""
    t = np.linspace(0.0, 1.0, steps)[:, None]
    return np.clip((t ** np.arange(len(_VIRIDIS))) @ _VIRIDIS, 0.0, 1.0).astype(np.float32)


def signed_map(steps: int = 256) -> NDArray[np.float32]:
    """(steps, 3) float32 colours of a signed difference, from the least to the largest."""
    t = np.linspace(-1.0, 1.0, steps, dtype=np.float32)[:, None]
    less, same, more = (np.asarray(color, np.float32) for color in (LESS, SAME, MORE))
    return (same + np.abs(t) * (np.where(t < 0.0, less, more) - same)).astype(np.float32)

"""The colours of modes, certificates and fates, and what each stands for: declared once, for all that shows them.

The colours of modes are those of Okabe and Ito, which every kind of colour-blindness tells apart, and greys do too.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.inspect.reasons import WHY_NOT_CULLED
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
FACES_AWAY = hex_color("3C3A72")
"""A surface that faces away from the light."""


class Certificate(IntEnum):
    """What is proven of a cell and a light, in the place that a shadow mode has in a word."""

    NONE = 0
    FULL = 1
    LIT = 2
    CANDIDATES = 3


_OCCLUSION: dict[OcclusionMode, tuple[Color, str]] = {
    OcclusionMode.INIT: (GREY, "not seen yet, or to be examined again"),
    OcclusionMode.PARTIALLY_OCCLUDED: (hex_color("E69F00"), "something hides a part of it in this frame"),
    OcclusionMode.FULLY_RENDERED: (hex_color("009E73"), "fully rendered: culled by its shadow modes"),
    OcclusionMode.DYNAMIC: (hex_color("CC79A7"), "it moves: never culled"),
}
_SHADOW: dict[ShadowMode, tuple[Color, str]] = {
    ShadowMode.INIT: (GREY, "no shadow ray yet"),
    ShadowMode.FULL_SHADOW: (hex_color("0072B2"), "every shadow ray was blocked: culled once fully rendered"),
    ShadowMode.NON_SHADOW: (
        hex_color("F0E442"), "no shadow ray was blocked: tested against dynamic objects only once fully rendered",
    ),
    ShadowMode.PARTIAL_SHADOW: (hex_color("D55E00"), "some were blocked: always traced"),
}  # fmt: skip
OCCLUSION_COLORS = {mode: color for mode, (color, _) in _OCCLUSION.items()}
OCCLUSION_MEANING = {mode: meaning for mode, (_, meaning) in _OCCLUSION.items()}
SHADOW_COLORS = {mode: color for mode, (color, _) in _SHADOW.items()}
SHADOW_MEANING = {mode: meaning for mode, (_, meaning) in _SHADOW.items()}
CERTIFICATE_COLORS = {found: SHADOW_COLORS[ShadowMode(found)] for found in Certificate}
CERTIFICATE_MEANING = {
    Certificate.NONE: "nothing is proven, or the light is behind it: its shadow rays are traced",
    Certificate.FULL: "all of it is in the shadow of static geometry: its shadow rays are culled",
    Certificate.LIT: "nothing static is between it and the light: tested against dynamic objects only",
    Certificate.CANDIDATES: "only a few primitives can block the light: tested against these and dynamic objects",
}

_BY_PAPER = "with the paper's method, {} of a fully rendered primitive (§2.4)"
# The colour of a shadow ray, its name, and what became of it; a fate that a mode brings about has the mode's colour.
_FATES: dict[Fate, tuple[Color, str, str]] = {
    Fate.NONE: (UNKNOWN, "not known yet", "this pixel has not been shaded yet"),
    Fate.FACES_AWAY: (
        FACES_AWAY, "faces away", "no shadow ray is due: the surface faces away from the light",
    ),
    Fate.CULLED: (
        SHADOW_COLORS[ShadowMode.FULL_SHADOW], terms.CULLED,
        f"answered without asking any geometry: {_BY_PAPER.format('FULL_SHADOW')}",
    ),
    Fate.DYNAMIC_ONLY: (
        SHADOW_COLORS[ShadowMode.NON_SHADOW], terms.DYNAMIC_ONLY,
        f"asked dynamic objects alone: {_BY_PAPER.format('NON_SHADOW')}",
    ),
    Fate.CANDIDATES: (
        hex_color("56B4E9"), terms.CANDIDATES_ONLY,
        "asked the few static primitives that can block it, and dynamic objects",
    ),
    Fate.CACHED: (hex_color("8ACBF3"), terms.CACHE_HITS, "blocked by what blocked the last ray from here"),
    Fate.PARTLY_OCCLUDED: (
        OCCLUSION_COLORS[OcclusionMode.PARTIALLY_OCCLUDED], f"{terms.TRACED}: partially occluded", "",
    ),
    Fate.PARTIAL_SHADOW: (SHADOW_COLORS[ShadowMode.PARTIAL_SHADOW], f"{terms.TRACED}: partly in shadow", ""),
    Fate.NOT_SEEN_WHOLE: (OCCLUSION_COLORS[OcclusionMode.INIT], f"{terms.TRACED}: not seen whole yet", ""),
    Fate.DYNAMIC: (OCCLUSION_COLORS[OcclusionMode.DYNAMIC], f"{terms.TRACED}: dynamic", ""),
    Fate.TRACED: (hex_color("D3D6DC"), terms.TRACED, "traced through the whole scene"),
}  # fmt: skip
FATE_COLORS = {fate: color for fate, (color, _, _) in _FATES.items()}
FATE_NAMES = {fate: name for fate, (_, name, _) in _FATES.items()}
"""Of shadow rays; TRACED also stands for all traced."""
FATE_MEANING = {fate: meaning for fate, (_, _, meaning) in _FATES.items()}
FATE_MEANING |= {fate: f"traced: {why}" for fate, why in WHY_NOT_CULLED.items()}
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

    return [color if stands_out(fate) else dimmed(color) for fate, color in FATE_COLORS.items()]


OTHERS = 0.18
"""How much is left of the colours of other fates than the one that is to stand out."""

WRONG = hex_color("FF00FF")
"""A pixel with a wrong shadow answer: a colour of no other view, as pure as no shaded one gets."""

BENEATH = 0.3
"""Brightness of the traced picture beneath the difference."""

WIPE_LINE = hex_color("F2F4F7")

LESS, SAME, MORE = hex_color("5AA9F5"), hex_color("1B1D22"), hex_color("FF9F40")
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

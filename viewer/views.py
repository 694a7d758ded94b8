"""What can be seen of a frame: the views, their colours, and what each colour stands for.

A view turns the buffers of a frame into a picture; the shader of that name under `shaders/` does
the turning, this module knows the names, the colours and the numbers of the legend.  Nothing here
needs GL.  The colours of modes are those of Okabe and Ito, told apart by every kind of
colour-blindness, and in greys.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.renderer import Frame

Color = tuple[float, float, float]


class View(StrEnum):
    """The views, by the name that commands, captures and shaders use."""

    COLOR = "color"
    OCCLUSION = "occlusion"
    SHADOW = "shadow"
    PRIMITIVE = "primitive"
    DEPTH = "depth"
    NORMAL = "normal"
    PIXEL_COUNT = "pixel-count"
    DIFFERENCE = "difference"
    WIPE = "wipe"

    @property
    def label(self) -> str:
        return _TITLES[self]

    @property
    def needs_verify(self) -> bool:
        """Whether it can be drawn of verified frames alone."""
        return self in (View.DIFFERENCE, View.WIPE)

    @property
    def explanation(self) -> str:
        return _EXPLANATIONS[self]


_TITLES = {
    View.COLOR: "Colour",
    View.OCCLUSION: "Occlusion mode",
    View.SHADOW: "Shadow mode",
    View.PRIMITIVE: "Primitives",
    View.DEPTH: "Depth",
    View.NORMAL: "Normals",
    View.PIXEL_COUNT: "Pixel count",
    View.DIFFERENCE: "Difference",
    View.WIPE: "Wipe",
}

_EXPLANATIONS = {
    View.COLOR: "The traced picture.",
    View.OCCLUSION: "How much of each primitive the camera has seen: only a fully rendered one is culled.",
    View.SHADOW: "What the shadow rays of each primitive have met on their way to the chosen light.",
    View.PRIMITIVE: "Every primitive in a colour of its own.",
    View.DEPTH: "Distance from the camera along the ray.",
    View.NORMAL: "The shading normal: x, y, z as red, green, blue.",
    View.PIXEL_COUNT: "Pixels a primitive covers now, against the most it covered while fully rendered.",
    View.DIFFERENCE: "Pixels for which a culled shadow ray was answered wrongly; black where every answer is right.",
    View.WIPE: "Left of the line the traced picture, right of it that with every shadow answer right. Drag the line.",
}


def _hex(code: str) -> Color:
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (0, 2, 4))
    return red, green, blue


BACKGROUND = _hex("16181D")
GREY = _hex("5C616C")

OCCLUSION_COLORS: dict[OcclusionMode, Color] = {
    OcclusionMode.INIT: GREY,
    OcclusionMode.PARTIALLY_OCCLUDED: _hex("E69F00"),
    OcclusionMode.FULLY_RENDERED: _hex("009E73"),
    OcclusionMode.DYNAMIC: _hex("CC79A7"),
}

SHADOW_COLORS: dict[ShadowMode, Color] = {
    ShadowMode.INIT: GREY,
    ShadowMode.FULL_SHADOW: _hex("0072B2"),
    ShadowMode.NON_SHADOW: _hex("F0E442"),
    ShadowMode.PARTIAL_SHADOW: _hex("D55E00"),
}

OCCLUSION_MEANING = {
    OcclusionMode.INIT: "not seen yet, or to be looked at again",
    OcclusionMode.PARTIALLY_OCCLUDED: "something hides a part of it in this frame",
    OcclusionMode.FULLY_RENDERED: "seen as a whole: its shadow modes are trusted",
    OcclusionMode.DYNAMIC: "it moves: never culled",
}

SHADOW_MEANING = {
    ShadowMode.INIT: "no shadow ray yet",
    ShadowMode.FULL_SHADOW: "every shadow ray was blocked: culled once fully rendered",
    ShadowMode.NON_SHADOW: "no shadow ray was blocked: only moving objects are asked once fully rendered",
    ShadowMode.PARTIAL_SHADOW: "some were blocked: always traced",
}

WRONG = _hex("FF00FF")
"""A pixel with a wrong shadow answer: a colour of no other view, as pure as no shaded one gets."""

RING_DIMMING = 0.5
"""Brightness of the rings around such pixels on black, against that of the pixels."""

WIPE_LINE = _hex("F2F4F7")

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


@dataclass(frozen=True)
class LegendRow:
    """One colour of a legend: what it means, and how much of the frame it is (counts, and fractions of all)."""

    name: str
    color: Color
    meaning: str
    primitives: int
    pixels: int
    primitive_share: float
    pixel_share: float


def occlusion_legend(frame: Frame) -> list[LegendRow]:
    """Primitives and primary pixels in each occlusion mode."""
    classes = modes.occlusion_mode(frame.modes)
    rows = [(mode.name, OCCLUSION_COLORS[mode], OCCLUSION_MEANING[mode]) for mode in OcclusionMode]
    return _rows(frame, classes, rows)


def shadow_legend(frame: Frame, light: int) -> list[LegendRow]:
    """Primitives and primary pixels in each shadow mode of a light; those that move are counted apart.

    Empty for a light that culling does not cover."""
    if not modes.has_shadow_mode(frame.modes, light):
        return []
    classes = modes.shadow_mode(frame.modes, light)
    classes[modes.occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC] = len(ShadowMode)
    rows = [(mode.name, SHADOW_COLORS[mode], SHADOW_MEANING[mode]) for mode in ShadowMode]
    rows.append(("DYNAMIC", OCCLUSION_COLORS[OcclusionMode.DYNAMIC], OCCLUSION_MEANING[OcclusionMode.DYNAMIC]))
    return _rows(frame, classes, rows)


def _rows(frame: Frame, classes: NDArray[np.uint8], rows: list[tuple[str, Color, str]]) -> list[LegendRow]:
    primitives = np.bincount(classes, minlength=len(rows))
    pixels = np.bincount(classes, weights=frame.pixel_count, minlength=len(rows)).astype(np.int64)
    total, seen = max(int(primitives.sum()), 1), max(int(pixels.sum()), 1)
    return [
        LegendRow(name, color, meaning, int(p), int(q), int(p) / total, int(q) / seen)
        for (name, color, meaning), p, q in zip(rows, primitives, pixels)
    ]


def depth_range(frame: Frame) -> tuple[float, float]:
    """Nearest and farthest distance worth a colour: the 1st and 99th percentile of what is hit (0, 1 for nothing)."""
    step = max(1, frame.height * frame.width // 20000)
    sample = frame.depth.reshape(-1)[::step]
    sample = sample[np.isfinite(sample)]
    if len(sample) == 0:
        return 0.0, 1.0
    low, high = np.percentile(sample, (1.0, 99.0))
    return float(low), float(max(high, low * (1.0 + 1e-6) + 1e-12))


class Mark(IntEnum):
    """What the difference view draws at a pixel."""

    NONE = 0
    RING = 1
    WRONG = 2


def wrong_marks(frame: Frame, magnified: int = 1) -> NDArray[np.uint8]:
    """(h, w) Mark: the pixels with wrong answers of a verified frame, and a ring around each, or around each crowd.

    The rings grow with the picture, so that a lone pixel is found in any; they are so much smaller where each pixel
    is shown as `magnified` of the screen's."""
    wrong = _verified(frame.wrong) > 0
    if not wrong.any():
        return np.zeros(wrong.shape, np.uint8)
    side = max(frame.width, frame.height)
    radius, thickness = (
        max(1, round(size / magnified)) for size in (max(3, round(side / 200)), max(1, round(side / 1500)))
    )
    ring = _within(wrong, radius + thickness) & ~_within(wrong, radius)
    return np.where(wrong, np.uint8(Mark.WRONG), ring.astype(np.uint8))


def _within(pixels: NDArray[np.bool_], radius: int) -> NDArray[np.bool_]:
    """Where one of some pixels is at most `radius` pixels away."""
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


def wipe_column(width: int, wipe: float) -> int:
    """The column of pixels that the line of the wipe covers; `width`, that is none, for a wipe of 1."""
    return min(max(int(wipe * width), 0), width)


@dataclass(frozen=True)
class DifferenceLegend:
    """How wrong a verified frame is: wrong answers of the rays that `due` counts, pixels with any, and the largest
    difference of a channel of the colour shown, from 0 to 1."""

    answers: int
    due: int
    pixels: int
    pixel_share: float
    largest: float


def difference_legend(frame: Frame) -> DifferenceLegend:
    """Counts of a verified frame."""
    wrong, reference = _verified(frame.wrong), _verified(frame.reference)
    pixels = int(np.count_nonzero(wrong))
    apart = np.abs(np.clip(frame.color[wrong > 0], 0.0, 1.0) - np.clip(reference[wrong > 0], 0.0, 1.0))
    shadow = frame.statistics.shadow
    return DifferenceLegend(shadow.wrong, shadow.due, pixels, pixels / wrong.size, float(apart.max(initial=0.0)))


def _verified(buffer: NDArray | None) -> NDArray:
    if buffer is None:
        raise ValueError("the frame was not verified")
    return buffer

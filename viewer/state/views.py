"""What can be seen of a frame: the views, their colours, and what each colour stands for.

A view turns the buffers of a frame into a picture; the shader of that name under `shaders/` does
the turning, this module knows the names and the colours, `viewer.output.legend_counts` counts what has which.  Nothing
here needs GL.  The colours of modes are those of Okabe and Ito, distinguished by every kind of
colour-blindness, and in greys.
"""

from __future__ import annotations

import math
from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray

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
    CERTIFICATE = "certificate"
    SAVED = "saved"
    COST = "cost"
    PENUMBRA = "penumbra"

    @property
    def label(self) -> str:
        return _TITLES[self]

    @property
    def key(self) -> str:
        return _KEYS[self]

    @property
    def needs_verify(self) -> bool:
        """Whether it can be drawn of verified frames alone."""
        return self in (View.DIFFERENCE, View.WIPE)

    @property
    def needs_work(self) -> bool:
        """Whether it can be drawn only of frames that recorded the work at each pixel."""
        return self in (View.SAVED, View.COST)

    @property
    def needs_lights(self) -> bool:
        """Whether it can be drawn only of frames that recorded what reaches each pixel."""
        return self is View.PENUMBRA

    @property
    def needs_more(self) -> bool:
        """Whether it can be drawn only of frames that were asked to record something."""
        return self.needs_verify or self.needs_work or self.needs_lights

    @property
    def of_light(self) -> bool:
        """Whether it speaks of one light."""
        return self in (View.SHADOW, View.CERTIFICATE, View.PENUMBRA)

    @property
    def of_modes(self) -> bool:
        """Whether it shows modes, of frames that keep them alone."""
        return self in (View.OCCLUSION, View.SHADOW, View.PIXEL_COUNT)

    def can_draw(self, frame: Frame) -> bool:
        """Whether the frame holds what the view shows."""
        if self.needs_verify:
            return frame.wrong is not None
        if self.needs_work:
            return work_of(frame, self) is not None
        if self.needs_lights:
            return frame.asked is not None and frame.reached is not None
        if self is View.CERTIFICATE:
            return frame.certificates is not None
        return frame.settings.keeps_modes or not self.of_modes

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
    View.CERTIFICATE: "Certificates",
    View.SAVED: "Shadow rays saved",
    View.COST: "Rays traced",
    View.PENUMBRA: "Penumbra",
}

_KEYS = {
    **{view: str(number) for number, view in enumerate(list(View)[:9], start=1)},
    View.CERTIFICATE: "0",
    View.SAVED: "H",
    View.COST: "Shift+H",
    View.PENUMBRA: "J",
}

_EXPLANATIONS = {
    View.COLOR: "The traced picture.",
    View.OCCLUSION: "How much of each primitive the camera has seen: only fully rendered ones are culled.",
    View.SHADOW: "What the shadow rays of each primitive have met on the way to the chosen light.",
    View.PRIMITIVE: "Every primitive in a colour of its own.",
    View.DEPTH: "Distance from the camera along the ray.",
    View.NORMAL: "The shading normal: x, y, z as red, green, blue.",
    View.PIXEL_COUNT: "Pixels a primitive covers now, against the most it covered while fully rendered.",
    View.DIFFERENCE: "Pixels with a wrong shadow answer; where all answers are right, the picture is shown, dimmed.",
    View.WIPE: "Left of the line is the traced picture, right of it the picture with every shadow answer right. Drag "
    "the line.",
    View.CERTIFICATE: "What is proven for each cell and the chosen light; lines are the borders of cells. Each "
    "frame proves more: T traces one more, K keeps tracing.",
    View.SAVED: "Shadow rays of each pixel, at all bounces, that culling saves tracing through the whole scene: how "
    "many, or which share of those due.",
    View.COST: "Rays traced for each pixel, of all kinds, at all bounces: how many, or which share of those that are "
    "traced without culling.",
    View.PENUMBRA: "How many samples of the chosen light reach each pixel: all are lit, none is dark, and between them "
    "lies the penumbra. A point has one sample, and no penumbra.",
}


_NO_WORK = "the frame did not record the work at its pixels"
_NO_LIGHTS = "the frame did not record which samples of its lights reach its pixels"


def _hex(code: str) -> Color:
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (0, 2, 4))
    return red, green, blue


BACKGROUND = _hex("16181D")
GREY = _hex("5C616C")


class Certificate(IntEnum):
    """What is proven of a cell and a light, in the place that a shadow mode has in a word."""

    NONE = 0
    FULL = 1
    LIT = 2
    CANDIDATES = 3


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

CERTIFICATE_COLORS: dict[Certificate, Color] = {
    Certificate.NONE: GREY,
    Certificate.FULL: SHADOW_COLORS[ShadowMode.FULL_SHADOW],
    Certificate.LIT: SHADOW_COLORS[ShadowMode.NON_SHADOW],
    Certificate.CANDIDATES: SHADOW_COLORS[ShadowMode.PARTIAL_SHADOW],
}

CELL_LINE = 0.55
"""Brightness of the lines between cells, against that of the cells."""

OCCLUSION_MEANING = {
    OcclusionMode.INIT: "not seen yet, or to be examined again",
    OcclusionMode.PARTIALLY_OCCLUDED: "something hides a part of it in this frame",
    OcclusionMode.FULLY_RENDERED: "fully rendered: culled by its shadow modes",
    OcclusionMode.DYNAMIC: "it moves: never culled",
}

SHADOW_MEANING = {
    ShadowMode.INIT: "no shadow ray yet",
    ShadowMode.FULL_SHADOW: "every shadow ray was blocked: culled once fully rendered",
    ShadowMode.NON_SHADOW: "no shadow ray was blocked: tested against dynamic objects only once fully rendered",
    ShadowMode.PARTIAL_SHADOW: "some were blocked: always traced",
}

CERTIFICATE_MEANING = {
    Certificate.NONE: "nothing is proven, or the light is behind it: its shadow rays are traced",
    Certificate.FULL: "all of it is in the shadow of static geometry: its shadow rays are culled",
    Certificate.LIT: "nothing static is between it and the light: tested against dynamic objects only",
    Certificate.CANDIDATES: "only a few primitives can block the light: tested against these and dynamic objects",
}


class Arrival(IntEnum):
    """How much of a light reaches a pixel."""

    AWAY = 0
    DARK = 1
    FEW = 2
    MOST = 3
    LIT = 4


ARRIVAL_COLORS: dict[Arrival, Color] = {
    Arrival.AWAY: _hex("3F434C"),
    Arrival.DARK: SHADOW_COLORS[ShadowMode.FULL_SHADOW],
    Arrival.FEW: _hex("8F3F00"),
    Arrival.MOST: _hex("F5BE82"),
    Arrival.LIT: SHADOW_COLORS[ShadowMode.NON_SHADOW],
}
"""In the penumbra, colours go from that of FEW, where next to none of the samples arrive, to that of MOST."""

ARRIVAL_MEANING = {
    Arrival.AWAY: "the surface faces away from all of the light",
    Arrival.DARK: "no sample of the light reaches it",
    Arrival.FEW: "some samples reach it, but at most half of those that it faces",
    Arrival.MOST: "more than half of the samples that it faces reach it, but not all",
    Arrival.LIT: "all samples that it faces reach it",
}

MOST_RECORDED = 1 << 28
"""Pixels times lights, at most, whose samples are recorded: a gigabyte of memory."""

WRONG = _hex("FF00FF")
"""A pixel with a wrong shadow answer: a colour of no other view, as pure as no shaded one gets."""

RING_DIMMING = 0.65
"""Brightness of the rings around such pixels in the difference, against that of the pixels."""

BENEATH = 0.3
"""Brightness of the traced picture beneath the difference."""

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


def depth_range(frame: Frame) -> tuple[float, float]:
    """Nearest and farthest distance worth a colour: the 1st and 99th percentile of what is hit (0, 1 for nothing)."""
    step = max(1, frame.height * frame.width // 20000)
    sample = frame.depth.reshape(-1)[::step]
    sample = sample[np.isfinite(sample)]
    if len(sample) == 0:
        return 0.0, 1.0
    low, high = np.percentile(sample, (1.0, 99.0))
    return float(low), float(max(high, low * (1.0 + 1e-6) + 1e-12))


def units_of(frame: Frame) -> NDArray[np.int32]:
    """(h, w) what carries modes at each pixel, a virtual cell or the primitive itself; -1 for a miss.

    Cells that have certificates have no modes."""
    return frame.cell if frame.certificates is None else frame.primitive


def has_modes_of_cells(frame: Frame) -> bool:
    """Whether what carries modes are virtual cells."""
    return frame.cells is not None and frame.certificates is None


def work_of(frame: Frame, view: View) -> NDArray[np.int32] | None:
    """(h, w) what a heat map shows at each pixel; None where the frame did not record it."""
    return frame.saved if view is View.SAVED else frame.cost


def whole_of(frame: Frame, view: View) -> NDArray[np.int32]:
    """(h, w) what the work at each pixel is a share of: the shadow rays that were due, or all rays that tracing without
    culling takes.

    Raises ValueError for a frame without that record."""
    if frame.saved is None or frame.cost is None or frame.due_rays is None:
        raise ValueError(_NO_WORK)
    return frame.due_rays if view is View.SAVED else frame.saved + frame.cost


def samples_of(frame: Frame, light: int) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """(h, w) samples of a light that each pixel faces, and those of them that reach it.

    Raises ValueError for a frame without that record."""
    if frame.asked is None or frame.reached is None:
        raise ValueError(_NO_LIGHTS)
    return frame.asked[..., light], frame.reached[..., light]


def arrivals(frame: Frame, light: int) -> NDArray[np.uint8]:
    """(h, w) Arrival of a light at each pixel; raises ValueError for a frame without that record."""
    asked, reached = samples_of(frame, light)
    penumbra = np.where(2 * reached.astype(np.int32) > asked, Arrival.MOST, Arrival.FEW)
    lit = np.where(reached == 0, Arrival.DARK, np.where(reached == asked, Arrival.LIT, penumbra))
    return np.where(asked == 0, Arrival.AWAY, lit).astype(np.uint8)


def work_top(frame: Frame, view: View) -> float:
    """What has a heat map's last colour: the 99th percentile of pixels that hit something, 1 at least.

    Raises ValueError for a frame without that record."""
    work = work_of(frame, view)
    if work is None:
        raise ValueError(_NO_WORK)
    step = max(1, work.size // 20000)
    sample = work.reshape(-1)[::step][frame.primitive.reshape(-1)[::step] >= 0]
    return max(1.0, float(np.percentile(sample, 99.0))) if len(sample) else 1.0


class Mark(IntEnum):
    """What the difference view draws at a pixel."""

    NONE = 0
    RING = 1
    WRONG = 2


def wrong_marks(frame: Frame, magnified: int = 1) -> NDArray[np.uint8]:
    """(h, w) Mark: the pixels with wrong answers of a verified frame, and a ring around each, or around each crowd.

    The rings grow with the picture, so that a lone pixel is found in any; they are so much smaller where each pixel
    is shown as `magnified` of the screen's."""
    wrong = verified(frame.wrong) > 0
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


def verified(buffer: NDArray | None) -> NDArray:
    """A buffer of verified frames; raises ValueError where the frame is none."""
    if buffer is None:
        raise ValueError("the frame was not verified")
    return buffer

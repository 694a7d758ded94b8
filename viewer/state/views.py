"""What can be seen of a frame: the views, their colours, and what each colour stands for.

A view turns the buffers of a frame into a picture; the shader of that name under `shaders/` does the turning, this
module knows the names and the colours, `viewer.state.readings` what is read off a frame, and
`viewer.output.legend_counts` how much of it has which colour.  Nothing here needs GL.  The colours of modes are those
of Okabe and Ito, distinguished by every kind of colour-blindness, and in greys.
"""

from __future__ import annotations

from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.reasons import WHY_NOT_CULLED
from viewer.state import terms

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
    LIGHTS = "lights"
    CUTS = "cuts"
    VOXELS = "voxels"
    CELL_LIGHTS = "cell-lights"
    TREE = "tree"
    FATE = "fate"
    MOVING_SHADOW = "moving-shadow"

    @property
    def label(self) -> str:
        return _TITLES[self]

    @property
    def key(self) -> str:
        return _KEYS[self]

    @property
    def also(self) -> str:
        """Words by which it is found as well."""
        return _ALSO.get(self, "")

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
        return self in (View.PENUMBRA, View.LIGHTS)

    @property
    def needs_fates(self) -> bool:
        """Whether it can be drawn only of frames that recorded what became of the shadow rays of each pixel."""
        return self in (View.FATE, View.MOVING_SHADOW)

    @property
    def needs_more(self) -> bool:
        """Whether it can be drawn only of frames that were asked to record something."""
        return self.needs_verify or self.needs_work or self.needs_lights or self.needs_fates

    @property
    def of_light(self) -> bool:
        """Whether it speaks of one light."""
        return self.needs_fates or self in (View.SHADOW, View.CERTIFICATE, View.PENUMBRA, View.VOXELS)

    @property
    def has_range(self) -> bool:
        """Whether it shows a number on the colour map, whose range can be chosen."""
        return self in (View.DEPTH, View.SAVED, View.COST, View.LIGHTS, View.CUTS, View.CELL_LIGHTS, View.TREE)

    @property
    def shows_picture(self) -> bool:
        """Whether it shows traced colours, by the tone that is chosen."""
        return self in (View.COLOR, View.DIFFERENCE, View.WIPE, View.VOXELS, View.TREE)

    @property
    def has_slice(self) -> bool:
        """Whether it shows a slice through space, which can be chosen."""
        return self in (View.VOXELS, View.TREE)

    @property
    def shows_clipped(self) -> bool:
        """Whether it can mark what the screen cuts off of its colours."""
        return self in (View.COLOR, View.WIPE)

    @property
    def is_flat(self) -> bool:
        """Whether it shows flat colours, under which the picture's light and shade can be seen."""
        return self in _FLAT

    @property
    def is_smooth(self) -> bool:
        """Whether it may be smoothed where it is enlarged."""
        return self in (View.COLOR, View.WIPE)

    @property
    def of_modes(self) -> bool:
        """Whether it shows modes, of frames that keep them alone."""
        return self in (View.OCCLUSION, View.SHADOW, View.PIXEL_COUNT)

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
    View.SAVED: "Untraced shadow rays",
    View.COST: "Rays traced",
    View.PENUMBRA: "Penumbra",
    View.LIGHTS: "Lights due",
    View.CUTS: "Clusters of lights",
    View.VOXELS: "Voxels",
    View.CELL_LIGHTS: "Lights per cell",
    View.TREE: "Tree built",
    View.FATE: "Fate of shadow rays",
    View.MOVING_SHADOW: "Moving shadows",
}

_KEYS = {
    **{view: str(number) for number, view in enumerate(list(View)[:9], start=1)},
    View.CERTIFICATE: "0",
    View.SAVED: "H",
    View.COST: "Shift+H",
    View.PENUMBRA: "J",
    View.LIGHTS: "Shift+J",
    View.CUTS: "Shift+N",
    View.VOXELS: "Shift+V",
    View.CELL_LIGHTS: "Shift+K",
    View.TREE: "Shift+T",
    View.FATE: "Shift+X",
    View.MOVING_SHADOW: "Shift+O",
}

_FLAT = {
    *(View.OCCLUSION, View.SHADOW, View.PRIMITIVE, View.PIXEL_COUNT, View.CERTIFICATE, View.PENUMBRA, View.TREE),
    *(View.FATE, View.MOVING_SHADOW),
}

_ALSO = {
    View.FATE: "why traced culled dynamic reason",
    View.MOVING_SHADOW: "dynamic only NON_SHADOW darkened objects",
}

_EXPLANATIONS = {
    View.COLOR: "The traced picture.",
    View.OCCLUSION: "How much of each primitive the camera has seen: only fully rendered ones are culled.",
    View.SHADOW: "What the shadow rays of each primitive have met on the way to the chosen light. Stripes: the "
    "primitive is not fully rendered, so that its mode is not trusted, and its rays are traced.",
    View.PRIMITIVE: "Every primitive in a colour of its own.",
    View.DEPTH: "Distance from the camera along the ray.",
    View.NORMAL: "The shading normal: x, y, z as red, green, blue.",
    View.PIXEL_COUNT: "Pixels a primitive covers now, against the most it covered while fully rendered.",
    View.DIFFERENCE: "Pixels with a wrong shadow answer; where all answers are right, the picture is shown, dimmed.",
    View.WIPE: "Left of the line is the traced picture, right of it the picture with every shadow answer right. Drag "
    "the line.",
    View.CERTIFICATE: "What is proven for each cell and the chosen light; lines are the borders of cells. Each "
    "frame proves more: T traces one more, K keeps tracing.",
    View.SAVED: "Shadow rays of each pixel, at all bounces, that need not be traced through the whole scene: saved "
    "ones, and with some methods candidates and cache hits. How many, or which share of those due.",
    View.COST: "Rays traced through the whole scene for each pixel, of all kinds, at all bounces: how many, or which "
    "share of those that are traced without culling.",
    View.PENUMBRA: "How many samples of the chosen light reach each pixel: all are lit, none is dark, and between them "
    "lies the penumbra. A point has one sample, and no penumbra.",
    View.LIGHTS: "How many lights each pixel has to look at: those that its surface faces, and to which rays are due.",
    View.CUTS: "How many clusters of lights each pixel is shaded by, with the methods that cluster them (lightcuts); a "
    "block of 128 points shares them.",
    View.VOXELS: "A slice through the voxels of the method voxels: which are in shadow of the chosen light as a whole, "
    "which see all of it, and of which neither is known. Behind it the picture is dimmed.",
    View.CELL_LIGHTS: "How many lights the cell of each pixel must look at, with the methods lie and lie-exact: all "
    "but those that it knows to be hidden. Lines are the borders of cells.",
    View.TREE: "A slice through a tree that is built where rays arrive: built parts by their level, and grey stripes "
    "where no ray has been yet. Lines are the borders of parts, and white ones those of objects or pieces. The slice "
    "goes through everything; what lies before it shows as light and shade.",
    View.FATE: "What became of the shadow ray from each pixel's first hit to the chosen light: culled, asked dynamic "
    "objects only, or traced, and why it was not culled.",
    View.MOVING_SHADOW: "Where a moving object darkens what nothing static has ever hidden from the chosen light "
    "(NON_SHADOW): its rays ask dynamic objects only, so that no stale shadow stays behind.",
}


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
FAINT_LINE = 0.72
"""The same where cells have many colours, and may be small."""

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

TRUSTED_MEANING = {
    ShadowMode.FULL_SHADOW: "fully rendered, and every shadow ray so far was blocked: culled",
    ShadowMode.NON_SHADOW: "fully rendered, and no shadow ray so far was blocked: tested against dynamic objects only",
}
"""Of the shadow modes that are trusted where the primitive is fully rendered, and striped in their view elsewhere."""

UNTRUSTED_MEANING = {
    ShadowMode.FULL_SHADOW: "every shadow ray so far was blocked, but it is not fully rendered: traced",
    ShadowMode.NON_SHADOW: "no shadow ray so far was blocked, but it is not fully rendered: traced",
}

UNTRUSTED_STRIPE = 3
"""Pixels across which a stripe goes where a shadow mode is not trusted, and the grey one of INIT beside it."""

CERTIFICATE_MEANING = {
    Certificate.NONE: "nothing is proven, or the light is behind it: its shadow rays are traced",
    Certificate.FULL: "all of it is in the shadow of static geometry: its shadow rays are culled",
    Certificate.LIT: "nothing static is between it and the light: tested against dynamic objects only",
    Certificate.CANDIDATES: "only a few primitives can block the light: tested against these and dynamic objects",
}


VOXEL_COLORS: dict[int, Color] = {
    0: GREY,
    int(ShadowMode.FULL_SHADOW): SHADOW_COLORS[ShadowMode.FULL_SHADOW],
    int(ShadowMode.NON_SHADOW): SHADOW_COLORS[ShadowMode.NON_SHADOW],
}
"""By the state of a voxel, which has the place of a shadow mode."""

VOXEL_MEANING = {
    0: "neither is known: rays that end in it walk on towards the light, from voxel to voxel",
    int(ShadowMode.FULL_SHADOW): "one triangle hides the light from all of it: rays that end in it, or come to it, are "
    "blocked",
    int(ShadowMode.NON_SHADOW): "nothing static is between it and the light: rays that end in it, or come to it, are "
    "tested against dynamic objects only",
}


TREE_WAITS = _hex("4A4E57"), _hex("6B707B")
"""Stripes of what of a tree is not built."""


class Arrival(IntEnum):
    """How much of a light reaches a pixel."""

    AWAY = 0
    DARK = 1
    FEW = 2
    MOST = 3
    LIT = 4
    UNKNOWN = 5


ARRIVAL_COLORS: dict[Arrival, Color] = {
    Arrival.AWAY: _hex("3C3A72"),
    Arrival.DARK: SHADOW_COLORS[ShadowMode.FULL_SHADOW],
    Arrival.FEW: _hex("8F3F00"),
    Arrival.MOST: _hex("F5BE82"),
    Arrival.LIT: SHADOW_COLORS[ShadowMode.NON_SHADOW],
    Arrival.UNKNOWN: _hex("868C97"),
}
"""In the penumbra, colours go from that of FEW, where next to none of the samples arrive, to that of MOST."""

ARRIVAL_MEANING = {
    Arrival.AWAY: "the surface faces away from all of the light",
    Arrival.DARK: "no sample of the light reaches it",
    Arrival.FEW: "some samples reach it, but at most half of those that it faces",
    Arrival.MOST: "more than half of the samples that it faces reach it, but not all",
    Arrival.LIT: "all samples that it faces reach it",
    Arrival.UNKNOWN: "this pixel has not been shaded yet",
}

FATE_COLORS: dict[Fate, Color] = {
    Fate.NONE: ARRIVAL_COLORS[Arrival.UNKNOWN],
    Fate.FACES_AWAY: ARRIVAL_COLORS[Arrival.AWAY],
    Fate.CULLED: SHADOW_COLORS[ShadowMode.FULL_SHADOW],
    Fate.DYNAMIC_ONLY: SHADOW_COLORS[ShadowMode.NON_SHADOW],
    Fate.CANDIDATES: _hex("56B4E9"),
    Fate.CACHED: _hex("8ACBF3"),
    Fate.PARTLY_OCCLUDED: OCCLUSION_COLORS[OcclusionMode.PARTIALLY_OCCLUDED],
    Fate.PARTIAL_SHADOW: SHADOW_COLORS[ShadowMode.PARTIAL_SHADOW],
    Fate.NOT_SEEN_WHOLE: OCCLUSION_COLORS[OcclusionMode.INIT],
    Fate.DYNAMIC: OCCLUSION_COLORS[OcclusionMode.DYNAMIC],
    Fate.TRACED: _hex("D3D6DC"),
}
"""Of a shadow ray; a fate that a mode brings about has the colour of this mode. TRACED also stands for all traced."""


def label_color(color: Color) -> Color:
    """Of words that stand on this colour: dark on bright ones, else light."""
    red, green, blue = color
    return (0.96, 0.97, 0.98) if 0.3 * red + 0.6 * green + 0.1 * blue < 0.45 else (0.05, 0.06, 0.08)


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

FATE_NAMES: dict[Fate, str] = {
    Fate.NONE: "not known yet",
    Fate.FACES_AWAY: "faces away",
    Fate.CULLED: terms.CULLED,
    Fate.DYNAMIC_ONLY: terms.DYNAMIC_ONLY,
    Fate.CANDIDATES: terms.CANDIDATES_ONLY,
    Fate.CACHED: terms.CACHE_HITS,
    Fate.PARTLY_OCCLUDED: f"{terms.TRACED}: partially occluded",
    Fate.PARTIAL_SHADOW: f"{terms.TRACED}: partly in shadow",
    Fate.NOT_SEEN_WHOLE: f"{terms.TRACED}: not seen whole yet",
    Fate.DYNAMIC: f"{terms.TRACED}: dynamic",
    Fate.TRACED: terms.TRACED,
}

FATE_WOULD: dict[Fate, str] = {
    Fate.CULLED: "would be culled",
    Fate.DYNAMIC_ONLY: "… dynamic only",
    Fate.TRACED: "traced in any case",
}
"""What fates that rays would have by the paper's method are called where nothing is culled."""

FATE_MEANING: dict[Fate, str] = {
    Fate.NONE: "this pixel has not been shaded yet",
    Fate.FACES_AWAY: "no shadow ray is due: the surface faces away from the light",
    Fate.CULLED: "answered without asking any geometry: with the paper's method, FULL_SHADOW of a fully rendered "
    "primitive (§2.4)",
    Fate.DYNAMIC_ONLY: "asked dynamic objects alone: with the paper's method, NON_SHADOW of a fully rendered "
    "primitive (§2.4)",
    Fate.CANDIDATES: "asked the few static primitives that can block it, and dynamic objects",
    Fate.CACHED: "blocked by what blocked the last ray from here",
    **{fate: f"traced: {why}" for fate, why in WHY_NOT_CULLED.items()},
    Fate.TRACED: "traced through the whole scene",
}


class MovingShadow(IntEnum):
    """What moving objects have to do with a pixel and a light."""

    NONE = 0
    LIT = 1
    DARK = 2
    TRACED = 3
    OBJECT = 4


MOVING_SHADOW_COLORS: dict[MovingShadow, Color] = {
    MovingShadow.NONE: (1.0, 1.0, 1.0),
    MovingShadow.LIT: _hex("F8F2A0"),
    MovingShadow.DARK: _hex("4A2FB5"),
    MovingShadow.TRACED: _hex("8E97F5"),
    MovingShadow.OBJECT: OCCLUSION_COLORS[OcclusionMode.DYNAMIC],
}
"""Over the paled picture: blues for shadows, pale NON_SHADOW, and DYNAMIC."""

MOVING_SHADOW_NAMES: dict[MovingShadow, str] = {
    MovingShadow.NONE: "neither",
    MovingShadow.LIT: "dynamic only, lit",
    MovingShadow.DARK: "dynamic only, darkened",
    MovingShadow.TRACED: "darkened, but not dynamic only",
    MovingShadow.OBJECT: "moving object",
}

MOVING_SHADOW_MEANING: dict[MovingShadow, str] = {
    MovingShadow.NONE: "no moving object has to do with it",
    MovingShadow.LIT: "its ray asked dynamic objects only, and none of them is in the way",
    MovingShadow.DARK: "its ray asked dynamic objects only, and one of them is in the way: the shadow mode NON_SHADOW "
    "stays, and the shadow goes with the object",
    MovingShadow.TRACED: "a moving object is in the way, and nothing static is; its ray was traced, or answered in "
    "another way",
    MovingShadow.OBJECT: "it moves itself: dynamic, never culled",
}

PALE = 0.5
"""How far the greys of the picture are paled towards white beneath shadows of moving objects."""

WRONG = _hex("FF00FF")
"""A pixel with a wrong shadow answer: a colour of no other view, as pure as no shaded one gets."""

RING_DIMMING = 0.65
"""Brightness of the rings around such pixels in the difference, against that of the pixels."""

BENEATH = 0.3
"""Brightness of the traced picture beneath the difference."""

WIPE_LINE = _hex("F2F4F7")

LESS, SAME, MORE = _hex("5AA9F5"), _hex("1B1D22"), _hex("FF9F40")
"""In a signed difference: where B has less than A, the same, and more."""

TOO_BRIGHT, BLACK = _hex("FF3B30"), _hex("2F7BFF")
"""Stripes over pixels of which the screen cuts something off, where these are marked."""
CLIP_STRIPE = 4
"""Pixels across which such a stripe goes, and the gap beside it."""

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

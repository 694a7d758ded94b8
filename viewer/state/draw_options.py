"""How a frame is drawn: all that changes the picture without tracing it again; and the tone that takes colours as they
were traced to the screen."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.util.setting import setting, setting_of, settings_of
from viewer.state.palette import BENEATH
from viewer.state.pixels import FIT, Zoom
from viewer.state.views import Record, View

# Hable's filmic curve, "Uncharted 2: HDR Lighting" (GDC 2010): shoulder, linear strength and angle, toe strength,
# numerator and denominator.
HABLE = (0.15, 0.50, 0.10, 0.20, 0.02, 0.30)


class Curve(StrEnum):
    """The curves that colours can take to the screen."""

    label: str
    meaning: str

    def __new__(cls, value: str, label: str, meaning: str) -> Curve:
        made = str.__new__(cls, value)
        made._value_, made.label, made.meaning = value, label, meaning
        return made

    NONE = "none", "None", "straight up to white; what is brighter is clipped"
    REINHARD = "reinhard", "Reinhard", "Reinhard's curve with a white point: compresses what is bright"
    FILMIC = "filmic", "Filmic", "Hable's filmic curve: compresses what is bright and deepens what is dark"
    SRGB = "srgb", "sRGB", "takes colours for linear light and encodes them as sRGB: brightens what is dark"


def _in_pictures(state: Any) -> bool:
    return bool(state.draw.view.shows_picture)


@dataclass(frozen=True)
class Tone:
    """`exposure` in stops, which doubles colours with each; `white` is the colour, once exposed, that becomes white."""

    exposure: float = setting(
        0.0, "Exposure", "Make colours brighter or darker by so many stops, each of which doubles them.",
        low=-16.0, high=16.0, slider=(-6.0, 6.0), unit=" EV", option="--exposure", panel="View",
        applies=_in_pictures, remembered=False,
    )  # fmt: skip
    white: float = setting(
        1.0, "White", "The colour, once exposed, that becomes white.", low=0.01, high=1000.0, log=True,
        option="--white", panel="View", applies=_in_pictures, remembered=False,
    )  # fmt: skip
    curve: Curve = setting(
        Curve.NONE, "Tone curve", "How colours up to white become those of the screen.", option="--tone", panel="View",
        applies=_in_pictures, remembered=False,
    )  # fmt: skip

    @property
    def neutral(self) -> bool:
        """Whether colours are shown as they were traced, bit for bit."""
        return self == NEUTRAL

    def in_words(self) -> str:
        """What differs from neutral, briefly; empty where nothing does."""
        parts = [f"{self.exposure:+.3g} EV"] if self.exposure else []
        parts += [f"white {self.white:.3g}"] if self.white != 1.0 else []
        return ", ".join([*parts, self.curve.value] if self.curve is not Curve.NONE else parts)


NEUTRAL = Tone()


# --- slices and ranges ------------------------------------------------------------------------------

AXES = ("x", "y", "z")
SHADING = 0.35
"""How much of the light shows under flat colours."""
Span = tuple[float, float]


class Slice(NamedTuple):
    """A plane through space: across which axis, 0 to 2, and where along it, 0 to 1."""

    axis: int = 1
    at: float = 0.25

    def layer(self, layers: int) -> int:
        """Return the number of the layer, of so many along the axis."""
        return min(int(self.at * layers), layers - 1)

    def in_layer(self, number: int, layers: int) -> Slice:
        """Return the slice in the middle of this layer, or of the last before they end."""
        return self._replace(at=(min(max(number, 0), layers - 1) + 0.5) / layers)

    def __str__(self) -> str:
        """Return it as the option `--slice` takes it."""
        return f"{AXES[self.axis]}:{self.at!r}"

    @staticmethod
    def parse(text: str) -> Slice:
        """Return the inverse of `str`; raises ValueError, in one line."""
        axis, colon, at = text.partition(":")
        try:
            found = Slice(AXES.index(axis.strip().lower()), float(at) if colon else Slice().at)
            found.check()
        except ValueError:
            raise ValueError(f"{text!r} is not a slice; give an axis and a part from 0 to 1, like y:0.25") from None
        return found

    def check(self) -> None:
        """Raise ValueError, in one line, for one that lies nowhere."""
        if not (0 <= self.axis < len(AXES) and 0.0 <= self.at <= 1.0):
            raise ValueError("the slice lies nowhere")


MIDDLE = Slice()


def in_views(shows: Callable[[View], bool]) -> Callable[[Any], bool]:
    """Return whether a setting applies to a state: in views that show something."""
    return lambda state: shows(state.draw.view)


def _check_spans(spans: tuple[tuple[View, Span], ...]) -> None:
    if not all(low < high for _, (low, high) in spans):
        raise ValueError("the range of a view is empty")


def _check_place(place: tuple[float, float]) -> None:
    if not all(0.0 <= part <= 1.0 for part in place):
        raise ValueError("the legend lies outside the picture")


LONGEST_CAPTION = 10_000


def check_caption(text: str) -> None:
    """Raise ValueError, in one line, for a caption that takes long to draw."""
    if len(text) > LONGEST_CAPTION:
        raise ValueError(f"a caption has {LONGEST_CAPTION:,} characters at most")


@dataclass(frozen=True)
class DrawOptions:
    """How a frame is drawn.

    `light` counts the lights that are on.  `spans` are the ranges that were chosen for views of numbers: a range that
    is not chosen is that of the frame.  Rings around wrong pixels are drawn for a picture that is shown `magnified`
    times as large.  `zoom` is the part of the picture that the window shows."""

    view: View = setting(View.COLOR, "View", "What is shown of the frame.", option="--view")
    light: int = setting(0, "Light", "The light that the view is about.", low=0, remembered=False,
                         applies=in_views(lambda view: view.of_light))  # fmt: skip
    wipe: float = setting(
        0.5, "Line", "Where the line between the two pictures is; or drag it in the picture.", low=0.0, high=1.0,
        percent=True, digits=0, panel="View", applies=in_views(lambda view: view is View.WIPE), remembered=False,
    )  # fmt: skip
    slice: Slice = setting(
        MIDDLE, "Slice", "The plane through space that is shown: across which axis, and where along it.",
        option="--slice", check=Slice.check, applies=in_views(lambda view: view.has_slice), remembered=False,
    )  # fmt: skip
    beneath: float = setting(
        BENEATH, "Beneath", "How bright the picture is beneath the wrong pixels, or behind the slice.",
        low=0.0, high=1.0, slider=(0.0, 0.6), percent=True, digits=0, option="--beneath", panel="View",
        applies=in_views(lambda view: view is View.DIFFERENCE or view.has_slice),
    )  # fmt: skip
    shading: float = setting(
        SHADING, "Shading", "How much of the picture's light and shade shows under the colours.", low=0.0, high=1.0,
        option="--shading", panel="View", applies=in_views(lambda view: view.is_flat),
    )  # fmt: skip
    tone: Tone = NEUTRAL
    spans: tuple[tuple[View, Span], ...] = setting(
        (), "Range", "What the first and the last colour of the map stand for.", option="--range", remembered=False,
        applies=lambda state: state.draw.has_span, check=_check_spans,
    )  # fmt: skip
    legend: bool = setting(
        False, "Legend", "Draw into the picture what its colours mean.", option="--legend",
        panel="View", in_window=True,
    )  # fmt: skip
    legend_at: tuple[float, float] = setting(
        (0.0, 1.0), "Place of the legend", "Where the legend is in the picture: 0,0 is the upper left.",
        option="--legend-at", check=_check_place,
    )  # fmt: skip
    outlines: bool = setting(
        False, "Outlines", "Draw the borders between primitives.", option="--outlines", panel="View"
    )
    shares: bool = setting(
        False, "Shares of rays",
        "Show the share of the shadow rays due, or of the rays traced without culling, instead of counts.",
        panel="View", applies=in_views(lambda view: view.records is Record.WORK),
    )  # fmt: skip
    mark_wrong: bool = setting(
        True, "Mark wrong pixels",
        "Draw rings around pixels with wrong shadow answers in Difference and Wipe.",
        option="--no-marks", panel="View", applies=in_views(lambda view: view.records is Record.VERIFY),
    )  # fmt: skip
    clipping: bool = setting(
        False, "Mark clipped pixels",
        "Draw stripes over pixels that are too bright for the screen, in red, and over black ones, in blue.",
        option="--mark-clipped", panel="View", applies=in_views(lambda view: view.shows_clipped), remembered=False,
    )  # fmt: skip
    rays: bool = setting(True, "Draw shadow rays", "Draw the shadow rays of the clicked pixel over the picture.")
    smooth: bool = setting(True, "Smooth upscaling", "Blend the pixels of a picture that is smaller than the window.")
    savings: str | None = setting(
        None, "Savings", "Say above the picture what culling saves, with this text for steps and time, and a bar.",
        option="--savings", remembered=False,
    )  # fmt: skip
    caption: str = setting(
        "", "Caption", "A line of text below the picture.", option="--caption", remembered=False, check=check_caption
    )
    magnified: int = setting(
        1, "Magnified", "Draw rings for a picture that is shown so many times as large.", low=1, high=100,
        option="--magnified", remembered=False,
    )  # fmt: skip
    zoom: Zoom = setting(FIT, "Zoom", "How closely the picture is looked at.", remembered=False)

    @property
    def has_span(self) -> bool:
        """Whether the view is of numbers that run from one to another; shares run from none to all."""
        return self.view.has_range and not (self.view.records is Record.WORK and self.shares)

    @property
    def span(self) -> Span | None:
        """The range that was chosen for the view; None: as the frame has it."""
        return dict(self.spans).get(self.view) if self.has_span else None

    def with_span(self, span: Span | None, view: View | None = None) -> DrawOptions:
        """Return these with another range for a view, the one that is shown where none is named."""
        spans = {**dict(self.spans), (view or self.view): span}
        return replace(self, spans=tuple((name, found) for name, found in spans.items() if found is not None))

    def as_needed(self) -> DrawOptions:
        """Return these without what the view has no use for: its tone, stripes, ranges and slice."""
        view, span = self.view, self.span
        return replace(
            self,
            tone=self.tone if view.shows_picture else NEUTRAL,
            clipping=self.clipping and view.shows_clipped,
            spans=() if span is None else ((view, span),),
            slice=self.slice if view.has_slice else MIDDLE,
        )

    @lru_cache(16)  # noqa: B019 - the same few values, several times in each frame of the window
    def of_pixels(self) -> DrawOptions:
        """Return these with the defaults of all that does not count for the view's pixels: else they are drawn anew."""
        used, state = self.as_needed(), SimpleNamespace(draw=self)
        unused = [one for one in settings_of(DrawOptions) if one.name in AROUND or not one.applies(state)]
        return replace(used, **{one.name: one.default for one in unused if not one.within})


AROUND = ("legend", "legend_at", "rays", "smooth", "savings", "caption", "zoom")
"""What lies over the pixels of a view, or around them."""


# --- tone, applied -----------------------------------------------------------------------------------


def toned(color: NDArray[np.float32], tone: Tone) -> NDArray[np.float32]:
    """Colours (..., 3) float32 for the screen, from 0; what exceeds 1 is clipped by whoever shows it.

    Unchanged, and not even copied, by a neutral tone."""
    if tone.neutral:
        return color
    x, white = np.maximum(color, np.float32(0.0)) * np.float32(2.0**tone.exposure), np.float32(tone.white)
    if tone.curve is Curve.REINHARD:
        return (x * (1 + x / (white * white)) / (1 + x)).astype(np.float32, copy=False)
    if tone.curve is Curve.FILMIC:
        return (_hable(x) / _hable(white)).astype(np.float32)
    if tone.curve is Curve.SRGB:
        return _srgb(x / white)
    return x / white


def _hable(x: Any) -> Any:
    a, b, c, d, e, f = (np.float32(v) for v in HABLE)
    return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f


def _srgb(x: NDArray[np.float32]) -> NDArray[np.float32]:
    """IEC 61966-2-1; values above 1 go on along the same curve, so that they can be told to be clipped."""
    curved = np.float32(1.055) * np.maximum(x, np.float32(0.0031308)) ** np.float32(1 / 2.4) - np.float32(0.055)
    return np.where(x <= np.float32(0.0031308), np.float32(12.92) * x, curved).astype(np.float32)


def clipped(color: NDArray[np.float32], tone: Tone) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which pixels (h, w) of colours (h, w, 3) have a channel too bright for the screen, and which are black."""
    shown = toned(color, tone)
    return np.any(shown > 1.0, axis=-1), np.all(shown <= 0.0, axis=-1)


def brighter(tone: Tone, stops: float) -> Tone:
    """The tone with another exposure, within its limits."""
    exposure = setting_of(Tone, "exposure").clamped(tone.exposure + stops)
    return replace(tone, exposure=0.0 if math.isclose(exposure, 0.0, abs_tol=1e-9) else exposure)

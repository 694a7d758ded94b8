"""How colours as they were traced become colours of the screen: exposure, white point and tone curve.

It changes what is shown and saved, never what was traced.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.setting import setting

MOST_EXPOSURE = 16.0
"""Stops of exposure, up and down."""

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
        low=-MOST_EXPOSURE, high=MOST_EXPOSURE, slider=(-6.0, 6.0), unit=" EV", option="--exposure", panel="Tone",
        applies=_in_pictures, remembered=False,
    )  # fmt: skip
    white: float = setting(
        1.0, "White", "The colour, once exposed, that becomes white.", low=0.01, high=1000.0, log=True,
        option="--white", panel="Tone", applies=_in_pictures, remembered=False,
    )  # fmt: skip
    curve: Curve = setting(
        Curve.NONE, "Tone curve", "How colours up to white become those of the screen.", option="--tone", panel="Tone",
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
    exposure = min(max(tone.exposure + stops, -MOST_EXPOSURE), MOST_EXPOSURE)
    return Tone(0.0 if math.isclose(exposure, 0.0, abs_tol=1e-9) else exposure, tone.white, tone.curve)

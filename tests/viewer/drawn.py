"""Pictures of frames by a few options, and what eyes make of colours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.scene.lights import Light
from viewer.state.draw_options import DrawOptions, Span
from viewer.state.palette import Color
from viewer.state.views import View
from viewer.views import colorize, legend_of, values_of, words_at
from viewer.views.base import Values
from viewer.views.legend import Legend


def options(view: View = View.COLOR, light: int = 0, span: Span | None = None, **more: Any) -> DrawOptions:
    """A view of a light, in a range, and other options."""
    return DrawOptions(view=view, light=light, **more).with_span(span)


def picture(frame: Frame, view: View = View.COLOR, light: int = 0, **more: Any) -> NDArray[np.uint8]:
    """(h, w, 3) uint8."""
    return colorize(frame, options(view, light, **more))


def legend_in(frame: Frame, view: View, light: int = 0, lights: tuple[Light, ...] = (), **more: Any) -> Legend | None:
    """What is said of the view."""
    return legend_of(frame, options(view, light, **more), lights)


def values_in(frame: Frame, view: View, light: int = 0, **more: Any) -> Values:
    """The exact values."""
    return values_of(frame, options(view, light, **more))


def words_in(frame: Frame, view: View, light: int, x: int, y: int, **more: Any) -> tuple[str, ...]:
    """What one pixel shows."""
    return words_at(frame, options(view, light, **more), x, y)


def units_in(frame: Frame, view: View, light: int = 0) -> dict[str, int]:
    """How many primitives or cells a legend of modes or certificates counts, by the name of the class."""
    found = legend_in(frame, view, light)
    return {one.name: int(one.values[1].replace(",", "")) for one in found.entries} if found is not None else {}


def luminance(color: Color) -> float:
    """Relative luminance (WCAG 2)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color]
    return float(np.dot(linear, (0.2126, 0.7152, 0.0722)))

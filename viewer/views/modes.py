"""What views of modes, and of certificates, share: how many units and pixels are of which class, and what the paper's
method would cull."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULLY_RENDERED, OcclusionMode, ShadowMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.frame import Frame
from tracer.method import Method
from viewer.state import terms
from viewer.state.palette import Color
from viewer.state.readings import has_modes_of_cells
from viewer.util.numbers import count, percent
from viewer.views.legend import Entry

_BY_MODES = "of this frame, at all bounces, by the modes after the frame before: what the paper's method saves"


class Class(NamedTuple):
    """A colour of a legend: its name, what it means, and the stripes that it may have."""

    name: str
    color: Color
    meaning: str
    stripes: Color | None = None


def class_entries(
    classes: Sequence[Class], units: NDArray[np.int64], pixels: NDArray[np.int64], of: str
) -> tuple[Entry, ...]:
    """Say how many units, and primary pixels, are of each class; `of` is what units are called."""
    total, seen = max(int(units.sum()), 1), max(int(pixels.sum()), 1)
    return tuple(
        Entry(
            one.name.replace("_", " ").lower(),
            one.color,
            (f"{100.0 * p / seen:.1f} %", count(u)),
            f"{one.name}: {one.meaning}. {count(p)} pixels; {100.0 * u / total:.2f} % of all {of}.",
            stripes=one.stripes,
        )
        for one, u, p in zip(classes, units.tolist(), pixels.tolist(), strict=True)
    )


def mode_entries(frame: Frame, of_unit: NDArray[np.uint8], classes: Sequence[Class]) -> tuple[Entry, ...]:
    """Say the same of the class of each unit; the primitives that rest follow, so that none is missed."""
    units = np.bincount(of_unit, minlength=len(classes))
    pixels = np.bincount(of_unit, weights=frame.pixel_count, minlength=len(classes)).astype(np.int64)
    return (*class_entries(classes, units, pixels, units_of(frame)), *at_rest(frame))


def at_rest(frame: Frame) -> tuple[Entry, ...]:
    """Count the primitives of dynamic objects that are not dynamic."""
    resting = frame.statistics.resting
    if not resting:
        return ()
    meaning = f"{count(resting)} primitives of dynamic objects that rest: with {frame.settings.method} they count as "
    return (Entry("dynamic, at rest", None, ("", count(resting)), f"{meaning}static, and are in the rows above"),)


def units_of(frame: Frame) -> str:
    """Return what carries modes."""
    return "cells" if has_modes_of_cells(frame) else "primitives"


def dynamic_meaning(frame: Frame) -> str:
    """Return what DYNAMIC means to the method: some take what rests for static, and so do modes beside a method."""
    method = Method.parse(frame.settings.method)
    if method.uses_modes and not method.has("rest"):
        return "of an object that can move, also while it rests: never culled"
    return "it moves now: not culled; what can move but rests counts as static"


def shadow_modes(frame: Frame, light: int) -> NDArray[np.uint8]:
    """Return the ShadowMode of each unit (n,); INIT for a light that culling does not cover."""
    if not has_shadow_mode(frame.modes, light):
        return np.zeros(len(frame.modes), np.uint8)
    return shadow_mode(frame.modes, light)


def untrusted(frame: Frame, light: int) -> NDArray[np.bool_]:
    """Find the units (n,) with a shadow mode by which they would be culled if they were fully rendered."""
    shadow, occlusion = shadow_modes(frame, light), occlusion_mode(frame.modes)
    culls = (shadow == ShadowMode.FULL_SHADOW) | (shadow == ShadowMode.NON_SHADOW)
    return culls & (occlusion != FULLY_RENDERED) & (occlusion != OcclusionMode.DYNAMIC)


def culled_by_modes(frame: Frame, light: int | None = None, number: int | None = None) -> tuple[Entry, ...]:
    """Say what the paper's method would cull of this frame's shadow rays: of one light, and of all."""
    said, columns = frame.statistics.by_modes, {"all lights": frame.statistics.by_modes_in_all}
    if not said:
        return ()
    if light is not None and light < len(said) > 1:
        columns = {f"light {number}": said[light]} | columns
    part = frame.statistics.part
    name = "shadow rays, all bounces"
    name += "" if Method.parse(frame.settings.method).uses_modes else ", if by modes"
    name += f", {percent(part, 1.0)} shaded" if part < 1.0 else ""
    return (
        Entry(name, None, tuple(columns), _BY_MODES, True),
        Entry(
            terms.CULLED,
            None,
            tuple(percent(one.full_shadow, one.due) for one in columns.values()),
            "of the rays due: those of fully rendered primitives in full shadow",
        ),
        Entry(
            terms.DYNAMIC_ONLY,
            None,
            tuple(percent(one.non_shadow, one.due) for one in columns.values()),
            "of the rays due: those of fully rendered primitives in non-shadow, tested against dynamic objects only",
        ),
    )

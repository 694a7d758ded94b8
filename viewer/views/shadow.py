"""Shadow modes of one light (§2.2 of the paper)."""

from __future__ import annotations

import numpy as np

from tracer.culling.modes import OcclusionMode, ShadowMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.frame import Frame
from tracer.scene.lights import named_light, number_of
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import OCCLUSION_COLORS, SHADOW_COLORS, SHADOW_MEANING
from viewer.views.base import FrameView, Lights, Pixels, Values, Words, hits, per_pixel, single, spoken
from viewer.views.legend import Legend, Note, NoteKind
from viewer.views.modes import (
    Class,
    culled_by_modes,
    dynamic_meaning,
    mode_entries,
    shadow_modes,
    units_of,
    untrusted,
)  # fmt: skip
from viewer.views.paint import by_class

FULL, NON = ShadowMode.FULL_SHADOW, ShadowMode.NON_SHADOW
_DYNAMIC, _UNTRUSTED = len(ShadowMode), len(ShadowMode)  # the class of what moves; added to that of what is not trusted
_TRUSTED_MEANING = {
    FULL: "fully rendered, and every shadow ray so far was blocked: culled",
    NON: "fully rendered, and no shadow ray so far was blocked: tested against dynamic objects only",
}
_UNTRUSTED_MEANING = {
    FULL: "every shadow ray so far was blocked, but it is not fully rendered: traced",
    NON: "no shadow ray so far was blocked, but it is not fully rendered: traced",
}
STRIPE = 3
"""Pixels across which a stripe goes where a shadow mode is not trusted, and the grey one of INIT beside it."""

_COLORS = [*SHADOW_COLORS.values(), OCCLUSION_COLORS[OcclusionMode.DYNAMIC], SHADOW_COLORS[FULL], SHADOW_COLORS[NON]]
_PALETTE = np.asarray(_COLORS, np.float32)
_STRIPED = np.asarray([*_COLORS[: _DYNAMIC + 1], *[SHADOW_COLORS[ShadowMode.INIT]] * 2], np.float32)


def _classes(frame: Frame, light: int) -> np.ndarray:
    """Return the class of each unit (n,): its shadow mode; what moves, and what is not trusted, apart."""
    classes, doubted = shadow_modes(frame, light), untrusted(frame, light)
    classes[occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC] = _DYNAMIC
    classes[doubted] += _UNTRUSTED
    return classes


class Shadow(FrameView):
    label = "Shadow mode"
    key = "3"
    help = (
        "What the shadow rays of each primitive have met on the way to the chosen light. Stripes: the primitive is not "
        "fully rendered, so that its mode is not trusted, and its rays are traced."
    )
    of_light = of_modes = is_flat = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        return by_class(frame, draw, frame.unit, _classes(frame, draw.light), _PALETTE, _STRIPED, STRIPE)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        title = f"{self.label}, {named_light(lights, draw.light)}"
        if not has_shadow_mode(frame.modes, draw.light):
            return not_culled(title)
        meaning, grey = SHADOW_MEANING | _TRUSTED_MEANING, SHADOW_COLORS[ShadowMode.INIT]
        classes = [Class(mode.name, SHADOW_COLORS[mode], meaning[mode]) for mode in ShadowMode]
        classes.append(Class("DYNAMIC", OCCLUSION_COLORS[OcclusionMode.DYNAMIC], dynamic_meaning(frame)))
        for mode, why in _UNTRUSTED_MEANING.items():
            classes.append(Class(f"{mode.name}, untrusted", SHADOW_COLORS[mode], why, grey))
        init, full, non, partial, dynamic, full_too, non_too, *rest = mode_entries(
            frame, _classes(frame, draw.light), classes
        )
        entries = (init, full, full_too, non, non_too, partial, dynamic, *rest)
        facts = culled_by_modes(frame, draw.light, number_of(lights, draw.light))
        return Legend(title, ("pixels", units_of(frame)), entries, facts=facts)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        modes = per_pixel(frame, shadow_modes(frame, draw.light))
        return single(modes, "shadow mode", hits(frame), classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        unit = frame.unit[y, x]
        if int(occlusion_mode(frame.modes[unit])) == OcclusionMode.DYNAMIC:
            return spoken(OcclusionMode.DYNAMIC.name)
        if not has_shadow_mode(frame.modes, draw.light):
            return ("not", "culled")
        said = spoken(ShadowMode(int(shadow_mode(frame.modes[unit], draw.light))).name)
        return (*said, "untrusted") if untrusted(frame, draw.light)[unit] else said


def not_culled(title: str) -> Legend:
    """Return the legend of a light that culling does not cover."""
    why = "This light is not culled, as there are too many: all its rays are traced."
    return Legend(title, notes=(Note(why, NoteKind.WARNING),))


VIEW = Shadow()

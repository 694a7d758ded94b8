"""Shadow modes of one light (§2.2 of the paper)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULLY_RENDERED, OcclusionMode, ShadowMode, has_shadow_mode, occlusion_mode
from tracer.frame import Frame
from tracer.scene.lights import number_of
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import OCCLUSION, SHADOW, Class
from viewer.views.base import Lights, Lines
from viewer.views.kinds import ModeView, culled_by_modes, not_culled, shadow_modes
from viewer.views.legend import Legend

STRIPE = 3
"""Pixels across which a stripe goes where a shadow mode is not trusted, and the grey one of INIT beside it."""
_INIT, _FULL, _NON, _PARTIAL = ShadowMode
_PLACES = np.array([0, 1, 3, 5], np.uint8)  # of these modes among the classes; those not trusted come after their modes
_MOVES = 6


def _trusted(mode: ShadowMode, meaning: str) -> Class:
    return SHADOW[mode]._replace(meaning=f"fully rendered, and {meaning}")


def _untrusted(mode: ShadowMode, meaning: str) -> Class:
    return Class(f"{SHADOW[mode].name}, untrusted", SHADOW[mode].color, meaning, SHADOW[_INIT].color)


class Shadow(ModeView):
    label = "Shadow mode"
    key = "3"
    help = (
        "What the shadow rays of each primitive have met on the way to the chosen light. Stripes: the primitive is not "
        "fully rendered, so that its mode is not trusted, and its rays are traced."
    )
    of_light = True
    what = "shadow mode"
    stripe = STRIPE
    classes = (
        SHADOW[_INIT],
        _trusted(_FULL, "every shadow ray so far was blocked: culled"),
        _untrusted(_FULL, "every shadow ray so far was blocked, but it is not fully rendered: traced"),
        _trusted(_NON, "no shadow ray so far was blocked: tested against dynamic objects only"),
        _untrusted(_NON, "no shadow ray so far was blocked, but it is not fully rendered: traced"),
        SHADOW[_PARTIAL],
        OCCLUSION[OcclusionMode.DYNAMIC],
    )

    def of_units(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        modes, occlusion = shadow_modes(frame, light), occlusion_mode(frame.modes)
        found = _PLACES[modes]
        found[((modes == _FULL) | (modes == _NON)) & (occlusion != FULLY_RENDERED)] += 1
        found[occlusion == OcclusionMode.DYNAMIC] = _MOVES
        return found

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        title = self.title(draw, lights)
        if not has_shadow_mode(frame.modes, draw.light):
            return not_culled(title)
        facts = culled_by_modes(frame, draw.light, number_of(lights, draw.light))
        return self.mode_legend(frame, draw, title, facts)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        moves = self.found(frame, draw)[y, x] == _MOVES
        if moves or has_shadow_mode(frame.modes, draw.light):
            return super().words(frame, draw, x, y)
        return "not", "culled"


VIEW = Shadow()

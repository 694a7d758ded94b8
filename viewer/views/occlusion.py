"""Occlusion modes (§2.2 of the paper)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import OCCLUSION_COLORS, OCCLUSION_MEANING
from viewer.views.base import Lights
from viewer.views.kinds import Class, ModeView, culled_by_modes, mode_name
from viewer.views.legend import Legend

MOVES = Class(
    mode_name(OcclusionMode.DYNAMIC), OCCLUSION_COLORS[OcclusionMode.DYNAMIC],
    "it moves, or could and the method is paper: never culled",
)  # fmt: skip


class Occlusion(ModeView):
    label = "Occlusion mode"
    key = "2"
    help = "How much of each primitive the camera has seen: only fully rendered ones are culled."
    what = "occlusion mode"
    classes = (
        *[Class(mode_name(one), OCCLUSION_COLORS[one], OCCLUSION_MEANING[one]) for one in list(OcclusionMode)[:-1]],
        MOVES,
    )

    def of_units(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        return occlusion_mode(frame.modes)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        return self.mode_legend(frame, draw, self.label, culled_by_modes(frame))


VIEW = Occlusion()

"""Occlusion modes (§2.2 of the paper)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import occlusion_mode
from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import OCCLUSION
from viewer.views.base import Lights
from viewer.views.kinds import ModeView, culled_by_modes
from viewer.views.legend import Legend


class Occlusion(ModeView):
    label = "Occlusion mode"
    key = "2"
    help = "How much of each primitive the camera has seen: only fully rendered ones are culled."
    what = "occlusion mode"
    classes = tuple(OCCLUSION.values())

    def of_units(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        return occlusion_mode(frame.modes)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        return self.mode_legend(frame, draw, self.label, culled_by_modes(frame))


VIEW = Occlusion()

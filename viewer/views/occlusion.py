"""Occlusion modes (§2.2 of the paper)."""

from __future__ import annotations

import numpy as np

from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import OCCLUSION_COLORS, OCCLUSION_MEANING
from viewer.views.base import FrameView, Lights, Pixels, Values, Words, hits, single, spoken
from viewer.views.legend import Legend
from viewer.views.modes import Class, culled_by_modes, dynamic_meaning, mode_entries, units_of
from viewer.views.paint import by_class

_PALETTE = np.asarray([OCCLUSION_COLORS[mode] for mode in OcclusionMode], np.float32)


class Occlusion(FrameView):
    label = "Occlusion mode"
    key = "2"
    help = "How much of each primitive the camera has seen: only fully rendered ones are culled."
    of_modes = is_flat = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        return by_class(frame, draw, frame.unit, occlusion_mode(frame.modes), _PALETTE)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        meaning = OCCLUSION_MEANING | {OcclusionMode.DYNAMIC: dynamic_meaning(frame)}
        classes = [Class(mode.name, OCCLUSION_COLORS[mode], meaning[mode]) for mode in OcclusionMode]
        entries = mode_entries(frame, occlusion_mode(frame.modes), classes)
        return Legend(self.label, ("pixels", units_of(frame)), entries, facts=culled_by_modes(frame))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(frame.occlusion_mode, "occlusion mode", hits(frame), classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        return spoken(OcclusionMode(int(occlusion_mode(frame.modes[frame.unit[y, x]]))).name)


VIEW = Occlusion()

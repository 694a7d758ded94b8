"""Certificates of one light, cell by cell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import OcclusionMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import CERTIFICATES, OCCLUSION, Certificate
from viewer.util.numbers import count
from viewer.views.base import Lights, hits
from viewer.views.kinds import ClassView, at_rest, not_culled
from viewer.views.legend import Legend

_MOVES = len(Certificate)


class Certificates(ClassView):
    label = "Certificates"
    key = "0"
    help = (
        "What is proved for each cell and the chosen light; lines are the borders of cells. Each frame proves more: T "
        "traces one more, K keeps tracing."
    )
    of_light = True
    shows = "certificates"
    what = "certificate"
    classes = (
        *CERTIFICATES.values(),
        OCCLUSION[OcclusionMode.DYNAMIC]._replace(meaning="it moves: never certified"),
    )

    def find(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        words = frame.certificates
        if words is None or not has_shadow_mode(words, light):
            found = np.zeros(frame.primitive.shape, np.uint8)
        else:
            found = shadow_mode(words, light)
        if len(frame.modes):
            found[(occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC)[frame.unit] & hits(frame)] = _MOVES
        return found

    def cells(self, frame: Frame) -> NDArray[np.int32] | None:
        return frame.cell

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        """Count primary pixels, and cells that are seen, with each certificate; what moves apart."""
        title = self.title(draw, lights)
        if frame.certificates is None or not has_shadow_mode(frame.certificates, draw.light):
            return not_culled(title)
        cells = [0] * len(self.classes)
        if frame.cells is not None:
            there = hits(frame) & (frame.cells >= 0)
            _, first = np.unique(frame.cells[there], return_index=True)
            cells = np.bincount(self.found(frame, draw)[there][first], minlength=len(cells)).tolist()
        entries = self.entries(self.counted(frame, draw), [count(n) for n in cells])
        return Legend(title, ("pixels", "cells"), (*entries, *at_rest(frame)))


VIEW = Certificates()

"""Certificates of one light, cell by cell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import OcclusionMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.frame import Frame
from tracer.scene.lights import named_light
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import CERTIFICATE_COLORS, CERTIFICATE_MEANING, OCCLUSION_COLORS, Certificate
from viewer.views.base import FrameView, Lights, Pixels, Values, Words, hits, single, spoken
from viewer.views.legend import Legend
from viewer.views.modes import Class, at_rest, class_entries
from viewer.views.paint import by_class
from viewer.views.shadow import not_culled

_DYNAMIC = len(Certificate)
_CLASSES = [Class(one.name, CERTIFICATE_COLORS[one], CERTIFICATE_MEANING[one]) for one in Certificate]
_CLASSES.append(Class("DYNAMIC", OCCLUSION_COLORS[OcclusionMode.DYNAMIC], "it moves: never certified"))
_PALETTE = np.asarray([one.color for one in _CLASSES], np.float32)


class Certificates(FrameView):
    label = "Certificates"
    key = "0"
    help = (
        "What is proven for each cell and the chosen light; lines are the borders of cells. Each frame proves more: T "
        "traces one more, K keeps tracing."
    )
    of_light = is_flat = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return frame.certificates is not None

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        found, all_of_them = _found(frame, draw.light).astype(np.int32), np.arange(len(_PALETTE), dtype=np.uint8)
        return by_class(frame, draw, found, all_of_them, _PALETTE, cells=frame.cell)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        """Count cells that are seen, and primary pixels, with each certificate; what moves apart."""
        title = f"{self.label}, {named_light(lights, draw.light)}"
        if frame.certificates is None or not has_shadow_mode(frame.certificates, draw.light):
            return not_culled(title)
        found, hit = _found(frame, draw.light), hits(frame)
        pixels, cells = np.bincount(found[hit], minlength=len(_CLASSES)), np.zeros(len(_CLASSES), np.int64)
        if frame.cells is not None:
            there = hit & (frame.cells >= 0)
            class_of = np.full(int(frame.cells.max(initial=-1)) + 1, len(_CLASSES), np.uint8)
            class_of[frame.cells[there]] = found[there]
            cells = np.bincount(class_of, minlength=len(_CLASSES))[: len(_CLASSES)]
        entries = (*class_entries(_CLASSES, cells, pixels, "cells"), *at_rest(frame))
        return Legend(title, ("pixels", "cells"), entries)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(_proven(frame, draw.light), "certificate", hits(frame), classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        words = frame.certificates
        if words is None or not has_shadow_mode(words, draw.light):
            return spoken(Certificate.NONE.name)
        return spoken(Certificate(int(shadow_mode(words[y, x], draw.light))).name)


def _proven(frame: Frame, light: int) -> NDArray[np.uint8]:
    """Return the Certificate of the light at each pixel."""
    if frame.certificates is None or not has_shadow_mode(frame.certificates, light):
        return np.zeros(frame.primitive.shape, np.uint8)
    return shadow_mode(frame.certificates, light)


def _found(frame: Frame, light: int) -> NDArray[np.uint8]:
    """Return the same, with one more class where a dynamic object is seen."""
    classes = _proven(frame, light)
    if len(frame.modes):
        dynamic = occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC
        classes[dynamic[np.maximum(frame.unit, 0)] & hits(frame)] = _DYNAMIC
    return classes


VIEW = Certificates()

"""How many lights each pixel has to look at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.views import Record
from viewer.util.numbers import count
from viewer.views.base import NOT_RECORDED, Lights, once
from viewer.views.counts import NOT_KNOWN_YET, Count
from viewer.views.legend import Legend, counts_scale, fact


class LightsDue(Count):
    label = "Lights due"
    key = "Shift+J"
    help = "How many lights the surface at each pixel faces: a shadow ray is due to each of them."
    records = Record.LIGHTS
    name = "lights due"

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return frame.asked is not None and frame.only_light is None

    def found(self, frame: Frame) -> NDArray[np.int32]:
        """Count the lights that each pixel faces with any of their samples."""
        asked = frame.asked
        if asked is None or frame.only_light is not None:
            raise ValueError(NOT_RECORDED[Record.LIGHTS])
        return once(frame, "lights", lambda: _counted(asked, frame.shaded))

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        facts = (fact("per pixel", f"{self.per_pixel(frame):.4g} of {count(frame.lights)} lights"),)
        entries = NOT_KNOWN_YET if frame.shaded is not None else ()
        scale = counts_scale(int(self.span(frame)[1]), draw.span)
        return Legend("Lights due at each pixel", (), entries, scale, facts)


def _counted(asked: NDArray[np.uint16], shaded: NDArray[np.bool_] | None) -> NDArray[np.int32]:
    found = np.count_nonzero(asked, axis=-1).astype(np.int32)
    return found if shaded is None else np.where(shaded, found, np.int32(-1))


VIEW = LightsDue()

"""How many lights each pixel has to look at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.views import Record
from viewer.views.base import once, shaded_pixels
from viewer.views.kinds import CountView


class LightsDue(CountView):
    label = "Lights due"
    key = "Shift+J"
    help = "How many lights the surface at each pixel faces: a shadow ray is due to each of them."
    records = Record.LIGHTS
    shows = "asked"
    what = "lights due"
    heading = "Lights due at each pixel"

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return super().can_draw(frame, light) and frame.only_light is None

    def find(self, frame: Frame) -> NDArray[np.int32]:
        """Count the lights that each pixel faces with any of their samples."""
        return once(frame, "lights", lambda: _count(frame))


def _count(frame: Frame) -> NDArray[np.int32]:
    assert frame.asked is not None
    return np.where(shaded_pixels(frame), np.count_nonzero(frame.asked, axis=-1), -1).astype(np.int32)


VIEW = LightsDue()

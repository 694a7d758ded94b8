"""How many pixels a unit covers, against those that it covered when it was last examined (§2.6 of the paper)."""

from __future__ import annotations

import numpy as np

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import GREY
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, hits, single
from viewer.views.kinds import culled_by_modes
from viewer.views.legend import Entry, Legend, Scale
from viewer.views.paint import by_number


class PixelCount(DrawnView):
    label = "Pixel count"
    key = "7"
    help = "Pixels that a primitive covers now, compared with its last examination."
    of_modes = is_flat = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        """Draw the ratio, logarithmic from 1 / zoom_factor to zoom_factor, where modes are no longer trusted."""
        if not len(frame.highest_count):
            return by_number(frame, draw, np.zeros(frame.unit.shape))
        ratio = np.maximum(frame.pixel_count, 1) / np.maximum(frame.highest_count, 1)
        place = 0.5 + 0.5 * np.log(ratio) / np.log(max(frame.settings.zoom_factor, 1.01))
        unit = np.maximum(frame.unit, 0)
        return by_number(frame, draw, place[unit], (frame.highest_count > 0)[unit], shading=draw.shading)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        zoom = frame.settings.zoom_factor
        scale = Scale(f"1/{zoom:.3g}", f"{zoom:.3g} x", "as many")
        entries = (Entry("never fully rendered", GREY),)
        return Legend("Pixels now, against the last examination", (), entries, scale, culled_by_modes(frame))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(frame.pixel_count[frame.unit], "pixels of the primitive", hits(frame))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        unit = frame.unit[y, x]
        examined = int(frame.highest_count[unit])
        return f"{int(frame.pixel_count[unit])} now", f"{examined} examined" if examined else "not examined"


VIEW = PixelCount()

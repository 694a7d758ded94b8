"""Distance from the camera."""

from __future__ import annotations

import numpy as np

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, hits, once, percentiles, single
from viewer.views.legend import Legend, Scale
from viewer.views.paint import by_number, in_range

FAR = np.float32(1e30)
"""Stands for the depth of what hits nothing, so that numbers can be subtracted."""


class Depth(DrawnView):
    label = "Depth"
    key = "5"
    help = "Distance from the camera along the ray."
    has_range = True

    def span(self, frame: Frame) -> tuple[float, float]:
        """Return the 1st and the 99th percentile of what is hit; 0 and 1 for nothing."""
        return once(frame, "depth", lambda: _range(frame))

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        near, far = draw.span or self.span(frame)
        depth = np.where(np.isfinite(frame.depth), frame.depth, np.float32(far))
        return by_number(frame, draw, 1.0 - np.clip(in_range(depth, (near, far)), 0.0, 1.0))  # near is bright

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        near, far = draw.span or self.span(frame)
        return Legend(
            f"{self.label}, in units of the scene", scale=Scale(f"{near:.4g}", f"{far:.4g}", "", reverse=True)
        )

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(np.where(hits(frame), frame.depth, FAR), "depth", hits(frame))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        return (f"{frame.depth[y, x]:.5g}",)


def _range(frame: Frame) -> tuple[float, float]:
    low, high = percentiles(frame, frame.depth, 1.0, 99.0) or (0.0, 1.0)
    return low, max(high, low * (1.0 + 1e-6) + 1e-12)


VIEW = Depth()

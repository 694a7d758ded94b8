"""Shading normals."""

from __future__ import annotations

from tracer.frame import Frame
from viewer.state.draw_options import AXES, DrawOptions
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, hits
from viewer.views.legend import Entry, Legend
from viewer.views.paint import by_color


class Normal(DrawnView):
    label = "Normals"
    key = "6"
    help = "The shading normal: x, y, z as red, green, blue."

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        return by_color(frame, draw, frame.normal * 0.5 + 0.5)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        directions = zip(AXES, ((1.0, 0.5, 0.5), (0.5, 1.0, 0.5), (0.5, 0.5, 1.0)), strict=True)
        return Legend(self.label, entries=tuple(Entry(f"towards +{axis}", color) for axis, color in directions))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return Values(frame.normal, AXES, hits(frame))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        return tuple(f"{axis:+z.3f}" for axis in frame.normal[y, x])


VIEW = Normal()

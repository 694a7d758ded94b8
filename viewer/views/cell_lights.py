"""How many lights the cell of each pixel must look at, with local illumination environments."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.readings import CELL_LIGHTS
from viewer.util.numbers import count
from viewer.views.base import Lights, Words, hits
from viewer.views.counts import Count
from viewer.views.legend import Legend, counts_scale, fact

_PER_CELL = (
    "those that are not known to be hidden from all of the cell: they light all of it, or something may block them"
)


class CellLights(Count):
    label = "Lights per cell"
    key = "Shift+K"
    help = (
        "How many lights the cell of each pixel must look at, with the methods lie and lie-exact: all but those that "
        "it knows to be hidden. Lines are the borders of cells."
    )
    name = "lights that the cell asks"
    has_cells = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return CELL_LIGHTS in frame.layers

    def found(self, frame: Frame) -> NDArray[np.int32]:
        """Return -1 also where a pixel lies in no cell."""
        if CELL_LIGHTS not in frame.layers:
            raise ValueError("the method of the frame has no cells that know which lights they must look at")
        return frame.layers[CELL_LIGHTS]

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        seen = hits(frame) & (self.found(frame) >= 0)
        facts = (
            fact("per pixel", f"{self.per_pixel(frame):.4g} of {count(frame.lights)} lights", _PER_CELL),
            fact("cells in view", count(len(np.unique(frame.cell[seen])) if seen.any() else 0)),
        )
        scale = counts_scale(int(self.span(frame)[1]), draw.span)
        return Legend("Lights that the cell must look at", (), self.unknown(frame), scale, facts)

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Words:
        return (f"{found} of {frame.lights}",)


VIEW = CellLights()

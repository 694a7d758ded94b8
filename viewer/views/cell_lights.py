"""How many lights may reach the cell of each pixel, with local illumination environments."""

from __future__ import annotations

import numpy as np

from tracer.frame import Frame
from viewer.state.views import CELL_LIGHTS
from viewer.util.numbers import count
from viewer.views.base import Lines
from viewer.views.kinds import CountView
from viewer.views.legend import Entry, fact


class CellLights(CountView):
    label = "Lights per cell"
    key = "Shift+K"
    help = (
        "How many lights may reach the cell of each pixel, with local illumination environments: all but those "
        "that are known to be hidden from it. Lines are the borders of cells."
    )
    shows = CELL_LIGHTS
    what = "lights of the cell"
    heading = "Lights that may reach the cell"
    each = "those not known to be hidden from all of the cell: they light all of it, or something may block them"
    has_cells = True

    def facts(self, frame: Frame) -> tuple[Entry, ...]:
        return (fact("cells in view", count(len(np.unique(frame.cell[self.seen(frame)])))),)

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Lines:
        return f"{found} of {frame.lights}", "lights"


VIEW = CellLights()

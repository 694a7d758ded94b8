"""The traced picture beside the one in which every shadow answer is right."""

from __future__ import annotations

import numpy as np

from tracer.frame import Frame
from viewer.state import verified
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import WIPE_LINE, WRONG
from viewer.views import color
from viewer.views.base import Lights, Lines, Pixels, Values
from viewer.views.color import displayed
from viewer.views.difference import Difference, Mark, legend_of_wrong, wrong_marks
from viewer.views.legend import Legend
from viewer.views.paint import by_color, in_bytes


class Wipe(Difference):
    label = "Wipe"
    key = "9"
    also = "right reference"
    help = (
        "Left of the line is the traced picture, right of it the picture with every shadow answer right. Drag the line."
    )
    shows_clipped = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        column, right = wipe_column(frame.width, draw.wipe), verified.known(frame.reference)
        both = displayed(np.concatenate([frame.color[:, :column], right[:, column:]], axis=1), draw)
        pixels = by_color(frame, draw, both, everywhere=True)
        if draw.mark_wrong:  # the pixels inside a ring stay as they are
            pixels[wrong_marks(frame, draw.magnified) == Mark.RING] = in_bytes(WRONG)
        pixels[:, column : column + 1] = in_bytes(WIPE_LINE)
        return pixels

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        name = "around wrong pixels" if draw.mark_wrong else "wrong pixels"
        return legend_of_wrong(frame, self.label, name, draw.mark_wrong)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return color.VIEW.values(frame, draw)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        return color.VIEW.words(frame, draw, x, y)


def wipe_column(width: int, wipe: float) -> int:
    """Return the column of pixels that the line covers; `width`, that is none, for a wipe of 1."""
    return min(max(int(wipe * width), 0), width)


VIEW = Wipe()

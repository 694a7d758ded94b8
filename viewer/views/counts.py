"""What views of a count at each pixel share: of lights, or of clusters of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import GREY
from viewer.views.base import FrameView, Pixels, Values, Words, hits, once, single
from viewer.views.legend import Entry
from viewer.views.paint import by_number, in_range

NOT_KNOWN_YET = (Entry("not known yet", GREY),)


class Count(FrameView):
    """A map of a count, which is not known everywhere."""

    has_range = True
    name = ""
    has_cells = False
    """Whether there are lines between cells."""

    def found(self, frame: Frame) -> NDArray[np.int32]:
        """Return the count at each pixel (h, w), -1 where it is not known.  Raises ValueError for a frame without."""
        raise NotImplementedError

    def span(self, frame: Frame) -> tuple[float, float]:
        return once(frame, self.name, lambda: (0.0, float(max(1, int(self.found(frame).max(initial=0))))))

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        found = self.found(frame)
        cells = frame.cell if self.has_cells else None
        return by_number(frame, draw, in_range(found, draw.span or self.span(frame)), found >= 0, cells)

    def seen(self, frame: Frame) -> NDArray[np.int32]:
        """Return the counts (n,) of the pixels that hit something, as far as they are known."""
        found = self.found(frame)
        return found[hits(frame) & (found >= 0)]

    def per_pixel(self, frame: Frame) -> float:
        """Return the mean of these."""
        seen = self.seen(frame)
        return float(seen.mean()) if len(seen) else 0.0

    def unknown(self, frame: Frame) -> tuple[Entry, ...]:
        """Return the entry of pixels of which it is not known, where there are any."""
        return NOT_KNOWN_YET if (hits(frame) & (self.found(frame) < 0)).any() else ()

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        found = self.found(frame)
        return single(found, self.name, hits(frame) & (found >= 0))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        found = int(self.found(frame)[y, x])
        return ("?",) if found < 0 else self.known_words(frame, found, x, y)

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Words:
        """Return what it shows of a pixel where it is known."""
        return (str(found),)

"""Shadow rays that were not traced, pixel by pixel; and what this shares with the map of rays that were."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import GREY
from viewer.state.views import Record
from viewer.util.numbers import count, percent
from viewer.views.base import (
    DrawnView,
    Lights,
    Lines,
    Pixels,
    Values,
    is_shaded,
    once,
    percentiles,
    shaded_pixels,
    single,
)
from viewer.views.kinds import filled_in
from viewer.views.legend import Entry, Legend, Scale, fact
from viewer.views.paint import by_number, in_range


class Work(DrawnView):
    """A map of rays at each pixel: how many, or which share of a whole they are."""

    records = Record.WORK
    has_range = everywhere = True
    name = ""
    title_of_shares = ""
    in_all = ""
    of = ""
    """Of what the total is a share, in the legend."""
    unknown_shares: ClassVar[tuple[Entry, ...]] = ()
    """The entry of pixels whose rays are a share of none."""

    def rays(self, frame: Frame) -> NDArray[np.int32]:
        """Return the rays at each pixel (h, w).  Raises ValueError for a frame that did not record them."""
        return recorded(getattr(frame, self.shows))

    def whole(self, frame: Frame) -> NDArray[np.int32]:
        """Return what they are a share of.  Raises ValueError for a frame without that record."""
        raise NotImplementedError

    def span(self, frame: Frame) -> tuple[float, float]:
        """Return 0 and the 99th percentile of pixels that hit something, 1 at least."""
        return once(frame, self.name, lambda: (0.0, max([1.0, *percentiles(frame, self.rays(frame), 99.0)])))

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        work = self.rays(frame)
        if not draw.shares:
            return by_number(frame, draw, in_range(work, draw.span or self.span(frame)))
        whole = self.whole(frame)
        return by_number(frame, draw, work / np.maximum(whole, 1), whole > 0)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        """Sum up over the pixels that are shaded: the others show what the nearest of these has."""
        work, whole, part = self.rays(frame), self.whole(frame), frame.statistics.part
        if frame.shaded is not None:
            work, whole = work[frame.shaded], whole[frame.shaded]
        total, per_pixel = int(work.sum(dtype=np.int64)), work.sum(dtype=np.int64) / max(work.size, 1)
        name = f"in the {percent(part, 1.0)} that is shaded" if part < 1.0 else "in all"
        facts = (
            fact(name, f"{count(total)} ({percent(total, int(whole.sum(dtype=np.int64)))}{self.of})", self.in_all),
            fact("per pixel", f"{per_pixel:.2f}, at most {count(int(work.max(initial=0)))}"),
        )
        if draw.shares:
            entries, scale = self.unknown_shares, Scale("0 %", "100 %", "50 %")
            return Legend(self.title_of_shares, (), entries, scale, facts, notes=filled_in(frame))
        low, high = draw.span or self.span(frame)
        scale = Scale(f"{low:.4g}", f"{high:.4g} and more", f"{(low + high) / 2.0:.3g}")
        return Legend(self.label, (), (), scale, facts, notes=filled_in(frame))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(self.rays(frame), self.name, shaded_pixels(frame))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        if not is_shaded(frame, x, y):
            return ("?",)
        work = int(self.rays(frame)[y, x])
        whole = int(self.whole(frame)[y, x]) if draw.shares else 0
        return (f"{100.0 * work / whole:.0f} %",) if whole else (f"{work}",)


def recorded(found: NDArray[np.int32] | None) -> NDArray[np.int32]:
    """Return what a frame recorded of its work; raises ValueError where that is nothing."""
    if found is None:
        raise ValueError("the frame did not record the work at its pixels")
    return found


class Saved(Work):
    label = "Untraced shadow rays"
    key = "H"
    help = (
        "Shadow rays of each pixel, at all bounces, that need not be traced through the whole scene: saved ones, and "
        "with some methods candidates and cache hits. How many, or which share of those due."
    )
    name = "shadow rays untraced"
    title_of_shares = "Share of the shadow rays due that is untraced"
    in_all = "of the first sample of each pixel; the share is of the shadow rays due"
    of = " of those due"
    unknown_shares = (Entry("no shadow ray is due", GREY),)
    shows = "saved"

    def whole(self, frame: Frame) -> NDArray[np.int32]:
        return recorded(frame.due_rays)


VIEW = Saved()

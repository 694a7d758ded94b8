"""Shadow rays that were traced although certificates could have known the answer."""

from __future__ import annotations

import numpy as np

from tracer.culling.fate import FATE, Fate
from tracer.frame import Frame
from tracer.inspect.proofs_at_pixels import regret_at_pixels
from viewer.state.frame_rows import primary_due, regret_of
from viewer.state.views import REGRET, Record
from viewer.util.numbers import count, percent
from viewer.views.base import Lines
from viewer.views.kinds import CountView
from viewer.views.legend import Entry, fact

_CEILING = "of the shadow rays of primary hits that are due: all of these are saved by the method free, the ceiling"


class Regret(CountView):
    label = "Regret"
    key = "Shift+R"
    help = (
        "How many shadow rays of each pixel's primary hit the method certified has traced although the smallest cell "
        "there could be proved to be lit, or dark: what a better method could still save."
    )
    records = Record.FATES
    shows = REGRET
    asks = staticmethod(lambda renderer, frame, light, *told: {REGRET: regret_at_pixels(renderer, frame, *told)})
    what = "rays traced that could be proved"
    heading = "Rays traced that could be proved"
    each = "shadow rays of primary hits, of the first sample of each pixel"

    def facts(self, frame: Frame) -> tuple[Entry, ...]:
        assert frame.fates is not None, "it can be drawn"
        rays, due = regret_of(frame), primary_due(frame)
        traced = int(np.count_nonzero(frame.fates & FATE == Fate.TRACED))
        return (
            fact("in all", f"{count(rays or 0)} ({percent(rays or 0, traced)} of the traced ones of primary hits)"),
            fact("of what free saves", percent(rays or 0, due), _CEILING),
            fact("untraced by now", percent(due - traced, due), _CEILING),
        )

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Lines:
        return f"{found} of {frame.lights}", "lights"


VIEW = Regret()

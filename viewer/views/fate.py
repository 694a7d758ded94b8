"""What became of the shadow ray from each pixel's first hit to one light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.method import Method
from viewer.state import terms
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import FATES, fate_palette
from viewer.state.views import Record
from viewer.util.numbers import percent
from viewer.views.base import Lights, Pixels
from viewer.views.kinds import ClassView, filled_in
from viewer.views.legend import Entry, Legend
from viewer.views.paint import by_class

_PAPER = {Fate.PARTLY_OCCLUDED, Fate.PARTIAL_SHADOW, Fate.NOT_SEEN_WHOLE, Fate.DYNAMIC}
_ALWAYS = {Fate.FACES_AWAY, Fate.CULLED, Fate.DYNAMIC_ONLY}


class Fates(ClassView):
    label = "Fate of shadow rays"
    key = "Shift+X"
    also = "why traced culled dynamic reason"
    help = (
        "What became of the shadow ray from each pixel's first hit to the chosen light: culled, tested against dynamic "
        "objects only, or traced, and why it was not culled."
    )
    records = Record.FATES
    of_light = True
    shows = "fates"
    what = "fate of the shadow ray"
    classes = tuple(FATES.values())

    def find(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        return frame.fate(light)

    def highlighted(self, frame: Frame, draw: DrawOptions, fate: Fate | None) -> Pixels:
        return by_class(frame, draw, self.found(frame, draw), np.asarray(fate_palette(fate), np.float32))

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        """Say how many rays had each fate, and which part of those due that is."""
        pixels = self.counted(frame, draw)
        due, saved, traced = (
            sum(pixels[fate] for fate in Fate if among(fate))
            for among in (lambda fate: fate.is_due, lambda fate: fate.is_saved, lambda fate: fate.is_traced)
        )
        usual = _ALWAYS | (_PAPER if Method.parse(frame.settings.method).uses_modes else {Fate.TRACED})
        of_due = [percent(pixels[fate], due) if fate.is_due else "" for fate in Fate]
        entries = self.entries(pixels, of_due, [fate for fate in Fate if pixels[fate] or fate in usual])
        facts = (
            Entry(terms.SAVED, None, ("", percent(saved, due)), terms.MEANINGS[terms.SAVED]),
            Entry(terms.TRACED, None, ("", percent(traced, due)), "through the whole scene, for whatever reason"),
        )
        title = self.title(draw, lights).replace(",", ", first hits,", 1)
        return Legend(title, ("pixels", "of due"), entries, facts=facts, notes=filled_in(frame))


VIEW = Fates()

"""How many clusters of lights each pixel is shaded by, with the methods that cluster them."""

from __future__ import annotations

import numpy as np

from tracer.frame import Frame
from tracer.method import Method
from tracer.methods.method_limits import lights_in_words, too_few
from viewer.state.views import CUT_BOUND, CUT_NODES
from viewer.util.numbers import percent
from viewer.views.base import Lines
from viewer.views.kinds import CountView
from viewer.views.legend import Entry, Note, NoteKind, fact

NEARLY_ALL = 0.9  # of the lights: cuts of more clusters show nothing
_EACH = "the chosen error: clusters are parted until each alone is wrong by no more than this part of a pixel's light"
_BOUND = (
    "by what part of its light a pixel would be wrong if each of its clusters were as wrong as it can be, all in the "
    "same direction; the middle of all pixels. What is wrong in fact, as Verify tells, is a small part of that."
)


class Cuts(CountView):
    label = "Clusters of lights"
    key = "Shift+N"
    help = (
        "How many clusters of lights each pixel is shaded by, with the methods that cluster them (lightcuts); a block "
        "of 128 points shares them."
    )
    shows = CUT_NODES
    what = "clusters of lights"
    heading = "Clusters of lights that each pixel is shaded by"

    def of_what(self, frame: Frame) -> str:
        cuts = frame.statistics.cuts
        return f"for {lights_in_words(frame.lights, 0 if cuts is None else cuts.lights)}"

    def facts(self, frame: Frame) -> tuple[Entry, ...]:
        bounds = frame.layers[CUT_BOUND][self.seen(frame)]
        bound = float(np.median(bounds)) if len(bounds) else 0.0
        return (
            fact("error of a cluster", f"{percent(frame.settings.lightcuts_error, 1.0)} of the light at most", _EACH),
            fact("error of a pixel", f"{percent(bound, 1.0)} at most", _BOUND),
        )

    def notes(self, frame: Frame) -> tuple[Note, ...]:
        cuts = frame.statistics.cuts
        if cuts is None or not cuts.blocks or cuts.mean <= NEARLY_ALL * cuts.lights:
            return ()
        few = too_few(Method.parse(frame.settings.method), frame.lights, cuts.lights)
        one = "light" if cuts.lights == frame.lights else "sample of a light"
        return (Note(f"Nearly every {one} is a cluster of its own{f': {few}' if few else ''}.", NoteKind.WARNING),)

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Lines:
        return f"{found}", f"± {100.0 * float(frame.layers[CUT_BOUND][y, x]):.3g} %"


VIEW = Cuts()

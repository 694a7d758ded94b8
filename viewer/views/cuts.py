"""How many clusters of lights each pixel is shaded by, with the methods that cluster them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.fit import lights_in_words, too_few
from tracer.frame import Frame
from tracer.method import Method
from viewer.state.draw_options import DrawOptions
from viewer.state.readings import CUT_BOUND, CUT_NODES
from viewer.util.numbers import percent
from viewer.views.base import Lights, Words, hits
from viewer.views.counts import Count
from viewer.views.legend import Legend, Note, NoteKind, counts_scale, fact

NEARLY_ALL = 0.9  # of the lights: cuts of more clusters show nothing
_EACH = "the chosen error: clusters are parted until each alone is wrong by no more than this part of a pixel's light"
_BOUND = (
    "the sum over the clusters of a pixel, each within its own error: by what part of its light the pixel would be "
    "wrong if every cluster were as wrong as it can be, all in the same direction; the middle of all pixels. What is "
    "wrong in fact, as Verify tells, is a small part of that."
)


class Cuts(Count):
    label = "Clusters of lights"
    key = "Shift+N"
    help = (
        "How many clusters of lights each pixel is shaded by, with the methods that cluster them (lightcuts); a block "
        "of 128 points shares them."
    )
    name = "clusters of lights"

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return CUT_NODES in frame.layers

    def found(self, frame: Frame) -> NDArray[np.int32]:
        if CUT_NODES not in frame.layers:
            raise ValueError("the method of the frame shades by all lights, not by clusters of them")
        return frame.layers[CUT_NODES]

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        nodes, cuts, settings = self.found(frame), frame.statistics.cuts, frame.settings
        seen = hits(frame) & (nodes >= 0)
        bound = float(np.median(frame.layers[CUT_BOUND][seen])) if seen.any() else 0.0
        of = lights_in_words(frame.lights, 0 if cuts is None else cuts.lights)
        facts = (
            fact("per pixel", f"{self.per_pixel(frame):.4g} for {of}"),
            fact("each may be wrong by", f"{percent(settings.lightcuts_error, 1.0)} of the light", _EACH),
            fact("all of them together", f"{percent(bound, 1.0)} at most", _BOUND),
        )
        notes: tuple[Note, ...] = ()
        if cuts is not None and cuts.blocks and cuts.mean > NEARLY_ALL * cuts.lights:
            few = too_few(Method.parse(settings.method), frame.lights, cuts.lights)
            one = "light" if cuts.lights == frame.lights else "sample of a light"
            notes = (Note(f"Nearly every {one} is a cluster of its own{f': {few}' if few else ''}.", NoteKind.WARNING),)
        scale = counts_scale(int(self.span(frame)[1]), draw.span)
        return Legend("Clusters of lights that each pixel is shaded by", (), self.unknown(frame), scale, facts, notes)

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Words:
        return f"{found}", f"± {100.0 * float(frame.layers[CUT_BOUND][y, x]):.3g} %"


VIEW = Cuts()

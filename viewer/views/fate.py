"""What became of the shadow ray from each pixel's first hit to one light."""

from __future__ import annotations

import numpy as np

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.method import Method
from tracer.scene.lights import named_light
from viewer.state import terms
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import FATE_COLORS, FATE_MEANING, FATE_NAMES, fate_palette
from viewer.state.views import Record
from viewer.util.numbers import count, percent
from viewer.views.base import FrameView, Highlight, Lights, Pixels, Values, Words, hits, once, single
from viewer.views.legend import Entry, Legend, Note
from viewer.views.paint import by_code

_PAPER = (Fate.PARTLY_OCCLUDED, Fate.PARTIAL_SHADOW, Fate.NOT_SEEN_WHOLE, Fate.DYNAMIC)
_ALWAYS = (Fate.FACES_AWAY, Fate.CULLED, Fate.DYNAMIC_ONLY)


class Fates(FrameView):
    label = "Fate of shadow rays"
    key = "Shift+X"
    also = "why traced culled dynamic reason"
    help = (
        "What became of the shadow ray from each pixel's first hit to the chosen light: culled, asked dynamic objects "
        "only, or traced, and why it was not culled."
    )
    records = Record.FATES
    of_light = is_flat = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return frame.fates is not None

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        return self.highlighted(frame, draw, Highlight())

    def highlighted(self, frame: Frame, draw: DrawOptions, highlight: Highlight) -> Pixels:
        fates = once(frame, ("fate", draw.light), lambda: frame.fate(draw.light))
        return by_code(frame, draw, fates, np.asarray(fate_palette(highlight.fate), np.float32))

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        """Say how many rays had each fate, and which part of those due that is."""
        hit, method = hits(frame), Method.parse(frame.settings.method)
        counts = np.bincount(frame.fate(draw.light)[hit], minlength=len(Fate)).tolist()
        pixels, seen = dict(zip(Fate, counts, strict=True)), int(hit.sum())
        due = sum(n for fate, n in pixels.items() if fate.is_due)
        saved, traced = (
            percent(sum(n for fate, n in pixels.items() if among(fate)), due)
            for among in (lambda fate: fate.is_saved, lambda fate: fate.is_traced)
        )
        usual = (*_ALWAYS, *(_PAPER if method.uses_modes else (Fate.TRACED,)))
        entries = tuple(
            Entry(
                FATE_NAMES[fate],
                FATE_COLORS[fate],
                (percent(n, seen), percent(n, due) if fate.is_due else ""),
                f"{FATE_MEANING[fate]}. {count(n)} pixels",
            )
            for fate, n in pixels.items()
            if n or fate in usual
        )
        facts = (
            Entry(terms.SAVED, None, ("", saved), terms.MEANINGS[terms.SAVED]),
            Entry(terms.TRACED, None, ("", traced), "through the whole scene, for whatever reason"),
        )
        title = f"{self.label}, first hits, {named_light(lights, draw.light)}"
        return Legend(title, ("pixels", "of due"), entries, facts=facts, notes=filled_in(frame))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(frame.fate(draw.light), "fate of the shadow ray", hits(frame), classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        fate = frame.fate(draw.light, (slice(y, y + 1), slice(x, x + 1)))[0, 0]
        return tuple(FATE_NAMES[Fate(int(fate))].split(": "))


def filled_in(frame: Frame) -> tuple[Note, ...]:
    """Return what is said of a picture of which only a part has been shaded."""
    return () if frame.shaded is None else (Note("Pixels that are not shaded yet go by the nearest that is."),)


VIEW = Fates()

"""What the legends of views of fates say: what became of the shadow rays to one light, and what moving objects do."""

from __future__ import annotations

import numpy as np

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.method import Method
from tracer.scene.lights import named_light
from viewer.output.legend_counts import fate_legend, moving_shadow_legend
from viewer.output.legend_parts import Chosen, Entry, Legend, Note
from viewer.state import terms
from viewer.state.views import (
    FATE_COLORS,
    FATE_MEANING,
    FATE_NAMES,
    MOVING_SHADOW_COLORS,
    MOVING_SHADOW_MEANING,
    MOVING_SHADOW_NAMES,
    MovingShadow,
    View,
)
from viewer.util.numbers import count, percent

_PAPER = (Fate.PARTLY_OCCLUDED, Fate.PARTIAL_SHADOW, Fate.NOT_SEEN_WHOLE, Fate.DYNAMIC)
_ALWAYS = (Fate.FACES_AWAY, Fate.CULLED, Fate.DYNAMIC_ONLY)


def of_fates(frame: Frame, view: View, chosen: Chosen) -> Legend:
    """How many rays had each fate, of those that are due."""
    found, method = fate_legend(frame, chosen.light), Method.parse(frame.settings.method)
    usual = (*_ALWAYS, *(_PAPER if method.uses_modes else (Fate.TRACED,)))
    entries = tuple(
        Entry(
            FATE_NAMES[fate],
            FATE_COLORS[fate],
            (percent(pixels, found.seen), percent(pixels, found.due) if fate.is_due else ""),
            f"{FATE_MEANING[fate]}. {count(pixels)} pixels",
        )
        for fate, pixels in found.pixels.items()
        if pixels or fate in usual
    )
    facts = (
        Entry(terms.SAVED, None, ("", percent(found.saved, found.due)), terms.MEANINGS[terms.SAVED]),
        Entry(
            terms.TRACED, None, ("", percent(found.traced, found.due)), "through the whole scene, for whatever reason"
        ),
    )
    title = f"{view.label}, first hits, {chosen.light_in_words}"
    return Legend(title, ("pixels", "of due"), entries, facts=facts, notes=_filled_in(frame))


def of_moving_shadows(frame: Frame, view: View, chosen: Chosen) -> Legend:
    """How many pixels moving objects darken, and how many ask about these alone."""
    pixels = moving_shadow_legend(frame, chosen.light)
    seen, asked = sum(pixels.values()), pixels[MovingShadow.LIT] + pixels[MovingShadow.DARK]
    entries = tuple(
        Entry(
            MOVING_SHADOW_NAMES[one],
            MOVING_SHADOW_COLORS[one],
            (percent(pixels[one], seen),),
            f"{MOVING_SHADOW_MEANING[one]}. {count(pixels[one])} pixels",
        )
        for one in (MovingShadow.DARK, MovingShadow.TRACED, MovingShadow.LIT, MovingShadow.OBJECT)
    )
    share = percent(pixels[MovingShadow.DARK], asked)
    facts = (Entry(f"of {terms.DYNAMIC_ONLY}, darkened", None, (share,), MOVING_SHADOW_MEANING[MovingShadow.DARK]),)
    dark = pixels[MovingShadow.DARK] + pixels[MovingShadow.TRACED]
    notes = (*(() if dark else (_no_moving_shadow(frame, chosen),)), *_filled_in(frame))
    return Legend(f"{view.label}, {chosen.light_in_words}", ("pixels",), entries, facts=facts, notes=notes)


def _no_moving_shadow(frame: Frame, chosen: Chosen) -> Note:
    """That the picture shows none of the chosen light, and of which light it shows most, if of any."""
    if frame.statistics.resting:
        return Note(f"What could move is at rest, and counts as static with {frame.settings.method}.")
    pixels = [int(np.count_nonzero(frame.moving_shadow(light))) for light in range(frame.lights)]
    most = max(range(frame.lights), key=pixels.__getitem__)
    others = f"; {named_light(chosen.lights, most)} has some" if pixels[most] else ", nor of another light"
    return Note(f"No moving object casts a shadow of this light now{others}.")


def _filled_in(frame: Frame) -> tuple[Note, ...]:
    """What is said of a picture of which only a part has been shaded."""
    return () if frame.shaded is None else (Note("Pixels that are not shaded yet go by the nearest that is."),)

"""Where a moving object darkens what nothing static hides from one light (§2.4 of the paper)."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.frame import Frame
from tracer.method import title_of
from tracer.scene.lights import named_light
from viewer.state import terms
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import OCCLUSION, Class, hex_color
from viewer.state.views import Record
from viewer.util.numbers import percent
from viewer.views.base import Lights, Pixels
from viewer.views.kinds import ClassView, filled_in
from viewer.views.legend import Legend, Note, fact
from viewer.views.paint import LUMINANCE, by_color, shaded

PALE = 0.5
"""How far the greys of the picture are paled towards white beneath shadows of moving objects."""


class MovingShadow(IntEnum):
    """What moving objects have to do with a pixel and a light."""

    NONE = 0
    DARK = 1
    TRACED = 2
    LIT = 3
    OBJECT = 4


class MovingShadows(ClassView):
    label = "Moving shadows"
    key = "Shift+O"
    also = "dynamic only NON_SHADOW darkened objects"
    help = (
        "Where a moving object darkens what nothing static has ever hidden from the chosen light (NON_SHADOW): such "
        "rays are tested against dynamic objects only, so that no stale shadow stays behind."
    )
    records = Record.FATES
    of_light = True
    shows = "fates"
    what = "shadow of a moving object"
    classes = (
        Class("neither", (1.0, 1.0, 1.0), "no moving object has to do with it"),
        Class(
            "dynamic only, darkened", hex_color("4A2FB5"),
            "its ray was tested against dynamic objects only, and one of them is in the way: the shadow mode "
            "NON_SHADOW stays, and the shadow goes with the object",
        ),
        Class(
            "darkened, but not dynamic only", hex_color("8E97F5"),
            "a moving object is in the way, and nothing static is; its ray was traced, or answered in another way",
        ),
        Class(
            "dynamic only, lit", hex_color("F8F2A0"),
            "its ray was tested against dynamic objects only, and none of them is in the way",
        ),
        Class("moving object", OCCLUSION[OcclusionMode.DYNAMIC].color, "it moves itself: dynamic, never culled"),
    )  # fmt: skip
    """Over the paled picture: blues for shadows, pale NON_SHADOW, and DYNAMIC."""

    def find(self, frame: Frame, light: int) -> NDArray[np.uint8]:
        dynamic_only, dark = frame.fate(light) == Fate.DYNAMIC_ONLY, frame.moving_shadow(light)
        found = np.where(dynamic_only, MovingShadow.LIT, MovingShadow.NONE).astype(np.uint8)
        moves = (occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC)[frame.unit] & (frame.primitive >= 0)
        found[moves] = MovingShadow.OBJECT
        found[dark] = np.where(dynamic_only[dark], MovingShadow.DARK, MovingShadow.TRACED)
        return found

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        found = self.found(frame, draw)
        stands_out = found != MovingShadow.NONE
        paled = PALE + (1.0 - PALE) * (np.clip(frame.color, 0.0, 1.0) @ LUMINANCE)
        colors = np.repeat(paled[..., None], 3, axis=-1)
        colors[stands_out] = shaded(frame, self.palette[found[stands_out]], draw.shading, stands_out)
        return by_color(frame, draw, colors)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        pixels = self.counted(frame, draw)
        dark, traced, lit = (pixels[one] for one in (MovingShadow.DARK, MovingShadow.TRACED, MovingShadow.LIT))
        share, meaning = percent(dark, lit + dark), self.classes[MovingShadow.DARK].meaning
        facts = (fact(f"of {terms.DYNAMIC_ONLY}, darkened", share, meaning),)
        notes = (*(() if dark + traced else (_no_moving_shadow(frame, lights),)), *filled_in(frame))
        entries = self.entries(pixels, listed=list(MovingShadow)[1:])
        return Legend(self.title(draw, lights), ("pixels",), entries, facts=facts, notes=notes)


def _no_moving_shadow(frame: Frame, lights: Lights) -> Note:
    """Say that the picture shows none of the chosen light, and of which light it shows most, if of any."""
    if frame.statistics.resting:
        return Note(f"What could move is at rest, and counts as static with {title_of(frame.settings.method)}.")
    pixels = [int(np.count_nonzero(frame.moving_shadow(other))) for other in range(frame.lights)]
    most = max(range(frame.lights), key=pixels.__getitem__)
    others = f"; {named_light(lights, most)} has some" if pixels[most] else ", nor of another light"
    return Note(f"No moving object casts a shadow of this light now{others}.")


VIEW = MovingShadows()

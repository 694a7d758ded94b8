"""Where a moving object darkens what nothing static hides from one light (§2.4 of the paper)."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.frame import EVERYWHERE, Frame, Region
from tracer.scene.lights import named_light
from viewer.state import terms
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import OCCLUSION_COLORS, Color, hex_color
from viewer.state.views import Record
from viewer.util.numbers import count, percent
from viewer.views.base import FrameView, Lights, Pixels, Values, Words, hits, single
from viewer.views.fate import filled_in
from viewer.views.legend import Entry, Legend, Note, fact
from viewer.views.paint import LUMINANCE, by_color, shaded

PALE = 0.5
"""How far the greys of the picture are paled towards white beneath shadows of moving objects."""


class MovingShadow(IntEnum):
    """What moving objects have to do with a pixel and a light."""

    NONE = 0
    LIT = 1
    DARK = 2
    TRACED = 3
    OBJECT = 4


MOVING_SHADOWS: dict[MovingShadow, tuple[str, Color, str]] = {
    MovingShadow.NONE: ("neither", (1.0, 1.0, 1.0), "no moving object has to do with it"),
    MovingShadow.LIT: (
        "dynamic only, lit", hex_color("F8F2A0"), "its ray asked dynamic objects only, and none of them is in the way",
    ),
    MovingShadow.DARK: (
        "dynamic only, darkened", hex_color("4A2FB5"),
        "its ray asked dynamic objects only, and one of them is in the way: the shadow mode NON_SHADOW stays, and the "
        "shadow goes with the object",
    ),
    MovingShadow.TRACED: (
        "darkened, but not dynamic only", hex_color("8E97F5"),
        "a moving object is in the way, and nothing static is; its ray was traced, or answered in another way",
    ),
    MovingShadow.OBJECT: (
        "moving object", OCCLUSION_COLORS[OcclusionMode.DYNAMIC], "it moves itself: dynamic, never culled",
    ),
}  # fmt: skip
"""Names, colours and meanings, over the paled picture: blues for shadows, pale NON_SHADOW, and DYNAMIC."""

_PALETTE = np.asarray([color for _, color, _ in MOVING_SHADOWS.values()], np.float32)


class MovingShadows(FrameView):
    label = "Moving shadows"
    key = "Shift+O"
    also = "dynamic only NON_SHADOW darkened objects"
    help = (
        "Where a moving object darkens what nothing static has ever hidden from the chosen light (NON_SHADOW): its "
        "rays ask dynamic objects only, so that no stale shadow stays behind."
    )
    records = Record.FATES
    of_light = is_flat = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return frame.fates is not None

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        found = moving_shadows(frame, draw.light)
        stands_out = found != MovingShadow.NONE
        paled = PALE + (1.0 - PALE) * (np.clip(frame.color, 0.0, 1.0) @ LUMINANCE)
        colors = np.repeat(paled[..., None], 3, axis=-1)
        colors[stands_out] = shaded(frame, _PALETTE[found[stands_out]], draw.shading, stands_out)
        return by_color(frame, draw, colors)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        counts = np.bincount(moving_shadows(frame, draw.light)[hits(frame)], minlength=len(MovingShadow)).tolist()
        pixels, seen = dict(zip(MovingShadow, counts, strict=True)), sum(counts)
        entries = tuple(
            Entry(name, color, (percent(pixels[one], seen),), f"{meaning}. {count(pixels[one])} pixels")
            for one in (MovingShadow.DARK, MovingShadow.TRACED, MovingShadow.LIT, MovingShadow.OBJECT)
            for name, color, meaning in (MOVING_SHADOWS[one],)
        )
        share = percent(pixels[MovingShadow.DARK], pixels[MovingShadow.LIT] + pixels[MovingShadow.DARK])
        facts = (fact(f"of {terms.DYNAMIC_ONLY}, darkened", share, MOVING_SHADOWS[MovingShadow.DARK][2]),)
        dark = pixels[MovingShadow.DARK] + pixels[MovingShadow.TRACED]
        notes = (*(() if dark else (_no_moving_shadow(frame, draw.light, lights),)), *filled_in(frame))
        title = f"{self.label}, {named_light(lights, draw.light)}"
        return Legend(title, ("pixels",), entries, facts=facts, notes=notes)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(moving_shadows(frame, draw.light), "shadow of a moving object", hits(frame), classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        found = moving_shadows(frame, draw.light, (slice(y, y + 1), slice(x, x + 1)))[0, 0]
        return tuple(MOVING_SHADOWS[MovingShadow(int(found))][0].split(", "))


def moving_shadows(frame: Frame, light: int, where: Region = EVERYWHERE) -> NDArray[np.uint8]:
    """Return the MovingShadow of a light at each pixel (h, w), or at some.  Raises ValueError for a frame without a
    record of fates."""
    dynamic_only, dark = frame.fate(light, where) == Fate.DYNAMIC_ONLY, frame.moving_shadow(light, where)
    found = np.where(dynamic_only, MovingShadow.LIT, MovingShadow.NONE).astype(np.uint8)
    hit = frame.primitive[where] >= 0
    seen = occlusion_mode(frame.modes[frame.unit[where][hit]])
    found[hit] = np.where(seen == OcclusionMode.DYNAMIC, np.uint8(MovingShadow.OBJECT), found[hit])
    found[dark] = np.where(dynamic_only[dark], MovingShadow.DARK, MovingShadow.TRACED)
    return found


def _no_moving_shadow(frame: Frame, light: int, lights: Lights) -> Note:
    """Say that the picture shows none of the chosen light, and of which light it shows most, if of any."""
    if frame.statistics.resting:
        return Note(f"What could move is at rest, and counts as static with {frame.settings.method}.")
    pixels = [int(np.count_nonzero(frame.moving_shadow(other))) for other in range(frame.lights)]
    most = max(range(frame.lights), key=pixels.__getitem__)
    others = f"; {named_light(lights, most)} has some" if pixels[most] else ", nor of another light"
    return Note(f"No moving object casts a shadow of this light now{others}.")


VIEW = MovingShadows()

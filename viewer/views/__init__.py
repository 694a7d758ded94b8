"""What can be seen of a frame: a view is one file here, which has the name of the view.

The functions below are all that others need: they look the view up by its name."""

from __future__ import annotations

from typing import cast

from tracer.culling.fate import Fate
from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.views import View, can_draw
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values
from viewer.views.legend import Legend, lights_in_words

USUAL = DrawOptions()


def view_of(view: View) -> DrawnView:
    """Return the view of this name."""
    return cast(DrawnView, view.declared)


def colorize(frame: Frame, draw: DrawOptions = USUAL, fate: Fate | None = None) -> Pixels:
    """Draw a frame, (h, w, 3) uint8, row 0 at the top; a `fate` stands out in the view of fates.

    Raises ValueError where there is no such light, or where the frame has not recorded what the view shows."""
    if draw.view.of_light and not 0 <= draw.light < frame.lights:
        raise ValueError(f"no light {draw.light}: {lights_in_words(frame.lights)}")
    return _drawable(frame, draw).highlighted(frame, draw, fate)


def legend_of(frame: Frame, draw: DrawOptions, lights: Lights = ()) -> Legend | None:
    """Return the legend of a frame; None for colours that speak for themselves, and where the view cannot be drawn."""
    return view_of(draw.view).legend(frame, draw, lights) if can_draw(frame, draw.view, draw.light) else None


def values_of(frame: Frame, draw: DrawOptions) -> Values:
    """Return the exact values of a frame.  Raises ValueError where the view cannot be drawn of it."""
    return _drawable(frame, draw).values(frame, draw)


def words_at(frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
    """Return the exact value of a pixel, in a few short lines; none where the view cannot be drawn of this frame."""
    view = view_of(draw.view)
    if not view.can_draw(frame, draw.light):
        return ()
    if not view.everywhere and frame.primitive[y, x] < 0:
        return ("miss",)
    return view.words(frame, draw, x, y)


def _drawable(frame: Frame, draw: DrawOptions) -> DrawnView:
    view = view_of(draw.view)
    if not view.can_draw(frame, draw.light):
        raise ValueError(f"the frame has nothing for the view {view.label}: it has not recorded that")
    return view

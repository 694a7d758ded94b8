"""What becomes of shadow rays is seen in the picture, also while a train goes by."""

from __future__ import annotations

import numpy as np

from tests.viewer.drawn import classes_in, picture
from tests.viewer.driver import Driver
from tracer.culling.fate import Fate
from tracer.frame import Frame
from viewer.state.palette import OCCLUSION_COLORS
from viewer.state.views import View
from viewer.util.resources import embedded_scenes
from viewer.window.keyboard import chord

SOME = 12  # pictures in motion that are looked at


def fates(d: Driver) -> None:
    """The keys of the views of fates; another light asks for no frame; colours and legends agree in motion."""
    d.settle()
    d.c.loader.open(embedded_scenes()["default"])
    d.fix_resolution(320, 180)
    d.c.settings.change(method="paper", samples=1)
    d.settle()
    d.press(chord(View.FATE.key))
    d.settle()
    frame, traced = d.c.frame, d.c.history.frames
    assert d.c.scheduler.drawn_view is View.FATE and frame.fates is not None
    drawn = []
    for light in range(3):
        _shows_what_is_drawn(d, View.FATE, light)
        drawn.append(d.shown())
        d.press(chord("L"))
    assert d.c.history.frames == traced and (drawn[0] != drawn[1]).any()
    found = frame.fate(0)[frame.primitive >= 0]
    assert (found == Fate.CULLED).any() and (found >= Fate.CULLED).sum() == sum(
        np.isin(found, [fate for fate in Fate if among(fate)]).sum()
        for among in (lambda fate: fate.is_saved, lambda fate: fate.is_traced)
    )

    # Views of fates, and of modes, while everything moves.
    d.press(chord("Space"))
    d.wait(lambda: d.c.frame.shaded is not None, "a picture of which a part is shaded")
    for view in (View.FATE, View.MOVING_SHADOW, View.OCCLUSION):
        d.press(chord(view.key))
        d.wait(lambda view=view: d.c.scheduler.drawn_view is view, f"the view {view.label}")
        seen: list[Frame] = []
        while len(seen) < SOME:
            frame = d.c.frame
            seen += [frame] if not seen or frame is not seen[-1] else []
            assert d.c.scheduler.drawn_view is view, "no other view flashes up"
            if view is View.OCCLUSION:
                _legend_counts_what_is_drawn(frame)
            d.frames(1)
    d.press(chord("Space"))
    d.settle()
    d.press(chord(View.MOVING_SHADOW.key))
    d.settle()
    _shows_what_is_drawn(d, View.MOVING_SHADOW, d.c.session.draw.light)


def _shows_what_is_drawn(d: Driver, view: View, light: int) -> None:
    expected = picture(d.c.frame, view, light, shading=d.c.session.draw.shading).astype(int)
    assert d.c.session.draw.light == light and np.abs(d.shown() - expected).max() <= 2


def _legend_counts_what_is_drawn(frame: Frame) -> None:
    """The legend's shares are those of the colours in the picture."""
    drawn = picture(frame, View.OCCLUSION, shading=0.0).reshape(-1, 3)
    colors = np.round(255.0 * np.array(list(OCCLUSION_COLORS.values())))
    for row, color in zip(classes_in(frame, View.OCCLUSION), colors, strict=True):
        assert row.pixels == (drawn == color).all(axis=1).sum(), row.name

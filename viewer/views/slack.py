"""How far one light may move before the certificate of each pixel's cell fails."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.inspect.proofs_at_pixels import slack_at_pixels
from tracer.renderer import Renderer
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import GREY
from viewer.util.numbers import percent
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, hits, once, single
from viewer.views.kinds import has_cells_of_triangles
from viewer.views.legend import Entry, Legend, Note, Scale, fact
from viewer.views.paint import by_number, in_range

_BOUND = "Certificates stay true until the light has moved this far, and perhaps further."


class Slack(DrawnView):
    label = "Slack"
    key = "Shift+U"
    help = (
        "How far the chosen light may move before the certificate of each cell fails, in units of the scene, by the "
        "method certified. Lines are the borders of cells."
    )
    of_light = True
    has_range = True
    asks_renderer = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return _layer(light) in frame.layers

    def can_ask(self, frame: Frame) -> bool:
        return has_cells_of_triangles(frame)

    def ask(
        self, renderer: Renderer, frame: Frame, light: int, cancelled: Callable[[], bool] | None
    ) -> dict[str, NDArray]:
        return {_layer(light): slack_at_pixels(renderer, frame, light, cancelled)}

    def span(self, frame: Frame) -> tuple[float, float]:
        """Return 0 and the 95th percentile of all that has been asked about."""
        return once(frame, ("slack", *sorted(frame.layers)), lambda: _range(frame))

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        slack = frame.layers[_layer(draw.light)]
        return by_number(frame, draw, in_range(slack, draw.span or self.span(frame)), slack >= 0.0, frame.cell)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        slack, seen = frame.layers[_layer(draw.light)], hits(frame)
        known = slack[seen & (slack >= 0.0)]
        low, high = draw.span or self.span(frame)
        figures = f"{np.median(known):.3g}, at least {known.min():.3g}" if len(known) else "-"
        facts = (
            fact("certified pixels", percent(len(known), int(np.count_nonzero(seen))), "of those that hit something"),
            fact("median slack", figures, _BOUND),
        )
        scale = Scale(f"{low:.3g}", f"{high:.3g} and more", f"{0.5 * (low + high):.3g}")
        unknown = Entry("no certificate, or candidates", GREY)
        return Legend(
            f"{self.title(draw, lights)}, in units of the scene", (), (unknown,), scale, facts, (Note(_BOUND),)
        )

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        slack = frame.layers[_layer(draw.light)]
        return single(slack, "slack", hits(frame) & (slack >= 0.0))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        slack = float(frame.layers[_layer(draw.light)][y, x])
        return (f"{slack:.3g}",) if slack >= 0.0 else ("none",)


def _layer(light: int) -> str:
    return f"slack {light}"


def _range(frame: Frame) -> tuple[float, float]:
    every = np.concatenate(
        [np.zeros(1), *(slack[slack >= 0.0] for name, slack in frame.layers.items() if "slack" in name)]
    )
    return 0.0, max(float(np.percentile(every, 95.0)), 1e-6)


VIEW = Slack()

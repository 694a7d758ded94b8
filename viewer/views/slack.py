"""How far one light may move before the certificate of each pixel's cell fails."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.inspect.proofs_at_pixels import slack_at_pixels
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import GREY
from viewer.util.numbers import percent
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, hits, once, single
from viewer.views.legend import Entry, Legend, Note, Scale, fact
from viewer.views.paint import by_number, in_range


class Slack(DrawnView):
    label = "Slack"
    key = "Shift+U"
    help = (
        "How far the chosen light may move before the certificate of each cell fails, in units of the scene, by the "
        "method certified. Lines are the borders of cells."
    )
    of_light = has_range = True
    asks = staticmethod(
        lambda renderer, frame, light, *told: {_layer(light): slack_at_pixels(renderer, frame, light, told[0])}
    )

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return _layer(light) in frame.layers

    def span(self, frame: Frame) -> tuple[float, float]:
        """Return 0 and the 95th percentile, of all lights that have been asked about."""
        slack = [found[found >= 0.0] for name, found in frame.layers.items() if name.startswith(_layer(""))]
        of_all = lambda: max(float(np.percentile(np.concatenate([[0.0], *slack]), 95.0)), 1e-6)  # noqa: E731
        return 0.0, once(frame, (self.label, len(slack)), of_all)

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        slack = _slack(frame, draw)
        return by_number(frame, draw, in_range(slack, draw.span or self.span(frame)), slack >= 0.0, frame.cell)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        seen, (low, high) = hits(frame), draw.span or self.span(frame)
        known = _slack(frame, draw)[seen]
        known = known[known >= 0.0]
        median = f"{np.median(known):.3g}, at least {known.min():.3g}" if len(known) else "-"
        of_seen = percent(len(known), int(np.count_nonzero(seen)))
        facts = fact("certified pixels", of_seen, "of those that hit something"), fact("median slack", median)
        scale = Scale(f"{low:.3g}", f"{high:.3g} and more", f"{0.5 * (low + high):.3g}")
        unknown, title = Entry("no certificate, or candidates", GREY), f"{self.title(draw, lights)}, in scene units"
        note = Note("Certificates stay true until the light has moved this far, and perhaps further.")
        return Legend(title, (), (unknown,), scale, facts, (note,))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        return single(_slack(frame, draw), "slack", hits(frame) & (_slack(frame, draw) >= 0.0))

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        slack = _slack(frame, draw)[y, x]
        return (f"{slack:.3g}" if slack >= 0.0 else "none",)


def _layer(light: int | str) -> str:
    return f"slack {light}"


def _slack(frame: Frame, draw: DrawOptions) -> NDArray[np.float32]:
    return frame.layers[_layer(draw.light)]


VIEW = Slack()

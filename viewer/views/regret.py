"""Shadow rays that were traced although certificates could have known the answer."""

from __future__ import annotations

from collections.abc import Callable

from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.inspect.proofs_at_pixels import regret_at_pixels
from tracer.renderer import Renderer
from viewer.state.frame_rows import regret_of
from viewer.state.views import REGRET, Record
from viewer.util.numbers import count, percent
from viewer.views.base import Lines
from viewer.views.kinds import CountView, has_cells_of_triangles
from viewer.views.legend import Entry, fact


class Regret(CountView):
    label = "Regret"
    key = "Shift+R"
    help = (
        "How many shadow rays of each pixel's primary hit the method certified has traced although the smallest cell "
        "there could be proved to be lit, or dark: what a better method could still save."
    )
    records = Record.FATES
    asks_renderer = True
    shows = REGRET
    what = "rays traced that could be proved"
    heading = "Rays traced that could be proved"
    each = "shadow rays of primary hits, of the first sample of each pixel"

    def can_ask(self, frame: Frame) -> bool:
        return has_cells_of_triangles(frame) and frame.fates is not None

    def ask(
        self, renderer: Renderer, frame: Frame, light: int, cancelled: Callable[[], bool] | None
    ) -> dict[str, NDArray]:
        return {REGRET: regret_at_pixels(renderer, frame, cancelled)}

    def facts(self, frame: Frame) -> tuple[Entry, ...]:
        found = regret_of(frame)
        assert found is not None, "it can be drawn"
        of_due = "of all shadow rays of primary hits that are due, which free saves"
        return (
            fact("in all", f"{count(found.rays)} ({percent(found.rays, found.traced)} of those traced)"),
            fact("of what free saves", percent(found.rays, found.due), of_due),
            fact("saved so far", percent(found.due - found.traced, found.due), of_due),
        )

    def known_words(self, frame: Frame, found: int, x: int, y: int) -> Lines:
        return f"{found} of {frame.lights}", "lights"


VIEW = Regret()

"""The columns of the panel that compares two pictures: made once, and anew when anything in them is another."""

from __future__ import annotations

from typing import Any

from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from tracer.statistics import FrameStatistics
from viewer.state.in_turn import LEAST, InTurn
from viewer.window.panels.compare import figures
from viewer.window.ui import Ui


class _Window:
    """What the panel keeps its columns in."""

    def __init__(self) -> None:
        self._cache: dict[str, Any] = {}

    cached = Ui.cached


def _timed(seconds: float) -> InTurn:
    return InTurn(("none", "paper"), ((FrameStatistics(seconds=seconds), FrameStatistics(seconds=1.0)),) * LEAST)


def test_new_medians_are_shown_wherever_in_memory_they_lie():
    """What is measured is another object each round, often in the place of one that has gone."""
    ui: Any = _Window()
    a, b = (make_frame(Settings(8, 8, method=method)) for method in ("none", "paper"))
    for k in range(50):
        shown = next(row for row in figures(ui, a, b, _timed(k + 1.0)) if row.name == "Frame")
        assert shown.a == 1e3 * (k + 1.0)
    timed = _timed(1.0)
    assert figures(ui, a, b, timed) is figures(ui, a, b, timed)

"""How a command that works is stopped."""

from __future__ import annotations

import pytest

from tracer.scene.model import Cancelled
from viewer.cli.console import Work


def test_ctrl_c_stops_at_a_report_of_progress_but_counted_steps_are_kept() -> None:
    work = Work()
    work.stopped = True
    work.count("frame 2 of 3", 1, 3)
    with pytest.raises(Cancelled):
        work.progress("reading", 0.5)

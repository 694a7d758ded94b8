"""The window is closed in the middle of something."""

from __future__ import annotations

import time

from tests.viewer.driver import Driver
from viewer.services.frame_scheduler import Activity


def closing_while_tracing(d: Driver) -> None:
    """The window goes at once, whatever is being traced."""
    d.c.settings.change(samples=4000)
    d.wait(lambda: d.c.scheduler.activity is Activity.ADDING_SAMPLES, "a long trace")
    _close(d)


def closing_while_loading(d: Driver) -> None:
    """The window goes at once, whatever is being loaded."""
    d.drop(d.folder / "big.aff")
    assert d.c.loader.load_job is not None
    _close(d)


def closing_while_experimenting(d: Driver) -> None:
    """The window goes at once, whatever is being measured."""
    d.c.runs.experiment_plan.size = (2048, 2048)
    d.c.runs.start_experiment()
    d.wait(lambda: d.c.runs.experiment.traced > 0, "a first frame")
    _close(d)


def _close(d: Driver) -> None:
    began = time.monotonic()
    closed = d.c.close

    def timed(*args: float) -> bool:
        done = closed(*args)
        assert done, "a thread would not stop"
        assert time.monotonic() - began < 10.0, "closing took too long"
        return done

    d.c.close = timed
    d.app._exit()

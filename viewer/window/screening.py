"""A recorded picture of a zoom test in the place of the traced one."""

from __future__ import annotations

from dataclasses import dataclass

from tracer.experiments.zoom import Approach, Step
from viewer.output.filmstrip import Shot
from viewer.services.runs import RecordedZoomTest


@dataclass(frozen=True)
class Screening:
    """A recorded picture that is shown where the traced one is, until something changes that."""

    test: RecordedZoomTest
    shot: Shot
    beside: object

    def step(self) -> Step | None:
        """The step that it is of; None of a test whose results are not there."""
        return next((s for a in approaches_of(self.test) if a.factor == self.shot.factor for s in a.steps
                     if s.number == self.shot.number), None)  # fmt: skip


def approaches_of(test: RecordedZoomTest) -> list[Approach]:
    return test.results.approaches if test.results is not None else []

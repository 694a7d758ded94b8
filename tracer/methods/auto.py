"""The method `auto`: certified cells where these are measured to be quicker than tracing every shadow ray.

Both give the same pictures, bit for bit, so that every frame may be traced in either way.  `AdaptivePolicy` decides, by
what certificates are seen to cost and to save, and now and then a tile is shaded both ways to find out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracer.culling.counters import SHADOW
from tracer.culling.verdicts import Answered, CullReason
from tracer.methods.adaptive_policy import AdaptivePolicy, Plan, Trial
from tracer.methods.certified import CertifiedCells, CertifiedLights
from tracer.methods.interface import FrameView, Services, ShadowMethod, Stage
from tracer.statistics import FrameStatistics, shadow_counts

GOLDEN = 0.618033988749895  # steps of it visit all tiles evenly


class Auto(ShadowMethod):
    """Certifies and culls by certificates as long as that pays."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        certified = services.method("certified")
        assert isinstance(certified, CertifiedCells | CertifiedLights)
        self._certified, self.parts = certified, (certified,)
        self.forget()

    def forget(self) -> None:
        self._kind: tuple[float | None, int | None] | None = None  # of lamps: their radius and samples
        self._start()

    def _start(self) -> None:
        """Nothing has been measured yet."""
        self.policy = AdaptivePolicy(self._certified.price, self._certified.pays_as_a_rule)
        self._plan = Plan()
        self._next_trial = 0  # of the tiles that are shaded both ways
        self._tried: frozenset[int] = frozenset()
        self._trials: list[Trial] = []

    def begin(self, frame: FrameView) -> None:
        settings = frame.settings
        kind = settings.lamp_radius, settings.lamp_samples
        if self._kind not in (None, kind):  # rays of other lamps cost, and save, something else
            self._start()
            if self._certified.store is not None:
                self.policy.made_ready()
        self._kind = kind
        patience = settings.certificate_seconds if settings.patient else 0.0
        plan = self.policy.plan(len(frame.tiles), patience)
        counts_all = settings.verify or settings.record_work  # then no tile may be shaded twice
        seconds = min(plan.seconds, settings.certificate_seconds)
        self._plan = replace(plan, seconds=seconds, trials=0 if counts_all else plan.trials)
        self._trials, self._tried = [], frozenset()
        if self._plan.needs_certificates:
            self._certified.begin(frame)

    def follows_rest(self) -> bool:
        return True  # in every frame, as modes that are kept beside would come and go with the plan

    @contextmanager
    def _paid(self) -> Iterator[None]:
        """Time what is spent on certificates."""
        start = self.services.clock()
        yield
        self.policy.spend(self.services.clock() - start)

    def update(self, frame: FrameView) -> None:
        if self._plan.needs_certificates:
            with self._paid():
                self._certified.update(frame)
                if self._certified.made_now:
                    self.policy.made_ready()

    def prepare(self, frame: FrameView) -> None:
        if self._plan.needs_certificates:
            self._certified.take_requests(frame, self._plan.seconds)
        if self._plan.seconds > 0.0:
            with self._paid():
                self._certified.certify(frame, self._plan.seconds)

    @property
    def finds_first(self) -> bool:
        return self._plan.looks_up

    def begin_shading(self, frame: FrameView, tiles: int, first_pass: bool) -> None:
        self._tried = frozenset()
        if not first_pass:
            return
        first = self._next_trial
        self._next_trial += self._plan.trials
        self._tried = frozenset(int((first + k) * GOLDEN % 1.0 * tiles) for k in range(self._plan.trials))

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        return self._certified.stages(frame, worker, learns) if self._plan.needs_certificates else []

    @property
    def takes_part(self) -> bool:
        return self._plan.looks_up

    def shade(self, shade: Callable[[bool, NDArray[np.int64]], None], tile: int, counts: NDArray[np.int64]) -> None:
        """Shade a tile with certificates or without; both ways where it is to be tried, one after the other.

        The picture is the same.  Of what is counted only that of the way that the whole frame goes is kept."""
        if tile not in self._tried:
            shade(self._plan.looks_up, counts)
            return
        seconds, counted, clock = {}, {}, self.services.thread_clock
        for looks_up in (False, True) if tile % 2 == 0 else (True, False):
            counted[looks_up] = np.zeros_like(counts)
            start = clock()
            shade(looks_up, counted[looks_up])
            seconds[looks_up] = clock() - start
        counts += counted[self._plan.looks_up]
        rays = shadow_counts(counted[True][SHADOW:])
        known = rays.culled + rays.dynamic_only + rays.candidates_only + rays.passed_over
        self._trials.append(Trial(seconds[False], seconds[True], rays.due + rays.passed_over, known))

    def keep(self, frame: FrameView) -> None:
        if self._plan.needs_certificates:
            self._certified.keep(frame)

    def discard(self, frame: FrameView, begun: bool) -> None:
        if self._plan.needs_certificates:
            self._certified.discard(frame, begun)
        if begun:
            self._settle(frame)
        else:
            self.policy.abandon(free=frame.settings.patient)

    def layers(self, frame: FrameView) -> dict[str, NDArray]:
        return self._certified.layers(frame) if self._plan.looks_up else {}

    def report(self, statistics: FrameStatistics) -> None:
        statistics.decision = self.policy.reason
        if self._plan.needs_certificates:
            self._certified.report(statistics)

    def finish(self, frame: FrameView, statistics: FrameStatistics) -> None:
        if self._plan.needs_certificates:
            self._certified.finish(frame, statistics)
        self._settle(frame)

    def _settle(self, frame: FrameView) -> None:
        """Tell the policy what the frame has cost."""
        looks_up, free = self._plan.looks_up, frame.settings.patient
        twice = sum(trial.plain if looks_up else trial.certified for trial in self._trials) / frame.workers
        self.policy.spend(twice, trying=True)
        shading = max(0.0, frame.phases.get("shading", 0.0) - twice)
        self.policy.finish(frame.seconds, shading, self._trials, free=free)
        self._trials = []

    def explain(self, primitive: int, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]]:
        return self._certified.explain(primitive, point, light) if self._plan.needs_certificates else ("none", ())

    def more(self, primitive: int, point: NDArray[np.float32], light: int) -> str:
        return self._certified.more(primitive, point, light) if self._plan.needs_certificates else ""

    def because(self, answered: Answered) -> CullReason:
        return self._certified.because(answered)

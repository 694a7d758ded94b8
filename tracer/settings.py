"""How to render: what is asked of a renderer, checked, before anything that renders is loaded."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tracer.geometry.accelerators import ACCELERATORS
from tracer.method import Method

MAX_SIDE = 16384


@dataclass(frozen=True)
class Settings:
    """How to render.

    Attributes:
        width, height: of the picture, in pixels.
        depth: bounces of a ray, at most.
        method: what culls shadow rays, by name (`tracer.method`).
        symmetric: test both pixels of a pair for occlusion, not one as published (§2.3); for methods that use modes.
        zoom_factor: a primitive that covers more than so many times its pixel count is examined anew (§2.6).
        modes: keep the paper's modes beside a method that does not cull by them: those that "paper+rest" would have,
            whichever method it is.  Objects that rest then count as static for any method (`tracer.culling.rest`).
        verify: trace every culled answer too, count the wrong ones, and fill Frame.reference and Frame.wrong.
        samples: rays of a pixel, which are averaged; modes and statistics are those of the first, through its centre.
        threads: at work at once; 0 for one on each core.
        accelerator: "bvh8", the fast structure, which counts the steps and tests of whole packets of rays, or
            "kdtree", the paper's, which counts them ray by ray.
        record_lights: fill Frame.due and Frame.lit.
        record_work: fill Frame.saved, Frame.cost and Frame.due_rays.
        certificates: made in a frame at most, where the method makes any.
        certificate_seconds: spent on certificates in a frame at most, a quarter of them at least on making them.  How
            many are made is left to chance then; inf lets counters repeat exactly.
        patient: nobody waits for the frame, so that "auto" may spend all of that, and not just what it is worth.
        certificate_memory: megabytes that certificates take at most.
    """

    width: int = 512
    height: int = 512
    depth: int = 10
    method: str = "paper"
    symmetric: bool = False
    zoom_factor: float = 4.0
    modes: bool = False
    verify: bool = False
    samples: int = 1
    threads: int = 0
    accelerator: str = "bvh8"
    record_lights: bool = False
    record_work: bool = False
    certificates: int = 100_000
    certificate_seconds: float = math.inf
    patient: bool = False
    certificate_memory: float = 256.0

    @property
    def keeps_modes(self) -> bool:
        """Whether frames learn modes: those of methods that cull by them always do."""
        return self.modes or Method.parse(self.method).uses_modes

    def validated(self) -> Settings:
        """Itself; raises ValueError, in one line, where a value is out of range."""
        Method.parse(self.method)
        checks = (
            (1 <= self.width <= MAX_SIDE and 1 <= self.height <= MAX_SIDE, f"width and height lie in 1 to {MAX_SIDE}"),
            (0 <= self.depth <= 100, "depth lies in 0 to 100"),
            (math.isfinite(self.zoom_factor) and self.zoom_factor >= 1.0, "zoom_factor is a finite number from 1 up"),
            (self.accelerator in ACCELERATORS, f"accelerator is one of {', '.join(ACCELERATORS)}"),
            (1 <= self.samples <= 4096, "samples lie in 1 to 4096"),
            (0 <= self.threads <= 1024, "threads lie in 0 to 1024"),
            (
                all(budget >= 0 for budget in (self.certificates, self.certificate_seconds, self.certificate_memory)),
                "budgets of certificates are 0 or more",
            ),
        )
        for holds, message in checks:
            if not holds:
                raise ValueError(message)
        return self

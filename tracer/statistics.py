"""What a frame cost: counters that kernels add up, as named figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

import numpy as np
from numpy.typing import NDArray

from tracer.culling.counters import BY_LIGHT, PRIMARY, RAYS, SECONDARY, SHADOW, STEPS, TESTS, ShadowCounter


@dataclass
class RayCounts:
    """Rays of one kind; traversal steps are kd-tree nodes entered, tests are rays against primitives.  In the 8-wide
    trees both are counted once for all rays of a packet, and a block of triangles is one test."""

    rays: int = 0
    traversal_steps: int = 0
    intersection_tests: int = 0


@dataclass
class ShadowCounts(RayCounts):
    """Shadow rays: those due and, of these, those culled, those that asked dynamic objects alone, those that asked
    a few candidates instead of the static tree, and those that a cached occluder blocked; and, where culled answers
    were verified, the wrong ones.  `rays` are those that asked any tree at all."""

    due: int = 0
    culled: int = 0
    dynamic_only: int = 0
    candidates_only: int = 0
    cache_hits: int = 0
    wrong: int = 0


@dataclass
class SaidByModes:
    """Of one light: shadow rays that are due, and of those the ones that the paper's method culls (`full_shadow`), and
    that it asks moving objects alone about (`non_shadow`), whichever method the frame was traced with."""

    due: int = 0
    full_shadow: int = 0
    non_shadow: int = 0


@dataclass
class FrameStatistics:
    """Counters and times of one frame; `phases` are seconds by the names of Figure 1's steps.

    `by_modes` is what modes, as the last frame left them, say of the shadow rays of each light that has modes; nothing
    where none are kept.  `certificates` is how many were made before it was shaded, with so many steps through a tree
    and tests of triangles.  `part` is the part of the pixels that were shaded: below 1, shadow and secondary rays are
    those of that part alone.  `decision` is what the method `auto` does now, and why, in a sentence."""

    primary: RayCounts = field(default_factory=RayCounts)
    secondary: RayCounts = field(default_factory=RayCounts)
    shadow: ShadowCounts = field(default_factory=ShadowCounts)
    occlusion_tests: int = 0
    certificates: int = 0
    certificate_steps: int = 0
    certificate_tests: int = 0
    part: float = 1.0
    decision: str = ""
    seconds: float = 0.0
    by_modes: list[SaidByModes] = field(default_factory=list)
    phases: dict[str, float] = field(default_factory=dict)

    @property
    def by_modes_in_all(self) -> SaidByModes:
        """The sum over the lights."""
        one = self.by_modes
        return SaidByModes(sum(s.due for s in one), sum(s.full_shadow for s in one), sum(s.non_shadow for s in one))

    def to_dict(self) -> dict:
        """Plain dictionaries and numbers, for JSON."""
        return asdict(self)


def shadow_counts(counts: NDArray[np.int64]) -> ShadowCounts:
    """The shadow counters (SHADOW_COUNTERS,) of one worker, or their sum, by name."""
    return ShadowCounts(**{counter.name.lower(): int(counts[counter]) for counter in ShadowCounter})


def gather(counts: NDArray[np.int64], occlusion_tests: int, lights_with_modes: int) -> FrameStatistics:
    """Sum the counters (workers, COUNTERS) of all workers."""
    total = counts.sum(0)

    def rays_from(start: int) -> RayCounts:
        return RayCounts(int(total[start + RAYS]), int(total[start + STEPS]), int(total[start + TESTS]))

    rays = rays_from(PRIMARY), rays_from(SECONDARY), shadow_counts(total[SHADOW:])
    by_light = range(SHADOW + BY_LIGHT, len(total), 3)[:lights_with_modes]
    by_modes = [SaidByModes(*(int(number) for number in total[at : at + 3])) for at in by_light]
    return FrameStatistics(*rays, occlusion_tests, by_modes=by_modes)

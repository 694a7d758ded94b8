"""A pixel's rays, and what became of their shadow rays: the model of `ray_tree`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.verdicts import CullReason, Verdict
from tracer.geometry.rays import MISS
from tracer.scene.arrays import Float32, Float64

if TYPE_CHECKING:
    from tracer.frame import Frame

VERDICTS = tuple(Verdict)
NUMBER_OF = {verdict: number for number, verdict in enumerate(VERDICTS)}
AWAY, TRACED = NUMBER_OF[Verdict.AWAY], NUMBER_OF[Verdict.TRACED]


def _nowhere() -> Float32:
    return np.full(3, np.nan, np.float32)


class RayKind(Enum):
    """What sent a ray."""

    PRIMARY = "primary"
    REFLECTED = "reflected"
    REFRACTED = "refracted"


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class ShadowRays:
    """The shadow rays of a point, s of them: one for each sample of each light, due or not.

    Attributes
    ----------
    light : (s,) int32
        The light of each.
    reasons : dict of int to CullReason
        Where there is more to say than the verdict: why rays were culled, and what was known of those that were traced.
    verdict : (s,) uint8
        What became of it, as its place among `VERDICTS`.
    lit : (s,) bool
        Whether the light gets to the point, as the frame has it; false if the ray is not due.
    wrong : (s,) bool
        Whether that is not true.
    blocker : (s,) int32
        The primitive that is truly in the way first, seen from the light; -1 for none.
    blocked_at : (s,) float32
        How far along the ray that is, 0 at the light and 1 at the point; inf for none.
    met : (s,) int32
        For rays that were traced, the primitive that the search came upon, which need not be the first; -1 for none.
    asked_moving : (s,) bool
        Whether moving objects alone were asked.
    of_static : (s,) bool
        Whether it was answered that nothing static is in the way, and no more: moving objects are asked as well, if
        there are any.
    steps, tests : (s,) int32
        Traversal steps and intersection tests of the ray, traced alone; 0 unless it was traced or moving objects were
        asked.
    """

    light: NDArray[np.int32]
    reasons: dict[int, CullReason]
    verdict: NDArray[np.uint8]
    lit: NDArray[np.bool_]
    wrong: NDArray[np.bool_]
    blocker: NDArray[np.int32]
    blocked_at: Float32
    met: NDArray[np.int32]
    asked_moving: NDArray[np.bool_]
    of_static: NDArray[np.bool_]
    steps: NDArray[np.int32]
    tests: NDArray[np.int32]

    def of_light(self, light: int) -> slice:
        """The places of a light's samples."""
        first, end = np.searchsorted(self.light, [light, light + 1])
        return slice(int(first), int(end))

    def fate(self, place: int) -> Fate:
        """What became of a ray, by what answered it; why it was traced is not told."""
        verdict = VERDICTS[self.verdict[place]]
        # Light buffers count what they have tested as dynamic only where that is what remains.
        asks_dynamic = verdict.fate is Fate.CULLED or verdict is Verdict.BUFFER_TESTED
        return Fate.DYNAMIC_ONLY if asks_dynamic and self.of_static[place] else verdict.fate

    def reason(self, place: int) -> CullReason:
        """Why a ray was culled, or what was known of it although it was traced."""
        return self.reasons.get(place) or CullReason(VERDICTS[self.verdict[place]])

    @cached_property
    def counts(self) -> Counter[Verdict]:
        """How many rays each verdict has, in the order of `Verdict`, without those that none has."""
        numbers = np.bincount(self.verdict, minlength=len(VERDICTS))
        return Counter({verdict: int(n) for verdict, n in zip(VERDICTS, numbers) if n})


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class PathRay:
    """A primary, reflected or refracted ray.

    `number` is its place in `RayTree.rays`, `parent` that of the ray that sent it, -1 for the primary ray. It starts at
    `origin` (3,), goes in the unit `direction` (3,), and counts with `weight` (3,). It hits `primitive` at `t`, -1 and
    inf for a miss; `point` (3,) is where, and `end` (3,) a little above it, where the shadow rays `shadows` end, None
    for a miss. `light` (3,) is what it brings to the pixel by itself, without what it sends on. `steps` and `tests` are
    what it costs, traced alone."""

    number: int
    parent: int
    kind: RayKind
    bounce: int
    origin: Float32
    direction: Float32
    weight: Float32
    light: Float64
    t: float = np.inf
    primitive: int = MISS
    point: Float32 = field(default_factory=_nowhere)
    end: Float32 = field(default_factory=_nowhere)
    steps: int = 0
    tests: int = 0
    shadows: ShadowRays | None = None


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class RayTree:
    """The rays of pixel (x, y) of a frame, and `samples` (s, 3), where the lights' samples are."""

    frame: Frame
    x: int
    y: int
    rays: tuple[PathRay, ...]
    samples: Float32

    @cached_property
    def children(self) -> dict[int, tuple[int, ...]]:
        """The rays that each has sent, and under -1 the primary one."""
        found: dict[int, list[int]] = {}
        for ray in self.rays:
            found.setdefault(ray.parent, []).append(ray.number)
        return {parent: tuple(numbers) for parent, numbers in found.items()}

    @cached_property
    def counts(self) -> Counter[Verdict]:
        """How many shadow rays each verdict has."""
        return sum((ray.shadows.counts for ray in self.rays if ray.shadows is not None), Counter())

    @property
    def due(self) -> int:
        """Shadow rays that had to be answered."""
        return sum(number for verdict, number in self.counts.items() if verdict.due)

    @property
    def traced(self) -> int:
        """Shadow rays that asked static geometry."""
        return self.counts[Verdict.TRACED]

    @property
    def color(self) -> Float32:
        """(3,) what all rays bring to the pixel."""
        return np.sum([ray.light for ray in self.rays], axis=0).astype(np.float32)

    def shadow_rays(self) -> Iterator[tuple[PathRay, int]]:
        """Each ray with the places of its shadow rays that are due."""
        for ray in self.rays:
            if ray.shadows is not None:
                for place in np.flatnonzero(ray.shadows.verdict != AWAY):
                    yield ray, int(place)

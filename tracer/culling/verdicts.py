"""What became of a shadow ray: whether it was asked, what answered it, and how."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Verdict(Enum):
    """The names are those of the paper's modes and of certificates where there are any."""

    AWAY = "away"
    PASSED_OVER = "passed over"
    FULL_SHADOW = "FULL_SHADOW"
    NON_SHADOW = "NON_SHADOW"
    CERTIFIED_FULL = "certificate full"
    CERTIFIED_LIT = "certificate lit"
    CANDIDATES = "certificate candidates"
    BEAM = "beam"
    CACHED = "cached occluder"
    BUFFER_LIT = "light buffer lit"
    BUFFER_FULL = "light buffer full"
    BUFFER_TESTED = "light buffer candidates"
    VOXEL_LIT = "voxel null"
    VOXEL_FULL = "voxel full"
    VOXEL_WALK = "voxel walk"
    CELL_LIT = "cell lit"
    CELL_FULL = "cell full"
    CELL_TESTED = "cell candidates"
    ANSWERED = "answered"
    TRACED = "traced"

    @property
    def due(self) -> bool:
        """Whether the ray had to be answered."""
        return self is not Verdict.AWAY

    @property
    def culled(self) -> bool:
        """Whether it was answered without asking static geometry."""
        return self not in (Verdict.AWAY, Verdict.TRACED)


class Answered(NamedTuple):
    """A shadow ray that a method has answered: the primitive that it ends at, and the point (3,) above it; the light,
    and whether it says that the light gets there; and what the stage keeps for the point, a number."""

    primitive: int
    point: tuple[float, float, float]
    light: int
    lit: bool
    kept: int


class Because(NamedTuple):
    """Why it could be answered, the primitives that this rests on, and what more there is to say, in sentences."""

    verdict: Verdict
    named: tuple[int, ...] = ()
    told: str = ""

"""What became of a shadow ray: whether it was asked, what answered it, and how."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from tracer.culling.fate import Fate


class Verdict(Enum):
    """What answered a shadow ray, and so what becomes of it if dynamic objects need not be asked as well.

    The names are those of the paper's modes and of certificates where there are any."""

    AWAY = "away", Fate.FACES_AWAY
    PASSED_OVER = "passed over", Fate.CULLED
    FULL_SHADOW = "FULL_SHADOW", Fate.CULLED
    NON_SHADOW = "NON_SHADOW", Fate.CULLED
    CERTIFIED_FULL = "certificate full", Fate.CULLED
    CERTIFIED_LIT = "certificate lit", Fate.CULLED
    CANDIDATES = "certificate candidates", Fate.CANDIDATES
    BEAM = "beam", Fate.CULLED
    CACHED = "cached occluder", Fate.CACHED
    BUFFER_LIT = "light buffer lit", Fate.CULLED
    BUFFER_FULL = "light buffer full", Fate.CULLED
    BUFFER_TESTED = "light buffer candidates", Fate.CANDIDATES
    VOXEL_LIT = "voxel null", Fate.CULLED
    VOXEL_FULL = "voxel full", Fate.CULLED
    VOXEL_WALK = "voxel walk", Fate.CANDIDATES
    CELL_LIT = "cell lit", Fate.CULLED
    CELL_FULL = "cell full", Fate.CULLED
    CELL_TESTED = "cell candidates", Fate.CANDIDATES
    ANSWERED = "answered", Fate.CULLED
    TRACED = "traced", Fate.TRACED

    fate: Fate

    def __new__(cls, name: str, fate: Fate) -> Verdict:
        verdict = object.__new__(cls)
        verdict._value_, verdict.fate = name, fate
        return verdict

    @property
    def due(self) -> bool:
        """Whether the ray had to be answered."""
        return self.fate.is_due

    @property
    def culled(self) -> bool:
        """Whether it was answered without asking static geometry."""
        return self.fate.is_due and not self.fate.is_traced


class Answered(NamedTuple):
    """A shadow ray that a method has answered: the primitive that it ends at, and the point (3,) above it; the light,
    and whether it says that the light gets there; and what the stage keeps for the point, a number."""

    primitive: int
    point: tuple[float, float, float]
    light: int
    lit: bool
    kept: int


class CullReason(NamedTuple):
    """Why a shadow ray could be answered, or was traced all the same.

    `named` are the primitives that the answer rests on, and `told` is what more there is to say, in sentences.  Of a
    ray that was traced, `known` is what was known but did not do: a mode by its name, which is the primitive's
    occlusion mode unless it was fully rendered, else its shadow mode; or "candidates"; or the state of a certificate
    that was not looked up, as "proved full, unused"."""

    verdict: Verdict
    named: tuple[int, ...] = ()
    told: str = ""
    known: str = ""

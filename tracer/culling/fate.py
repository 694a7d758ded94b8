"""What becomes of a shadow ray: it is culled, asks less than the whole scene, or is traced, and why.

The reasons why a ray is traced are those of the paper's method: it culls by a shadow mode that says the same of every
ray so far (§2.5), of a primitive that has been seen whole (§2.3).
"""

from __future__ import annotations

from enum import IntEnum


class Fate(IntEnum):
    """What became of the shadow ray from a point to a light."""

    NONE = 0
    """Nobody knows: there is no surface, it has not been shaded yet, or the light was not looked at."""
    FACES_AWAY = 1
    """No ray is due: the surface faces away from the light."""
    CULLED = 2
    """Answered without asking any geometry."""
    DYNAMIC_ONLY = 3
    """Asked dynamic objects alone."""
    CANDIDATES = 4
    """Asked a few static primitives that may block it, and dynamic objects."""
    CACHED = 5
    """Blocked by the primitive that blocked the last ray from here."""
    PARTLY_OCCLUDED = 6
    """Traced: something hides a part of the primitive, or the screen's edge cuts it off (§2.3)."""
    PARTIAL_SHADOW = 7
    """Traced: some shadow rays of the primitive were blocked and some were not (§2.5)."""
    NOT_SEEN_WHOLE = 8
    """Traced: the primitive has not been seen whole yet, or no shadow ray of it has been traced (§2.2)."""
    DYNAMIC = 9
    """Traced: the primitive belongs to a dynamic object, which is never culled."""
    TRACED = 10
    """Traced, for a reason that is not one of the paper's."""

    @property
    def is_due(self) -> bool:
        """Whether there is a shadow ray."""
        return self >= Fate.CULLED

    @property
    def is_saved(self) -> bool:
        """Whether no static geometry is asked."""
        return self in (Fate.CULLED, Fate.DYNAMIC_ONLY)

    @property
    def is_traced(self) -> bool:
        """Whether the ray is traced through the whole scene."""
        return self >= Fate.PARTLY_OCCLUDED

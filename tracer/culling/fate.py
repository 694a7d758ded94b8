"""What becomes of a shadow ray: it is culled, asks less than the whole scene, or is traced, and why.

Kernels record a fate for each pixel and light, without reasons (`tracer.shading.recording`).  The reasons why a ray is
traced are those of the paper's method: it culls by a shadow mode that says the same of every ray so far (§2.5), of a
primitive that has been seen whole (§2.3).  They are read off the words that shadow testing went by.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes


class Fate(IntEnum):
    """What became of the shadow ray from a point to a light.

    The order tells how much was asked: no ray, then nothing, then more and more. Of the samples of a lamp the greatest
    is kept; what is due begins at CULLED, and what is traced through the whole scene at PARTLY_OCCLUDED, with TRACED
    last, which kernels record for all of these. Palettes have a colour for each, in this order."""

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


# numba takes plain numbers as constants
FACES_AWAY, CULLED, DYNAMIC_ONLY, CANDIDATES, CACHED, TRACED = (
    int(fate) for fate in (Fate.FACES_AWAY, Fate.CULLED, Fate.DYNAMIC_ONLY, Fate.CANDIDATES, Fate.CACHED, Fate.TRACED)
)
FATE, MOVING_SHADOW = 0x0F, 0x10
"""Bits of what is recorded: the fate, and whether nothing but a dynamic object is in the way."""


def by_modes(fates: NDArray[np.uint8], words: NDArray[np.unsignedinteger], light: int) -> NDArray[np.uint8]:
    """Say what the paper's method made of rays, and why it traced them, by the packed words that it read (§2.4).

    Parameters
    ----------
    fates : (n,) uint8
        The Fate of each ray as it was recorded, or that of a ray nearby.
    words : (n,) uint32 or uint64
        Word of the unit that it starts at.
    light : int
        Number of the light. One that has no modes is traced for no reason of the paper's.

    Returns
    -------
    (n,) uint8
        The same with reasons in the place of TRACED.
    """
    if not modes.has_shadow_mode(words, light):
        return fates
    occlusion, shadow = modes.occlusion_mode(words), modes.shadow_mode(words, light)
    said = np.where(occlusion == modes.FULLY_RENDERED, _SEEN_WHOLE[shadow], _NOT_CULLED[occlusion])
    saved = (said == CULLED) | (said == DYNAMIC_ONLY)
    open_before = (fates == CULLED) | (fates == DYNAMIC_ONLY) | (fates == TRACED)
    return np.where((fates >= CULLED) & (saved | open_before), said, fates).astype(np.uint8)


_SEEN_WHOLE = np.array([Fate.NOT_SEEN_WHOLE, Fate.CULLED, Fate.DYNAMIC_ONLY, Fate.PARTIAL_SHADOW], np.uint8)
"""By shadow mode."""
_NOT_CULLED = np.array([Fate.NOT_SEEN_WHOLE, Fate.PARTLY_OCCLUDED, Fate.NONE, Fate.DYNAMIC], np.uint8)
"""By occlusion mode."""

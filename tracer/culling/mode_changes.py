"""What a frame changes of modes: how many units and lights go from one mode to another (§2.2, §2.5, §2.6)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.runtime.kernels import kernel
from tracer.runtime.parallel import for_each_chunk
from tracer.simd import ones

CHUNK = 1 << 18  # units that a thread compares at a time: fewer are compared sooner than another thread wakes
LOWER_BITS = 0x5555_5555_5555_5554  # the lower bit of each light's shadow mode in a word


@dataclass
class ModeChanges:
    """How modes changed from the last frame to this one.

    Attributes
    ----------
    fully_rendered : int
        Units that became FULLY_RENDERED: they have been seen whole (§2.6).
    examined_anew : int
        Units that were FULLY_RENDERED and are INIT again, as they cover more pixels than the zoom factor allows (§2.6).
    partially_occluded : int
        Units that became PARTIALLY_OCCLUDED, and were not in the last frame (§2.3).
    full_shadow, non_shadow : int
        Shadow modes, of a unit and a light each, that were INIT and are FULL_SHADOW or NON_SHADOW now (§2.5).
    partial_shadow : int
        Shadow modes that became PARTIAL_SHADOW, whatever they were.
    units : dict of str to int
        How many units have each occlusion mode now, by its name in lower case.
    shadow_modes : dict of str to int
        How many shadow modes, of a unit and a light each, are FULL_SHADOW, NON_SHADOW and PARTIAL_SHADOW now.
    """

    fully_rendered: int = 0
    examined_anew: int = 0
    partially_occluded: int = 0
    full_shadow: int = 0
    non_shadow: int = 0
    partial_shadow: int = 0
    units: dict[str, int] = field(default_factory=dict)
    shadow_modes: dict[str, int] = field(default_factory=dict)

    @property
    def gained(self) -> int:
        """Shadow modes gained in all."""
        return self.full_shadow + self.non_shadow + self.partial_shadow


@kernel
def _compare(before, after, first, last, units, now, gained):
    """Count units first to last - 1 in units[occlusion mode before, after] (4, 4), and their lights in now[mode] and,
    those that have just got it, in gained[mode], both (4,) by shadow mode."""
    for unit in range(first, last):
        old, new = np.int64(before[unit]), np.int64(after[unit])
        units[old & 3, new & 3] += 1
        # Each light has two bits: the lower set alone is FULL_SHADOW, the upper NON_SHADOW, both PARTIAL_SHADOW.
        old_lower, old_upper = old & LOWER_BITS, (old >> 1) & LOWER_BITS
        lower, upper = new & LOWER_BITS, (new >> 1) & LOWER_BITS
        full, non, partial = lower & ~upper, upper & ~lower, lower & upper
        was_init = ~(old_lower | old_upper)
        now[1] += ones(full)
        now[2] += ones(non)
        now[3] += ones(partial)
        gained[1] += ones(full & was_init)
        gained[2] += ones(non & was_init)
        gained[3] += ones(partial & ~(old_lower & old_upper))


def mode_changes(before: NDArray[np.unsignedinteger], after: NDArray[np.unsignedinteger], threads: int) -> ModeChanges:
    """Compare the words of all units (units,) as shadow testing read them with those that the frame leaves."""
    units = np.zeros((threads, 4, 4), np.int64)
    now, gained = np.zeros((2, threads, 4), np.int64)

    def work(chunk: int, worker: int) -> None:
        first = chunk * CHUNK
        last = min(len(after), first + CHUNK)
        _compare(before, after, first, last, units[worker], now[worker], gained[worker])

    for_each_chunk(work, -(-len(after) // CHUNK), threads)
    went, shadows, new = units.sum(0), now.sum(0).tolist(), gained.sum(0).tolist()
    init, occluded, whole = (int(m) for m in list(OcclusionMode)[:3])
    return ModeChanges(
        fully_rendered=int(went[:, whole].sum() - went[whole, whole]),
        examined_anew=int(went[whole, init]),
        partially_occluded=int(went[init, occluded]),
        full_shadow=new[ShadowMode.FULL_SHADOW],
        non_shadow=new[ShadowMode.NON_SHADOW],
        partial_shadow=new[ShadowMode.PARTIAL_SHADOW],
        units={mode.name.lower(): int(went[:, mode].sum()) for mode in OcclusionMode},
        shadow_modes={mode.name.lower(): shadows[mode] for mode in list(ShadowMode)[1:]},
    )

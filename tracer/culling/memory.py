"""What culling remembers between frames: words, counts, and where the lights stood.

A pixel count means nothing at another resolution, so each resolution has a memory of its own.
"""

from __future__ import annotations

import numpy as np

from tracer.culling import modes


class Memory:
    """Modes and counts of all units at one resolution.

    words (units,) uint32 or uint64 (`tracer.culling.modes`), pixel_count and highest_count (units,)
    int32, hidden (units,) bool, gained (workers, units) like words.
    """

    def __init__(self, dynamic: np.ndarray, lights: int, workers: int) -> None:
        """`dynamic` (units,) bool tells which units belong to dynamic objects."""
        units, word = len(dynamic), modes.word_type(lights)
        self.words = np.where(dynamic, word(modes.DYNAMIC), word(modes.INIT)).astype(word)
        self.pixel_count = np.zeros(units, np.int32)
        self.highest_count = np.zeros(units, np.int32)
        self.hidden = np.zeros(units, np.bool_)
        self.gained = np.zeros((workers, units), word)
        self.light_positions: np.ndarray | None = None

    def follow_lights(self, positions: np.ndarray) -> None:
        """Forget what is known of lights that are not where the last frame had them; positions (lights, 3)."""
        before, self.light_positions = self.light_positions, positions.copy()
        if before is not None:
            moved = np.flatnonzero((before != positions).any(axis=1))
            if len(moved):
                modes.forget_lights(self.words, [int(i) for i in moved])

    def discard_frame(self) -> None:
        """Drop what an unfinished frame has gathered."""
        self.hidden[:] = False
        self.gained[:] = 0

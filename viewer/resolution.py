"""How coarse a frame must be to come in time.

While the camera moves, frames are traced at the window's resolution divided by 1, 2, 3, ...: the
finest step that should hold the wanted frame rate.  The cost of a pixel is learnt from the frames
that were traced.  A finer step is taken only with some time to spare, so that the resolution does
not flutter between two steps.
"""

from __future__ import annotations

LARGEST_DIVISOR = 8
SPARE = 0.8
SMOOTHING = 0.4


class ResolutionControl:
    """Chooses the divisor of the resolution for the next frame in motion."""

    def __init__(self) -> None:
        self.divisor = 2
        self._seconds_per_pixel: float | None = None

    def observe(self, seconds: float, pixels: int) -> None:
        """Learn from a traced frame."""
        if pixels <= 0 or seconds <= 0.0:
            return
        cost = seconds / pixels
        known = self._seconds_per_pixel
        self._seconds_per_pixel = cost if known is None else known + SMOOTHING * (cost - known)

    def forget(self) -> None:
        """Another scene costs something else."""
        self._seconds_per_pixel = None
        self.divisor = 2

    def choose(self, width: int, height: int, target_fps: float) -> int:
        """The divisor for a window of this size (pixels) at this frame rate."""
        if self._seconds_per_pixel is None:
            return self.divisor
        budget = 1.0 / target_fps
        for divisor in range(1, LARGEST_DIVISOR + 1):
            limit = budget * SPARE if divisor < self.divisor else budget
            w, h = divided(width, height, divisor)
            if self._seconds_per_pixel * w * h <= limit:
                break
        self.divisor = divisor
        return divisor


def divided(width: int, height: int, divisor: int) -> tuple[int, int]:
    """The size of a frame that is coarser by `divisor`, never empty."""
    return max(1, round(width / divisor)), max(1, round(height / divisor))

"""What marks the pixels of a verified frame that have wrong answers, and where the line of a wipe is."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.verified import known


class Mark(IntEnum):
    """What the difference view draws at a pixel."""

    NONE = 0
    RING = 1
    WRONG = 2


def wrong_marks(frame: Frame, magnified: int = 1) -> NDArray[np.uint8]:
    """(h, w) Mark: the pixels with wrong answers of a verified frame, and a ring around each, or around each crowd.

    The rings grow with the picture, so that a lone pixel is found in any; they are so much smaller where each pixel
    is shown as `magnified` of the screen's."""
    wrong = known(frame.wrong) > 0
    if not wrong.any():
        return np.zeros(wrong.shape, np.uint8)
    side = max(frame.width, frame.height)
    radius, thickness = (
        max(1, round(size / magnified)) for size in (max(3, round(side / 200)), max(1, round(side / 1500)))
    )
    ring = _within(wrong, radius + thickness) & ~_within(wrong, radius)
    return np.where(wrong, np.uint8(Mark.WRONG), ring.astype(np.uint8))


def _within(pixels: NDArray[np.bool_], radius: int) -> NDArray[np.bool_]:
    """Where one of some pixels is at most `radius` pixels away."""
    wide = [pixels]  # by how far to the left and right
    for k in range(1, radius + 1):
        wider = wide[-1].copy()
        wider[:, k:] |= pixels[:, :-k]
        wider[:, :-k] |= pixels[:, k:]
        wide.append(wider)
    near = wide[radius].copy()
    for k in range(1, radius + 1):
        row = wide[math.isqrt(radius * (radius + 1) - k * k)]
        near[k:] |= row[:-k]
        near[:-k] |= row[k:]
    return near


def wipe_column(width: int, wipe: float) -> int:
    """The column of pixels that the line of the wipe covers; `width`, that is none, for a wipe of 1."""
    return min(max(int(wipe * width), 0), width)

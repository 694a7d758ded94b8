"""Colours as a screen shows them."""

from __future__ import annotations

import numpy as np

from tracer.kernels import kernel


@kernel
def to_screen(color, pixels):
    """Colours (n, 3) float32, display-referred, as pixels (n, 4) uint8, opaque: clamped to 0 to 1, the nearest of 256
    steps."""
    for i in range(len(color)):
        for c in range(3):
            step = min(max(color[i, c], np.float32(0)), np.float32(1)) * np.float32(255)
            pixels[i, c] = np.uint8(np.rint(step))
        pixels[i, 3] = np.uint8(255)

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
            shown = color[i, c] if color[i, c] > np.float32(0) else np.float32(0)  # of what is no number, nothing
            pixels[i, c] = np.uint8(np.rint(min(shown, np.float32(1)) * np.float32(255)))
        pixels[i, 3] = np.uint8(255)

"""What eyes make of colours."""

from __future__ import annotations

import numpy as np

from viewer.state import views


def luminance(color: views.Color) -> float:
    """Relative luminance (WCAG 2)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color]
    return float(np.dot(linear, (0.2126, 0.7152, 0.0722)))

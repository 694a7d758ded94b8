"""A scene whose shadows are missed by rays until one zooms in: Figure 4 of the paper three times."""

from __future__ import annotations

import math
from pathlib import Path

from viewer.util.resources import embedded_scenes

_PIXEL = 2.0 * math.tan(math.radians(15.0)) * 20.0 / 96  # of a picture of 96 × 96, seen from where the path begins
_LAMP, _PLACES = (2.0, 3.0, 8.0), (-12 * _PIXEL, 0.0, 12 * _PIXEL)  # the shadows lie between rays
STEP, LAST = 3, 24
"""Of the path: the frames that are searched here, while all of the triangles are to be seen."""


def write_marbles(folder: Path) -> Path:
    """Write Figure 4 of the paper three times, side by side: each triangle has a shadow that only shows after
    zooming in; triangles 0 to 2 in the light of two lamps, then a marble for each."""
    text = embedded_scenes()["figure4"].read_text()
    start, middle, end = text.index("# 0 the receiver"), text.index("# 1 the occluder"), text.index("a 0 6 60")
    fill, paint = (text[a:b].splitlines()[1] for a, b in ((start, middle), (middle, end)))
    parts = [text[:start], "l -6 4 9  0.1 0.1 0.1\n", fill, ""]
    for x in _PLACES:
        parts.append(f"p 3\n{x - 0.6} -0.9 0\n{x + 0.6} -0.9 0\n{x} 0.95 0")
    parts.append(paint)
    for x in _PLACES:
        parts.append("s {} {} {} 0.03".format(*((a + b) / 2.0 for a, b in zip((x, 0.0, 0.0), _LAMP))))
    path = folder / "marbles.aff"
    path.write_text("\n".join(parts) + "\n" + text[end:])
    return path

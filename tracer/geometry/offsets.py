"""How far above a surface rays start, so that a rounded hit point does not hit its own surface again."""

from __future__ import annotations

# Of the largest coordinate at hand (the depth of the hit or a coordinate of the point, whichever is larger):
# about 300 roundings of a float32.
RAY_OFFSET = 2e-5

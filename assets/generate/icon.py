"""The icon: a ball, a light, and its shadow on a floor of cells in the colours of the shadow modes."""

from __future__ import annotations

import numpy as np

from generate.images import coordinates, paint, ramp, step
from generate.mesh import Array

SIZE = 256
LIT, HALF, DARK = (0.99, 0.80, 0.36), (0.86, 0.45, 0.26), (0.16, 0.18, 0.33)


def icon() -> Array:
    """(256, 256, 4): colour and opacity."""
    factor = 4
    x, y = coordinates(SIZE * factor, SIZE * factor)
    image = ramp(
        y, [(0, (0.13, 0.16, 0.30)), (0.55, (0.30, 0.29, 0.44)), (0.56, (0.2, 0.2, 0.3)), (1, (0.2, 0.2, 0.3))]
    )
    glow = np.hypot(x - 0.24, y - 0.22)
    image = image + (0.55 * np.exp(-((glow / 0.20) ** 2)))[..., None] * np.array([1.0, 0.85, 0.5])
    image = paint(image, 1 - step(0.075, glow, 0.006), (1.0, 0.95, 0.78))

    floor = y > 0.56
    depth = 0.11 / np.maximum(y - 0.49, 0.02)  # a perspective floor; cells are squares cut into triangles
    u, v = (x - 0.5) * depth * 9, depth * 9
    i, j = np.floor(u), np.floor(v)
    upper = (u - i) + (v - j) > 1
    along, across = u - 1.35, v - 3.3
    inside = np.hypot(along * 0.62, across * 1.15) / 1.15

    def reach(du: float, dv: float) -> Array:
        return np.hypot((i + du - 1.35) * 0.62, (j + dv - 3.3) * 1.15) / 1.15

    corners = (reach(1, 0) < 1).astype(int) + (reach(0, 1) < 1) + (np.where(upper, reach(1, 1), reach(0, 0)) < 1)
    touched = (corners > 0) | (np.hypot(i + 0.5 - 1.35, j + 0.5 - 3.3) < 0.9)
    cells = np.where((corners == 3)[..., None], DARK, np.where(touched[..., None], HALF, LIT))
    edge = np.minimum(np.minimum(u - i, v - j), np.abs((u - i) + (v - j) - 1) * 0.7)
    edge = np.minimum(edge, np.minimum(1 - (u - i), 1 - (v - j)))
    cells = cells * (0.80 + 0.20 * step(0.03, edge, 0.03))[..., None]
    cells = paint(cells, 0.55 * (1 - step(1.0, inside, 0.02)) * (corners < 3), DARK)
    image = paint(image, floor.astype(float), cells)

    ball = np.hypot(x - 0.57, y - 0.50)
    radius = 0.225
    bulge = np.sqrt(np.clip(1 - (ball / radius) ** 2, 0, 1))
    light = ((0.57 - x) * 0.62 + (0.50 - y) * 0.58) / radius + 0.52 * bulge
    shade = ramp(
        light, [(-0.1, (0.10, 0.11, 0.22)), (0.12, (0.20, 0.30, 0.48)), (0.8, (0.48, 0.75, 0.86)), (1.05, (0.97, 1, 1))]
    )
    image = paint(image, 1 - step(radius, ball, 0.004), shade)

    corner = np.hypot(np.maximum(np.abs(x - 0.5) - 0.27, 0), np.maximum(np.abs(y - 0.5) - 0.27, 0))
    alpha = 1 - step(0.215, corner, 0.004)
    whole = np.concatenate([np.clip(image, 0, 1), alpha[..., None]], axis=2)
    return whole.reshape(SIZE, factor, SIZE, factor, 4).mean(axis=(1, 3))

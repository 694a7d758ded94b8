"""Pictures that hang in the room or lie behind its window: each shown once, none repeats."""

from __future__ import annotations

import math

import numpy as np

from generate.images import clouds, coordinates, generator, paint, ramp, step
from generate.mesh import Array

SKY = (0.62, 0.76, 0.92)


def garden(width: int = 512, height: int = 230) -> Array:
    """The view from the window: sky, hills, a hedge, trees, a lawn with flower beds and a path."""
    x, y = coordinates(width, height)
    wide = x * 4
    high = 1 - y
    cloud = clouds(wide * 2.2, y * 7, (9, 7), 201, 5)
    sky = ramp(high, [(0.45, (0.86, 0.91, 0.95)), (0.9, SKY), (1.0, SKY)])
    image = paint(sky, step(0.55, cloud, 0.22) * (1 - step(0.90, high, 0.15)) * 0.85, (0.97, 0.97, 0.98))
    for base, height_, seed, colour in (
        (0.50, 0.16, 211, (0.55, 0.66, 0.76)), (0.46, 0.12, 212, (0.42, 0.56, 0.56)),
        (0.42, 0.10, 213, (0.30, 0.47, 0.32)),
    ):  # fmt: skip
        ridge = base + height_ * (clouds(wide * 0.9, 0 * y, (4, 1), seed, 4) - 0.35)
        image = paint(image, 1 - step(ridge, high, 0.008), colour)
    lawn = ramp(high + 0.05 * clouds(wide * 20, y * 40, (80, 40), 221, 3),
                [(0.0, (0.24, 0.42, 0.12)), (0.42, (0.50, 0.66, 0.28))])  # fmt: skip
    image = paint(image, 1 - step(0.36, high, 0.01), lawn)
    leaves = clouds(wide * 26, y * 30, (104, 30), 231, 3)
    hedge_top = 0.41 + 0.025 * (clouds(wide * 8, 0 * y, (32, 1), 232, 3) - 0.5)
    hedge = (1 - step(hedge_top + 0.02 * (leaves - 0.5), high, 0.008)) * step(0.31, high, 0.02)
    image = paint(image, hedge, ramp(leaves, [(0.2, (0.07, 0.20, 0.07)), (0.8, (0.27, 0.46, 0.18))]))
    random = generator(241)
    for centre, size, ground in ((0.10, 0.30, 0.30), (0.31, 0.20, 0.34), (0.73, 0.26, 0.31), (0.93, 0.34, 0.29)):
        trunk = (1 - step(0.012 + 0.01 * (1 - high), np.abs(x - centre) * 2.2, 0.006)) * step(ground, high, 0.01)
        image = paint(image, trunk * (1 - step(ground + size * 0.8, high, 0.02)), (0.30, 0.21, 0.14))
        for _ in range(26):
            cx = centre + (random.random_sample() - 0.5) * size * 0.55
            cy = ground + size * (0.62 + 0.75 * random.random_sample())
            radius = size * (0.13 + 0.12 * random.random_sample())
            distance = np.hypot((x - cx) * 2.2, high - cy)
            blob = 1 - step(radius * (0.75 + 0.5 * leaves), distance, 0.012)
            light = 0.30 + 0.5 * leaves + 0.9 * (high - cy) / size - 0.6 * (x - cx) / size
            image = paint(image, blob, ramp(light, [(0, (0.06, 0.18, 0.05)), (0.6, (0.24, 0.44, 0.13)),
                                                    (1.2, (0.62, 0.72, 0.30))]))  # fmt: skip
    middle = 0.52 + 0.09 * np.sin(high * 14)
    path = (1 - step(0.02 + 0.10 * (0.36 - high), np.abs(x - middle), 0.006)) * (1 - step(0.33, high, 0.02))
    image = paint(image, path, ramp(leaves, [(0, (0.62, 0.55, 0.43)), (1, (0.86, 0.79, 0.66))]))
    for _ in range(420):
        depth = random.random_sample()
        cy = 0.04 + 0.26 * depth
        side = -1 if random.random_sample() < 0.5 else 1
        cx = 0.52 + side * (0.14 + 0.30 * random.random_sample())
        radius = 0.013 * (1.25 - depth)
        colour = [(0.88, 0.22, 0.28), (0.95, 0.80, 0.25), (0.93, 0.90, 0.94), (0.70, 0.32, 0.72)][random.randint(4)]
        row, column, reach = int((1 - cy) * height), int(cx * width), int(0.05 * height)
        here = np.s_[max(row - reach, 0) : row + reach, max(column - reach, 0) : column + reach]
        dx, dy = (x[here] - cx) * 2.2, high[here] - cy
        foliage = 0.8 * (1 - step(radius * 1.2, np.hypot(dx, dy + radius * 1.5), 0.01))
        image[here] = paint(image[here], foliage, (0.13, 0.32, 0.10))
        image[here] = paint(image[here], 1 - step(radius, np.hypot(dx, dy), 0.005), colour)
    return image


def seascape(width: int = 320, height: int = 224) -> Array:
    """A moonlit sea: a picture of one light and its reflection."""
    x, y = coordinates(width, height)
    cloud = clouds(x * 5, y * 9, (5, 9), 301, 5)
    image = ramp(y, [(0, (0.05, 0.09, 0.20)), (0.55, (0.24, 0.33, 0.47)), (0.6, (0.46, 0.50, 0.52))])
    moon = np.hypot((x - 0.66) * 1.43, y - 0.24)
    image = image + (0.5 * np.exp(-((moon / 0.22) ** 2)))[..., None] * np.array([0.9, 0.85, 0.6])
    image = paint(image, 1 - step(0.065, moon, 0.01), (0.99, 0.96, 0.82))
    image = paint(image, 0.8 * step(0.60, cloud, 0.25) * (1 - step(0.56, y, 0.1)), (0.16, 0.19, 0.28))
    waves = clouds(x * 14, y * 90, (14, 90), 311, 3)
    sea = ramp((y - 0.58) * 2 + 0.5 * (waves - 0.5), [(0, (0.22, 0.30, 0.40)), (1, (0.03, 0.08, 0.15))])
    glint = np.exp(-(((x - 0.66) / (0.05 + 0.25 * (y - 0.58))) ** 2)) * step(0.52, waves, 0.12)
    image = paint(image, step(0.58, y, 0.004), paint(sea, np.clip(glint, 0, 1), (0.96, 0.92, 0.74)))
    hull = (np.abs(x - 0.30) < 0.085 - 0.9 * (y - 0.60)) & (y > 0.600) & (y < 0.632)
    sail = (y > 0.40) & (y < 0.595) & (x > 0.285 - 0.5 * (y - 0.40)) & (x < 0.297)
    jib = (y > 0.43) & (y < 0.595) & (x > 0.305) & (x < 0.305 + 0.33 * (y - 0.43))
    for mask, colour in ((hull, (0.06, 0.05, 0.06)), (sail, (0.80, 0.76, 0.66)), (jib, (0.70, 0.67, 0.60))):
        image = paint(image, mask.astype(float), colour)
    return image * (0.92 + 0.16 * clouds(x * 90, y * 64, (90, 64), 321, 2))[..., None]


def partition(width: int = 256, height: int = 256) -> Array:
    """A composition of planes, split axis by axis around a few points: what a kd-tree would hang on its wall."""
    random = generator(401)
    points = random.random_sample((26, 2))
    image = np.ones((height, width, 3)) * np.array([0.93, 0.91, 0.85])
    colours = [(0.80, 0.12, 0.10), (0.10, 0.22, 0.55), (0.95, 0.78, 0.15), (0.12, 0.12, 0.13), (0.74, 0.76, 0.74)]
    x, y = coordinates(width, height)
    line = 0.012

    def split(left: float, top: float, right: float, bottom: float, inside: Array, level: int) -> None:
        nonlocal image
        if level == 0 or len(inside) < 2:
            if random.random_sample() < 0.45:
                cell = (x > left) & (x < right) & (y > top) & (y < bottom)
                image = paint(image, cell.astype(float), colours[random.randint(len(colours))])
            return
        axis = 0 if right - left > bottom - top else 1
        at = float(np.median(inside[:, axis]))
        low, high = inside[inside[:, axis] < at], inside[inside[:, axis] >= at]
        if axis == 0:
            split(left, top, at, bottom, low, level - 1)
            split(at, top, right, bottom, high, level - 1)
            bar = (np.abs(x - at) < line) & (y > top) & (y < bottom)
        else:
            split(left, top, right, at, low, level - 1)
            split(left, at, right, bottom, high, level - 1)
            bar = (np.abs(y - at) < line) & (x > left) & (x < right)
        image = paint(image, bar.astype(float), (0.08, 0.08, 0.09))

    split(0, 0, 1, 1, points, 5)
    return image


def eclipse(width: int = 224, height: int = 288) -> Array:
    """A ball, a light and the shadow between them."""
    x, y = coordinates(width, height)
    py = y * height / width
    image = ramp(
        y, [(0, (0.86, 0.55, 0.24)), (0.66, (0.95, 0.80, 0.52)), (0.70, (0.55, 0.38, 0.26)), (1, (0.33, 0.20, 0.16))]
    )
    sun = np.hypot(x - 0.25, py - 0.26)
    for k in range(6, 0, -1):
        image = paint(image, 0.35 * (1 - step(0.085 + 0.05 * k, sun, 0.006)), (0.99, 0.90, 0.62))
    image = paint(image, 1 - step(0.10, sun, 0.006), (1.0, 0.97, 0.86))
    shadow = np.hypot((x - 0.80 - 0.45 * (py - 1.05)) / 0.30, (py - 1.06) / 0.075)
    image = paint(image, 1 - step(1.0, shadow, 0.03), (0.13, 0.08, 0.10))
    ball = np.hypot(x - 0.60, py - 0.80)
    height_ = np.sqrt(np.clip(1 - (ball / 0.235) ** 2, 0, 1))
    lit = ((0.60 - x) * 0.55 + (0.80 - py) * 0.70) / 0.235 * 0.9 + 0.35 * height_
    shade = ramp(
        lit, [(-0.2, (0.10, 0.05, 0.12)), (0.2, (0.40, 0.10, 0.16)), (0.9, (0.93, 0.42, 0.25)), (1.3, (1, 0.8, 0.6))]
    )
    image = paint(image, 1 - step(0.235, ball, 0.006), shade)
    return image * (0.92 + 0.16 * clouds(x * 70, y * 90, (70, 90), 501, 2))[..., None]


def globe(width: int = 256, height: int = 128) -> Array:
    """An old globe: seas, land, ice and a graticule."""
    x, y = coordinates(width, height)
    land = clouds(x * 6, y * 4, (6, 4), 611, 5, 0.55)
    polar = np.abs(y - 0.5) * 2
    tone = land - 0.10 * step(0.75, polar, 0.3)
    image = ramp(tone, [(0.30, (0.20, 0.36, 0.45)), (0.51, (0.42, 0.58, 0.58)), (0.52, (0.45, 0.36, 0.18)),
                        (0.54, (0.82, 0.74, 0.48)), (0.62, (0.62, 0.62, 0.32)),
                        (0.75, (0.60, 0.42, 0.24))])  # fmt: skip
    image = paint(image, step(0.86, polar + 0.2 * (land - 0.5), 0.04), (0.93, 0.92, 0.88))
    meridian = np.abs((x * 12) % 1 - 0.5) > 0.485
    parallel = np.abs((y * 6) % 1 - 0.5) > 0.47
    return paint(image, 0.35 * (meridian | parallel), (0.30, 0.22, 0.14))


def clock_face(size: int = 128) -> Array:
    """Cream enamel, twelve strokes; the hands are real."""
    x, y = coordinates(size, size)
    px, py = x - 0.5, y - 0.5
    radius, angle = np.hypot(px, py), np.arctan2(px, -py)
    image = np.ones((size, size, 3)) * np.array([0.94, 0.90, 0.78])
    image = paint(image, 1 - step(0.008, np.abs(radius - 0.46), 0.012), (0.15, 0.10, 0.06))
    image = paint(image, 1 - step(0.005, np.abs(radius - 0.33), 0.012), (0.45, 0.32, 0.15))
    hour = (angle / (2 * math.pi) * 12 + 0.5) % 1 - 0.5
    quarter = (angle / (2 * math.pi) * 4 + 0.5) % 1 - 0.5
    thick = np.where(np.abs(quarter) < 0.1, 0.02, 0.011)
    stroke = (1 - step(thick, np.abs(hour) / 12 * 2 * math.pi * radius, 0.01)) * (np.abs(radius - 0.395) < 0.045)
    image = paint(image, stroke, (0.10, 0.07, 0.05))
    minute = np.abs((angle / (2 * math.pi) * 60 + 0.5) % 1 - 0.5) < 0.12
    return paint(image, minute * (np.abs(radius - 0.455) < 0.012) * 1.0, (0.10, 0.07, 0.05))

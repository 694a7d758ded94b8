"""Surfaces of the room: wood, wallpaper, stone, cloth.  All of them repeat without a seam."""

from __future__ import annotations

import math

import numpy as np

from generate.images import clouds, coordinates, generator, noise, paint, ramp, step
from generate.mesh import Array

OAK = [(0.0, (0.30, 0.17, 0.08)), (0.5, (0.52, 0.32, 0.16)), (1.0, (0.70, 0.48, 0.27))]


def parquet(size: int = 384) -> Array:
    """Herringbone oak, eight staves of 4:1 to the period."""
    long = 4
    x, y = coordinates(size, size)
    x, y = x * 2 * long, y * 2 * long
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    k = (i - j) % (2 * long)
    flat = k < long  # else the stave stands upright
    along = np.where(flat, k + (x - i), (2 * long - 1 - k) + (y - j))
    across = np.where(flat, y - j, x - i)
    row = np.where(flat, j, i) % (2 * long)
    column = np.where(flat, i - k, j - (2 * long - 1 - k)) % (2 * long)
    stave = row * 2 * long + column + np.where(flat, 0, 4 * long * long)
    shift = generator(11).random_sample(8 * long * long)[stave]
    grain = clouds(along * 1.6 + shift * 64, across * 9 + shift * 512, (64, 512), 21, 4, 0.6)
    rings = 0.5 + 0.5 * np.sin(
        (across * 3 + 2.4 * noise(along * 0.7 + shift * 64, across * 2, (64, 64), 5)) * 6 + shift * 50
    )
    tone = 0.16 + 0.42 * shift + 0.50 * (grain - 0.35) + 0.14 * rings
    image = ramp(tone, OAK)
    edge = np.minimum(np.minimum(across, 1 - across), np.minimum(along, long - along))
    return image * (0.42 + 0.58 * step(0.025, edge, 0.045))[..., None]


def wood(size: int = 256) -> Array:
    """Straight-grained walnut, v along the grain."""
    x, y = coordinates(size, size)
    bend = clouds(x * 3, y * 2, (3, 2), 31, 3)
    rings = 0.5 + 0.5 * np.sin(2 * math.pi * (7 * x + 1.5 * bend))
    fibre = clouds(x * 48, y * 3, (48, 3), 41, 3, 0.6)
    tone = 0.30 + 0.30 * rings * clouds(x * 4, y * 2, (4, 2), 51, 2) + 0.55 * (fibre - 0.4)
    return ramp(tone, [(0, (0.20, 0.105, 0.055)), (0.45, (0.42, 0.24, 0.125)), (1, (0.62, 0.40, 0.22))])


def wallpaper(size: int = 256) -> Array:
    """Two greens in broad stripes, with a damask leaf on every second one."""
    x, y = coordinates(size, size)
    stripe = step(0.25, np.abs(x - 0.5), 0.012)
    image = ramp(stripe, [(0, (0.50, 0.57, 0.47)), (1, (0.60, 0.66, 0.54))])
    line = 1 - step(0.010, np.abs(np.abs(x - 0.5) - 0.225), 0.008)
    image = paint(image, 0.8 * line, (0.80, 0.74, 0.52))
    for centre_x, centre_y in ((0.5, 0.25), (0.5, 0.75), (0.0, 0.0), (0.0, 0.5)):
        dx = np.abs((x - centre_x + 0.5) % 1 - 0.5)
        dy = (y - centre_y + 0.5) % 1 - 0.5
        radius, angle = np.hypot(dx, dy * 0.8), np.arctan2(dx, -dy)
        leaf = 0.085 + 0.055 * np.cos(3 * angle) * np.cos(angle / 2) + 0.03 * np.cos(8 * angle)
        mask = 1 - step(leaf, radius, 0.010)
        vein = 1 - step(0.006, np.abs(radius - 0.55 * leaf), 0.006)
        image = paint(image, 0.55 * mask, (0.78, 0.76, 0.58))
        image = paint(image, 0.7 * mask * vein, (0.46, 0.53, 0.42))
    weave = clouds(x * 64, y * 64, (64, 64), 61, 2)
    return image * (0.94 + 0.10 * weave)[..., None]


def marble(size: int = 256) -> Array:
    x, y = coordinates(size, size)
    warp = clouds(x * 3, y * 3, (3, 3), 71, 5)
    vein = np.abs(np.sin(2 * math.pi * (x + y + 1.4 * warp)))
    fine = np.abs(np.sin(2 * math.pi * (2 * x - y + 1.8 * clouds(x * 4, y * 4, (4, 4), 81, 4))))
    tone = 0.72 * vein**0.45 + 0.28 * fine**0.5
    return ramp(tone, [(0, (0.33, 0.36, 0.37)), (0.55, (0.72, 0.73, 0.71)), (1, (0.92, 0.91, 0.88))])


def brick(size: int = 256) -> Array:
    """Eight courses in running bond."""
    x, y = coordinates(size, size)
    course = np.floor(y * 8).astype(int)
    u = x * 4 + 0.5 * (course % 2)
    number = (np.floor(u).astype(int) % 4) + 4 * course
    tone = generator(91).random_sample(32)[number]
    rough = clouds(x * 24, y * 24, (24, 24), 95, 3)
    image = ramp(
        0.6 * tone + 0.5 * rough, [(0, (0.34, 0.13, 0.09)), (0.5, (0.53, 0.24, 0.16)), (1, (0.70, 0.42, 0.30))]
    )
    along, across = u % 1, (y * 8) % 1
    edge = np.minimum(np.minimum(along, 1 - along) * 2.2, np.minimum(across, 1 - across))
    joint = 1 - step(0.075 + 0.03 * (rough - 0.5), edge, 0.05)
    return paint(image, joint, (0.60, 0.57, 0.52))


def cloth(size: int = 128) -> Array:
    """Oxblood upholstery with a small diamond weave."""
    x, y = coordinates(size, size)
    a, b = np.sin(2 * math.pi * 8 * (x + y)), np.sin(2 * math.pi * 8 * (x - y))
    diamond = step(0.0, a * b, 0.6)
    weave = clouds(x * 64, y * 64, (64, 64), 101, 2)
    image = ramp(0.75 * diamond + 0.25 * weave, [(0, (0.42, 0.09, 0.08)), (1, (0.57, 0.16, 0.12))])
    dot = 1 - step(0.15, np.hypot(((x * 8) % 1) - 0.5, ((y * 8) % 1) - 0.5), 0.16)
    return paint(image, 0.7 * dot, (0.74, 0.50, 0.27))


def rug(width: int = 384, height: int = 288) -> Array:
    """A carpet: borders within borders, and a medallion; symmetric both ways."""
    x, y = coordinates(width, height)
    half_x, half_y = 1.35, 1.0
    px, py = np.abs(x - 0.5) * 2 * half_x, np.abs(y - 0.5) * 2 * half_y
    inset = np.minimum(half_x - px, half_y - py)  # distance from the rim
    red, blue, cream, gold = (0.52, 0.10, 0.09), (0.10, 0.16, 0.33), (0.86, 0.78, 0.62), (0.75, 0.53, 0.22)
    image = np.broadcast_to(np.asarray(red), (height, width, 3)).copy()
    soft = 0.012
    lattice = np.cos(px * 2 * math.pi * 4) + np.cos(py * 2 * math.pi * 4)
    image = paint(image, step(1.55, lattice, 0.2), gold)
    image = paint(image, step(1.72, lattice, 0.1), blue)
    image = paint(image, 1 - step(-1.75, lattice, 0.12), (0.66, 0.22, 0.14))
    angle, radius = np.arctan2(py, px), np.hypot(px * 0.80, py)
    for size, wave, colour in (
        (0.56, 0.055, gold), (0.54, 0.055, blue), (0.40, 0.045, cream), (0.37, 0.045, red),
        (0.23, 0.035, gold), (0.20, 0.035, blue), (0.085, 0.02, cream),
    ):  # fmt: skip
        image = paint(image, 1 - step(size + wave * np.cos(16 * angle), radius, soft), colour)
    petals = 0.5 + 0.5 * np.cos(16 * angle)
    ring = (1 - step(0.035, np.abs(radius - 0.47), 0.02)) * step(0.55, petals, 0.3)
    image = paint(image, ring, cream)
    corner = np.hypot((half_x - 0.24 - px), (half_y - 0.24 - py))
    for size, colour in ((0.36, gold), (0.34, blue), (0.22, cream), (0.20, red), (0.09, gold)):
        wave = 0.02 * np.cos(12 * np.arctan2(half_y - 0.24 - py, half_x - 0.24 - px))
        image = paint(image, 1 - step(size + wave, corner, soft), colour)
    for width_, colour in (
        (0.245, gold), (0.235, blue), (0.085, cream), (0.075, red), (0.03, cream),
    ):  # fmt: skip
        image = paint(image, 1 - step(width_, inset, soft), colour)
    run = np.where(half_x - px < half_y - py, py, px)
    vine = np.sin(run * 2 * math.pi * 5)
    stem = (1 - step(0.010, np.abs(inset - 0.16 - 0.030 * vine), 0.010)) * step(0.09, inset, 0.01)
    image = paint(image, stem, gold)
    flower = np.hypot((run * 10 % 1 - 0.5) / 10, inset - 0.16 - 0.030 * vine)
    image = paint(image, (1 - step(0.026, flower, 0.01)) * step(0.09, inset, 0.01), cream)
    image = paint(image, (1 - step(0.011, flower, 0.008)) * step(0.09, inset, 0.01), red)
    image = paint(image, (1 - step(0.012, np.abs((run * 12) % 1 - 0.5), 0.4)) * (1 - step(0.068, inset, 0.01))
                  * step(0.038, inset, 0.01), gold)  # fmt: skip
    wool = generator(111).random_sample((height, width))
    return image * (0.86 + 0.20 * wool)[..., None]


def spines(width: int = 512, height: int = 192, count: int = 32) -> Array:
    """The backs of `count` books side by side: leather and linen, gilt bands, a label, lettering one cannot read."""
    random = generator(121)
    x, y = coordinates(width, height)
    palette = [
        (0.42, 0.11, 0.09), (0.12, 0.20, 0.35), (0.15, 0.30, 0.20), (0.55, 0.36, 0.18), (0.28, 0.15, 0.10),
        (0.62, 0.55, 0.42), (0.20, 0.18, 0.20), (0.50, 0.22, 0.13), (0.70, 0.60, 0.35), (0.30, 0.34, 0.38),
    ]  # fmt: skip
    image = np.zeros((height, width, 3))
    grain = clouds(x * 128, y * 48, (128, 48), 131, 2)
    for book in range(count):
        here = (x * count >= book) & (x * count < book + 1)
        u = x * count - book
        cover = np.asarray(palette[random.randint(len(palette))]) * (0.8 + 0.4 * random.random_sample())
        gold = np.asarray((0.82, 0.66, 0.30))
        picture = np.broadcast_to(cover, image.shape)
        bands = random.randint(3, 7)
        at = (np.arange(bands) + 0.5) / bands if random.random_sample() < 0.6 else np.array([0.08, 0.14, 0.86, 0.92])
        for position in at:
            picture = paint(picture, 1 - step(0.006, np.abs(y - position), 0.008), gold)
        if random.random_sample() < 0.7:  # a label with a title
            top = 0.2 + 0.1 * random.random_sample()
            bottom = top + 0.12 + 0.15 * random.random_sample()
            label = step(top, y, 0.01) * (1 - step(bottom, y, 0.01)) * (1 - step(0.40, np.abs(u - 0.5), 0.05))
            dark = random.random_sample() < 0.5
            picture = paint(picture, label, cover * 0.45 if dark else (0.88, 0.82, 0.66))
            words = random.random_sample((height // 3 + 1, 8))[
                (np.arange(height) // 3)[:, None], (u * 8).astype(int) % 8
            ]
            lines = label * (words > 0.45) * (np.abs(u - 0.5) < 0.30) * (((y * height // 3).astype(int)) % 2)
            picture = paint(picture, lines, gold if dark else (0.2, 0.12, 0.08))
        round_back = 0.62 + 0.38 * np.sqrt(np.clip(1 - (2 * u - 1) ** 2, 0, 1))
        picture = picture * (round_back * (0.88 + 0.24 * grain))[..., None]
        image = np.where(here[..., None], picture, image)
    return image

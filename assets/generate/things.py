"""Things that stand about: glasses, fruit, a globe, a plant, a clock.  Each at the origin, upwards along y."""

from __future__ import annotations

import math

import numpy as np

from generate import materials as m
from generate.aff import Model
from generate.images import generator
from generate.mesh import Mesh, join
from generate.shapes import box, curve, grid, lathe, rounded_box, sheet, thinned, tube, turned


def globe() -> Model:
    """0.42 m high, on a turned foot, with its axis tilted in a brass ring."""
    model = Model("globe")
    angles = np.linspace(-math.pi / 2, math.pi / 2, 17)
    ball = lathe([(0.13 * max(math.cos(a), 0.0), 0.13 * math.sin(a)) for a in angles], 32, 80)
    uvs = ball.uvs.copy()
    model.add(m.GLOBE, Mesh(ball.corners, ball.normals, uvs).turned("y", 100).turned("z", -23).moved(0, 0.26, 0))
    ring = [(0.145 * math.cos(a), 0.26 + 0.145 * math.sin(a), 0) for a in np.linspace(0, 2 * math.pi, 33)]
    model.add(m.BRASS, tube(ring, 0.006, 6))
    for sign in (-1, 1):
        a = math.radians(90 - 23)
        model.sphere(m.BRASS, (sign * 0.136 * math.cos(a), 0.26 + sign * 0.136 * math.sin(a), 0), 0.010)
    foot = turned(
        [(0, 0), (0.09, 0.0), (0.092, 0.012), (0.05, 0.03), (0.018, 0.05), (0.025, 0.08), (0.012, 0.115)], 22, 20
    )
    model.add(m.MAHOGANY, foot.mapped("y", 2))
    return model


def tumbler() -> Model:
    model = Model("tumbler", decimals=5)
    outside = [(0.0, 0.0), (0.030, 0.0), (0.033, 0.004), (0.035, 0.03), (0.0385, 0.088), (0.0385, 0.0905)]
    inside = [(0.0365, 0.0905), (0.0355, 0.086), (0.0322, 0.018), (0.028, 0.013), (0.0, 0.012)]
    model.add(m.GLASS, lathe(outside + inside, 28, 28))
    return model


def goblet() -> Model:
    """A wine glass, 0.17 m high, a third full."""
    model = Model("goblet", decimals=5)
    profile = [(0.0, 0.0), (0.036, 0.0), (0.036, 0.003), (0.012, 0.009), (0.0045, 0.020), (0.0040, 0.05),
               (0.006, 0.073),
               (0.022, 0.085), (0.034, 0.105), (0.0375, 0.125), (0.0350, 0.150), (0.0325, 0.168)]  # fmt: skip
    bowl = [(0.0312, 0.168), (0.0336, 0.150), (0.0360, 0.125), (0.0325, 0.106), (0.020, 0.0875), (0.0, 0.0805)]
    model.add(m.GLASS, lathe(profile + bowl, 22, 50))
    wine = [(0.0, 0.0812), (0.0195, 0.0880), (0.0318, 0.1062), (0.0343, 0.1150), (0.0, 0.1150)]
    model.add(m.WINE, lathe(wine, 22, 45))
    return model


def carafe() -> Model:
    """0.27 m high, with a glass stopper."""
    model = Model("carafe", decimals=5)
    outside = curve(
        [
            (0.060, 0.004),
            (0.074, 0.03),
            (0.072, 0.075),
            (0.045, 0.125),
            (0.0215, 0.165),
            (0.0195, 0.205),
            (0.030, 0.232),
        ],
        26,
    )
    inside = curve(
        [
            (0.026, 0.230),
            (0.0165, 0.204),
            (0.0185, 0.165),
            (0.042, 0.122),
            (0.0685, 0.075),
            (0.0705, 0.034),
            (0.056, 0.012),
        ],
        22,
    )
    profile = (
        [(0.0, 0.0), (0.056, 0.0)]
        + [(float(r), float(y)) for r, y in np.concatenate([thinned(outside, 0.0012), thinned(inside, 0.0012)])]
        + [(0.0, 0.010)]
    )
    model.add(m.GLASS, lathe(profile, 32, 50))
    model.sphere(m.CRYSTAL, (0, 0.262, 0), 0.030)
    return model


def tray() -> Model:
    model = Model("tray")
    plate = lathe(
        [
            (0, 0.004),
            (0.18, 0.004),
            (0.20, 0.010),
            (0.215, 0.024),
            (0.210, 0.024),
            (0.196, 0.014),
            (0.178, 0.009),
            (0, 0.009),
        ],
        40,
        30,
    )
    model.add(m.CHROME, plate.scaled(1.0, 1.0, 0.72))
    return model


def fruit_bowl() -> Model:
    """China on a foot with apples, oranges (true spheres) and pears."""
    model = Model("fruit_bowl")
    bowl = [(0, 0.0), (0.06, 0.0), (0.062, 0.008), (0.04, 0.022), (0.09, 0.04), (0.135, 0.075), (0.155, 0.115),
            (0.150, 0.115),
            (0.128, 0.078), (0.085, 0.046), (0.0, 0.036)]  # fmt: skip
    model.add(m.CHINA, lathe(bowl, 36, 60))
    rim = [(0.1545 * math.cos(a), 0.114, 0.1545 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 49)]
    model.add(m.BLUE_CHINA, tube(rim, 0.005, 6))
    for x, y, z, radius, kind in (
        (-0.055, 0.098, 0.045, 0.042, m.APPLE), (0.060, 0.098, 0.040, 0.040, m.ORANGE),
        (0.0, 0.096, -0.068, 0.041, m.APPLE),
        (-0.075, 0.105, -0.035, 0.036, m.ORANGE), (0.078, 0.105, -0.040, 0.037, m.APPLE),
        (0.004, 0.155, 0.002, 0.040, m.ORANGE),
    ):  # fmt: skip
        model.sphere(kind, (x, y, z), radius)
        if kind is m.APPLE:
            model.add(m.STEM, tube([(x, y + radius * 0.96, z), (x + 0.006, y + radius + 0.016, z + 0.003)], 0.0018, 6))
    pear = turned(
        [(0.0, 0.0), (0.030, 0.006), (0.040, 0.030), (0.034, 0.058), (0.019, 0.080), (0.013, 0.094), (0.0, 0.100)],
        20,
        18,
    )
    stalk = tube([(0, 0.098, 0), (0.004, 0.118, 0.002)], 0.0018, 6)
    for x, z, lean in ((0.005, 0.088, 30), (-0.06, 0.0, -14)):
        model.add(m.PEAR, pear.turned("x", lean).moved(x, 0.108 if lean < 0 else 0.09, z))
        model.add(m.STEM, stalk.turned("x", lean).moved(x, 0.108 if lean < 0 else 0.09, z))
    return model


def vase() -> Model:
    """Blue china, 0.34 m, with dry twigs."""
    model = Model("vase")
    outside = curve(
        [(0.045, 0.0), (0.055, 0.02), (0.09, 0.12), (0.085, 0.20), (0.04, 0.27), (0.032, 0.30), (0.05, 0.34)], 28
    )
    profile = (
        [(0.0, 0.0)]
        + [(float(r), float(y)) for r, y in thinned(outside, 0.0015)]
        + [(0.046, 0.34), (0.028, 0.30), (0.03, 0.26)]
    )
    model.add(m.BLUE_CHINA, lathe(profile, 30, 50))
    random = generator(701)
    for k in range(11):
        a, reach, top = 2.4 * k, 0.10 + 0.14 * random.random_sample(), 0.62 + 0.22 * random.random_sample()
        x, z = math.cos(a), math.sin(a)
        twig = curve([(0.01 * x, 0.2, 0.01 * z), (0.035 * x, 0.36, 0.035 * z), (reach * 0.6 * x, 0.5, reach * 0.6 * z),
                      (reach * x, top, reach * z)], 9)  # fmt: skip
        model.add(m.STEM, tube(twig, np.linspace(0.0035, 0.0015, 9), 4))
        for i in (4, 5, 6, 7, 8):
            dx, dz = 0.018 * (random.random_sample(2) - 0.5)
            model.sphere(m.WAX if k % 3 else m.APPLE, (twig[i, 0] + dx, twig[i, 1] + 0.004, twig[i, 2] + dz), 0.009)
    return model


def leaf(length: float, width: float, droop: float) -> Mesh:
    """A pointed leaf from the origin along +x, bending down."""
    rows, columns = 2, 6
    points = np.empty((rows + 1, columns + 1, 3))
    for j in range(columns + 1):
        s = j / columns
        half = width * math.sin(math.pi * min(s**0.75, 1.0)) * 0.5 + 0.0015
        for i in range(rows + 1):
            t = i / rows * 2 - 1
            points[i, j] = (
                length * s,
                0.25 * length * s - droop * length * s * s + 0.22 * width * abs(t) * math.sin(math.pi * s),
                -half * t,
            )
    return sheet(points)


def plant() -> Model:
    """A rubber plant about 1.7 m high in a terracotta pot made of cones."""
    model = Model("plant")
    model.cone(m.TERRACOTTA, (0, 0.0, 0), 0.15, (0, 0.30, 0), 0.20)
    model.cone(m.TERRACOTTA, (0, 0.29, 0), 0.222, (0, 0.36, 0), 0.226)
    rim = lathe([(0.200, 0.29), (0.222, 0.29), (0.226, 0.36), (0.205, 0.362), (0.200, 0.33)], 36, 20)
    model.add(m.TERRACOTTA, rim)
    model.add(m.SOIL, lathe([(0.203, 0.335), (0.10, 0.345), (0, 0.348)], 24, 60))
    random = generator(711)
    stems = [
        [(0.02, 0.34, 0.0), (0.05, 0.7, 0.03), (0.02, 1.1, 0.08), (0.06, 1.55, 0.05)],
        [(-0.05, 0.34, 0.04), (-0.13, 0.62, 0.06), (-0.22, 0.95, 0.02), (-0.25, 1.28, 0.05)],
        [(0.04, 0.34, -0.05), (0.14, 0.60, -0.02), (0.24, 0.90, -0.06), (0.26, 1.20, -0.04)],
        [(0.0, 0.34, 0.06), (0.03, 0.55, 0.16), (0.02, 0.80, 0.25), (-0.02, 1.02, 0.30)],
    ]
    for number, path in enumerate(stems):
        points = curve(path, 34)
        model.add(m.STEM, tube(points[::4], np.linspace(0.015, 0.006, 9), 7))
        for i in range(7, 34):
            azimuth = 137.5 * i + 70 * number + 20 * random.random_sample()
            size = 0.16 + 0.10 * random.random_sample() - 0.06 * (i / 34)
            blade = leaf(size, size * 0.42, 0.35 + 0.45 * random.random_sample())
            blade = blade.turned("z", 10 + 35 * (i / 34) + 12 * random.random_sample()).turned("y", azimuth)
            colour = m.LEAF_PALE if i > 28 or random.random_sample() < 0.12 else m.LEAF
            model.add(colour, blade.moved(*map(float, points[i])))
    return model


def desk_things() -> Model:
    """Papers, a stack of books, a cup of pencils, a crystal ball; the desk's top is y = 0 and its middle the origin."""
    model = Model("desk_things")
    for k, (x, z, turn) in enumerate(((-0.05, 0.06, 8), (0.02, 0.08, -5), (0.22, 0.02, -24))):
        sheet_ = grid((-0.105, 0, 0.148), (0.21, 0, 0), (0, 0, -0.296), 2, 3)
        model.add(m.PAPER, sheet_.turned("y", turn).moved(x, 0.0032 + 0.0012 * k, z))
    pen = tube([(0.05, 0.0105, 0.13), (0.13, 0.0105, 0.00)], 0.004, 8)
    model.add(m.BLACK_PAINT, pen)
    for k, (width, height, cover) in enumerate(
        ((0.26, 0.035, m.BLUE_PAINT), (0.24, 0.028, m.RED_PAINT), (0.21, 0.04, m.GREEN_PAINT))
    ):
        y = (0.0, 0.0352, 0.0634)[k]
        angle = (4.0, -7.0, 12.0)[k]
        half, deep = width / 2, width * 0.36
        boards = [
            box((-half, y, -deep), (half, y + 0.003, deep)),
            box((-half, y + height - 0.003, -deep), (half, y + height, deep)),
            box((-half, y + 0.003, deep - 0.004), (half, y + height - 0.003, deep)),
        ]
        block = join(boards)
        pages = box((-half + 0.005, y + 0.003, -deep + 0.005), (half - 0.005, y + height - 0.003, deep - 0.004))
        model.add(cover, block.turned("y", angle).moved(0.33, 0, -0.17))
        model.add(m.PAGES, pages.turned("y", angle).moved(0.33, 0, -0.17))
    model.cone(m.CHROME, (-0.28, 0, -0.17), 0.036, (-0.28, 0.095, -0.17), 0.040)
    model.add(m.IRON, lathe([(0.0365, 0.003), (0, 0.003)], 20).moved(-0.28, 0, -0.17))
    for k, paint_ in enumerate((m.YELLOW_PAINT, m.RED_PAINT, m.BLUE_PAINT, m.GREEN_PAINT, m.YELLOW_PAINT)):
        a = 1.3 * k
        x, z = -0.28 + 0.014 * math.cos(a), -0.17 + 0.014 * math.sin(a)
        tip = (-0.28 + 0.042 * math.cos(a), 0.15 + 0.006 * (k % 3), -0.17 + 0.042 * math.sin(a))
        end = tuple(p + 0.10 * (p - q) for p, q in zip(tip, (x, 0.006, z), strict=True))
        model.cone(paint_, (x, 0.006, z), 0.0038, tip, 0.0038)
        model.cone(m.PAGES, tip, 0.0038, end, 0.0006)
    ring = lathe([(0.030, 0.0), (0.045, 0.0), (0.045, 0.010), (0.030, 0.014)], 24)
    model.add(m.BRASS, ring.moved(-0.12, 0, -0.14))
    model.sphere(m.CRYSTAL, (-0.12, 0.058, -0.14), 0.055)
    return model


def clock() -> Model:
    """A long-case clock, 2.1 m, against a wall behind z = 0; its pendulum swings in the open case."""
    model = Model("clock")
    wood = [
        rounded_box((-0.25, 0.0, 0.0), (0.25, 0.09, 0.29), 0.012, 2),
        box((-0.22, 0.09, 0.01), (0.22, 0.55, 0.27)),
        rounded_box((-0.24, 0.53, 0.0), (0.24, 0.58, 0.285), 0.015, 2),
        box((-0.17, 0.58, 0.01), (-0.135, 1.55, 0.23)),
        box((0.135, 0.58, 0.01), (0.17, 1.55, 0.23)),
        grid((-0.135, 0.58, 0.02), (0.27, 0, 0), (0, 0.97, 0), 2, 6),
        rounded_box((-0.24, 1.53, 0.0), (0.24, 1.58, 0.285), 0.015, 2),
        box((-0.22, 1.58, 0.01), (0.22, 2.02, 0.262)),
        rounded_box((-0.27, 2.01, 0.0), (0.27, 2.06, 0.31), 0.018, 2),
        rounded_box((-0.16, 0.14, 0.265), (0.16, 0.49, 0.28), 0.01, 2),
    ]
    model.add(m.MAHOGANY, *[part.mapped("y", 1.2) for part in wood])
    crest = lathe([(0, 0), (0.19, 0.0), (0.19, 0.012), (0.15, 0.05), (0.05, 0.085), (0, 0.09)], 28, 30).scaled(
        1.2, 1, 0.7
    )
    model.add(m.MAHOGANY, crest.mapped("x", 1.2).moved(0, 2.06, 0.15))
    for x in (-0.2, 0.2):
        model.add(m.BRASS, turned([(0.012, 0), (0.03, 0.03), (0.02, 0.07), (0, 0.12)], 10, 12).moved(x, 2.06, 0.2))
    model.add(m.CLOCK_FACE, grid((-0.17, 1.63, 0.2635), (0.34, 0, 0), (0, 0.34, 0), 2, 2))
    ring = [(0.172 * math.cos(a), 1.80 + 0.172 * math.sin(a), 0.266) for a in np.linspace(0, 2 * math.pi, 41)]
    model.add(m.GOLD, tube(ring, 0.010, 8))
    for angle, length, width in ((-62.0, 0.085, 0.010), (42.0, 0.135, 0.007)):
        hand = box((-width / 2, -0.02, 0.268 + 0.1 * width), (width / 2, length, 0.270 + 0.1 * width))
        model.add(m.BLACK_PAINT, hand.turned("z", angle).moved(0, 1.80, 0))
    for x, low in ((-0.075, 0.98), (0.075, 0.86)):
        model.cone(m.BRASS, (x, low, 0.10), 0.024, (x, low + 0.17, 0.10), 0.024)
        model.add(m.BRASS, *[lathe([(0.024, 0), (0.012, 0.012), (0, 0.014)], 14).moved(x, low + 0.17, 0.10)])
        model.add(m.IRON, tube([(x, low + 0.17, 0.10), (x, 1.55, 0.10)], 0.0025, 5))
    swing = Model("pendulum")
    swing.add(m.BRASS, tube([(0, 0, 0), (0, -0.72, 0)], 0.006, 6))
    bob = lathe([(0, -0.012), (0.05, -0.010), (0.068, 0.0), (0.05, 0.010), (0, 0.012)], 28, 40)
    swing.add(m.BRASS, bob.turned("x", 90).moved(0, -0.72, 0))
    pivot = Model("pendulum_pivot")
    pivot.animate(swing, "pendulum")
    model.place(pivot, (0, 1.52, 0.155))
    return model

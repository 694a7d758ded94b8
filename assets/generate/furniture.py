"""Furniture.  Each piece stands at the origin on the floor and faces +z."""

from __future__ import annotations

import math

import numpy as np

from generate import materials as m
from generate.aff import Material, Model
from generate.images import generator
from generate.mesh import Mesh, join
from generate.shapes import box, grid, lathe, pillow, rounded_box, sheet, tube, turned

BALUSTER = [
    (0.6, 0.0),
    (0.75, 0.03),
    (0.55, 0.08),
    (0.7, 0.2),
    (1.0, 0.45),
    (1.1, 0.62),
    (0.75, 0.72),
    (1.0, 0.76),
    (1.0, 1.0),
]


def leg(height: float, radius: float, segments: int = 12, samples: int = 14) -> Mesh:
    """A turned leg from the floor up to a height."""
    return turned([(radius * r, height * h) for r, h in BALUSTER], samples, segments).mapped("y", 1.2)


def armchair() -> Model:
    model = Model("armchair")
    model.add(m.CLOTH, *[part.mapped("y", 3.2) for part in (
        rounded_box((-0.36, 0.17, -0.36), (0.36, 0.33, 0.36), 0.05, 2),
        pillow((-0.30, 0.28, -0.27), (0.30, 0.47, 0.40), 0.42, 8, 20),
        rounded_box((-0.44, 0.17, -0.36), (-0.29, 0.60, 0.36), 0.07, 2),
        rounded_box((0.29, 0.17, -0.36), (0.44, 0.60, 0.36), 0.07, 2),
        tube([(-0.365, 0.60, -0.34), (-0.365, 0.60, 0.37)], 0.085, 14),
        tube([(0.365, 0.60, -0.34), (0.365, 0.60, 0.37)], 0.085, 14),
    )])  # fmt: skip
    back = join(
        [
            rounded_box((-0.40, 0.0, -0.07), (0.40, 0.86, 0.07), 0.07, 2),
            pillow((-0.30, 0.14, 0.02), (0.30, 0.80, 0.17), 0.5, 8, 16),
            tube([(-0.40, 0.80, 0), (-0.41, 0.70, 0.10), (-0.40, 0.45, 0.13)], [0.06, 0.07, 0.05], 10),
            tube([(0.40, 0.80, 0), (0.41, 0.70, 0.10), (0.40, 0.45, 0.13)], [0.06, 0.07, 0.05], 10),
        ]
    )
    model.add(m.CLOTH, back.mapped("y", 3.2).turned("x", -12).moved(0, 0.22, -0.32))
    for x in (-0.33, 0.33):
        for z in (-0.30, 0.30):
            model.add(m.MAHOGANY, leg(0.20, 0.032).moved(x, 0, z))
    for x in (-0.365, 0.365):
        model.sphere(m.BRASS, (x, 0.60, 0.372), 0.018)
    return model


def wooden_chair() -> Model:
    """A spindle-back chair."""
    model = Model("wooden_chair")
    seat = rounded_box((-0.22, 0.43, -0.21), (0.22, 0.465, 0.22), 0.016, 2)
    parts = [seat.mapped("z", 1.6)]
    for x in (-0.18, 0.18):
        for z in (-0.17, 0.17):
            parts.append(leg(0.43, 0.023, 10, 16).moved(x, 0, z))
    for z in (-0.17, 0.17):
        parts.append(tube([(-0.18, 0.16, z), (0.18, 0.16, z)], 0.010, 8))
    for x in (-0.18, 0.18):
        parts.append(tube([(x, 0.21, -0.17), (x, 0.21, 0.17)], 0.010, 8))
    lean = -0.09
    for k in range(7):
        x = -0.18 + 0.06 * k
        radius = 0.015 if k in (0, 6) else 0.008
        parts.append(
            tube([(x, 0.46, -0.19), (x * 1.04, 0.70, -0.20 + lean * 0.4), (x * 1.06, 0.93, -0.20 + lean)], radius, 8)
        )
    top = [
        (x, 0.95 + 0.03 * math.cos(x * 7), -0.20 + lean - 0.02 * math.cos(x * 7)) for x in np.linspace(-0.22, 0.22, 9)
    ]
    parts.append(tube(top, 0.024, 8))
    model.add(m.OAK, *parts)
    return model


def desk() -> Model:
    """A writing desk, 1.5 m wide, with a leather top and two pedestals."""
    model = Model("desk")
    model.add(m.MAHOGANY, rounded_box((-0.78, 0.70, -0.34), (0.78, 0.74, 0.34), 0.012, 2).mapped("x", 1.1))
    model.add(m.LEATHER, grid((-0.52, 0.7412, 0.26), (1.04, 0, 0), (0, 0, -0.46), 4, 2))
    model.add(m.MAHOGANY, rounded_box((-0.74, 0.60, -0.30), (0.74, 0.705, 0.30), 0.006).mapped("x", 1.1, (0.4, 0.2)))
    for side in (-1, 1):
        low, high = sorted((side * 0.74, side * 0.36))
        model.add(m.MAHOGANY, box((low, 0.08, -0.30), (high, 0.61, 0.30)).mapped("y", 1.1))
        model.add(m.MAHOGANY, rounded_box((low - 0.01, 0.0, -0.31), (high + 0.01, 0.09, 0.31), 0.01).mapped("x", 1.1))
        for y in (0.12, 0.28, 0.44):
            drawer = rounded_box((low + 0.025, y, 0.29), (high - 0.025, y + 0.14, 0.315), 0.008, 2)
            model.add(m.MAHOGANY, drawer.mapped("x", 1.1, (0.3 * side, y)))
            for dx in (-0.06, 0.06):
                model.sphere(m.BRASS, ((low + high) / 2 + dx, y + 0.07, 0.325), 0.013)
    return model


def round_table() -> Model:
    """A low table on a turned pillar with three feet; its top is at 0.50 m."""
    model = Model("round_table")
    top = lathe([(0, 0.465), (0.44, 0.465), (0.52, 0.475), (0.535, 0.485), (0.53, 0.497), (0.515, 0.50), (0.40, 0.50),
                 (0.20, 0.50), (0, 0.50)], 40)  # fmt: skip
    pillar = turned([(0.05, 0.10), (0.075, 0.13), (0.045, 0.17), (0.04, 0.22), (0.07, 0.30), (0.06, 0.36),
                     (0.035, 0.40),
                     (0.06, 0.43), (0.16, 0.466)], 28, 20)  # fmt: skip
    model.add(m.MAHOGANY, top.mapped("x", 0.9), pillar.mapped("y", 1.2))
    for k in range(3):
        foot = tube([(0.02, 0.16, 0), (0.12, 0.17, 0), (0.22, 0.11, 0), (0.29, 0.035, 0), (0.34, 0.022, 0)],
                    [0.040, 0.036, 0.028, 0.022, 0.022], 10)  # fmt: skip
        model.add(m.MAHOGANY, foot.mapped("x", 1.2).turned("y", 120 * k + 35))
    return model


def sideboard() -> Model:
    """1.7 m wide, against a wall behind z = 0; its marble top is at 0.90 m."""
    model = Model("sideboard")
    model.add(m.WALNUT, box((-0.82, 0.14, 0.02), (0.82, 0.86, 0.44)).mapped("y", 1.0))
    model.add(m.MARBLE, rounded_box((-0.87, 0.86, 0.01), (0.87, 0.90, 0.48), 0.014, 2).mapped("x", 1.3))
    for x in (-0.76, 0.76):
        for z in (0.08, 0.38):
            model.add(m.WALNUT, leg(0.15, 0.035).moved(x, 0, z))
    for k in range(4):
        x = -0.79 + 0.40 * k
        frame = rounded_box((x, 0.19, 0.43), (x + 0.38, 0.66, 0.458), 0.01)
        panel = rounded_box((x + 0.06, 0.25, 0.45), (x + 0.32, 0.60, 0.468), 0.012)
        drawer = rounded_box((x, 0.68, 0.43), (x + 0.38, 0.84, 0.458), 0.01)
        model.add(
            m.WALNUT, frame.mapped("y", 1.0, (0.2, 0)), panel.mapped("y", 1.0, (0.5, 0.4)), drawer.mapped("x", 1.0)
        )
        model.sphere(m.BRASS, (x + (0.34 if k % 2 == 0 else 0.04), 0.44, 0.475), 0.014)
        model.sphere(m.BRASS, (x + 0.19, 0.76, 0.475), 0.014)
    return model


def book(width: float, height: float, depth: float, spine: int) -> tuple[Mesh, Mesh]:
    """Cover and pages of a standing book: left edge at x = 0, its back at z = 0, towards +z."""
    u0, u1 = spine / 32 + 0.002, (spine + 1) / 32 - 0.002
    points = np.empty((2, 4, 3))
    s = np.linspace(0, 1, 4)
    points[..., 0] = s * width
    points[..., 1] = np.array([[0.0], [height]])
    points[..., 2] = 0.22 * width * (1 - (2 * s - 1) ** 2)
    back = sheet(points)
    back.uvs[..., 0] = u0 + (u1 - u0) * back.uvs[..., 0]
    left = grid((0, 0, -depth), (0, 0, depth), (0, height, 0))
    right = grid((width, 0, 0), (0, 0, -depth), (0, height, 0))
    for side in (left, right):
        side.uvs[..., 0] = u0 + 0.10 * (u1 - u0)
        side.uvs[..., 1] = 0.04
    rim = 0.003
    pages = join(
        [
            grid((0, height - rim, 0), (width, 0, 0), (0, 0, rim - depth)),
            grid((width, 0, rim - depth), (-width, 0, 0), (0, height - rim, 0)),
        ]
    )
    return join([back, left, right]), pages


def row_of_books(model: Model, x0: float, x1: float, y: float, z: float, tallest: float, seed: int) -> None:
    """Fills a shelf from left to right, with a gap now and then and the last book leaning."""
    random = generator(seed)
    x = x0
    while True:
        width = 0.022 + 0.030 * random.random_sample()
        if x + width > x1:
            break
        height = tallest * (0.68 + 0.30 * random.random_sample())
        depth = 0.15 + 0.05 * random.random_sample()
        cover, pages = book(width, height, depth, int(random.randint(32)))
        lean = random.random_sample() < 0.10 and x + width + 0.09 < x1
        if lean:  # to the left, on its neighbour
            angle = 9.0
            cover, pages = cover.turned("z", angle), pages.turned("z", angle)
            shift = height * math.sin(math.radians(angle))
            cover, pages = cover.moved(shift), pages.moved(shift)
            x += shift + width * math.cos(math.radians(angle))
            at = x - shift - width * math.cos(math.radians(angle))
        else:
            at = x
            x += width + 0.0012
        inset = z - 0.02 * random.random_sample()
        model.add(m.SPINES, cover.moved(at, y, inset))
        model.add(m.PAGES, pages.moved(at, y, inset))
        if random.random_sample() < 0.05:
            x += 0.07


def bookcase(name: str, width: float, shelves: int, seed: int, wood: Material = m.WALNUT, gap: float = 0.345) -> Model:
    """Open shelves full of books, against a wall behind z = 0."""
    model = Model(name)
    depth, height = 0.31, 0.10 + shelves * gap + 0.03
    for x in (-width / 2, width / 2 - 0.03):
        model.add(wood, rounded_box((x, 0, 0), (x + 0.03, height, depth), 0.004).mapped("y", 1.0, (x, 0)))
    model.add(wood, grid((-width / 2, 0, 0.012), (width, 0, 0), (0, height, 0), 3, 2 * shelves).mapped("y", 1.0))
    inner = width / 2 - 0.03
    for k in range(shelves + 1):
        y = 0.10 + k * gap
        board = rounded_box((-inner, y - 0.025, 0.012), (inner, y, depth - 0.01), 0.004)
        model.add(wood, board.mapped("x", 1.0, (0.3 * k, 0)))
        if k < shelves:
            row_of_books(model, -inner + 0.006, inner - 0.006, y, depth - 0.07, gap - 0.055, seed + k)
    model.add(wood, box((-inner, 0, 0.02), (inner, 0.076, depth - 0.02)).mapped("x", 1.0))
    crown = rounded_box(
        (-width / 2 - 0.03, height - 0.005, 0), (width / 2 + 0.03, height + 0.05, depth + 0.03), 0.02, 2
    )
    model.add(wood, crown.mapped("x", 1.0, (0.7, 0.1)))
    return model


def framed(name: str, picture: Material, width: float, height: float, frame: Material, border: float = 0.07) -> Model:
    """A picture or mirror on a wall behind z = 0, its centre at the origin."""
    model = Model(name)
    x, y = width / 2, height / 2
    model.add(picture, grid((-x, -y, 0.018), (width, 0, 0), (0, height, 0), 4, 3))
    for low, high in (
        ((-x - border, y - 0.004), (x + border, y + border)),
        ((-x - border, -y - border), (x + border, -y + 0.004)),
        ((-x - border, -y), (-x + 0.004, y)),
        ((x - 0.004, -y), (x + border, y)),
    ):
        model.add(frame, rounded_box((*low, 0.0), (*high, 0.045), 0.018, 3).mapped("y", 1.5))
    for low, high in (
        ((-x - border * 0.55, y + border * 0.4), (x + border * 0.55, y + border * 0.62)),
        ((-x - border * 0.55, -y - border * 0.62), (x + border * 0.55, -y - border * 0.4)),
        ((-x - border * 0.62, -y - border * 0.5), (-x - border * 0.4, y + border * 0.5)),
        ((x + border * 0.4, -y - border * 0.5), (x + border * 0.62, y + border * 0.5)),
    ):
        model.add(frame, rounded_box((*low, 0.03), (*high, 0.058), 0.007).mapped("y", 1.5))
    return model

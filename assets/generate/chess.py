"""A chess board and its turned pieces, set up as at the end of Morphy's game at the opera (Paris, 1858).

Pieces are modelled in units of a square and placed by scale; ivory and ebony share one shape each.
"""

from __future__ import annotations

import math

import numpy as np

from generate import materials as m
from generate.aff import Model
from generate.mesh import Mesh, join
from generate.shapes import box, grid, lathe, pillow, rounded_box, tube, turned

POSITION = "1n1Rkb1r/p4ppp/4q3/4p1B1/4P3/8/PPP2PPP/2K5"
SQUARE = 0.052

FOOT = [(0.38, 0.0), (0.39, 0.06), (0.36, 0.12), (0.30, 0.16), (0.30, 0.20)]


def body(waist: float, height: float, collar: float) -> Mesh:
    """Foot, stem and collar of a piece; the collar's top is at `height`."""
    foot = lathe(FOOT, 16)
    stem = turned(
        [(0.30, 0.20), (0.22, 0.27), (waist * 1.15, 0.40), (waist, 0.62 * height), (waist * 1.08, height - 0.12)],
        12,
        16,
    )
    ring = lathe(
        [(waist, height - 0.12), (collar, height - 0.08), (collar, height - 0.045), (waist * 0.9, height)], 16, 30
    )
    return join([foot, stem, ring])


def ball(radius: float, centre: float, rows: int = 7) -> Mesh:
    angles = np.linspace(-math.pi / 2, math.pi / 2, rows)
    return lathe([(radius * max(math.cos(a), 0.0), centre + radius * math.sin(a)) for a in angles], 16, 80)


def shapes() -> dict[str, Mesh]:
    """One mesh for each kind of piece, standing at the origin; a square is one unit wide."""
    crown = lathe([(0.13, 1.42), (0.17, 1.52), (0.26, 1.74), (0.20, 1.74), (0.12, 1.68), (0, 1.66)], 20)
    points = [ball(0.045, 0, 5).moved(0.235 * math.cos(a), 1.76, 0.235 * math.sin(a))
              for a in np.arange(8) * math.pi / 4]  # fmt: skip
    merlons = []
    for k in range(6):
        block = box((0.17, 0.96, -0.07), (0.285, 1.09, 0.07))
        merlons.append(block.turned("y", 60 * k))
    head = tube(
        [(0.0, 0.42, -0.06), (0.0, 0.62, -0.13), (0, 0.86, -0.12), (0, 1.04, -0.01), (0, 1.06, 0.12), (0, 0.95, 0.25),
         (0, 0.86, 0.33)],
        [0.20, 0.19, 0.175, 0.165, 0.145, 0.105, 0.085], 14,
    )  # fmt: skip
    mane = tube([(0, 0.46, -0.26), (0, 0.72, -0.32), (0, 0.98, -0.24), (0, 1.16, -0.06)], [0.04, 0.07, 0.08, 0.045], 8)
    ears = [
        tube([(x, 1.13, -0.03), (x * 1.25, 1.27, -0.02), (x * 1.3, 1.33, 0.0)], [0.055, 0.04, 0.0], 8)
        for x in (-0.075, 0.075)
    ]
    jaw = pillow((-0.10, 0.78, 0.02), (0.10, 1.0, 0.30), 0.8, 6, 12)
    return {
        "pawn": join([body(0.13, 0.78, 0.22), ball(0.185, 0.93)]),
        "rook": join([body(0.19, 0.86, 0.29), lathe([(0.19, 0.86), (0.285, 0.90), (0.285, 0.98), (0.0, 0.98)], 20),
                                                     *merlons]),
        "knight": join([lathe(FOOT, 16), turned([(0.30, 0.20), (0.24, 0.28), (0.23, 0.36), (0.25, 0.42),
                                                 (0, 0.46)], 10, 20),
                        head.scaled(0.82, 1, 1), mane, *ears, jaw]),
        "bishop": join([body(0.14, 1.06, 0.24), turned([(0.12, 1.06), (0.19, 1.16), (0.205, 1.26), (0.14, 1.42),
                                                        (0.03, 1.53)], 12, 16),
                        ball(0.055, 1.55, 7)]),
        "queen": join([body(0.15, 1.42, 0.26), crown, *points, ball(0.085, 1.73, 7)]),
        "king": join([body(0.16, 1.50, 0.28), lathe([(0.14, 1.50), (0.18, 1.60), (0.25, 1.80), (0.23, 1.85),
                                                     (0.0, 1.92)], 20),
                      rounded_box((-0.04, 1.90, -0.03), (0.04, 2.16, 0.03), 0.015),
                      rounded_box((-0.11, 1.99, -0.03), (0.11, 2.06, 0.03), 0.015)]),
    }  # fmt: skip


def board() -> Model:
    """The board with its pieces, centred at the origin, its underside at y = 0; black sits at -z."""
    model = Model("chess")
    side, rim, top = 4 * SQUARE, 0.026, 0.022
    model.add(m.WALNUT, box((-side, 0.002, -side), (side, top - 0.004, side)).mapped("x", 3))
    for low, high in (
        ((-side - rim, 0, side), (side + rim, top + 0.003, side + rim)),
        ((-side - rim, 0, -side - rim), (side + rim, top + 0.003, -side)),
        ((-side - rim, 0, -side - 0.001), (-side, top + 0.0025, side + 0.001)),
        ((side, 0, -side - 0.001), (side + rim, top + 0.0025, side + 0.001)),
    ):
        model.add(m.WALNUT, rounded_box(low, high, 0.004, 2).mapped("x", 3))
    for rank in range(8):
        for file in range(8):
            square = grid((-side + file * SQUARE, top, -side + (rank + 1) * SQUARE), (SQUARE, 0, 0), (0, 0, -SQUARE))
            model.add(m.IVORY if (rank + file) % 2 == 0 else m.EBONY, square)
    pieces = {}
    for name, mesh in shapes().items():
        letter = "n" if name == "knight" else name[0]
        pieces[letter] = Model(name, decimals=3)
        pieces[letter].shape(mesh)
    for rank, row in enumerate(POSITION.split("/")):
        file = 0
        for letter in row:
            if letter.isdigit():
                file += int(letter)
                continue
            x, z = -side + (file + 0.5) * SQUARE, -side + (rank + 0.5) * SQUARE
            white = letter.isupper()
            model.place(
                pieces[letter.lower()], (x, top, z), 180.0 if white else 0.0, SQUARE, m.IVORY if white else m.EBONY
            )
            file += 1
    return model

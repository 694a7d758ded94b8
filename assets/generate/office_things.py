"""Office furniture of few triangles, for there are 64 rooms of it.  Each piece stands at the origin and faces +z."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

from generate import materials as m
from generate.aff import Colour, Material, Model
from generate.images import generator
from generate.mesh import Mesh, join
from generate.shapes import box, flat_quad, grid, lathe, rounded_box

AMBIENT = 0.16  # less than in the study: panels are everywhere


def matte(name: str, colour: Colour, ambient: float = AMBIENT) -> Material:
    return m.matte(name, colour, ambient)


def dimmed(material: Material) -> Material:
    """A material of the study, with as little ambient light as the office has, and without a mirror image."""
    r, g, b = material.diffuse
    return replace(material, ambient=(AMBIENT * r, AMBIENT * g, AMBIENT * b), specular=(0.0, 0.0, 0.0))


OAK, WALNUT, CLOTH, RUG = dimmed(m.OAK), dimmed(m.WALNUT), dimmed(m.CLOTH), dimmed(m.RUG)
PICTURES = [dimmed(m.SEASCAPE), dimmed(m.PARTITION), dimmed(m.ECLIPSE)]
WHITE = matte("white laminate", (0.86, 0.86, 0.84))
GREY = matte("grey enamel", (0.42, 0.44, 0.46))
DARK = matte("dark plastic", (0.09, 0.09, 0.10))
FABRICS = [
    matte("blue fabric", (0.12, 0.24, 0.42)),
    matte("mustard fabric", (0.72, 0.50, 0.12)),
    matte("green fabric", (0.16, 0.36, 0.24)),
]
STEEL = m.metal("brushed steel", (0.34, 0.35, 0.37), (0.16, 0.16, 0.17), 12)
BINDERS = [
    matte("red binders", (0.62, 0.12, 0.10)),
    matte("blue binders", (0.10, 0.22, 0.50)),
    matte("black binders", (0.10, 0.10, 0.11)),
    matte("grey binders", (0.60, 0.60, 0.58)),
    matte("yellow binders", (0.84, 0.62, 0.14)),
]
SCREEN = m.glowing("a screen that is on", (0.55, 0.72, 0.92))
TEXT = m.glowing("a window on the screen", (0.92, 0.95, 0.98))
LEAF, POT, SOIL, PAPER = (dimmed(x) for x in (m.LEAF, m.CHINA, m.SOIL, m.PAPER))


def desk() -> Model:
    """1.6 m wide and 0.8 m deep; its top is at 0.74 m; whoever sits at it sits at +z."""
    model = Model("desk")
    model.add(OAK, rounded_box((-0.8, 0.71, -0.4), (0.8, 0.74, 0.4), 0.006).mapped("x", 0.9))
    for x in (-0.76, 0.72):
        for z in (-0.36, 0.32):
            model.add(GREY, box((x, 0, z), (x + 0.04, 0.71, z + 0.04)))
    model.add(GREY, box((-0.72, 0.32, -0.36), (0.72, 0.66, -0.345)))
    model.add(WHITE, box((0.28, 0.08, -0.32), (0.70, 0.66, 0.28)))
    for y in (0.10, 0.29, 0.48):
        model.add(WHITE, rounded_box((0.295, y, 0.27), (0.685, y + 0.165, 0.30), 0.006))
        model.add(STEEL, box((0.43, y + 0.12, 0.30), (0.55, y + 0.13, 0.315)))
    model.place(workplace(), (0, 0.74, 0))
    return model


def workplace() -> Model:
    """What is on a desk: a screen, a keyboard, papers and a mug."""
    model = Model("workplace")
    model.add(DARK, rounded_box((-0.33, 0.12, -0.235), (0.33, 0.52, -0.205), 0.008))
    model.add(SCREEN, grid((-0.315, 0.135, -0.2035), (0.63, 0, 0), (0, 0.37, 0), 2, 1))
    model.add(TEXT, grid((-0.27, 0.18, -0.2028), (0.30, 0, 0), (0, 0.28, 0)))
    model.add(DARK, box((-0.04, 0.01, -0.26), (0.04, 0.30, -0.235)), box((-0.12, 0, -0.33), (0.12, 0.012, -0.15)))
    model.add(DARK, rounded_box((-0.22, 0, 0.08), (0.22, 0.02, 0.22), 0.006), box((0.29, 0, 0.11), (0.35, 0.025, 0.20)))
    model.add(PAPER, box((-0.30, 0, -0.12), (-0.09, 0.012, 0.17)).turned("y", 14).moved(-0.38, 0, 0.05))
    model.add(PAPER, box((-0.105, 0, -0.15), (0.105, 0.004, 0.15)).turned("y", -9).moved(0.60, 0, 0.12))
    model.cone(BINDERS[0], (0.52, 0, -0.14), 0.038, (0.52, 0.095, -0.14), 0.042)
    return model


def swivel_chair(name: str, fabric: Material) -> Model:
    """Five feet, a column, a seat and a back; whoever sits in it looks to +z."""
    model = Model(name)
    for k in range(5):
        a = 2 * math.pi * k / 5
        x, z = 0.30 * math.cos(a), 0.30 * math.sin(a)
        model.cone(STEEL, (0.03 * math.cos(a), 0.11, 0.03 * math.sin(a)), 0.022, (x, 0.075, z), 0.014)
        model.sphere(DARK, (x, 0.035, z), 0.035)
    model.cone(STEEL, (0, 0.09, 0), 0.030, (0, 0.42, 0), 0.024)
    model.add(fabric, rounded_box((-0.25, 0.42, -0.24), (0.25, 0.50, 0.25), 0.035, 2))
    model.add(
        fabric, rounded_box((-0.22, 0, -0.03), (0.22, 0.48, 0.03), 0.028, 2).turned("x", -8).moved(0, 0.60, -0.27)
    )
    model.add(DARK, box((-0.03, 0.43, -0.30), (0.03, 0.80, -0.27)))
    for x in (-0.29, 0.26):
        model.add(DARK, box((x, 0.66, -0.12), (x + 0.03, 0.69, 0.14)), box((x, 0.45, -0.02), (x + 0.03, 0.66, 0.02)))
    return model


def side_chair() -> Model:
    """A chair on four legs; whoever sits in it looks to +z."""
    model = Model("side_chair")
    for x in (-0.2, 0.2):
        for z in (-0.2, 0.2):
            model.cone(STEEL, (1.1 * x, 0, 1.1 * z), 0.012, (x, 0.44, z), 0.012)
    model.add(FABRICS[0], rounded_box((-0.23, 0.43, -0.22), (0.23, 0.48, 0.23), 0.02))
    model.add(
        FABRICS[0], rounded_box((-0.22, 0, -0.02), (0.22, 0.30, 0.02), 0.018).turned("x", -10).moved(0, 0.58, -0.22)
    )
    for x in (-0.17, 0.17):
        model.cone(STEEL, (x, 0.44, -0.2), 0.011, (x, 0.80, -0.255), 0.011)
    return model


def shelf(name: str, seed: int) -> Model:
    """Open shelves with binders, 0.9 m wide and 1.95 m high, against a wall behind z = 0."""
    model, random = Model(name), generator(seed)
    for x in (-0.45, 0.43):
        model.add(OAK, box((x, 0, 0), (x + 0.02, 1.95, 0.34)).mapped("y", 0.9, (x, 0)))
    model.add(OAK, grid((-0.43, 0, 0.008), (0.86, 0, 0), (0, 1.95, 0), 2, 4).mapped("y", 0.9))
    for k in range(6):
        y = 0.06 + 0.374 * k
        model.add(OAK, box((-0.43, y, 0.008), (0.43, y + 0.02, 0.33)).mapped("x", 0.9, (0.2 * k, 0)))
        x = -0.42
        while k < 5 and random.random_sample() < 0.93:
            width = 0.035 + 0.045 * random.random_sample()
            if x + width > 0.42:
                break
            height, depth = 0.26 + 0.05 * random.random_sample(), 0.26 + 0.04 * random.random_sample()
            binder = box((x + 0.001, y + 0.02, 0.02), (x + width - 0.001, y + 0.02 + height, depth))
            model.add(BINDERS[int(random.randint(len(BINDERS)))], binder)
            x += width
    return model


def cabinet() -> Model:
    """A low cabinet with two doors, 1.2 m wide, against a wall behind z = 0; its top is at 0.78 m."""
    model = Model("cabinet")
    model.add(WHITE, box((-0.6, 0.06, 0.0), (0.6, 0.76, 0.42)))
    model.add(OAK, rounded_box((-0.62, 0.75, 0.0), (0.62, 0.78, 0.45), 0.006).mapped("x", 0.9))
    for x in (-0.59, 0.005):
        model.add(WHITE, rounded_box((x, 0.09, 0.42), (x + 0.585, 0.74, 0.44), 0.005))
    for x in (-0.05, 0.04):
        model.add(STEEL, box((x, 0.40, 0.44), (x + 0.012, 0.56, 0.455)))
    return model


def plant() -> Model:
    """A pot with arching leaves, 1.2 m high."""
    model, random = Model("office_plant"), generator(911)
    model.add(POT, lathe([(0, 0), (0.13, 0), (0.18, 0.32), (0.165, 0.32)], 14))
    model.add(SOIL, lathe([(0.17, 0.29), (0, 0.29)], 14))
    for k in range(26):
        turn = 137.5 * k
        rise, out = 0.35 + 0.55 * random.random_sample(), 0.14 + 0.30 * random.random_sample()
        model.add(LEAF, leaf(rise, out).moved(0, 0.29, 0).turned("y", turn))
    return model


def leaf(rise: float, out: float, width: float = 0.05) -> Mesh:
    """A leaf that rises from the origin and arches out to +x: three quads."""
    points = [(0.0, 0.0, 0.2), (0.25 * out, 0.6 * rise, 0.8), (0.65 * out, rise, 1.0), (out, 0.92 * rise, 0.15)]
    quads = []
    for (x0, y0, w0), (x1, y1, w1) in itertools.pairwise(points):
        a, b = width * w0, width * w1
        corners = [(x0, y0, -a), (x0, y0, a), (x1, y1, b), (x1, y1, -b)]
        quads.append(flat_quad(corners))
        quads.append(flat_quad(corners[::-1]).moved(0, -0.001, 0))
    return join(quads)


def meeting_table() -> Model:
    """2.4 m x 1.1 m, on two feet; its top is at 0.74 m; it is long in z."""
    model = Model("meeting_table")
    model.add(WALNUT, rounded_box((-0.55, 0.705, -1.2), (0.55, 0.74, 1.2), 0.012, 2).mapped("z", 0.8))
    for z in (-0.7, 0.7):
        model.add(GREY, box((-0.06, 0.04, z - 0.06), (0.06, 0.705, z + 0.06)))
        model.add(GREY, box((-0.40, 0, z - 0.05), (0.40, 0.04, z + 0.05)))
    return model


def whiteboard() -> Model:
    """2 m x 1.1 m on a wall behind z = 0, its centre at the origin."""
    model = Model("whiteboard")
    model.add(matte("whiteboard", (0.93, 0.94, 0.95)), grid((-1.0, -0.55, 0.015), (2.0, 0, 0), (0, 1.1, 0), 4, 2))
    for low, high in (((-1.03, 0.55), (1.03, 0.58)), ((-1.03, -0.58), (1.03, -0.55))):
        model.add(STEEL, box((*low, 0), (*high, 0.03)))
    for x in (-1.03, 1.0):
        model.add(STEEL, box((x, -0.55, 0), (x + 0.03, 0.55, 0.03)))
    model.add(GREY, box((-0.4, -0.60, 0), (0.4, -0.58, 0.09)))
    for k, colour in enumerate((BINDERS[1], BINDERS[0], LEAF)):  # a plot
        heights = (0.18, 0.34, 0.27) if k == 0 else (0.30, 0.12, 0.40) if k == 1 else (0.22, 0.44, 0.16)
        for j, height in enumerate(heights):
            left = -0.75 + 0.32 * j + 0.08 * k
            model.add(colour, grid((left, -0.38, 0.017), (0.07, 0, 0), (0, 1.5 * height, 0)))
    return model


def sofa() -> Model:
    """1.8 m wide, against a wall behind z = 0."""
    model, fabric = Model("sofa"), FABRICS[2]
    model.add(fabric, rounded_box((-0.9, 0.12, 0.05), (0.9, 0.34, 0.85), 0.04, 2))
    model.add(fabric, rounded_box((-0.9, 0.30, 0.05), (0.9, 0.80, 0.26), 0.06, 2))
    for x in (-0.9, 0.72):
        model.add(fabric, rounded_box((x, 0.12, 0.05), (x + 0.18, 0.58, 0.85), 0.05, 2))
    for x in (-0.715, 0.005):
        model.add(fabric, rounded_box((x, 0.33, 0.24), (x + 0.71, 0.46, 0.87), 0.05, 2))
    model.add(
        FABRICS[1], rounded_box((-0.2, -0.2, -0.06), (0.2, 0.2, 0.06), 0.05, 2).turned("x", -22).moved(-0.5, 0.64, 0.36)
    )
    for x in (-0.82, 0.80):
        for z in (0.12, 0.78):
            model.add(DARK, box((x, 0, z), (x + 0.03, 0.13, z + 0.03)))
    return model


def coffee_table() -> Model:
    model = Model("coffee_table")
    model.add(WALNUT, rounded_box((-0.5, 0.36, -0.3), (0.5, 0.40, 0.3), 0.01, 2).mapped("x", 0.9))
    for x in (-0.45, 0.42):
        for z in (-0.26, 0.23):
            model.add(DARK, box((x, 0, z), (x + 0.03, 0.36, z + 0.03)))
    model.add(PAPER, box((-0.15, 0, -0.11), (0.15, 0.02, 0.11)).turned("y", 20).moved(0.18, 0.40, 0.02))
    return model


def framed(name: str, picture: Material, width: float, height: float) -> Model:
    """A picture in a thin frame on a wall behind z = 0, its centre at the origin."""
    model = Model(name)
    x, y = width / 2, height / 2
    model.add(picture, grid((-x, -y, 0.018), (width, 0, 0), (0, height, 0), 2, 2))
    for low, high in (
        ((-x - 0.03, y), (x + 0.03, y + 0.03)),
        ((-x - 0.03, -y - 0.03), (x + 0.03, -y)),
        ((-x - 0.03, -y), (-x, y)),
        ((x, -y), (x + 0.03, y)),
    ):
        model.add(DARK, box((*low, 0), (*high, 0.03)))
    return model


def bin_and_stand() -> Model:
    """A waste-paper bin beside a coat stand."""
    model = Model("bin_and_stand")
    model.cone(GREY, (0.32, 0.005, 0), 0.11, (0.32, 0.32, 0), 0.14)
    model.add(GREY, lathe([(0.11, 0.006), (0, 0.006)], 12).moved(0.32, 0, 0))
    model.cone(STEEL, (0, 0, 0), 0.02, (0, 1.72, 0), 0.016)
    model.add(STEEL, lathe([(0, 0), (0.19, 0), (0.19, 0.015), (0, 0.03)], 16))
    for k in range(4):
        a = math.radians(90 * k + 20)
        model.cone(STEEL, (0, 1.62, 0), 0.010, (0.13 * math.cos(a), 1.74, 0.13 * math.sin(a)), 0.008)
    model.add(FABRICS[0], rounded_box((-0.16, 0.75, 0.06), (0.16, 1.62, 0.15), 0.04))
    return model

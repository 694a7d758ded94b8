"""The courtyard at night: 24 arches around a well and eight firs, under 10,000 coloured bulbs.

It is round: one bay, an arch with the wall above it and the walk behind it, stands 24 times around the centre.  Bulbs
hang on 48 strings from a mast to the cornice, along every arch and beneath the cornice, and wind around the firs.  Each
is a small sphere that glows, and a point light just beyond it, so that a bulb shades what is behind it.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from generate import materials as m
from generate.aff import Colour, Lamp, Material, Model, Point
from generate.images import generator
from generate.mesh import Array, Mesh, lattice
from generate.root import root_file
from generate.shapes import box, flat_quad, grid, lathe, rounded_box
from generate.tracks import Flight

BAYS, FIRS, STRINGS = 24, 8, 48
ON_A_STRING, ON_AN_ARCH, ON_A_CORNICE, ON_A_FIR = 75, 70, 60, 410  # 48 x 75 + 24 x (70 + 60) + 8 x 410 = 10,000
APOTHEM, WALK = 12.0, 3.0  # from the centre to the arches, and from there to the wall behind
HALF = APOTHEM * math.tan(math.pi / BAYS)  # half the width of a bay
SPRING, RADIUS, ARCADE, CORNICE, ROOF = 2.5, 1.18, 4.2, 4.5, 7.4
PIER = 0.45  # how thick the arches are
MAST = 8.2
BULB, BEYOND = 0.026, 0.034  # its radius, and how far from its middle the light is
POWER = 0.020
FIR_AT, FIR_HEIGHT, FIR_RADIUS = 8.3, 4.4, 1.25
AMBIENT = 0.035


def matte(name: str, colour: Colour) -> Material:
    return m.matte(name, colour, AMBIENT)


def dimmed(material: Material, tint: float = 1.0) -> Material:
    """A material of the study at night, without a mirror image."""
    r, g, b = (tint * c for c in material.diffuse)
    return replace(material, diffuse=(r, g, b), ambient=(AMBIENT * r, AMBIENT * g, AMBIENT * b), specular=(0.0,) * 3)


STONE = matte("plaster", (0.72, 0.66, 0.56))
TRIM = matte("sandstone", (0.62, 0.52, 0.40))
VAULT = matte("ceiling of the walk", (0.55, 0.56, 0.60))
BRICK = dimmed(m.BRICK)
PAVING = matte("paving", (0.46, 0.44, 0.42))
PAVING_DARK = matte("dark paving", (0.30, 0.28, 0.28))
MARBLE = dimmed(m.MARBLE)
WATER = Material("water", (0.03, 0.05, 0.06), (0.004, 0.008, 0.01), (0.35, 0.37, 0.38), 40.0)
SHUTTER = matte("shutter", (0.16, 0.30, 0.26))
DOOR = dimmed(m.WALNUT)
PANE = m.glowing("a window behind which nobody is up", (0.020, 0.024, 0.040))
LIT_PANE = m.glowing("a lit window", (0.80, 0.56, 0.24))
NEEDLES = matte("needles", (0.10, 0.26, 0.13))
TRUNK = matte("trunk", (0.26, 0.17, 0.10))
TUB = matte("tub", (0.50, 0.25, 0.14))
WIRE = matte("wire", (0.05, 0.06, 0.05))
WOOD = dimmed(m.OAK)

COLOURS: list[tuple[str, Colour]] = [
    ("warm", (1.0, 0.72, 0.38)),
    ("red", (1.0, 0.16, 0.10)),
    ("green", (0.16, 0.95, 0.28)),
    ("blue", (0.18, 0.36, 1.0)),
    ("amber", (1.0, 0.50, 0.08)),
    ("pink", (1.0, 0.24, 0.62)),
]
GLASS = [m.glowing(f"{name} bulb", colour) for name, colour in COLOURS]


def bulbs(model: Model, points: Array, outward: Array, pattern: list[int], power: float = POWER) -> None:
    """Bulbs at points (n, 3), each with its light on the side of `outward` (n, 3), in colours that repeat."""
    for i, (at, out) in enumerate(zip(points, outward)):
        colour = pattern[i % len(pattern)]
        model.sphere(GLASS[colour], at, BULB)
        r, g, b = (power * c for c in COLOURS[colour][1])
        model.lamps.append(Lamp((at + BEYOND * out / np.linalg.norm(out)).tolist(), (r, g, b)))


def wire(model: Model, points: Array) -> None:
    for a, b in itertools.pairwise(points):
        model.cone(WIRE, a, 0.006, b, 0.006)


def string(name: str, pattern: list[int]) -> Model:
    """From the mast at the origin to the cornice at +x, sagging."""
    model = Model(name)
    end = APOTHEM / math.cos(math.pi / BAYS) - 0.35

    def at(s: Array) -> Array:
        sag = -4 * 0.75 * s * (1 - s)
        return np.stack([0.12 + (end - 0.12) * s, MAST + (CORNICE + 0.35 - MAST) * s + sag, 0 * s], axis=1)

    s = (np.arange(ON_A_STRING) + 0.7) / (ON_A_STRING + 0.4)
    bulbs(model, at(s) - (0, 0.04, 0), np.tile([0.0, -1.0, 0.0], (len(s), 1)), pattern)
    wire(model, at(np.linspace(0, 1, 13)))
    return model


def arch_ring(radius: float, steps: int, z: float) -> Array:
    """(steps + 1, 3): half a circle above the spring, from left to right."""
    a = np.linspace(math.pi, 0, steps + 1)
    return np.stack([radius * np.cos(a), SPRING + radius * np.sin(a), np.full_like(a, z)], axis=1)


def spandrel(z: float, flip: bool) -> Mesh:
    """The wall around an arch, from its spring to the top of the arcade, in the plane of z."""
    steps = 16
    ring = arch_ring(RADIUS, steps, z)
    top = np.stack([np.linspace(-HALF, HALF, steps + 1), np.full(steps + 1, ARCADE), np.full(steps + 1, z)], axis=1)
    top[: steps // 4, 0], top[-(steps // 4) :, 0] = -HALF, HALF
    top[: steps // 4, 1] = np.linspace(SPRING, ARCADE, steps // 4, endpoint=False)
    top[-(steps // 4) :, 1] = top[: steps // 4, 1][::-1]
    rows = np.stack([ring, top])
    mesh = lattice(rows, np.broadcast_to([0.0, 0.0, 1.0], rows.shape), np.zeros((2, steps + 1, 2)))
    return mesh.flipped() if flip else mesh


def bay(lit: bool) -> Model:
    """One side of the courtyard: in its own frame the court lies at +z, the arch in the plane z = 0."""
    model = Model("bay_lit" if lit else "bay")
    back, outer_half = -WALK, (APOTHEM + WALK) * math.tan(math.pi / BAYS)
    model.add(STONE, spandrel(0.0, False), spandrel(-PIER, True))
    ring = [arch_ring(RADIUS, 16, z) for z in (-PIER, 0.0)]
    inward = np.stack([[(-x / RADIUS, -(y - SPRING) / RADIUS, 0) for x, y, _ in r] for r in ring])
    model.add(TRIM, lattice(np.stack(ring), inward, np.zeros((2, 17, 2))))
    rows = np.stack([arch_ring(RADIUS, 16, 0.03), arch_ring(RADIUS + 0.16, 16, 0.03)])
    model.add(TRIM, lattice(rows, np.broadcast_to([0.0, 0.0, 1.0], rows.shape), np.zeros((2, 17, 2))))
    # Half a pier on either side, from the floor to the spring.
    for side in (-1, 1):
        inner, outer = side * RADIUS, side * HALF
        low, high = sorted((inner, outer))
        model.add(TRIM, box((low, 0, -PIER), (high, SPRING, 0)))
        model.add(TRIM, box((min(inner - side * 0.06, outer), SPRING - 0.16, -PIER - 0.05),
                            (max(inner - side * 0.06, outer), SPRING, 0.05)))  # fmt: skip
        model.add(TRIM, box((min(inner - side * 0.05, outer), 0, -PIER - 0.04),
                            (max(inner - side * 0.05, outer), 0.30, 0.04)))  # fmt: skip
    # The walk: paving, ceiling, and a wall of brick with a door or a bench.
    model.add(PAVING_DARK, quad((-HALF, 0, 0), (HALF, 0, 0), (outer_half, 0, back), (-outer_half, 0, back), 3))
    model.add(VAULT, quad((-HALF, ARCADE, 0), (-outer_half, ARCADE, back), (outer_half, ARCADE, back),
                          (HALF, ARCADE, 0), 3))  # fmt: skip
    wall = grid((-outer_half, 0, back), (2 * outer_half, 0, 0), (0, ARCADE, 0), 5, 5)
    model.add(BRICK, wall.mapped("y", 0.8))
    model.add(DOOR if lit else WOOD, *(door() if lit else bench()))
    # The upper floor: cornices, a wall, a window with shutters.
    model.add(TRIM, box((-HALF - 0.03, ARCADE, -0.2), (HALF + 0.03, CORNICE, 0.16)))
    model.add(TRIM, box((-HALF - 0.03, ROOF - 0.25, -0.2), (HALF + 0.03, ROOF, 0.22)))
    w, low, high = 0.5, 5.05, 6.6
    for left, bottom, right, top in ((-HALF, CORNICE, -w, ROOF), (w, CORNICE, HALF, ROOF), (-w, CORNICE, w, low),
                                     (-w, high, w, ROOF)):  # fmt: skip
        columns, rows = max(1, round((right - left) / 0.6)), max(1, round((top - bottom) / 0.6))
        model.add(STONE, grid((left, bottom, 0), (right - left, 0, 0), (0, top - bottom, 0), columns, rows))
    model.add(LIT_PANE if lit else PANE, grid((-w, low, -0.12), (2 * w, 0, 0), (0, high - low, 0)))
    for x in (-w, w - 0.05, -0.02):
        model.add(TRIM, box((x, low, -0.12), (x + 0.05, high, -0.05)))
    model.add(TRIM, box((-w, (low + high) / 2 - 0.02, -0.12), (w, (low + high) / 2 + 0.02, -0.06)))
    model.add(TRIM, box((-w - 0.1, low - 0.1, -0.1), (w + 0.1, low, 0.14)))
    for side in (-1, 1):
        x0, x1 = sorted((side * (w + 0.02), side * (w + 0.5)))
        model.add(SHUTTER, box((x0, low, 0.0), (x1, high, 0.045)))
        for k in range(9):
            y = low + 0.1 + 0.16 * k
            model.add(SHUTTER, box((x0 + 0.05, y, 0.045), (x1 - 0.05, y + 0.06, 0.06)))
    return model


def quad(a: Point, b: Point, c: Point, d: Point, rows: int) -> Mesh:
    """A flat trapezium, counter-clockwise, cut into rows between ab and dc."""
    p = [np.asarray(x, np.float64) for x in (a, b, c, d)]
    s = np.linspace(0, 1, rows + 1)[:, None]
    left, right = p[0] + s * (p[3] - p[0]), p[1] + s * (p[2] - p[1])
    points = np.stack([left, (left + right) / 2, right], axis=1)
    normal = np.cross(p[1] - p[0], p[3] - p[0])
    normals = np.broadcast_to(normal / np.linalg.norm(normal), points.shape)
    return lattice(points, normals, np.zeros((*points.shape[:2], 2)))


def door() -> list[Mesh]:
    """A door in the wall of the walk."""
    leaf = [rounded_box((-0.55, 0, -WALK), (0.55, 2.3, -WALK + 0.06), 0.01).mapped("y", 0.7)]
    leaf += [rounded_box((x, y, -WALK + 0.05), (x + 0.42, y + 0.9, -WALK + 0.08), 0.01).mapped("y", 0.7, (x, y))
             for x in (-0.48, 0.06) for y in (0.15, 1.2)]  # fmt: skip
    return leaf


def bench() -> list[Mesh]:
    """A bench along the wall of the walk."""
    planks = [box((-0.8, 0.42, -WALK + 0.12 + 0.13 * k), (0.8, 0.46, -WALK + 0.23 + 0.13 * k)) for k in range(3)]
    planks += [box((-0.8, 0.55 + 0.15 * k, -WALK + 0.06), (0.8, 0.66 + 0.15 * k, -WALK + 0.09)) for k in range(2)]
    legs = [box((x, 0, -WALK + 0.06), (x + 0.06, 0.42, -WALK + 0.48)) for x in (-0.65, 0.59)]
    return [part.mapped("x", 0.9) for part in (*planks, *legs)]


def garland(name: str, shift: int) -> Model:
    """The bulbs of a bay: around its arch, and in two swags beneath the cornice."""
    model = Model(name)
    a = np.linspace(math.pi + 0.55, -0.55, ON_AN_ARCH)  # a little further than the half circle, down the piers
    radius = RADIUS + 0.08
    x = np.where(np.sin(a) > 0, radius * np.cos(a), np.sign(np.cos(a)) * radius)
    y = np.where(np.sin(a) > 0, SPRING + radius * np.sin(a), SPRING + 1.3 * np.sin(a))
    arch = np.stack([x, y, np.full_like(a, 0.10)], axis=1)
    order = [0, 4] if shift == 0 else [0, 5] if shift == 1 else [0, 3]
    bulbs(model, arch, np.tile([0.0, 0.0, 1.0], (len(a), 1)), order)
    s = np.linspace(-1, 1, ON_A_CORNICE)
    swag = np.stack(
        [0.955 * HALF * s, CORNICE - 0.14 - 0.30 * np.abs(np.sin(math.pi * s)), np.full_like(s, 0.21)], axis=1
    )
    bulbs(model, swag, np.tile([0.0, -0.3, 1.0], (len(s), 1)), [0, 1, 2, 3, 4, 5][shift:] + [0, 1, 2, 3, 4, 5][:shift])
    wire(model, swag[:: (ON_A_CORNICE - 1) // 6] + np.array([0, 0.035, -0.01]))
    return model


def fir() -> Model:
    """A fir in a tub: seven skirts of needles around a trunk."""
    model, random = Model("fir"), generator(1225)
    model.add(TUB, lathe([(0, 0), (0.40, 0), (0.50, 0.5), (0.46, 0.5), (0.44, 0.44), (0, 0.44)], 18))
    model.cone(TRUNK, (0, 0.4, 0), 0.09, (0, FIR_HEIGHT, 0), 0.015)
    skirts = 9
    for k in range(skirts):
        low = 0.75 + (FIR_HEIGHT - 1.0) * k / skirts
        reach = fir_radius(low)
        high = low + 0.95 * (1 - 0.45 * k / skirts)
        points = 2 * (17 - k)
        turn = 2 * math.pi * random.random_sample()
        rim = []
        for j in range(points + 1):
            a = turn + 2 * math.pi * (j % points) / points
            r = reach * (1.0 if j % 2 == 0 else 0.80)
            y = low - (0.10 if j % 2 == 0 else -0.06)
            rim.append((r * math.cos(a), y, -r * math.sin(a)))
        top = np.tile([0.0, min(high, FIR_HEIGHT), 0.0], (points + 1, 1))
        under = np.tile([0.0, low + 0.22, 0.0], (points + 1, 1))
        for rows in (np.stack([np.array(rim), top]), np.stack([under, np.array(rim)])):
            cloth = lattice(rows, np.zeros((2, points + 1, 3)), np.zeros((2, points + 1, 2)))
            model.add(NEEDLES, cloth.flat())
    return model


def fir_radius(y: float | Array) -> float | Array:
    return FIR_RADIUS * (FIR_HEIGHT - y) / (FIR_HEIGHT - 0.7)


def fir_lights(name: str, pattern: list[int]) -> Model:
    """Bulbs in a spiral around a fir, evenly along it, with a star of them on its top."""
    model = Model(name)
    s = np.linspace(0, 1, 4000)
    y = 0.85 + (FIR_HEIGHT - 0.95) * s
    r = 1.02 * fir_radius(y) + 0.03
    a = 2 * math.pi * 11 * s
    path = np.stack([r * np.cos(a), y, r * np.sin(a)], axis=1)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    where = np.interp(np.linspace(0, along[-1], ON_A_FIR), along, s)
    at = np.stack([np.interp(where, s, path[:, k]) for k in range(3)], axis=1)
    bulbs(model, at, at * (1, 0, 1) + (0, 0.1, 0), pattern)
    return model


def well() -> Model:
    """The well in the middle, and the mast that carries the strings."""
    model = Model("well")
    wall = [(1.9, 0), (1.9, 0.12), (1.55, 0.12), (1.50, 0.55), (1.62, 0.60), (1.62, 0.68), (1.30, 0.68), (1.30, 0.20)]
    model.add(MARBLE, lathe(wall, 40).mapped("y", 0.7))
    model.add(WATER, lathe([(1.31, 0.52), (0, 0.52)], 40))
    bowl = [(0.34, 0.2), (0.30, 0.7), (0.16, 0.9), (0.14, 1.3), (0.70, 1.52), (0.74, 1.60), (0.66, 1.60), (0.10, 1.46)]
    model.add(MARBLE, lathe(bowl, 28).mapped("y", 0.9))
    model.cone(WOOD, (0, 1.4, 0), 0.09, (0, MAST + 0.1, 0), 0.06)
    model.sphere(GLASS[0], (0, MAST + 0.32, 0), 0.2)
    return model


def paving() -> Model:
    """Rings of paving stones, every other one dark in two of them."""
    model = Model("paving")
    radii = np.linspace(1.7, APOTHEM / math.cos(math.pi / BAYS), 13)
    sides = 2 * BAYS
    for k, (inner, outer) in enumerate(itertools.pairwise(radii)):
        for j in range(sides):
            a, b = 2 * math.pi * (j - 0.5) / sides, 2 * math.pi * (j + 0.5) / sides
            corners = [
                (r * math.cos(t), 0.0, -r * math.sin(t)) for r, t in ((inner, a), (outer, a), (outer, b), (inner, b))
            ]
            dark = k in (3, 10) or (k in (4, 9) and j % 2 == 0)
            model.add(PAVING_DARK if dark else PAVING, flat_quad(corners))
    return model


def courtyard() -> Model:
    court, random = Model("courtyard"), generator(10_000)
    court.place(paving())
    court.place(well())
    bays = [bay(False), bay(True)]
    garlands = [garland(f"garland_{k}", k) for k in range(3)]
    lit = random.permutation(np.arange(BAYS) < BAYS // 3)
    for k in range(BAYS):
        turn = 360 * k / BAYS
        a = math.radians(turn)
        at = (-APOTHEM * math.sin(a), 0, -APOTHEM * math.cos(a))
        court.place(bays[int(lit[k])], at, turn)
        court.place(garlands[k % 3], at, turn)
    strings = [string(f"string_{k}", p) for k, p in enumerate(([0, 1, 0, 2, 0, 3], [0, 4, 0, 5], [3, 0, 2, 0, 1, 4]))]
    for k in range(STRINGS):
        court.place(strings[k % 3], (0, 0, 0), 360 * (k + 0.5) / STRINGS)
    tree = fir()
    around = [fir_lights("fir_lights_warm", [0, 0, 4]), fir_lights("fir_lights_bright", [1, 0, 2, 3, 5])]
    for k in range(FIRS):
        a = 2 * math.pi * (k + 0.5) / FIRS
        at = (FIR_AT * math.cos(a), 0, -FIR_AT * math.sin(a))
        court.place(tree, at, 47 * k)
        court.place(around[k % 2], at, 47 * k)
    return court


FRAMES = 300


def waypoints() -> list[tuple[float, tuple[float, float, float], tuple[float, float, float]]]:
    """Along the walk behind the arches, out into the court, once around the well, and back."""

    def at(degrees: float, radius: float, height: float) -> tuple[float, float, float]:
        a = math.radians(degrees)
        return radius * math.cos(a), height, -radius * math.sin(a)

    # Arches are at -135 and -90 degrees, and between the two firs on either side of each there is room to walk.
    way = [(0.0, at(-135, 13.4, 1.65), at(-105, 11.0, 2.0))]
    way += [(3.5, at(-124, 13.4, 1.65), at(-90, 12.6, 1.9)), (7.0, at(-108, 13.4, 1.65), at(-84, 10.5, 1.9))]
    way += [(10.0, at(-93, 13.0, 1.65), at(-70, 3.0, 2.2)), (12.5, at(-90, 11.2, 1.65), at(90, 2.0, 2.4))]
    way += [(16.5, at(-88, 7.2, 1.65), at(45, 6.0, 2.5))]
    for k in range(12):  # around the well, rising and sinking again
        angle = -72 + 25 * k
        rise = 1.3 * math.sin(math.pi * k / 11) ** 2
        way.append((19.5 + 2.6 * k, at(angle, 5.3, 1.65 + rise), at(angle + 85, 8.5, 2.5 - 0.6 * rise)))
    way += [(51.5, at(223, 7.2, 1.65), at(225, 12.5, 1.9)), (55.0, at(225, 11.2, 1.65), at(232, 15.0, 1.8))]
    way.append((60.0, at(225, 13.4, 1.65), at(255, 11.0, 2.0)))
    return way


def text(folder: str) -> str:
    """The root file; everything else is included from `folder`."""
    comments = (
        "A courtyard at night under 10,000 coloured bulbs.  Written by assets/make_scenes.py.",
        "Every bulb is a point light that falls off with the square of the distance; a walk of 300 frames.",
    )
    return root_file(comments, (0.012, 0.016, 0.035), 60.0, f"{folder}/courtyard.aff", Flight(waypoints()), FRAMES)

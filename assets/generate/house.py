"""The shell of the room: floor, walls with panels, ceiling with beams, the window and what lies behind it.

The room is 6.4 m along x, 5.2 m along z and 2.9 m high; the window is in the wall z = 0.  Large
surfaces are cut into quads of a third to half a metre, the grain at which shadows are classified.
"""

from __future__ import annotations

import math

import numpy as np

from generate import materials as m
from generate.aff import Model
from generate.mesh import Mesh, join
from generate.shapes import box, grid, lathe, rounded_box, sheet, tube

WIDTH, DEPTH, HEIGHT = 6.4, 5.2, 2.9
RAIL = 0.95
WINDOW = (2.3, 0.95, 4.1, 2.42)  # left, bottom, right, top in the wall z = 0
REVEAL = 0.22

WALLS = {  # length, then where the wall's own left end stands and how it is turned
    "north": (WIDTH, (0.0, 0.0, 0.0), 0.0),
    "south": (WIDTH, (WIDTH, 0.0, DEPTH), 180.0),
    "west": (DEPTH, (0.0, 0.0, DEPTH), 90.0),
    "east": (DEPTH, (WIDTH, 0.0, 0.0), -90.0),
}


def on_wall(mesh: Mesh, wall: str) -> Mesh:
    """From a wall's own frame (x along it from the left, y up, z into the room) to the room's."""
    _, at, turn = WALLS[wall]
    return mesh.turned("y", turn).moved(*at)


def patch(left: float, low: float, right: float, high: float, quad: float = 0.4) -> Mesh:
    """A piece of wall in the wall's frame, cut into quads of about a size."""
    columns, rows = max(1, round((right - left) / quad)), max(1, round((high - low) / quad))
    return grid((left, low, 0), (right - left, 0, 0), (0, high - low, 0), columns, rows)


def shell() -> Model:
    """Floor, walls and ceiling, with panels, rails and beams."""
    model = Model("shell")
    floor = grid((0, 0, DEPTH), (WIDTH, 0, 0), (0, 0, -DEPTH), 26, 21)
    model.add(m.PARQUET, floor.mapped("z", 1 / 0.72))
    model.add(m.CEILING, grid((0, HEIGHT, 0), (WIDTH, 0, 0), (0, 0, DEPTH), 16, 13))
    for wall, (length, _, _) in WALLS.items():
        model.add(m.PAINT, on_wall(patch(0, 0, length, RAIL, 0.32), wall))
        pieces = [(0.0, RAIL, length, HEIGHT)]
        if wall == "north":
            left, _, right, top = WINDOW
            pieces = [(0, RAIL, left, HEIGHT), (right, RAIL, length, HEIGHT), (left, top, right, HEIGHT)]
        papered = join([patch(*piece) for piece in pieces])
        model.add(m.WALLPAPER, on_wall(papered.mapped("y", 1 / 0.8), wall))
        trim = [
            rounded_box((0, 0, 0), (length, 0.13, 0.022), 0.008),
            rounded_box((0, RAIL - 0.03, 0), (length, RAIL + 0.03, 0.03), 0.012, 2),
            rounded_box((0, HEIGHT - 0.09, 0), (length, HEIGHT, 0.07), 0.03, 2),
        ]
        panels = round(length / 0.64)
        step = length / panels
        for i in range(panels + 1):
            x = min(max(i * step, 0.04), length - 0.04)
            trim.append(rounded_box((x - 0.04, 0.13, 0), (x + 0.04, RAIL - 0.03, 0.014), 0.006))
        model.add(m.TRIM, *[on_wall(piece, wall) for piece in trim])
    for z in (0.65, 1.95, 3.25, 4.55):
        low, high, half = HEIGHT - 0.17, HEIGHT, 0.075
        faces = [
            grid((0, low, z - half), (WIDTH, 0, 0), (0, 0, 2 * half), 14),
            grid((0, low, z + half), (WIDTH, 0, 0), (0, high - low, 0), 14),
            grid((WIDTH, low, z - half), (-WIDTH, 0, 0), (0, high - low, 0), 14),
        ]
        model.add(m.BEAM, join(faces).mapped("x", 1.3, (z, z)))
    return model


def window() -> Model:
    """The opening with its bars and sill.  It has no panes: glass is opaque to lights, and the sun is to come in."""
    model = Model("window")
    left, bottom, right, top = WINDOW
    width, height = right - left, top - bottom
    model.add(
        m.TRIM,
        grid((left, bottom, 0), (0, 0, -REVEAL), (0, height, 0), 1, 4),
        grid((right, bottom, -REVEAL), (0, 0, REVEAL), (0, height, 0), 1, 4),
        grid((left, top, -REVEAL), (width, 0, 0), (0, 0, REVEAL), 5, 1),
        grid((left, bottom, 0), (width, 0, 0), (0, 0, -REVEAL), 5, 1),
    )
    depth = (-0.15, -0.10)
    bars = [
        ((left, bottom), (left + 0.05, top)),
        ((right - 0.05, bottom), (right, top)),
        ((left, top - 0.05), (right, top)),
        ((left, bottom), (right, bottom + 0.05)),
    ]
    bars += [((left + width * k / 4 - 0.014, bottom), (left + width * k / 4 + 0.014, top)) for k in (1, 3)]
    bars += [((left + width / 2 - 0.03, bottom), (left + width / 2 + 0.03, top))]
    bars += [((left, bottom + height * k / 3 - 0.014), (right, bottom + height * k / 3 + 0.014)) for k in (1, 2)]
    for i, ((x0, y0), (x1, y1)) in enumerate(bars):
        inset = 0.0008 * i  # crossing bars do not share a plane
        model.add(m.TRIM, rounded_box((x0, y0, depth[0] + inset), (x1, y1, depth[1] - inset), 0.006))
    model.add(
        m.MARBLE,
        rounded_box((left - 0.08, bottom - 0.035, -0.08), (right + 0.08, bottom + 0.004, 0.10), 0.012, 2).mapped(
            "x", 1.5
        ),
    )
    casing = [
        ((left - 0.09, bottom, 0), (left, top + 0.09, 0.028)),
        ((right, bottom, 0), (right + 0.09, top + 0.09, 0.028)),
        ((left, top, 0), (right, top + 0.09, 0.028)),
    ]
    model.add(m.TRIM, *[rounded_box(low, high, 0.008) for low, high in casing])
    return model


def curtains() -> Model:
    """Two tied curtains on a brass rod."""
    model = Model("curtains")
    left, _, right, _ = WINDOW
    rod = 2.66
    for side, edge in ((-1, left), (1, right)):
        rows, columns = 10, 54
        points = np.empty((rows + 1, columns + 1, 3))
        for i in range(rows + 1):
            y = 0.10 + (rod - 0.03 - 0.10) * i / rows
            tied = math.exp(-(((y - 1.15) / 0.42) ** 2))
            width = 0.62 * (1 - 0.58 * tied)
            fold = 0.042 * (1 - 0.45 * tied)
            for j in range(columns + 1):
                s = j / columns
                outer = edge + side * 0.46
                x = outer + width * s if side < 0 else outer - width * (1 - s)
                wave = math.sin(s * 2 * math.pi * 9) + 0.3 * math.sin(s * 2 * math.pi * 4 + 1 + y)
                points[i, j] = (x, y, 0.135 + fold * wave)
        model.add(m.CURTAIN, sheet(points))
        band_x = edge + side * 0.46 - side * 0.13
        ring = [(band_x + 0.15 * math.cos(a), 1.15 + 0.02 * math.cos(a), 0.135 + 0.062 * math.sin(a))
                for a in np.linspace(0, 2 * math.pi, 25)]  # fmt: skip
        model.add(m.GOLD, tube(ring, 0.012, 6))
    model.cone(m.BRASS, (left - 0.58, rod, 0.135), 0.014, (right + 0.58, rod, 0.135), 0.014)
    for x in (left - 0.60, right + 0.60):
        model.sphere(m.BRASS, (x, rod, 0.135), 0.034)
        inner = x + 0.05 if x < left else x - 0.05
        model.add(m.BRASS, box((inner - 0.01, rod - 0.01, 0), (inner + 0.01, rod + 0.01, 0.13)))
    return model


def garden() -> Model:
    """A curved picture behind the window, low enough for the sun to clear it; above it is the background's sky."""
    model = Model("garden")
    radius, columns, rows = 5.2, 30, 4
    centre = (WINDOW[0] + WINDOW[2]) / 2
    angles = np.radians(np.linspace(-90, 90, columns + 1))
    points = np.empty((rows + 1, columns + 1, 3))
    points[..., 0] = centre + radius * np.sin(angles)
    points[..., 1] = np.linspace(-0.40, 3.65, rows + 1)[:, None]
    points[..., 2] = -0.3 - radius * np.cos(angles) * 0.8
    whole = sheet(points)
    u = (whole.uvs[..., 0] - 0.5) * 180 / 108  # the middle 108 degrees hold the picture, the rest its mirror image
    whole.uvs[..., 0] = 0.5 + np.where(np.abs(u) > 0.5, np.sign(u) - u, u)
    model.add(m.GARDEN, whole)
    return model


def door() -> Model:
    """A panelled door with its casing, in a wall's frame, x from 0 to 0.9."""
    model = Model("door")
    model.add(m.MAHOGANY, box((0, 0, 0), (0.9, 2.05, 0.035)).mapped("y", 1.2))
    for x in (0.10, 0.50):
        for foot, head in ((0.18, 0.85), (1.00, 1.90)):
            model.add(
                m.MAHOGANY, rounded_box((x, foot, 0.03), (x + 0.30, head, 0.052), 0.015, 2).mapped("y", 1.2, (0.3, 0))
            )
    for low, high in (
        ((-0.10, 0, 0), (0, 2.15, 0.05)),
        ((0.9, 0, 0), (1.0, 2.15, 0.05)),
        ((0, 2.05, 0), (0.9, 2.15, 0.05)),
    ):
        model.add(m.TRIM, rounded_box(low, high, 0.01))
    knob = lathe([(0, 0), (0.028, 0), (0.028, 0.006), (0.010, 0.012), (0.010, 0.03)], 16)
    model.add(m.BRASS, knob.turned("x", 90).moved(0.83, 1.02, 0.035))
    model.sphere(m.BRASS, (0.83, 1.02, 0.082), 0.027)
    return model


def fireplace() -> Model:
    """A brick breast with a marble surround and a fire, in a wall's frame around x = 0."""
    model = Model("fireplace")
    front, half, hole, top = 0.36, 0.78, 0.40, 0.74
    brick = [
        grid((-half, 0, front), (half - hole, 0, 0), (0, top, 0), 1, 3),
        grid((hole, 0, front), (half - hole, 0, 0), (0, top, 0), 1, 3),
        grid((-half, top, front), (2 * half, 0, 0), (0, HEIGHT - top, 0), 5, 7),
        grid((-half, 0, 0), (0, 0, front), (0, HEIGHT, 0), 1, 8),
        grid((half, 0, front), (0, 0, -front), (0, HEIGHT, 0), 1, 8),
    ]
    model.add(m.BRICK, *[piece.mapped("y", 1 / 0.62) for piece in brick])
    hearth = [
        grid((-hole, 0, 0.03), (2 * hole, 0, 0), (0, top, 0), 3, 3),
        grid((-hole, 0, front), (0, 0, 0.03 - front), (0, top, 0), 2, 3),
        grid((hole, 0, 0.03), (0, 0, front - 0.03), (0, top, 0), 2, 3),
        grid((-hole, top, 0.03), (2 * hole, 0, 0), (0, 0, front - 0.03), 3, 1),
        grid((-hole, 0.012, front), (2 * hole, 0, 0), (0, 0, 0.03 - front), 3, 1),
    ]
    model.add(m.SOOT, *hearth)
    marble = [rounded_box((-0.92, 0, front), (0.92, 0.035, 0.88), 0.012, 2)]
    for x in (-0.53, 0.53):
        marble += [
            rounded_box((x - 0.125, 0.03, front - 0.02), (x + 0.125, 0.14, front + 0.10), 0.008),
            rounded_box((x - 0.105, 0.13, front - 0.02), (x + 0.105, 0.99, front + 0.075), 0.012, 2),
            rounded_box((x - 0.125, 0.95, front - 0.02), (x + 0.125, 1.03, front + 0.10), 0.008),
        ]
        marble += [
            tube([(x + dx, 0.17, front + 0.075), (x + dx, 0.91, front + 0.075)], 0.014, 8) for dx in (-0.06, 0, 0.06)
        ]
    marble += [
        rounded_box((-0.66, top + 0.02, front - 0.02), (0.66, 1.0, front + 0.062), 0.01, 2),
        rounded_box((-0.80, 1.03, front - 0.02), (0.80, 1.075, front + 0.16), 0.015, 2),
        rounded_box((-0.86, 1.07, front - 0.02), (0.86, 1.115, front + 0.21), 0.018, 2),
    ]
    model.add(m.MARBLE, *[piece.mapped("y", 1.4) for piece in marble])
    for x, y, z, tilt, radius in (
        (-0.01, 0.11, 0.14, 4, 0.048),
        (0.03, 0.11, 0.26, -6, 0.043),
        (0.0, 0.185, 0.20, 14, 0.040),
    ):
        dx, dz = 0.24 * math.cos(math.radians(tilt)), 0.24 * math.sin(math.radians(tilt))
        model.add(m.BARK, tube([(x - dx, y, z - dz), (x, y + 0.006, z), (x + dx, y, z + dz)], radius, 10))
    for x in (-0.2, 0.0, 0.2):
        model.add(m.IRON, tube([(x, 0.055, 0.06), (x, 0.05, 0.32), (x, 0.12, 0.335)], 0.010, 6))
        model.sphere(m.IRON, (x, 0.135, 0.335), 0.018)
    for x, z, height, radius in (
        (-0.15, 0.19, 0.20, 0.045), (-0.06, 0.17, 0.33, 0.060), (0.05, 0.20, 0.27, 0.055), (0.15, 0.18, 0.18, 0.042),
        (0.0, 0.14, 0.24, 0.05),
    ):  # fmt: skip
        rows = [(0.0, 0.0), (0.7, 0.10), (1.0, 0.26), (0.82, 0.46), (0.48, 0.68), (0.18, 0.88), (0.0, 1.0)]
        flame = lathe([(radius * r, height * h) for r, h in rows], 12, 80)
        bend = flame.corners.copy()
        bend[..., 0] += 0.03 * np.sin(8 * bend[..., 1] + 20 * x) * bend[..., 1] / height
        model.add(m.FLAME, Mesh(bend, flame.normals, flame.uvs).moved(x, 0.13, z))
    for k in range(14):
        x, z = 0.26 * math.sin(k * 2.4), 0.19 + 0.09 * math.cos(k * 1.7)
        model.sphere(m.EMBER, (x, 0.03, z), 0.022 + 0.008 * math.sin(k * 5.0))
    return model

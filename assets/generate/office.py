"""The office: 64 furnished rooms along four corridors, lit by 256 ceiling panels of 16 samples each.

All measures are multiples of a ceiling tile, 0.6 m.  A room is 7 tiles wide (x) and 9 deep (z); its door is in the
wall z = DEPTH, and a room whose corridor is on the other side is turned half about.  Corridors run along x between two
rows of rooms, and two more along z join their ends.  Panels lie in the ceiling, in recesses whose rims keep their light
from the ceiling and, like walls and shut doors, from all that is further away.
"""

from __future__ import annotations

import numpy as np

from generate import materials as m
from generate import office_things as things
from generate.aff import Colour, Lamp, Model
from generate.images import generator
from generate.mesh import Mesh
from generate.office_things import GREY, STEEL, matte
from generate.root import root_file
from generate.shapes import box, grid
from generate.tracks import Flight

TILE = 0.6
COLUMNS, ROWS = 8, 8  # of rooms
ACROSS, DEEP, WALK = 7, 9, 4  # tiles: of a room, and across a corridor
WIDTH, DEPTH, AISLE, HEIGHT = ACROSS * TILE, DEEP * TILE, WALK * TILE, 2.7
WALL, RECESS, MARGIN = 0.06, 0.06, 0.06
WALL_PIECE = 6.0  # about: a side of the rectangles that walls are cut into
DOOR = (2.9, 3.85, 2.1)  # left, right, height in the wall of the corridor
SAMPLES = 16
OPEN_DOORS = 36

TINTS: dict[str, Colour] = {"warm": (1.0, 0.86, 0.68), "neutral": (1.0, 0.95, 0.87), "cool": (0.86, 0.94, 1.0)}
ROOM_POWER, CORRIDOR_POWER = 1.5, 1.6

WALLS = matte("white walls", (0.80, 0.79, 0.76))
CEILING = matte("ceiling tiles", (0.84, 0.84, 0.82), 0.42)
SKIRTING = matte("skirting", (0.36, 0.37, 0.38))
CARPETS = [matte("grey carpet", (0.33, 0.34, 0.36)), matte("blue carpet", (0.20, 0.26, 0.36))]
LINOLEUM = [matte("light linoleum", (0.62, 0.58, 0.50)), matte("dark linoleum", (0.40, 0.38, 0.35))]
PANEL = m.glowing("ceiling panel", (1.0, 0.98, 0.94))
RIM = matte("rim of a panel", (0.9, 0.9, 0.9), 0.6)
DOOR_LEAF = things.dimmed(m.OAK)
ACCENTS = [
    matte("sea green wall", (0.32, 0.50, 0.48)),
    matte("ochre wall", (0.72, 0.54, 0.28)),
    matte("terracotta wall", (0.62, 0.34, 0.25)),
    matte("blue wall", (0.28, 0.38, 0.54)),
    matte("light grey wall", (0.66, 0.67, 0.68)),
]


def ceiling(model: Model, columns: int, rows: int, panels: list[tuple[int, int, int, int]], power: Colour) -> None:
    """Tiles from the origin on, but for panels (column, row, columns, rows) in recesses, each of them a lamp."""
    covered = {(c + i, r + j) for c, r, w, d in panels for i in range(w) for j in range(d)}
    tiles = [
        grid((c * TILE, HEIGHT, r * TILE), (TILE, 0, 0), (0, 0, TILE))
        for r in range(rows)
        for c in range(columns)
        if (c, r) not in covered
    ]
    model.add(CEILING, *tiles)
    for c, r, w, d in panels:
        x0, z0, x1, z1 = c * TILE, r * TILE, (c + w) * TILE, (r + d) * TILE
        top = HEIGHT + RECESS
        model.add(PANEL, grid((x0, top, z0), (x1 - x0, 0, 0), (0, 0, z1 - z0)))
        model.add(
            RIM,
            grid((x0, HEIGHT, z0), (x1 - x0, 0, 0), (0, RECESS, 0)),
            grid((x1, HEIGHT, z1), (x0 - x1, 0, 0), (0, RECESS, 0)),
            grid((x0, HEIGHT, z1), (0, 0, z0 - z1), (0, RECESS, 0)),
            grid((x1, HEIGHT, z0), (0, 0, z1 - z0), (0, RECESS, 0)),
        )
        edges = ((x1 - x0 - 2 * MARGIN, 0, 0), (0, 0, z1 - z0 - 2 * MARGIN))
        model.lamps.append(Lamp(((x0 + x1) / 2, HEIGHT + RECESS / 2, (z0 + z1) / 2), power, edges, SAMPLES))


def facing(wall: str, left: float, low: float, right: float, high: float, at: float) -> Mesh:
    """A piece of wall at x or z = `at` that faces +x, -x, +z or -z; left and right are as its beholder sees them."""
    columns, rows = max(1, round(abs(right - left) / WALL_PIECE)), max(1, round((high - low) / WALL_PIECE))
    origin, along = (
        ((left, low, at), (right - left, 0, 0)) if wall[1] == "z" else ((at, low, left), (0, 0, right - left))
    )
    return grid(origin, along, (0, high - low, 0), columns, rows)


def shell() -> Model:
    """A room without its accent wall, its door and its lamps: floor, walls on both sides, the door's frame."""
    model = Model("shell")
    x0, x1, z0, z1 = WALL, WIDTH - WALL, WALL, DEPTH - 2 * WALL
    left, right, top = DOOR
    model.add(CARPETS[0], grid((0, 0, DEPTH), (WIDTH, 0, 0), (0, 0, -DEPTH), 6, 8))
    model.add(
        WALLS,
        facing("+x", z1, 0, z0, HEIGHT, x0),
        facing("-x", z0, 0, z1, HEIGHT, x1),
        facing("-z", x1, 0, right, HEIGHT, z1),
        facing("-z", right, top, left, HEIGHT, z1),
        facing("-z", left, 0, x0, HEIGHT, z1),
        facing("+z", 0, 0, left, HEIGHT, DEPTH),
        facing("+z", left, top, right, HEIGHT, DEPTH),
        facing("+z", right, 0, WIDTH, HEIGHT, DEPTH),
    )
    model.add(
        SKIRTING,
        box((x0, 0, z0), (x0 + 0.012, 0.08, z1)),
        box((x1 - 0.012, 0, z0), (x1, 0.08, z1)),
        box((x0, 0, z0), (x1, 0.08, z0 + 0.012)),
        box((0, 0, DEPTH), (left - 0.05, 0.08, DEPTH + 0.012)),
        box((right + 0.05, 0, DEPTH), (WIDTH, 0.08, DEPTH + 0.012)),
    )
    for low, high in (((left - 0.05, 0), (left, top)), ((right, 0), (right + 0.05, top)),
                      ((left - 0.05, top), (right + 0.05, top + 0.05))):  # fmt: skip
        model.add(GREY, box((*low, z1 - 0.012), (*high, DEPTH + 0.016)))
    model.add(STEEL, box((left - 0.32, 1.5, DEPTH), (left - 0.14, 1.62, DEPTH + 0.008)))
    model.add(things.BINDERS[2], grid((left - 0.30, 1.52, DEPTH + 0.009), (0.08, 0, 0), (0, 0.08, 0)))
    return model


def accent() -> Model:
    """The wall opposite the door, in the material of whoever places it."""
    model = Model("accent")
    model.shape(facing("+z", WALL, 0, WIDTH - WALL, HEIGHT, WALL))
    return model


def stripe() -> Model:
    """A stripe along the corridor's wall of a room, in the material of whoever places it."""
    model = Model("stripe")
    left, right, _ = DOOR
    for x0, x1 in ((0, left - 0.05), (right + 0.05, WIDTH)):
        model.shape(grid((x0, 0.98, DEPTH + 0.004), (x1 - x0, 0, 0), (0, 0.16, 0), max(1, round((x1 - x0) / 0.7))))
    return model


def door() -> Model:
    """A door's leaf, its hinge at the origin, shut towards -x."""
    model = Model("door")
    width = DOOR[1] - DOOR[0] - 0.02
    model.add(DOOR_LEAF, box((-width, 0.005, -0.02), (-0.005, DOOR[2] - 0.01, 0.02)).mapped("y", 0.8))
    for z in (-0.06, 0.05):
        model.add(STEEL, box((-width + 0.05, 1.03, z), (-width + 0.17, 1.05, z + 0.01)))
    model.add(STEEL, box((-width + 0.05, 1.03, -0.06), (-width + 0.07, 1.05, 0.06)))
    return model


def light(tint: str) -> Model:
    """The ceiling of a room with its three panels."""
    model = Model(f"ceiling_{tint}")
    r, g, b = (ROOM_POWER * c for c in TINTS[tint])
    ceiling(model, ACROSS, DEEP, [(3, 1, 1, 1), (3, 4, 1, 1), (3, 7, 1, 1)], (r, g, b))
    return model


def layouts() -> list[Model]:
    """Furnished rooms, each without its walls; the door's way in is free in all of them."""
    chair = [things.swivel_chair(f"chair_{k}", fabric) for k, fabric in enumerate(things.FABRICS)]
    shelves = [things.shelf(f"shelf_{k}", 920 + k) for k in range(3)]
    desk, cabinet, plant, side, stand = (
        things.desk(), things.cabinet(), things.plant(), things.side_chair(), things.bin_and_stand()
    )  # fmt: skip
    pictures = [
        things.framed("picture_sea", things.PICTURES[0], 1.2, 0.84),
        things.framed("picture_parts", things.PICTURES[1], 0.9, 0.9),
        things.framed("picture_moon", things.PICTURES[2], 0.7, 0.9),
    ]
    west, east, south = 90.0, -90.0, 180.0

    single = Model("room_single")
    single.place(desk, (1.9, 0, 1.75), south)
    single.place(chair[0], (1.9, 0, 0.95), 8)
    single.place(side, (1.45, 0, 2.75), 190)
    single.place(side, (2.35, 0, 2.80), 165)
    for k in range(2):
        single.place(shelves[k], (WALL + 0.01, 0, 2.6 + 0.92 * k), west)
    single.place(cabinet, (WIDTH - WALL - 0.01, 0, 1.2), east)
    single.place(pictures[0], (2.0, 1.62, WALL))
    single.place(plant, (0.45, 0, 0.5))
    single.place(stand, (0.45, 0, 4.85))

    double = Model("room_double")
    double.place(desk, (1.45, 0, 2.30), south)
    double.place(desk, (1.45, 0, 3.12))
    double.place(chair[1], (1.40, 0, 1.45), -12)
    double.place(chair[1], (1.50, 0, 3.95), 170)
    double.place(shelves[2], (0.75, 0, WALL + 0.01))
    double.place(shelves[0], (1.67, 0, WALL + 0.01))
    double.place(cabinet, (WIDTH - WALL - 0.01, 0, 1.6), east)
    double.place(pictures[1], (WIDTH - WALL, 1.60, 1.6), east)
    double.place(plant, (3.70, 0, 0.5), 40)

    meeting = Model("room_meeting")
    meeting.place(things.meeting_table(), (1.75, 0, 2.35))
    for k in range(3):
        meeting.place(side, (0.95, 0, 1.55 + 0.8 * k), west + 7 * k - 7)
        meeting.place(side, (2.55, 0, 1.50 + 0.8 * k), east + 5 * k - 9)
    meeting.place(things.whiteboard(), (WALL, 1.45, 2.35), west)
    meeting.place(pictures[2], (2.1, 1.60, WALL))
    meeting.place(plant, (3.72, 0, 0.48), 80)
    meeting.place(stand, (0.42, 0, 4.9))

    lounge = Model("room_lounge")
    rug = Model("rug")
    rug.add(things.RUG, box((-1.0, 0, -1.3), (1.0, 0.012, 1.3)).mapped("z", 0.5))
    lounge.place(rug, (1.75, 0, 2.4))
    lounge.place(things.sofa(), (WALL + 0.02, 0, 2.4), west)
    lounge.place(things.coffee_table(), (1.75, 0.012, 2.4), west)
    lounge.place(chair[2], (2.75, 0, 1.75), -75)
    lounge.place(chair[2], (2.80, 0, 3.00), -112)
    lounge.place(pictures[0], (WALL, 1.65, 2.4), west)
    lounge.place(cabinet, (1.9, 0, WALL + 0.01))
    lounge.place(plant, (0.45, 0, 0.5), 120)
    lounge.place(plant, (3.70, 0, 0.55), 200)

    archive = Model("room_archive")
    for k in range(4):
        archive.place(shelves[k % 3], (0.62 + 0.91 * k, 0, WALL + 0.01))
        archive.place(shelves[(k + 1) % 3], (WALL + 0.01, 0, 1.0 + 0.91 * k), west)
    for k in range(3):
        archive.place(shelves[(k + 2) % 3], (1.95, 0, 1.55 + 0.91 * k), west)
        archive.place(shelves[k], (1.93, 0, 1.55 + 0.91 * k), east)
    archive.place(cabinet, (WIDTH - WALL - 0.01, 0, 1.7), east)
    return [single, double, meeting, lounge, archive]


def floor(model: Model, columns: int, rows: int) -> None:
    """Linoleum in two shades: a light middle between dark borders two thirds of a tile wide."""
    width, depth, border = columns * TILE, rows * TILE, 0.4
    for low, high, material in ((0, border, 1), (border, depth - border, 0), (depth - border, depth, 1)):
        patch = grid((0, 0, high), (width, 0, 0), (0, 0, low - high), columns, 1 if material else 3)
        model.add(LINOLEUM[material], patch)


def corridor_power() -> Colour:
    r, g, b = (CORRIDOR_POWER * c for c in TINTS["neutral"])
    return r, g, b


def bay() -> Model:
    """A piece of corridor between two doors, from the origin along x: floor, and a ceiling with one panel."""
    model = Model("bay")
    floor(model, ACROSS, WALK)
    ceiling(model, ACROSS, WALK, [(3, 1, 1, 2)], corridor_power())
    return model


def passage() -> Model:
    """A piece of the corridors along z, as deep as a room, from the origin; rooms lie at its x = AISLE."""
    model = Model("passage")
    model.add(LINOLEUM[0], grid((0, 0, DEPTH), (AISLE, 0, 0), (0, 0, -DEPTH), WALK, DEEP))
    ceiling(model, WALK, DEEP, [(1, 4, 2, 1)], corridor_power())
    model.add(WALLS, facing("-x", 0, 0, DEPTH, HEIGHT, AISLE))
    model.add(SKIRTING, box((AISLE - 0.012, 0, 0), (AISLE, 0.08, DEPTH)))
    return model


def crossing() -> Model:
    """Where the corridors meet, from the origin."""
    model = Model("crossing")
    model.add(LINOLEUM[0], grid((0, 0, AISLE), (AISLE, 0, 0), (0, 0, -AISLE), WALK, WALK))
    ceiling(model, WALK, WALK, [(1, 1, 1, 2), (2, 1, 1, 2)], corridor_power())
    return model


def outer_wall() -> Model:
    """The wall along a whole side of the house, and those at the ends of its passage."""
    model = Model("outer_wall")
    length = ROWS * DEPTH + ROWS // 2 * AISLE
    model.add(WALLS, facing("+x", length, 0, 0, HEIGHT, 0))
    model.add(WALLS, facing("+z", 0, 0, AISLE, HEIGHT, 0), facing("-z", AISLE, 0, 0, HEIGHT, length))
    model.add(SKIRTING, box((0, 0, 0), (0.012, 0.08, length)))
    return model


def row_starts() -> list[tuple[float, bool]]:
    """Where each row of rooms begins in z, and whether its corridor lies before it and not behind it."""
    starts, z = [], 0.0
    for row in range(ROWS):
        starts.append((z, row % 2 == 1))
        z += DEPTH + (AISLE if row % 2 == 0 else 0.0)
    return starts


def office() -> Model:
    """All rooms and corridors; which room is what, and which doors are open, comes from a seed."""
    house, random = Model("office"), generator(64)
    count = COLUMNS * ROWS
    kinds, lights = layouts(), [light(tint) for tint in TINTS]
    shells, back, band, leaf = shell(), accent(), stripe(), door()
    kind = random.permutation(np.arange(count) % len(kinds))
    tint = random.permutation(np.arange(count) % len(lights))
    colour = random.permutation(np.arange(count) % len(ACCENTS))
    opened = random.permutation(np.arange(count) < OPEN_DOORS)
    angles = 62 + 40 * random.random_sample(count)
    for row, (z, before) in enumerate(row_starts()):
        for column in range(COLUMNS):
            i = row * COLUMNS + column
            corner, half = ((column + 1) * WIDTH, 0, z + DEPTH) if before else (column * WIDTH, 0, z), 180.0 * before
            for part in (shells, lights[tint[i]], kinds[kind[i]]):
                house.place(part, corner, half)
            house.place(back, corner, half, material=ACCENTS[colour[i]])
            house.place(band, corner, half, material=ACCENTS[(row + 1) // 2 % len(ACCENTS)])
            hinge, sign = (DOOR[1] - 0.01, DEPTH - 2 * WALL + (0.0 if opened[i] else 0.04)), -1.0 if before else 1.0
            angle = -float(np.round(angles[i])) if opened[i] else 0.0
            house.place(leaf, (corner[0] + sign * hinge[0], 0, corner[2] + sign * hinge[1]), half + angle)
    hall, side, cross, outside = bay(), passage(), crossing(), outer_wall()
    for z, before in row_starts():
        house.place(side, (-AISLE, 0, z))
        house.place(side, (COLUMNS * WIDTH + AISLE, 0, z + DEPTH), 180)
        if before:
            for column in range(COLUMNS):
                house.place(hall, (column * WIDTH, 0, z - AISLE))
            house.place(cross, (-AISLE, 0, z - AISLE))
            house.place(cross, (COLUMNS * WIDTH, 0, z - AISLE))
    house.place(outside, (-AISLE, 0, 0))
    house.place(outside, (COLUMNS * WIDTH + AISLE, 0, ROWS * DEPTH + ROWS // 2 * AISLE), 180)
    return house


FRAMES = 420
EYE = 1.6
FIRST, SECOND = DEPTH + AISLE / 2, 3 * DEPTH + 1.5 * AISLE  # the middles of two corridors
EAST, WEST = COLUMNS * WIDTH + AISLE / 2, -AISLE / 2  # and of the two that join them
WAYPOINTS = [  # time, position, what is looked at
    (0.0, (WEST + 0.2, EYE, FIRST + 0.2), (6.0, 1.35, FIRST)),
    (4.0, (3.0, EYE, FIRST), (9.0, 1.35, FIRST)),
    (10.0, (11.5, EYE, FIRST), (17.5, 1.40, FIRST)),
    (22.0, (30.0, EYE, FIRST), (36.0, 1.40, FIRST)),
    (25.0, (EAST - 1.0, EYE, FIRST + 0.3), (EAST + 1.5, 1.40, FIRST + 4.0)),
    (27.5, (EAST, EYE, FIRST + 2.2), (EAST, 1.40, FIRST + 8.0)),
    (33.5, (EAST, EYE, SECOND - 2.2), (EAST - 0.3, 1.40, SECOND + 3.5)),
    (36.0, (EAST - 1.0, EYE, SECOND - 0.2), (EAST - 5.0, 1.40, SECOND + 1.0)),
    (38.5, (30.0, EYE, SECOND), (24.0, 1.40, SECOND)),
    (60.0, (3.0, EYE, SECOND), (-3.0, 1.40, SECOND)),
    (63.0, (WEST + 1.0, EYE, SECOND - 0.2), (WEST - 1.5, 1.40, SECOND - 4.0)),
    (65.5, (WEST, EYE, SECOND - 2.2), (WEST, 1.40, SECOND - 8.0)),
    (72.0, (WEST, EYE, FIRST + 3.0), (WEST + 0.2, 1.38, FIRST - 3.0)),
    (76.0, (WEST, EYE, FIRST + 0.9), (WEST + 2.5, 1.36, FIRST - 2.5)),
    (84.0, (WEST + 0.2, EYE, FIRST + 0.2), (6.0, 1.35, FIRST)),
]


def text(folder: str) -> str:
    """The root file; everything else is included from `folder`."""
    comments = (
        "An office of 64 rooms under 256 ceiling panels.  Written by assets/make_scenes.py.",
        "Each panel shines from 16 points, 4,096 in all; a walk of 420 frames past open and shut doors.",
    )
    return root_file(comments, (0.0, 0.0, 0.0), 58.0, f"{folder}/office.aff", Flight(WAYPOINTS), FRAMES)

"""The default scene: a study with a fire, a window, many lights, and things that move."""

from __future__ import annotations

import math

from generate import furniture, house, lamps, things, toys
from generate import materials as m
from generate.aff import Model, number, numbers
from generate.chess import board
from generate.house import DEPTH, HEIGHT, WIDTH
from generate.pictures import SKY
from generate.shapes import box, grid, rounded_box
from generate.tracks import Flight

FRAMES, DURATION = 200, 46.0
MIDDLE = (2.9, 2.6)  # of rug, table and rails
PIVOT = (MIDDLE[0], HEIGHT - 0.08, MIDDLE[1])

LIGHTS = [
    ("the sun, through the window", (4.5, 6.0, -6.0), (0.90, 0.82, 0.64)),
    ("chandelier", (MIDDLE[0], HEIGHT - 0.88, MIDDLE[1]), (0.45, 0.40, 0.33)),
    ("desk lamp", (2.62, 0.74 + 0.335, 0.36), (0.36, 0.29, 0.18)),
    ("lamp on the low bookcase", (3.55, 1.215 + 0.335, 5.02), (0.36, 0.30, 0.21)),
    ("floor lamp", (0.95, 1.52, 4.62), (0.38, 0.32, 0.22)),
    ("fire", (0.44, 0.34, MIDDLE[1]), (0.42, 0.22, 0.09)),
]

WAYPOINTS = [  # time, position, what is looked at
    (0.0, (5.86, 1.62, 4.66), (2.35, 0.95, 1.9)),
    (3.5, (5.15, 1.35, 4.05), (2.5, 0.75, 2.2)),
    (6.5, (4.50, 0.50, 3.55), (3.3, 0.25, 2.6)),
    (8.5, (4.00, 0.42, 3.62), (2.95, 0.40, 2.65)),
    (11.0, (3.50, 0.80, 3.20), (2.9, 0.56, 2.6)),
    (13.5, (3.16, 0.76, 2.98), (2.92, 0.54, 2.60)),
    (14.7, (2.92, 0.86, 2.74), (2.20, 0.62, 2.46)),
    (16.0, (2.62, 0.98, 2.42), (1.3, 0.72, 2.55)),
    (18.5, (1.62, 1.02, 2.60), (0.30, 0.80, 2.62)),
    (21.0, (1.45, 1.58, 2.75), (0.36, 1.72, 2.62)),
    (23.5, (1.00, 1.48, 1.90), (0.28, 1.32, 0.90)),
    (26.0, (1.42, 1.42, 1.50), (1.75, 1.15, 0.20)),
    (28.5, (2.15, 1.22, 1.25), (3.00, 0.92, 0.38)),
    (30.5, (2.85, 1.10, 0.98), (3.30, 0.84, 0.32)),
    (32.5, (3.95, 1.32, 1.62), (5.60, 1.12, 1.00)),
    (34.5, (4.85, 1.32, 2.45), (6.15, 1.14, 2.45)),
    (36.5, (5.42, 1.18, 2.85), (6.10, 1.00, 3.05)),
    (38.2, (5.36, 1.26, 3.02), (5.95, 1.10, 4.10)),
    (39.8, (5.12, 1.38, 3.00), (4.30, 1.20, 4.60)),
    (41.6, (4.95, 1.48, 3.10), (2.80, 1.20, 4.60)),
    (46.0, (5.86, 1.62, 4.66), (2.35, 0.95, 1.9)),
]


def carpet() -> Model:
    model = Model("carpet")
    x, z = MIDDLE
    half_x, half_z, thick = 1.72, 1.28, 0.010
    top = grid((x - half_x, thick, z + half_z), (2 * half_x, 0, 0), (0, 0, -2 * half_z), 12, 9)
    model.add(m.RUG, top)
    edge = box((x - half_x, 0.0, z - half_z), (x + half_x, thick - 0.0004, z + half_z))
    model.add(m.CURTAIN, edge)
    for k in range(64):  # fringes
        at = z - half_z + 2 * half_z * (k + 0.5) / 64
        for side in (-1, 1):
            end = x + side * half_x
            low, high = sorted((end, end + side * 0.045))
            model.add(m.PAGES, box((low, 0.001, at - 0.006), (high, 0.006, at + 0.006)))
    return model


def mantelpiece() -> Model:
    """What stands on the mantel, in the fireplace's frame."""
    model = Model("mantelpiece")
    stick = lamps.candlestick()
    for x in (-0.66, -0.56, 0.62):
        model.place(stick, (x, 1.115, 0.47))
    model.add(m.BLACK_PAINT, rounded_box((0.26, 1.115, 0.42), (0.44, 1.135, 0.54), 0.004))
    model.sphere(m.CRYSTAL, (0.35, 1.19, 0.48), 0.055)
    model.cone(m.BLUE_CHINA, (-0.36, 1.115, 0.47), 0.040, (-0.36, 1.21, 0.47), 0.058)
    model.cone(m.BLUE_CHINA, (-0.36, 1.21, 0.47), 0.058, (-0.36, 1.235, 0.47), 0.030)
    return model


def study() -> Model:
    """Everything that stands in the room."""
    room = Model("study")
    for part in (house.shell(), house.window(), house.curtains(), house.garden(), carpet()):
        room.place(part)
    west, south, east = 90.0, 180.0, -90.0
    x, z = MIDDLE
    room.place(house.fireplace(), (0, 0, z), west)
    room.place(mantelpiece(), (0, 0, z), west)
    room.place(furniture.framed("mirror", m.MIRROR, 1.15, 0.98, m.GOLD, 0.09), (0.361, 1.84, z), west)
    room.place(furniture.bookcase("bookcase_north", 1.34, 6, 801), (0, 0, 0.98), west)
    room.place(furniture.bookcase("bookcase_south", 1.34, 6, 821), (0, 0, 4.24), west)
    room.place(furniture.bookcase("bookcase_low", 2.3, 3, 841), (2.75, 0, DEPTH), south)
    room.place(furniture.framed("seascape", m.SEASCAPE, 0.86, 0.60, m.GOLD), (2.35, 1.85, DEPTH), south)
    room.place(furniture.framed("eclipse", m.ECLIPSE, 0.42, 0.54, m.WALNUT, 0.05), (1.12, 1.82, 0))
    room.place(house.door(), (5.55, 0, DEPTH), south)
    room.place(furniture.framed("partition", m.PARTITION, 0.72, 0.72, m.BLACK_PAINT, 0.04), (WIDTH, 1.80, 3.05), east)
    room.place(things.clock(), (WIDTH, 0, 1.62), east)
    room.place(furniture.sideboard(), (WIDTH, 0, 3.05), east)
    room.place(furniture.desk(), (3.2, 0, 0.44))
    room.place(things.desk_things(), (3.2, 0.7412, 0.44))
    lamp = lamps.desk_lamp()
    room.place(lamp, (2.62, 0.74, 0.36))
    room.place(lamp, (3.55, 1.215, 5.02))
    room.place(things.globe(), (3.82, 0.74, 0.38))
    room.place(furniture.wooden_chair(), (3.30, 0, 1.12), 162)
    chair = furniture.armchair()
    room.place(chair, (1.50, 0, 1.30), 42)
    room.place(chair, (1.50, 0, 3.98), 138)
    room.place(furniture.round_table(), (x, 0.010, z))
    room.place(board(), (x, 0.510, z), 65)
    glass = things.tumbler()
    room.place(glass, (x + 0.33, 0.510, z + 0.20))
    room.place(glass, (x - 0.30, 0.510, z - 0.27))
    room.place(lamps.floor_lamp(), (0.95, 0, 4.62))
    room.place(lamps.chandelier(), (x, HEIGHT, z))
    room.place(things.plant(), (5.72, 0, 0.68))
    room.place(things.tray(), (6.13, 0.90, 2.72), 90)
    room.place(things.carafe(), (6.20, 0.909, 2.70))
    goblet = things.goblet()
    for dx, dz in ((-0.085, -0.10), (-0.075, 0.06), (0.03, 0.135)):
        room.place(goblet, (6.15 + dx, 0.909, 2.72 + dz))
    room.place(things.fruit_bowl(), (6.12, 0.90, 3.12))
    room.place(things.vase(), (6.18, 0.90, 3.66))
    stick = lamps.candlestick()
    room.place(stick, (6.22, 0.90, 2.34))
    rails = Model("railway")
    rails.place(toys.rails())
    rails.animate(toys.locomotive(), "locomotive")
    rails.animate(toys.wagon("tender", m.GREEN_PAINT, "coal"), "tender")
    rails.animate(toys.wagon("wagon_balls", m.BLUE_PAINT, "balls"), "wagon_balls")
    rails.animate(toys.wagon("wagon_logs", m.YELLOW_PAINT, "logs"), "wagon_logs")
    room.place(rails, (x, 0.010, z))
    room.animate(toys.airplane(), "airplane")
    return room


def text(folder: str) -> str:
    """The root file; everything else is included from `folder`."""
    flight = Flight(WAYPOINTS)
    position, target = flight.at(0.0)
    keys = round(DURATION * 2) + 1
    head = [
        "# A study: the scene that Shadowcull opens with.  Written by assets/make_scenes.py.",
        "# Six lights, a mirror, glass; a train, an airplane and a pendulum that move; a flight of 200 frames.",
        "",
        f"b {numbers(SKY, 3)}",
        f"am {numbers((m.GLOBAL_AMBIENT,) * 3)}",
        "v",
        f"from {numbers(position)}",
        f"at {numbers(target)}",
        "up 0 1 0",
        "angle 50",
        "hither 0.01",
        "resolution 800 600",
        "",
    ]
    for name, where, colour in LIGHTS:
        head += [f"# {name}", f"l {numbers(where)}  {numbers(colour, 3)}"]
    head += ["", f"a 0 {number(DURATION)} {FRAMES}", "", f"i 0 {folder}/study.aff", f"i 0 {folder}/tracks.aff", ""]
    head.append(flight.text(0.0, DURATION, keys))
    return "\n".join(head) + "\n"


def tracks() -> str:
    parts = toys.train_tracks(DURATION, 3) + toys.airplane_tracks(DURATION, 5, PIVOT) + toys.pendulum_tracks(DURATION)
    assert math.isclose(DURATION % 2.0, 0.0), "the pendulum ends as it began"
    return "# How the toys move.\n\n" + "\n\n".join(parts) + "\n"

"""What moves: a toy train on an oval of rails and a model airplane on a string."""

from __future__ import annotations

import math

import numpy as np

from generate import materials as m
from generate.aff import Material, Model
from generate.mesh import Mesh, rotation
from generate.shapes import box, lathe, rounded_box, sheet, tube, turned
from generate.tracks import axis_angle, key_times, track, translation, turning

STRAIGHT, RADIUS = 0.50, 0.80  # half the straight, and the bends
LENGTH = 4 * STRAIGHT + 2 * math.pi * RADIUS
GAUGE = 0.032  # half of it
RAIL_TOP = 0.022


def oval(s: float) -> tuple[float, float, float]:
    """x, z and heading (radians, counter-clockwise from above) after s metres along the oval."""
    s = s % LENGTH
    bend = math.pi * RADIUS
    if s < 2 * STRAIGHT:
        return s - STRAIGHT, RADIUS, 0.0
    s -= 2 * STRAIGHT
    if s < bend:
        a = s / RADIUS
        return STRAIGHT + RADIUS * math.sin(a), RADIUS * math.cos(a), a
    s -= bend
    if s < 2 * STRAIGHT:
        return STRAIGHT - s, -RADIUS, math.pi
    a = (s - 2 * STRAIGHT) / RADIUS
    return -STRAIGHT - RADIUS * math.sin(a), -RADIUS * math.cos(a), math.pi + a


def rails() -> Model:
    """Two rails on sleepers, around the origin."""
    model = Model("rails")
    steps = 96
    for side in (-GAUGE, GAUGE):
        path = []
        for k in range(steps + 1):
            x, z, heading = oval(LENGTH * k / steps)
            path.append((x + side * math.sin(heading), RAIL_TOP - 0.004, z + side * math.cos(heading)))
        model.add(m.STEEL, tube(path, 0.004, 5))
    sleepers = 84
    for k in range(sleepers):
        x, z, heading = oval(LENGTH * (k + 0.5) / sleepers)
        sleeper = box((-0.013, 0.0, -0.055), (0.013, 0.0145, 0.055))
        model.add(m.WALNUT, sleeper.mapped("z", 4, (0.1 * k, 0)).turned("y", math.degrees(heading)).moved(x, 0, z))
    return model


def wheels(model: Model, at: tuple[float, ...], radius: float) -> None:
    for x in at:
        for side in (-1, 1):
            disc = lathe([(0, -0.004), (radius, -0.004), (radius, 0.003), (radius * 0.8, 0.003), (radius * 0.7, 0.001),
                          (0.006, 0.001), (0.006, 0.005), (0, 0.005)], 14, 30)  # fmt: skip
            model.add(m.IRON, disc.turned("x", 90 * side).moved(x, radius, side * GAUGE))
        model.add(m.STEEL, tube([(x, radius, -GAUGE), (x, radius, GAUGE)], 0.003, 6))


def locomotive() -> Model:
    """Faces +x; stands on the rails at y = 0; its boiler is a cylinder, its funnel a cone."""
    model = Model("locomotive")
    wheels(model, (-0.055, 0.0, 0.045), 0.020)
    wheels(model, (0.085,), 0.014)
    model.add(m.BLACK_PAINT, rounded_box((-0.10, 0.018, -0.026), (0.115, 0.034, 0.026), 0.004, 2))
    model.cone(m.GREEN_PAINT, (-0.03, 0.066, 0), 0.031, (0.10, 0.066, 0), 0.031)
    for x in (-0.01, 0.035, 0.08):
        model.cone(m.BRASS, (x - 0.003, 0.066, 0), 0.0322, (x + 0.003, 0.066, 0), 0.0322)
    front = lathe([(0.0312, 0.0), (0.0312, 0.004), (0.024, 0.010), (0, 0.013)], 24, 30)
    model.add(m.BLACK_PAINT, front.turned("z", -90).moved(0.098, 0.066, 0))
    model.cone(m.BLACK_PAINT, (0.078, 0.094, 0), 0.010, (0.078, 0.128, 0), 0.016)
    model.cone(m.BRASS, (0.078, 0.126, 0), 0.018, (0.078, 0.134, 0), 0.018)
    dome = turned([(0.014, 0), (0.014, 0.010), (0.010, 0.018), (0, 0.021)], 10, 16)
    model.add(m.BRASS, dome.moved(0.03, 0.094, 0))
    model.add(m.RED_PAINT, rounded_box((-0.10, 0.034, -0.036), (-0.032, 0.080, 0.036), 0.004, 2))
    for x in (-0.096, -0.040):
        for z in (-0.033, 0.033):
            model.add(m.RED_PAINT, box((x, 0.08, z - 0.003), (x + 0.007, 0.116, z + 0.003)))
    roof = [[(x, 0.126 - 6.0 * z * z, z) for x in (-0.110, -0.022)] for z in np.linspace(0.044, -0.044, 9)]
    model.add(m.BLACK_PAINT, sheet(np.asarray(roof)), sheet(np.asarray(roof) - np.array([0, 0.003, 0])).flipped())
    model.add(m.RED_PAINT, rounded_box((0.112, 0.014, -0.036), (0.120, 0.036, 0.036), 0.003))
    for z in (-0.022, 0.022):
        model.sphere(m.BRASS, (0.122, 0.026, z), 0.006)
    model.sphere(m.BULB, (0.112, 0.083, 0), 0.007)
    return model


def wagon(name: str, colour: Material, cargo: str) -> Model:
    """An open wagon with balls, logs or coal."""
    model = Model(name)
    wheels(model, (-0.05, 0.05), 0.014)
    model.add(m.BLACK_PAINT, rounded_box((-0.085, 0.018, -0.028), (0.085, 0.030, 0.028), 0.004))
    model.add(m.BLACK_PAINT, box((0.08, 0.021, -0.004), (0.108, 0.027, 0.004)))
    for low, high in (
        ((-0.08, 0.030, -0.038), (0.08, 0.036, 0.038)), ((-0.08, 0.034, -0.038), (0.08, 0.070, -0.034)),
        ((-0.08, 0.034, 0.034), (0.08, 0.070, 0.038)), ((-0.08, 0.034, -0.0345), (-0.076, 0.069, 0.0345)),
        ((0.076, 0.034, -0.0345), (0.08, 0.069, 0.0345)),
    ):  # fmt: skip
        model.add(colour, box(low, high))
    if cargo == "balls":
        paints = (m.RED_PAINT, m.YELLOW_PAINT, m.CHROME, m.BLUE_PAINT)
        for k, x in enumerate((-0.055, -0.018, 0.019, 0.056)):
            model.sphere(paints[k], (x, 0.054, 0.016), 0.018)
            model.sphere(paints[(k + 2) % 4], (x, 0.054, -0.0175), 0.0165)
        model.sphere(m.CHROME, (0.001, 0.082, 0.0), 0.019)
    elif cargo == "logs":
        for y, z in ((0.048, -0.022), (0.048, 0.0), (0.048, 0.022), (0.067, -0.011), (0.067, 0.011), (0.086, 0.0)):
            model.add(m.OAK, tube([(-0.072, y, z), (0.0, y, z), (0.072, y, z)], 0.0108, 10).mapped("x", 4, (z * 9, 0)))
    else:
        for k in range(26):
            x, z = -0.064 + 0.0052 * k, 0.024 * math.sin(k * 2.4)
            model.sphere(m.EBONY, (x, 0.060 + 0.006 * math.cos(k * 4.0), z), 0.0105)
    return model


def train_tracks(duration: float, laps: int) -> list[str]:
    """Keys for locomotive, tender and wagons, one behind the other."""
    times = key_times(0.0, duration, 44 * laps + 1)
    texts = []
    for name, behind in (("locomotive", 0.0), ("tender", 0.205), ("wagon_balls", 0.395), ("wagon_logs", 0.585)):

        def distance(t: float, behind: float = behind) -> float:
            return LENGTH * laps * t / duration + 0.9 - behind + LENGTH

        def where(t: float) -> tuple[float, float, float]:
            x, z, _ = oval(distance(t))
            return x, RAIL_TOP, z

        def how(t: float) -> tuple[float, float, float, float]:
            # A vehicle rests on two points of the rails, so it turns gently into a bend.
            x0, z0, _ = oval(distance(t) - 0.06)
            x1, z1, _ = oval(distance(t) + 0.06)
            return 0.0, 1.0, 0.0, math.degrees(math.atan2(z0 - z1, x1 - x0))

        texts.append(track(name, translation(times, where), turning(times, how)))
    return texts


CIRCLE, DROP, BANK = 1.30, 0.52, 20.0


def airplane() -> Model:
    """A biplane facing +x that hangs on a string; the pivot is CIRCLE metres to its right and DROP above."""
    model = Model("airplane")
    hull = turned(
        [
            (0, -0.20),
            (0.012, -0.19),
            (0.022, -0.12),
            (0.036, 0.0),
            (0.042, 0.10),
            (0.040, 0.15),
            (0.030, 0.17),
            (0, 0.172),
        ],
        26,
        18,
    )
    model.add(m.RED_PAINT, hull.turned("z", -90))

    def wing(y: float, span: float, chord: float, x: float) -> Mesh:
        ring = [
            (0.5, 0.0),
            (0.30, 0.09),
            (0.05, 0.10),
            (-0.25, 0.06),
            (-0.5, 0.0),
            (-0.25, -0.02),
            (0.05, -0.03),
            (0.30, -0.04),
            (0.5, 0.0),
        ]
        stations = []
        for s in np.linspace(-1, 1, 13):
            c = chord * math.sqrt(max(1 - (abs(s) ** 6), 0.02))
            stations.append([(x + c * a, y + 0.6 * c * b + 0.015 * abs(s), s * span) for a, b in ring])
        return sheet(np.asarray(stations)[::-1])

    model.add(
        m.YELLOW_PAINT,
        wing(-0.026, 0.25, 0.095, 0.055),
        wing(0.075, 0.28, 0.10, 0.075),
        wing(0.012, 0.095, 0.06, -0.165),
    )
    fin = wing(0.0, 0.06, 0.06, 0.0).turned("x", 90).moved(-0.17, 0.05, 0)
    model.add(m.RED_PAINT, fin)
    for z in (-0.18, 0.18, -0.05, 0.05):
        for dx in (0.0, 0.05):
            top = (0.06 + dx, 0.078 + 0.012 * abs(z) / 0.2, z)
            foot = (0.035 + dx, -0.02 + 0.012 * abs(z) / 0.2 if abs(z) > 0.1 else 0.02, z if abs(z) > 0.1 else z * 0.5)
            model.add(m.OAK, tube([foot, top], 0.003, 6))
    for z in (-0.055, 0.055):
        model.add(m.IRON, tube([(0.09, -0.02, z * 0.4), (0.10, -0.085, z)], 0.003, 6))
        tyre = lathe([(0, -0.007), (0.018, -0.007), (0.022, 0), (0.018, 0.007), (0, 0.007)], 16, 50)
        model.add(m.BLACK_PAINT, tyre.turned("x", 90).moved(0.10, -0.085, z))
    model.add(m.IRON, tube([(0.10, -0.085, -0.06), (0.10, -0.085, 0.06)], 0.0025, 6))
    model.sphere(m.WAX, (-0.012, 0.052, 0), 0.017)
    model.sphere(m.BRASS, (0.178, 0, 0), 0.013)
    pivot = rotation((1, 0, 0), -BANK) @ np.array([0.0, DROP, CIRCLE])
    model.add(m.BLACK_PAINT, tube([(0.05, 0.085, 0.0), pivot], 0.0022, 5))
    blades = Model("propeller")
    for turn in (0.0, 180.0):
        rows = []
        for a in np.linspace(0, 2 * math.pi, 9):
            across, thick = 0.013 * math.cos(a), 0.004 * math.sin(a)
            rows.append([(thick * (1 - s), 0.012 + 0.078 * s, across * (1 - 0.5 * s) * (0.4 + 2 * s * (1.2 - s)))
                         for s in np.linspace(0, 1, 6)])  # fmt: skip
        blades.add(m.MAHOGANY, sheet(np.asarray(rows)).turned("x", turn).mapped("y", 3))
    nose = Model("airplane_nose")
    nose.animate(blades, "propeller")
    model.place(nose, (0.186, 0, 0))
    return model


def airplane_tracks(duration: float, laps: int, centre: tuple[float, float, float]) -> list[str]:
    """Keys that take the airplane around a pivot, and its propeller round and round."""
    times = key_times(0.0, duration, 24 * laps + 1)

    def angle(t: float) -> float:
        return 2 * math.pi * laps * t / duration + 2.2

    def where(t: float) -> tuple[float, float, float]:
        return centre[0] + CIRCLE * math.cos(angle(t)), centre[1] - DROP, centre[2] + CIRCLE * math.sin(angle(t))

    def how(t: float) -> tuple[float, float, float, float]:
        heading = math.degrees(math.atan2(-math.cos(angle(t)), -math.sin(angle(t))))
        return axis_angle(rotation((0, 1, 0), heading) @ rotation((1, 0, 0), BANK))

    spins = round(1.5 * duration)
    spin_times = key_times(0.0, duration, 3 * spins + 1)
    return [
        track("airplane", translation(times, where), turning(times, how)),
        track("propeller", turning(spin_times, lambda t: (1.0, 0.0, 0.0, (360.0 * spins * t / duration) % 360.0))),
    ]


def pendulum_tracks(duration: float) -> list[str]:
    times = key_times(0.0, duration, int(duration / 2.0) * 8 + 1)
    return [track("pendulum", turning(times, lambda t: (0.0, 0.0, 1.0, 5.0 * math.sin(math.pi * t))))]

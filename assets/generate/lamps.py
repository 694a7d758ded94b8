"""What shines: lamps and candles, at the origin, upwards along y.

Every shade is opaque, as all casters are: a light stands inside it, clear of bulb and stand, and shines out
below and above.
"""

from __future__ import annotations

import math

from generate import materials as m
from generate.aff import Model
from generate.shapes import curve, lathe, tube, turned


def desk_lamp() -> Model:
    """0.46 m high, its open shade a cone; the light belongs inside it, at y = 0.335, below the bulb."""
    model = Model("desk_lamp")
    base = turned([(0, 0.0), (0.085, 0.0), (0.09, 0.012), (0.05, 0.03), (0.018, 0.05), (0.022, 0.09), (0.034, 0.13),
                   (0.022, 0.19), (0.012, 0.25), (0.012, 0.30)], 36, 18)  # fmt: skip
    model.add(m.BRASS, base)
    model.cone(m.SHADE, (0, 0.30, 0), 0.145, (0, 0.46, 0), 0.075)
    for k in range(3):
        a = 2 * math.pi * k / 3
        spoke = [(0.01 * math.cos(a), 0.298, 0.01 * math.sin(a)), (0.145 * math.cos(a), 0.302, 0.145 * math.sin(a))]
        model.add(m.BRASS, tube(spoke, 0.0018, 5))
    model.sphere(m.BULB, (0, 0.40, 0), 0.018)
    return model


def floor_lamp() -> Model:
    """1.72 m high; the light belongs inside its shade, at y = 1.52, below the bulb."""
    model = Model("floor_lamp")
    base = turned(
        [(0, 0), (0.15, 0.0), (0.155, 0.018), (0.09, 0.035), (0.03, 0.06), (0.024, 0.12), (0.016, 0.16)], 24, 24
    )
    knop = turned([(0.013, 0.80), (0.028, 0.83), (0.035, 0.86), (0.028, 0.89), (0.013, 0.92)], 16, 16)
    model.add(m.BRASS, base, knop)
    model.cone(m.BRASS, (0, 0.15, 0), 0.013, (0, 1.465, 0), 0.011)
    model.cone(m.SHADE, (0, 1.45, 0), 0.25, (0, 1.74, 0), 0.15)
    for k in range(3):
        a = 2 * math.pi * k / 3 + 0.4
        model.add(m.BRASS, tube([(0, 1.458, 0), (0.243 * math.cos(a), 1.46, 0.243 * math.sin(a))], 0.003, 5))
    model.sphere(m.BULB, (0, 1.61, 0), 0.024)
    return model


def chandelier() -> Model:
    """Hangs from y = 0 down to -0.95; the light belongs in its middle, at y = -0.88."""
    model = Model("chandelier")
    rose = lathe([(0.0, -0.05), (0.03, -0.05), (0.07, -0.03), (0.10, -0.012), (0.105, 0.0)], 24)
    hub = turned([(0, -0.80), (0.02, -0.79), (0.035, -0.76), (0.06, -0.70), (0.05, -0.64), (0.02, -0.60),
                  (0.028, -0.55), (0.012, -0.50)],
                 24, 20)  # fmt: skip
    model.add(m.BRASS, rose, hub)
    model.cone(m.BRASS, (0, -0.51, 0), 0.009, (0, -0.03, 0), 0.009)
    for k in range(6):
        a = math.pi * k / 3
        path = [(0.04, -0.69), (0.13, -0.80), (0.23, -0.83), (0.31, -0.76), (0.33, -0.67)]
        arm = [(r * math.cos(a), y, r * math.sin(a)) for r, y in curve(path, 11)]
        x, z = 0.33 * math.cos(a), 0.33 * math.sin(a)
        saucer = lathe(
            [(0, -0.675), (0.02, -0.675), (0.048, -0.655), (0.046, -0.652), (0.018, -0.668), (0, -0.668)], 14
        )
        model.add(m.BRASS, tube(arm, 0.009, 7), saucer.moved(x, 0, z))
        model.cone(m.WAX, (x, -0.668, z), 0.013, (x, -0.56, z), 0.012)
        bulb = lathe([(0.004, -0.56), (0.014, -0.54), (0.015, -0.525), (0.008, -0.50), (0, -0.475)], 10, 80)
        model.add(m.BULB, bulb.moved(x, 0, z))
    model.sphere(m.BRASS, (0, -0.815, 0), 0.022)
    return model


def candlestick() -> Model:
    model = Model("candlestick")
    stick = turned([(0, 0), (0.05, 0.0), (0.052, 0.008), (0.02, 0.022), (0.012, 0.05), (0.018, 0.09), (0.010, 0.13),
                    (0.014, 0.165),
                    (0.026, 0.18), (0.014, 0.182)], 34, 18)  # fmt: skip
    model.add(m.BRASS, stick)
    model.cone(m.WAX, (0, 0.175, 0), 0.0115, (0, 0.30, 0), 0.0105)
    model.add(m.WAX, lathe([(0.0105, 0.30), (0.006, 0.297), (0, 0.297)], 12))
    flame = lathe([(0, 0.302), (0.005, 0.310), (0.0065, 0.318), (0.004, 0.332), (0, 0.350)], 10, 80)
    model.add(m.FLAME, flame)
    return model

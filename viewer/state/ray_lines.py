"""A tree of rays as lines on a picture: rays on their way, and shadow rays as far as light comes, and on."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np

from tracer.frame import Frame
from tracer.geometry.visits import Visit
from tracer.told_rays import AWAY, TRACED, RayTree
from viewer.state.projection import Stroke, strokes
from viewer.state.verdicts import Filter

MOST_DRAWN = 160  # shadow rays
FAR = 3.0  # times the way to the first hit: how far a ray is drawn that leaves the scene


class Part(Enum):
    """What a line stands for."""

    PATH = "a reflected or refracted ray"
    ASKED = "a shadow ray that was traced, as far as light comes"
    SAVED = "a shadow ray that was culled, as far as light comes"
    DARK = "the rest of a shadow ray, behind what blocks it"


class RayLine(NamedTuple):
    """A line of a ray: of which path ray, and which shadow ray of that, -1 for the path ray itself."""

    part: Part
    ray: int
    place: int
    strokes: list[Stroke]


def ray_lines(frame: Frame, tree: RayTree, shown: Filter) -> list[RayLine]:
    """The rays on their way and the shadow rays that a filter lets be seen, MOST_DRAWN of these at most: those of the
    first points first, and of one point evenly."""
    lines, left = [], MOST_DRAWN
    for ray in tree.rays:
        if ray.parent >= 0:
            length = ray.t if np.isfinite(ray.t) else FAR * tree.rays[0].t
            lines.append(
                RayLine(Part.PATH, ray.number, -1, strokes(frame, [ray.origin, ray.origin + length * ray.direction]))
            )
        if ray.shadows is None:
            continue
        s = ray.shadows
        places = shown.places(s)
        places = places[s.verdict[places] != AWAY]
        if len(places) > left:
            places = places[np.linspace(0, len(places) - 1, left).astype(int)] if left else places[:0]
        left -= len(places)
        for place in places.tolist():
            lines += shadow_lines(frame, tree, ray.number, place)
    return lines


def shadow_lines(frame: Frame, tree: RayTree, number: int, place: int) -> list[RayLine]:
    """A shadow ray from its light to its point."""
    ray = tree.rays[number]
    s = ray.shadows
    assert s is not None
    start, end = tree.samples[place].astype(np.float64), ray.end.astype(np.float64)
    part = Part.ASKED if s.verdict[place] == TRACED else Part.SAVED
    if s.blocker[place] < 0:
        return [RayLine(part, number, place, strokes(frame, [start, end]))]
    stop = start + float(s.blocked_at[place]) * (end - start)
    return [
        RayLine(part, number, place, strokes(frame, [start, stop])),
        RayLine(Part.DARK, number, place, strokes(frame, [stop, end])),
    ]


def box_strokes(frame: Frame, visit: Visit) -> list[Stroke]:
    """The twelve edges of a node's box."""
    edges = [(a, a | 1 << axis) for axis in range(3) for a in range(8) if not a >> axis & 1]
    return [stroke for a, b in edges for stroke in strokes(frame, visit.corners[[a, b]])]


def way_strokes(frame: Frame, tree: RayTree, number: int, place: int | None, visit: Visit) -> list[Stroke]:
    """The part of a ray that lies in a node's box."""
    ray = tree.rays[number]
    start, way = ray.origin.astype(np.float64), ray.direction.astype(np.float64)
    if place is not None:
        start = tree.samples[place].astype(np.float64)
        way = ray.end.astype(np.float64) - start
    return strokes(frame, [start + visit.enter * way, start + min(visit.leave, 1e6) * way])

"""The way of one ray of a tree through a structure, in words: what it enters, what that costs, and how far it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tracer.geometry.visits import Visit
from tracer.told_rays import TRACED, RayKind, RayTree
from viewer.output.ray_rows import Row
from viewer.util.numbers import several

_PACKETS = (
    "The row says what tracing the ray takes, as a packet of its own: packets may enter other nodes than the ray "
    "itself, and a block of triangles is one test. This list has the nodes that the ray enters, and every primitive "
    "that it is tested against."
)
_OTHER = "The row says what tracing took, which went through the other structure, {traced}."


def summary(tree: RayTree, row: Row, visits: Sequence[Visit], structure: str) -> tuple[str, str]:
    """What a list of nodes holds, and how the ray's row counts the same where that differs; and why, "" where it is
    the same."""
    tests, leaves = sum(len(visit.tested) for visit in visits), sum(visit.leaf for visit in visits)
    text = f"{several(len(visits), 'node')} ({several(leaves, 'leaf', 'leaves')}), {several(tests, 'test')}"
    costs, traced = costs_of(tree, row), tree.frame.settings.accelerator
    if costs is None or costs == (len(visits), tests):
        return text, ""
    how, why = ("as a packet", _PACKETS) if structure == traced else (f"in {traced}", _OTHER.format(traced=traced))
    return f"{text}; {how} {several(costs[0], 'step')}, {several(costs[1], 'test')}", why


def costs_of(tree: RayTree, row: Row) -> tuple[int, int] | None:
    """Steps and tests as the row of a single ray has them, None if it was not traced."""
    ray = tree.rays[row.ray]
    if not len(row.places) or ray.shadows is None:
        return ray.steps, ray.tests
    s, place = ray.shadows, int(row.places[0])
    asked = s.verdict[place] == TRACED or s.asked_moving[place]
    return (int(s.steps[place]), int(s.tests[place])) if asked else None


def length_of(tree: RayTree, row: Row) -> float:
    """How long the way of the ray is from t = 0 to t = 1, in the scene's units."""
    ray = tree.rays[row.ray]
    way = ray.end - tree.samples[int(row.places[0])] if len(row.places) else ray.direction
    return float(np.linalg.norm(way.astype(np.float64)))


def origin_of(tree: RayTree, row: Row) -> str:
    """From where the ray goes, in words."""
    if len(row.places):
        return "the light"
    return "the camera" if tree.rays[row.ray].kind is RayKind.PRIMARY else "the surface that sent it"

"""Why is it in shadow there?  What each light meets on its way to what a pixel shows.

One ray for each light that is due, as shading would trace it, and, where the renderer keeps certificates, what
these say of the point.  The world is asked as it stands: it must be placed for the frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.attributes import FACE_NORMAL, OBJECT
from tracer.geometry.camera import pinhole
from tracer.geometry.offsets import RAY_OFFSET
from tracer.geometry.rays import ray_batch
from tracer.scene.arrays import Float32, Float64
from tracer.scene.model import SPHERE, Quadrics

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.geometry.world import World
    from tracer.renderer import Renderer

Point = tuple[float, float, float]

NO_CERTIFICATE = "none"
ROUND = 48  # corners of a circle's outline


@dataclass(frozen=True)
class Explanation:
    """What is between a point and one light.

    Attributes
    ----------
    light : int
        Number of the light.
    due : bool
        Whether the light is on the viewer's side of the surface.
    lit : bool
        Whether any of the light really reaches the point; false if no ray is due.
    samples, reached : int
        How many samples of the light are due, and how many of these reach the point.
    certificate : str
        What is known from certificates, in a word.
    blocker : int or None
        The first primitive that blocks the light, possibly the one that the point is on: of the first of its samples
        that anything blocks.
    named : tuple of int
        The primitives that the certificate names, each once.
    light_position, point : tuple of float
        Where that sample is, or the first that is due, or else the light's centre; and where its shadow rays end, a
        little above the surface.
    blocked_at : tuple of float or None
        Where the first primitive blocks the light.
    used : bool
        Whether the frame has looked the certificate up; the method "auto" does so only where that saves time.
    """

    light: int
    due: bool
    lit: bool
    certificate: str
    blocker: int | None
    named: tuple[int, ...]
    light_position: Point
    point: Point
    blocked_at: Point | None
    samples: int = 1
    reached: int = 0
    used: bool = True


def explain(renderer: Renderer, frame: Frame, x: int, y: int) -> tuple[Explanation, ...]:
    """Explain why the light of each lamp does or does not reach what a pixel shows.

    The world of the renderer must still be placed for this frame.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame.
    frame : Frame
        The picture.
    x, y : int
        Column and row of the pixel.

    Returns
    -------
    tuple of Explanation
        One for each light; empty if the pixel shows nothing.
    """
    primitive = int(frame.primitive[y, x])
    if primitive < 0:
        return ()
    position, normal, point = _surface(renderer.world, frame, x, y)
    lamps = renderer.state.lamps(frame.settings).at(renderer.scene.light_positions(frame.time))
    ways = point - lamps.samples
    due = (lamps.samples - position) @ normal > 0
    asked = np.flatnonzero(due)
    hits = renderer.world.closest_hits(ray_batch(lamps.samples[asked], ways[asked], LIGHT_MARGIN, 1.0), threads=1)
    met = np.full(len(lamps.samples), -1)
    reach = np.zeros(len(lamps.samples))
    met[asked], reach[asked] = hits.primitive, hits.t
    explanations = []
    for light, (first, end) in enumerate(pairwise(lamps.first)):
        facing = first + np.flatnonzero(due[first:end])
        blocked = facing[met[facing] >= 0]
        certificate = NO_CERTIFICATE
        named: tuple[int, ...] = ()
        if len(facing) and (answer := renderer.explain(primitive, point, light)) is not None:
            certificate, named = answer
        shown = blocked[0] if len(blocked) else facing[0] if len(facing) else None
        explanations.append(
            Explanation(
                light=light,
                due=len(facing) > 0,
                lit=len(blocked) < len(facing),
                certificate=certificate,
                blocker=int(met[shown]) if len(blocked) else None,
                named=tuple(dict.fromkeys(int(number) for number in named)),
                light_position=_triple(lamps.places[light] if shown is None else lamps.samples[shown]),
                point=_triple(point),
                blocked_at=_triple(lamps.samples[shown] + reach[shown] * ways[shown]) if len(blocked) else None,
                samples=len(facing),
                reached=len(facing) - len(blocked),
                used=renderer.takes_part,
            )
        )
    return tuple(explanations)


def _surface(world: World, frame: Frame, x: int, y: int) -> tuple[Float32, Float32, Float32]:
    """The point that a pixel shows, its geometric normal towards the viewer, and the end of its shadow rays."""
    rays, primitive = pinhole(frame.camera, frame.width, frame.height), int(frame.primitive[y, x])
    direction = rays.corner + np.float32(x) * rays.column + np.float32(y) * rays.row
    direction /= np.linalg.norm(direction)
    depth = frame.depth[y, x]
    position = rays.origin + depth * direction
    across = frame.normal[y, x].astype(np.float64)  # a quadric's shading normal is its own
    if primitive < len(world.placed.triangles):
        across = world.attributes[primitive, FACE_NORMAL:OBJECT] @ _to_object(world, primitive)[:, :3]
        across /= max(float(np.linalg.norm(across)), 1e-300)
    normal: Float32 = (-across if across @ direction > 0 else across).astype(np.float32)
    offset = RAY_OFFSET * max(depth, np.abs(position).max())
    return position, normal, position + offset * normal


def _to_object(world: World, primitive: int) -> Float64:
    owner = int(world.object_of[primitive])
    return world.placed.to_object[owner].reshape(3, 4).astype(np.float64) if owner else np.eye(3, 4)


def outline(world: World, primitive: int) -> tuple[Float64, ...]:
    """Lines (n, 3) that show a primitive where it is: a triangle's sides, three great circles of a sphere, or the ends
    and four sides of a cone.  None of one that is not there at all."""
    triangles = world.placed.triangles
    if primitive < len(triangles):
        first, *edges = triangles[primitive].reshape(3, 3).astype(np.float64)
        lines = [np.stack([first, first + edges[0], first + edges[1], first])]
    else:
        lines = _quadric_lines(world, primitive)
    to_object = _to_object(world, primitive)
    try:
        back = np.linalg.inv(to_object[:, :3])
    except np.linalg.LinAlgError:
        return ()
    return tuple((line - to_object[:, 3]) @ back.T for line in lines)


def _quadric_lines(world: World, primitive: int) -> list[Float64]:
    """Of a quadric, in the space of its object."""
    scene, owner = world.scene, world.scene.object_of(primitive)
    quadrics: Quadrics = scene.objects[owner].quadrics
    i = primitive - int(scene.quadric_offsets[owner])
    turn = np.linspace(0.0, 2.0 * np.pi, ROUND + 1)
    circle, level = np.stack([np.cos(turn), np.sin(turn)], axis=1), np.zeros((ROUND + 1, 1))
    if quadrics.kind[i] == SPHERE:
        flat = np.hstack([circle, level])
        lines = [flat, np.roll(flat, 1, axis=1), np.roll(flat, 2, axis=1)]
    else:
        ends = [np.hstack([radius * circle, level + z]) for z, radius in enumerate(quadrics.radii[i])]
        lines = [*ends, *(np.stack([ends[0][k], ends[1][k]]) for k in range(0, ROUND, ROUND // 4))]
    place = quadrics.to_object[i]
    return [line @ place[:, :3].T + place[:, 3] for line in lines]


def _triple(v: NDArray) -> Point:
    return float(v[0]), float(v[1]), float(v[2])

"""What was clicked, in the picture or by its number, and where primitives are in the world: no ray needed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.modes import ShadowMode
from tracer.editing.edits import Edited
from tracer.frame import Frame
from tracer.inspect.projection import HIDDEN, place
from tracer.inspect.why_in_words import kind_of
from tracer.scene.deformation import deformed
from tracer.scene.model import CONE, Camera, Quadrics, Scene
from viewer.state.navigation import Vector, ray
from viewer.state.parts import parts_of
from viewer.state.pixels import pixel_at
from viewer.state.views import has_modes_of_cells

NEARBY = 2
"""Pixels from a point's place on the picture at which its surface still stands for it."""
_BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
_EDGES = [(a, b) for a in range(8) for b in range(a) if np.abs(_BOX[a] - _BOX[b]).sum() == 2.0]

Seen = tuple[float, Camera, int, int]


@dataclass(frozen=True)
class Pick:
    """What is selected: a primitive, and the point of it that a pixel of a frame shows; with a `part`, that whole part
    of the scene (`viewer.state.parts`).

    `primitive` is -1 where the ray left the scene; then only x and y mean anything.  `seen` is the frame's time,
    camera, width and height, None where x and y are no pixel of a frame."""

    x: int
    y: int
    primitive: int
    part: int | None = None
    kind: str = ""
    object_name: str = ""
    dynamic: bool = False
    point: tuple[float, float, float] | None = None
    seen: Seen | None = None


def pick(frame: Frame, scene: Scene, u: float, v: float) -> Pick:
    """What lies under a point of the picture."""
    x, y = pixel_at(frame, u, v)
    primitive = int(frame.primitive[y, x])
    if not 0 <= primitive < scene.primitive_count:
        return Pick(x, y, -1)
    point = point_at(frame, u, v)
    return _named(scene, primitive, x, y, point, seen_of(frame))


def pick_primitive(frame: Frame, scene: Scene, primitive: int) -> Pick | None:
    """A primitive as if it had been clicked: at the pixel in the middle of what is seen of it, or, where nothing of it
    is seen, at its own middle.  None for a number that is no primitive's, or of what is beyond all numbers."""
    if not 0 <= primitive < scene.primitive_count:
        return None
    shown = frame.primitive == primitive
    if shown.any():
        return _middle_pick(frame, scene, shown)
    points = primitive_points(scene, primitive, frame.time)
    return _named(scene, primitive, -1, -1, points.mean(axis=0), None) if len(points) else None


def pick_part(frame: Frame, now: Edited, part: int) -> Pick | None:
    """A part as if it had been clicked in its middle; None where it has no primitives, is hidden, or is nowhere."""
    found = _primitives_of(now, part)
    if not len(found):
        return None
    in_part = np.zeros(len(now.primitives) + 1, np.bool_)  # -1, a miss, finds the last of them
    in_part[found] = True
    shown, scene = in_part[frame.primitive], now.scene
    pick = _middle_pick(frame, scene, shown) if shown.any() else pick_primitive(frame, scene, int(found[0]))
    return None if pick is None else replace(pick, part=part)


def _named(scene: Scene, primitive: int, x: int, y: int, point: Vector | None, seen: Seen | None) -> Pick:
    return Pick(
        x, y, primitive, kind=kind_of(scene, primitive), object_name=scene.name_of(primitive),
        dynamic=scene.object_of(primitive) > 0, point=None if point is None else tuple(point.tolist()), seen=seen,
    )  # fmt: skip


def _middle_pick(frame: Frame, scene: Scene, shown: NDArray[np.bool_]) -> Pick:
    """The one of these pixels that is nearest to their mean."""
    rows, columns = np.nonzero(shown)
    nearest = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
    return pick(frame, scene, (columns[nearest] + 0.5) / frame.width, (rows[nearest] + 0.5) / frame.height)


def seen_of(frame: Frame) -> Seen:
    """What a pixel of a frame is told by from those of others: its time, its camera and its size."""
    return frame.time, frame.camera, frame.width, frame.height


def same_place(one: Frame, other: Frame) -> bool:
    """Whether two frames are of the same moment from the same place, in the same size."""
    return seen_of(one) == seen_of(other)


def pixel_of(kept: Pick, frame: Frame) -> tuple[int, int] | None:
    """The pixel of a frame that shows the point that was picked; None where the frame does not show it.

    At another size, or from elsewhere, the point lies between pixels: the nearest within `NEARBY` counts that shows its
    primitive, or else, as that may be smaller than a pixel, a surface at the point's distance."""
    if kept.seen == seen_of(frame) and frame.primitive[kept.y, kept.x] == kept.primitive:
        return kept.x, kept.y
    at = place(frame, kept.point) if kept.point is not None else None
    if kept.point is None or at is None or not (0.0 <= at[0] < 1.0 and 0.0 <= at[1] < 1.0):
        return None
    x, y = pixel_at(frame, *at)
    left, top = max(x - NEARBY, 0), max(y - NEARBY, 0)
    around = np.s_[top : y + NEARBY + 1, left : x + NEARBY + 1]
    shown = frame.primitive[around] == kept.primitive
    if not shown.any() and not kept.dynamic:
        distance = math.dist(frame.camera.position, kept.point)
        shown = (frame.depth[around] < distance * HIDDEN) & (frame.depth[around] > distance / HIDDEN)
    rows, columns = np.nonzero(shown)
    if not len(rows):
        return None
    columns, rows = columns + left, rows + top
    nearest = np.argmin(np.hypot(columns + 0.5 - at[0] * frame.width, rows + 0.5 - at[1] * frame.height))
    return int(columns[nearest]), int(rows[nearest])


# --- what a frame knows of a pixel --------------------------------------------------------------------


def unit_of(frame: Frame, primitive: int, at: tuple[int, int] | None) -> int:
    """What carries the modes and pixel counts of a primitive: itself or, where cells do, the one that its pixel shows;
    -1 where that is not seen."""
    if not has_modes_of_cells(frame):
        return primitive
    return -1 if at is None else int(frame.unit[at[1], at[0]])


def shadow_mode_of(frame: Frame, unit: int, light: int) -> ShadowMode | None:
    """A unit's shadow mode for a light; None where culling does not cover the light."""
    if not modes.has_shadow_mode(frame.modes, light):
        return None
    return ShadowMode(int(modes.shadow_mode(frame.modes[unit], light)))


def wrong_at(frame: Frame, x: int, y: int) -> int | None:
    """How many shadow answers of a pixel are wrong, None where that is not known."""
    known = frame.wrong is not None and (frame.shaded is None or frame.shaded[y, x])
    return int(frame.wrong[y, x]) if known and frame.wrong is not None else None


def point_at(frame: Frame, u: float, v: float) -> Vector | None:
    """The world point under a point of the picture, or None where the ray left the scene."""
    x, y = pixel_at(frame, u, v)
    depth = float(frame.depth[y, x])
    if not math.isfinite(depth):
        return None
    # Through the pixel's centre, as the ray was that found this depth.
    origin, direction = ray(frame.camera, (x + 0.5) / frame.width, (y + 0.5) / frame.height, frame.width / frame.height)
    return origin + depth * direction


def extent_at(frame: Frame, u: float, v: float) -> float | None:
    """A radius, in world units, of what the primitive under a point of the picture shows of itself."""
    x, y = pixel_at(frame, u, v)
    depth = float(frame.depth[y, x])
    if not math.isfinite(depth):
        return None
    rows, columns = np.nonzero(frame.primitive == frame.primitive[y, x])
    pixels = max(np.ptp(rows), np.ptp(columns)) + 1
    return depth * math.tan(math.radians(frame.camera.angle) / 2.0) * float(pixels) / frame.height


def typical_depth(frame: Frame) -> float:
    """How far the camera sees, as a rule: the median distance of what is hit; inf where nothing is."""
    depth = frame.depth[np.isfinite(frame.depth)]
    return float(np.median(depth)) if len(depth) else math.inf


# --- where primitives are, whether or not a picture shows them ------------------------------------------


def primitive_points(scene: Scene, primitive: int, time: float) -> NDArray[np.float64]:
    """World space corners of a primitive, (3, 3) of a triangle, (8, 3) of a box around a sphere or a cone; none of a
    corner that is beyond all numbers."""
    return _corners(scene, np.array([primitive]), time)


def points_of(now: Edited, picked: Pick, time: float) -> NDArray[np.float64]:
    """(k, 3) corners of what is selected: of the primitive, or of all of a part's that are somewhere."""
    part = picked.part
    return _corners(now.scene, np.array([picked.primitive]) if part is None else _primitives_of(now, part), time)


def outline_of(points: NDArray) -> list[NDArray[np.float64]]:
    """Lines (n, 3) around points: a triangle's sides, or else the edges of a box."""
    if len(points) == 3:
        return [points[[0, 1, 2, 0]]]
    if not len(points):
        return []
    low, high = points.min(axis=0), points.max(axis=0)
    corners = 0.5 * (low + high) + 0.5 * (high - low) * _BOX
    return [corners[list(edge)] for edge in _EDGES]


def _primitives_of(now: Edited, part: int) -> NDArray:
    """The numbers of a part's primitives in the edited scene: of those that are in it."""
    found = now.numbers[parts_of(now.original).primitives_of(part)]
    return found[found >= 0]


def _corners(scene: Scene, primitives: NDArray, time: float) -> NDArray[np.float64]:
    """(k, 3) corners of primitives of one object."""
    if not len(primitives):
        return np.empty((0, 3))
    index = scene.object_of(int(primitives[0]))
    owner, are_quadrics = scene.objects[index], primitives >= scene.triangle_count
    triangles = primitives[~are_quadrics] - int(scene.triangle_offsets[index])
    quadrics = primitives[are_quadrics] - int(scene.quadric_offsets[index])
    if owner.deformation is None:
        corners = owner.triangles.corners[triangles].astype(np.float64)
    else:
        d = owner.deformation
        keyed = replace(d, times=d.times[triangles], corners=d.corners[triangles], normals=d.normals[triangles])
        corners = deformed(keyed, time)[0].astype(np.float64)
    local = np.concatenate([corners.reshape(-1, 3), _boxes(owner.quadrics, quadrics).reshape(-1, 3)])
    matrix = scene.animation.matrix(owner.chain, time)
    with np.errstate(all="ignore"):
        points = np.asarray(local @ matrix[:3, :3].T + matrix[:3, 3], np.float64)
    return points[np.isfinite(points).all(axis=1)]


def _boxes(quadrics: Quadrics, which: NDArray) -> NDArray[np.float64]:
    """(k, 8, 3) corners of boxes around quadrics, in the space of their object."""
    boxes = np.repeat(_BOX[None], len(which), axis=0)
    cones = quadrics.kind[which] == CONE
    boxes[cones, :, :2] *= np.abs(quadrics.radii[which][cones]).max(axis=1)[:, None, None]
    boxes[cones, :, 2] = 0.5 * boxes[cones, :, 2] + 0.5
    maps = quadrics.to_object[which]
    return np.asarray(np.einsum("kij,kcj->kci", maps[:, :, :3], boxes) + maps[:, None, :, 3], np.float64)

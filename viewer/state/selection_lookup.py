"""Where primitives are in the world at a time, whether or not a picture shows them."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.scene.deformation import deformed
from tracer.scene.edits import Edited
from tracer.scene.model import CONE, Camera, Scene
from tracer.why_in_words import kind_of
from viewer.state import navigation
from viewer.state.parts import parts_of
from viewer.state.picking import Pick, pick, shadow_mode_of
from viewer.state.readings import has_modes_of_cells

_BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
_EDGES = [(a, b) for a in range(8) for b in range(a) if np.abs(_BOX[a] - _BOX[b]).sum() == 2.0]


class Place(NamedTuple):
    """A ball around something: its middle and radius in world units, and the unit normal of a triangle, else None."""

    middle: NDArray[np.float64]
    radius: float
    normal: NDArray[np.float64] | None = None


def primitive_points(scene: Scene, primitive: int, time: float) -> NDArray[np.float64]:
    """World space corners of a primitive: (3, 3) of a triangle, (8, 3) of a box around a sphere or a cone; (0, 3) where
    it is beyond all numbers."""
    corners = _corners(scene, scene.object_of(primitive), np.array([primitive]), time)[0]
    return corners if np.isfinite(corners).all() else np.empty((0, 3))


def part_points(now: Edited, part: int, time: float) -> NDArray[np.float64]:
    """(k, 3) corners of all primitives of a part that are somewhere."""
    scene, found = now.scene, _primitives_of(now, part)
    if not len(found):
        return np.empty((0, 3))
    index = scene.object_of(int(found[0]))
    quadrics = found >= scene.triangle_count
    corners = [_corners(scene, index, found[which], time).reshape(-1, 3) for which in (~quadrics, quadrics)]
    points = np.concatenate(corners)
    return points[np.isfinite(points).all(axis=1)]


def place_of(points: NDArray) -> Place | None:
    """Where these points are, of a triangle with its normal; None where there are none."""
    if not len(points):
        return None
    low, high, normal = points.min(axis=0), points.max(axis=0), None
    if len(points) == 3:
        across = np.cross(points[1] - points[0], points[2] - points[0])
        length = float(np.linalg.norm(across))
        normal = across / length if length > 0.0 else None
    return Place((low + high) / 2.0, float(np.linalg.norm(high - low)) / 2.0, normal)


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


def _corners(scene: Scene, index: int, primitives: NDArray, time: float) -> NDArray[np.float64]:
    """(k, corners, 3) of triangles, or of quadrics, of one object."""
    held = scene.objects[index]
    if not len(primitives):
        return np.empty((0, 3, 3))
    if primitives[0] < scene.triangle_count:
        which = primitives - int(scene.triangle_offsets[index])
        if held.deformation is None:
            local = held.triangles.corners[which].astype(np.float64)
        else:
            d = held.deformation
            keyed = replace(d, times=d.times[which], corners=d.corners[which], normals=d.normals[which])
            local = deformed(keyed, time)[0].astype(np.float64)
    else:
        local = _boxes(scene, index, primitives - int(scene.quadric_offsets[index]))
    matrix = scene.animation.matrix(held.chain, time)
    with np.errstate(all="ignore"):
        return np.asarray(local @ matrix[:3, :3].T + matrix[:3, 3], np.float64)


def _boxes(scene: Scene, index: int, which: NDArray) -> NDArray[np.float64]:
    """(k, 8, 3) corners of boxes around quadrics, in the space of their object."""
    quadrics = scene.objects[index].quadrics
    boxes = np.repeat(_BOX[None], len(which), axis=0)
    cones = quadrics.kind[which] == CONE
    boxes[cones, :, :2] *= np.abs(quadrics.radii[which][cones]).max(axis=1)[:, None, None]
    boxes[cones, :, 2] = 0.5 * boxes[cones, :, 2] + 0.5
    maps = quadrics.to_object[which]
    return np.asarray(np.einsum("kij,kcj->kci", maps[:, :, :3], boxes) + maps[:, None, :, 3], np.float64)


def pick_primitive(frame: Frame, scene: Scene, primitive: int) -> Pick | None:
    """A primitive as if it had been clicked: at the pixel in the middle of what is seen of it, or, where nothing of it
    is seen, at its own middle.  None for a number that is no primitive's, or of what is beyond all numbers."""
    if not 0 <= primitive < scene.primitive_count:
        return None
    shown = frame.primitive == primitive
    if shown.any():
        return _middle_pick(frame, scene, shown)
    points = primitive_points(scene, primitive, frame.time)
    if not len(points):
        return None
    x, y, z = points.mean(axis=0).tolist()
    in_cells = has_modes_of_cells(frame)
    known = not in_cells and primitive < len(frame.modes)
    unit = primitive if known else -1
    return Pick(
        -1,
        -1,
        primitive,
        unit=unit,
        in_cells=in_cells,
        kind=kind_of(scene, primitive),
        object_name=scene.name_of(primitive),
        dynamic=scene.object_of(primitive) > 0,
        material=scene.material_of(primitive),
        shadows=tuple(shadow_mode_of(frame, unit, light) if known else None for light in range(len(scene.lights))),
        point=(x, y, z),
    )


def pick_part(frame: Frame, now: Edited, part: int) -> Pick | None:
    """A part as if it had been clicked in its middle; None where it has no primitives, is hidden, or is nowhere."""
    found = _primitives_of(now, part)
    if not len(found):
        return None
    in_part = np.zeros(len(now.primitives) + 1, np.bool_)  # -1, a miss, finds the last of them
    in_part[found] = True
    shown = in_part[frame.primitive]
    return _middle_pick(frame, now.scene, shown) if shown.any() else pick_primitive(frame, now.scene, int(found[0]))


def _middle_pick(frame: Frame, scene: Scene, shown: NDArray[np.bool_]) -> Pick:
    """The one of these pixels that is nearest to their mean."""
    rows, columns = np.nonzero(shown)
    nearest = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
    x, y = int(columns[nearest]), int(rows[nearest])
    return pick(frame, scene, (x + 0.5) / frame.width, (y + 0.5) / frame.height)


def looking_at(camera: Camera, place: Place, world: navigation.Vector, seen: bool) -> Camera:
    """A camera that looks at something from near: from where it is or, where that is not `seen` and is a triangle, from
    above its front."""
    if seen or place.normal is None:
        return navigation.focus(camera, place.middle.tolist(), place.radius, world)
    away = max(place.radius, 1e-6 * float(np.abs(place.middle).max(initial=1.0)))
    start = place.middle + 1e3 * away * _tilted(place.normal, world)
    return navigation.focus(
        replace(camera, position=(float(start[0]), float(start[1]), float(start[2]))),
        place.middle.tolist(), away, world,
    )  # fmt: skip


def _tilted(normal: NDArray, world: navigation.Vector) -> NDArray:
    """The normal, turned a little where it is straight up or down, which is a bad way to look."""
    if np.linalg.norm(np.cross(normal, world)) > 0.3:
        return normal
    aside = np.cross(world, [0.0, 0.0, 1.0] if abs(world[2]) < 0.9 else [1.0, 0.0, 0.0])
    turned = normal + 0.4 * aside / np.linalg.norm(aside)
    return np.asarray(turned / np.linalg.norm(turned))

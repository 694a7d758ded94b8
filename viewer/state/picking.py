"""What a pixel shows: read from the frame's buffers, no ray needed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from tracer.culling import modes
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.renderer import Frame
from tracer.scene.model import Camera, Material, Scene
from tracer.why_in_words import kind_of
from viewer.state.navigation import Vector, ray
from viewer.state.projection import HIDDEN, place
from viewer.state.readings import has_modes_of_cells

NEARBY = 2
"""Pixels from a point's place on the picture at which its surface still stands for it."""


@dataclass(frozen=True)
class Pick:
    """One pixel of a frame.  `primitive` is -1 where the ray left the scene; then only x and y mean anything.

    `unit` carries the modes and counts; `in_cells` says whether units are virtual cells, else they are primitives.

    `wrong` is the number of the pixel's wrong shadow answers, None where that is not known; `seen` is the frame's
    time, camera, width and height."""

    x: int
    y: int
    primitive: int
    unit: int = -1
    in_cells: bool = False
    kind: str = ""
    object_name: str = ""
    dynamic: bool = False
    material: Material | None = None
    occlusion: OcclusionMode | None = None
    shadows: tuple[ShadowMode | None, ...] = ()
    pixels: int = 0
    highest: int = 0
    depth: float = math.inf
    point: tuple[float, float, float] | None = None
    normal: tuple[float, float, float] | None = None
    wrong: int | None = None
    seen: tuple[float, Camera, int, int] | None = None


def pixel_at(frame: Frame, u: float, v: float) -> tuple[int, int]:
    """The pixel under a point of the picture (0 to 1 from the left and the top)."""
    return min(max(int(u * frame.width), 0), frame.width - 1), min(max(int(v * frame.height), 0), frame.height - 1)


def pick(frame: Frame, scene: Scene, u: float, v: float) -> Pick:
    """Everything known about the pixel under a point of the picture."""
    x, y = pixel_at(frame, u, v)
    primitive = int(frame.primitive[y, x])
    if not 0 <= primitive < scene.primitive_count:
        return Pick(x, y, -1)
    index, unit = scene.object_of(primitive), int(frame.unit[y, x])
    return Pick(
        x,
        y,
        primitive,
        unit=unit,
        in_cells=has_modes_of_cells(frame),
        kind=kind_of(scene, primitive),
        object_name=scene.name_of(primitive),
        dynamic=index > 0,
        material=scene.material_of(primitive),
        occlusion=OcclusionMode(int(frame.modes[unit]) & 3),
        shadows=tuple(shadow_mode_of(frame, unit, light) for light in range(len(scene.lights))),
        pixels=int(frame.pixel_count[unit]),
        highest=int(frame.highest_count[unit]),
        depth=float(frame.depth[y, x]),
        point=_triple(point_at(frame, u, v)),
        normal=_triple(frame.normal[y, x]),
        wrong=_wrong_at(frame, x, y),
        seen=_seen(frame),
    )


def _wrong_at(frame: Frame, x: int, y: int) -> int | None:
    known = frame.wrong is not None and (frame.shaded is None or frame.shaded[y, x])
    return int(frame.wrong[y, x]) if known and frame.wrong is not None else None


def _seen(frame: Frame) -> tuple[float, Camera, int, int]:
    return frame.time, frame.camera, frame.width, frame.height


def same_place(one: Frame, other: Frame) -> bool:
    """Whether two frames are of the same moment from the same place, in the same size."""
    return _seen(one) == _seen(other)


def shadow_mode_of(frame: Frame, unit: int, light: int) -> ShadowMode | None:
    """A unit's shadow mode for a light; None where culling does not cover the light."""
    if not modes.has_shadow_mode(frame.modes, light):
        return None
    return ShadowMode(int(modes.shadow_mode(frame.modes[unit], light)))


def point_at(frame: Frame, u: float, v: float) -> Vector | None:
    """The world point under a point of the picture, or None where the ray left the scene."""
    x, y = pixel_at(frame, u, v)
    depth = float(frame.depth[y, x])
    if not math.isfinite(depth):
        return None
    # Through the pixel's centre, as the ray was that found this depth.
    origin, direction = ray(frame.camera, (x + 0.5) / frame.width, (y + 0.5) / frame.height, frame.width / frame.height)
    return origin + depth * direction


def pixel_of(kept: Pick, frame: Frame) -> tuple[int, int] | None:
    """The pixel of a frame that shows the point that was picked; None where the frame does not show it.

    At another size, or from elsewhere, the point lies between pixels: the nearest within `NEARBY` counts that shows its
    primitive, or else, as that may be smaller than a pixel, a surface at the point's distance."""
    if kept.seen == _seen(frame) and frame.primitive[kept.y, kept.x] == kept.primitive:
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
    apart = np.hypot(columns + left + 0.5 - at[0] * frame.width, rows + top + 0.5 - at[1] * frame.height)
    nearest = int(np.argmin(apart))
    return int(columns[nearest]) + left, int(rows[nearest]) + top


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


def _triple(v: Vector | None) -> tuple[float, float, float] | None:
    return None if v is None else (float(v[0]), float(v[1]), float(v[2]))


def refreshed(old: Pick, frame: Frame) -> Pick:
    """The same unit's modes and counts as a newer frame knows them; where it was clicked stays.

    Where units are others now, cells or no cells any more, it is the primitive, or else what the pixel shows.  Wrong
    answers are those of the pixel, and known only while it shows the same."""
    same, in_cells = old.seen == _seen(frame), has_modes_of_cells(frame)
    unit = old.unit if in_cells == old.in_cells else old.primitive
    if in_cells != old.in_cells and in_cells:
        unit = int(frame.unit[old.y, old.x]) if same else -1
    if old.primitive < 0 or not 0 <= unit < len(frame.modes):
        return old
    return replace(
        old,
        unit=unit,
        in_cells=in_cells,
        occlusion=OcclusionMode(int(frame.modes[unit]) & 3),
        shadows=tuple(shadow_mode_of(frame, unit, light) for light in range(len(old.shadows))),
        pixels=int(frame.pixel_count[unit]),
        highest=int(frame.highest_count[unit]),
        wrong=_wrong_at(frame, old.x, old.y) if same else None,
    )

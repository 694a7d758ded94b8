"""A small studio for a model that brings neither camera nor lights: a floor, three lamps and a first camera.

The model keeps its coordinates; the studio is built around it, with any axis up. The camera looks at it from the front,
the right and above, and its frame is filled as far as the model's own points allow. The key lamp stands to the
camera's left, the fill lamp to its right, and the rim lamp behind. The background is what the floor looks like at its
far edge, so that there is hardly a horizon.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Float32, Float64, vector
from tracer.scene.bounds import ball_of, extent
from tracer.scene.lights import Light
from tracer.scene.model import Camera, Material, Scene, SceneObject, Triangles

FLOOR = "studio floor"
"""The name of the floor's part and of its material."""
FLOOR_TRIANGLES = 2
FLOOR_REACH = 40.0
"""Radii of the model from its middle to the floor's edges."""
ANGLE = 40.0
FILLED = 0.8
"""Part of the frame's height and width, at most, that the model takes."""
LAMP_DISTANCE = 3.5
"""Radii of the model from its middle to a lamp, roughly."""

# Towards the camera's right, up and towards the camera, in LAMP_DISTANCE; radius, in the model's; colour; samples.
_LAMPS = {
    "key": ((-0.75, 0.95, 0.70), 0.60, (0.79, 0.765, 0.72), 64),
    "fill": ((1.05, 0.60, 0.60), 1.00, (0.28, 0.30, 0.34), 16),
    "rim": ((0.55, 1.00, -0.85), 0.90, (0.40, 0.40, 0.41), 16),
}
LAMPS = len(_LAMPS)
_FLOOR_COLOR = np.array([0.44, 0.45, 0.465])
_FLOOR_AMBIENT = np.array([0.25, 0.26, 0.275])

_BLOCK = 1 << 20  # points that are looked at together

_UPRIGHT = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-y": ((-1, 0, 0), (0, -1, 0), (0, 0, 1)),
    "z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "-z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "x": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-x": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
}
"""Right, up and front of a model, as seen from its front, by the axis that points up: turned about one axis each."""
TURNS = ("y", "z", "x", "-y", "-z", "-x")
"""The axes that may point up, the likeliest first."""


@dataclass(frozen=True)
class Studio:
    """What stands around a model."""

    floor: Triangles
    camera: Camera
    lights: tuple[Light, ...]
    material: Material
    background: tuple[float, float, float]


def build_studio(corners: Float32, up: str, material: int, report: Callable[[], None] = lambda: None) -> Studio:
    """The studio for triangles (n, 3, 3), n > 0, with the floor's material under this number; `report` is called again
    and again on the way, and may raise Cancelled."""
    points = np.unique(corners.reshape(-1, 3), axis=0) if len(corners) < 4096 else corners.reshape(-1, 3)
    frame = np.array(_UPRIGHT[up], np.float64)
    ends = np.stack(extent(points)).astype(np.float64) @ frame.T
    low, high = ends.min(axis=0), ends.max(axis=0)  # a turned box is a box, as the axes are but exchanged
    middle = (low + high) / 2
    radius = float(np.linalg.norm(high - low)) / 2 or 1.0
    away = _towards_camera(high - low)
    report()
    camera = _framing(points, away, frame, float(np.linalg.norm(high - low)), report)
    # Lower by a hair, so that it never fights with a face at the model's foot over who is seen.
    largest = float(np.abs(ends).max())
    ground = low[1] - max(5e-4 * radius, 4.0 * largest * float(np.finfo(np.float32).eps))
    beside = np.array([away[2], 0.0, -away[0]]) / np.hypot(away[0], away[2])
    behind = np.array([away[0], 0.0, away[2]]) / np.hypot(away[0], away[2])
    axes = np.stack([beside, (0.0, 1.0, 0.0), behind])
    lights = []
    for name, (place, size, color, samples) in _LAMPS.items():
        at = (middle + LAMP_DISTANCE * radius * (np.array(place) @ axes)) @ frame
        lights.append(Light(name, vector(at), color, kind="sphere", radius=size * radius, samples=samples))
    centre = np.array([middle[0], ground, middle[2]])
    reach = FLOOR_REACH * radius
    corner = [centre + reach * (a * beside + b * behind) for a, b in ((-1, 1), (1, 1), (1, -1), (-1, -1))]
    quad = np.stack(corner) @ frame
    floor = _two_triangles(quad.astype(np.float32), frame[1], material)
    far = (centre - reach * behind) @ frame
    return Studio(floor, camera, tuple(lights), _floor_material(), _seen(far, frame[1], lights))


def with_floor(static: SceneObject, floor: Triangles, report: Callable[[], None] = lambda: None) -> SceneObject:
    """Static geometry, and the floor as its last part; `report` as for `build_studio`."""
    t = static.triangles
    fields = []
    for name in t.__dataclass_fields__:
        fields.append(_joined(getattr(t, name), getattr(floor, name), report))
    joined = Triangles(*fields)
    assert static.part_of is not None
    n = len(t)
    part_of = np.insert(static.part_of, n, [len(static.parts)] * len(floor)).astype(np.int32)
    return replace(static, triangles=joined, parts=(*static.parts, FLOOR), part_of=part_of)


def _joined(many: NDArray[Any], few: NDArray[Any], report: Callable[[], None]) -> NDArray[Any]:
    """Both arrays, one behind the other."""
    joined = np.empty((len(many) + len(few), *many.shape[1:]), many.dtype)
    for start in range(0, len(many), _BLOCK):
        report()
        joined[start : start + _BLOCK][: len(many) - start] = many[start : start + _BLOCK]
    joined[len(many) :] = few
    return joined


def model_bounds(scene: Scene) -> Float64 | None:
    """(2, 3) least and greatest corner of the model that stands in a studio; None where there is no studio."""
    static = scene.objects[0]
    if FLOOR not in static.parts or static.part_of is None:
        return None
    model = static.triangles.corners[static.part_of[: len(static.triangles)] != static.parts.index(FLOOR)]
    return np.stack([model.min(axis=(0, 1)), model.max(axis=(0, 1))]).astype(np.float64) if len(model) else None


def up_in_studio(scene: Scene) -> str | None:
    """The axis that points up in a studio, such as "-z"; None where there is no studio."""
    if FLOOR not in scene.objects[0].parts:
        return None
    return next(up for up, frame in _UPRIGHT.items() if frame[1] == scene.camera.up)


def _towards_camera(size: Float64) -> Float64:
    """The unit vector from a model of this width, height and depth to its camera.

    What is deep is seen more from its side, and what is flat more from above."""
    width, height, depth = np.maximum(size, 1e-9 * max(float(size.max()), 1e-300))
    deep = np.clip(np.log2(depth / width) / 2.0, 0.0, 1.0)
    flat = np.clip((0.5 - height / max(width, depth)) / 0.45, 0.0, 1.0)
    turn, rise = np.radians(30.0 + 32.0 * deep), np.radians(22.0 + 14.0 * flat)
    return np.array([np.sin(turn) * np.cos(rise), np.sin(rise), np.cos(turn) * np.cos(rise)])


def _framing(points: Float32, away: Float64, frame: Float64, size: float, report: Callable[[], None]) -> Camera:
    """The nearest camera in this direction from which all points (n, 3) lie within the inner part of a square frame;
    `size` is their diagonal.

    Each side of the frame bounds a point's place by a plane, so the points that touch are found without a search."""
    across, top, forward = Camera((0.0, 0.0, 0.0), vector(-away)).basis()
    slope = FILLED * float(np.tan(np.radians(ANGLE) / 2))
    reach = np.full(5, -np.inf)
    for start in range(0, len(points), _BLOCK):
        report()
        columns = np.ascontiguousarray(points[start : start + _BLOCK].T, np.float64)
        x, y, z = (sum(a * b for a, b in zip(axis @ frame, columns)) for axis in (across, top, forward))
        sides = (x - slope * z, -x - slope * z, y - slope * z, -y - slope * z, -z)
        reach = np.maximum(reach, [side.max() for side in sides])
    right, left, upper, lower, near = reach.tolist()
    size = size or 1.0
    back = min(-(right + left) / (2 * slope), -(upper + lower) / (2 * slope), -near - 0.05 * size)
    position = (right - left) / 2 * across + (upper - lower) / 2 * top + back * forward
    return Camera(vector(position @ frame), vector(-away @ frame), vector(frame[1]), ANGLE)


def _two_triangles(quad: Float32, up: Float64, material: int) -> Triangles:
    """Four corners, counter-clockwise from above."""
    corners = quad[np.array([[0, 1, 2], [0, 2, 3]])]
    normals = np.broadcast_to(up.astype(np.float32), corners.shape).copy()
    n = FLOOR_TRIANGLES
    uvs = np.zeros((n, 3, 2), np.float32)
    return Triangles(corners, normals, uvs, np.full(n, material, np.int32), np.full(n, -1, np.int32))


def _floor_material() -> Material:
    return Material(FLOOR, vector(_FLOOR_AMBIENT), vector(_FLOOR_COLOR))


def _seen(point: Float64, up: Float64, lights: Sequence[Light]) -> tuple[float, float, float]:
    """The colour of the floor at a point, far from all shadows."""
    color = _FLOOR_AMBIENT.copy()
    for light in lights:
        way = np.array(light.position) - point
        color += _FLOOR_COLOR * light.color * max(float(way @ up / np.linalg.norm(way)), 0.0)
    return vector(color)


# --- without a studio: the whole model in view, lit from over both shoulders ---------------------------


def framing_camera(box: Float64 | None, angle: float = 45.0) -> Camera:
    """A camera that sees the whole of a box (2, 3), from the front, the right and above; y is up."""
    centre, radius = ball_of(box)
    away = np.array([0.45, 0.35, 1.0])
    away /= np.linalg.norm(away)
    position = centre + away * (1.05 * radius / np.sin(np.radians(angle) / 2))
    return Camera(vector(position), vector(-away), (0.0, 1.0, 0.0), angle)


def framing_lights(box: Float64 | None, camera: Camera) -> tuple[Light, Light]:
    """A key light over the camera's left shoulder and a weaker one over its right, both well outside the box."""
    centre, radius = ball_of(box)
    right, up, forward = camera.basis()
    key = centre + 3.0 * radius * (up * 0.9 - right * 0.7 - forward * 0.8)
    fill = centre + 3.0 * radius * (up * 0.5 + right * 1.0 - forward * 0.6)
    return (Light("key", vector(key), (0.8, 0.8, 0.8)), Light("fill", vector(fill), (0.35, 0.35, 0.35)))

"""Moving a camera: pure functions from a camera to another one.

Two ways to move, as in every modelling program: *fly* (walk along the view, look around in place)
and *orbit* (turn around a point, which stays where it is on the screen).  A camera is turned as a
rigid body, direction and up together, about the world's up and its own right hand; so a roll that
an animated camera brought along is kept, and looking straight up or down is avoided."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import Camera

Vector = NDArray[np.float64]

STEEPEST = math.radians(89.0)
RADIANS_PER_HEIGHT = math.radians(100.0)
CROSSING_SECONDS = 8.0
SHORTEST_FLIGHT, LONGEST_FLIGHT = 0.35, 1.5


def pace(low: Sequence[float], high: Sequence[float], seen: float = math.inf) -> float:
    """World units per second with which a scene of these bounds is crossed in a few seconds.

    `seen` is how far the scene's own camera typically sees: where that is much less (a room with a far horizon
    around it), it sets the pace."""
    size = float(np.linalg.norm(np.subtract(high, low)))
    size = min(size if size > 0.0 else math.inf, 2.0 * seen if seen > 0.0 else math.inf)
    return size / CROSSING_SECONDS if math.isfinite(size) else 1.0


def world_up(camera: Camera) -> Vector:
    """The world's up as a scene's camera suggests it: the nearest axis if it is near one, else its own up."""
    up = _unit(np.asarray(camera.up, np.float64))
    axis = int(np.argmax(np.abs(up)))
    snapped = np.zeros(3)
    snapped[axis] = math.copysign(1.0, up[axis])
    return snapped if float(up @ snapped) > 0.85 else up


def fly(camera: Camera, right: float, up: float, forward: float, world: Vector) -> Camera:
    """Walk by so many world units along the camera's right, the world's up and the camera's view."""
    hand, _, view = camera.basis()
    return _moved(camera, right * hand + up * world + forward * view)


def look(camera: Camera, right: float, up: float, world: Vector) -> Camera:
    """Turn in place by so many radians to the right and upwards."""
    return _turned(camera, _rotation(camera, right, up, world))


def orbit(camera: Camera, pivot: Sequence[float], right: float, up: float, world: Vector) -> Camera:
    """Turn the camera around a point, as if the hand moved the world by so many radians right and up."""
    turn = _rotation(camera, right, up, world)
    arm = np.subtract(camera.position, pivot)
    return replace(_turned(camera, turn), position=_triple(np.asarray(pivot) + turn @ arm))


def pan(camera: Camera, right: float, up: float, distance: float) -> Camera:
    """Shift sideways so that what is `distance` away moves by so many picture heights."""
    hand, head, _ = camera.basis()
    size = 2.0 * distance * math.tan(math.radians(camera.angle) / 2.0)
    return _moved(camera, -size * (right * hand + up * head))


def dolly(camera: Camera, pivot: Sequence[float], notches: float) -> Camera:
    """Go towards a point by a tenth of the way per notch (away if negative), never through it."""
    arm = np.subtract(camera.position, pivot)
    return replace(camera, position=_triple(np.asarray(pivot) + arm * 0.9**notches))


def focus(camera: Camera, point: Sequence[float], radius: float, world: Vector) -> Camera:
    """Look straight at a point, from where something of that radius fills a third of the height; never farther than
    now, unless the camera is inside that radius."""
    arm = np.subtract(point, camera.position)
    distance = float(np.linalg.norm(arm))
    if not math.isfinite(distance) or distance < 1e-12:
        return camera
    view = arm / distance
    fitting = 3.0 * radius / math.tan(math.radians(camera.angle) / 2.0)
    wanted = max(min(distance, fitting), 1.5 * radius, 1e-3 * distance)
    up = world if np.linalg.norm(np.cross(view, world)) > math.cos(STEEPEST) else np.asarray(camera.up)
    return replace(camera, position=_triple(np.subtract(point, view * wanted)), direction=_triple(view), up=_triple(up))


def ray(camera: Camera, x: float, y: float, aspect: float) -> tuple[Vector, Vector]:
    """Origin and unit direction through a point of the picture; x and y run from 0 (left, top) to 1."""
    hand, head, view = camera.basis()
    half = math.tan(math.radians(camera.angle) / 2.0)
    direction = view + (2.0 * x - 1.0) * half * aspect * hand + (1.0 - 2.0 * y) * half * head
    return np.asarray(camera.position, np.float64), _unit(direction)


def flight_seconds(start: Camera, end: Camera, pace: float) -> float:
    """How long a flight from one place to another takes: longer for a long way or a wide turn, and never long.

    `pace` is in world units per second."""
    way = float(np.linalg.norm(np.subtract(end.position, start.position))) / max(pace, 1e-300)
    turn = math.acos(min(max(float(start.basis()[2] @ end.basis()[2]), -1.0), 1.0))
    return SHORTEST_FLIGHT + (LONGEST_FLIGHT - SHORTEST_FLIGHT) * (1.0 - math.exp(-0.35 * way - 0.6 * turn))


def blend(start: Camera, end: Camera, t: float) -> Camera:
    """The camera a fraction `t` (eased) of the way between two, for a glide that the eye can follow."""
    if t >= 1.0:
        return end
    t = t * t * (3.0 - 2.0 * t)
    position = np.add(np.multiply(start.position, 1.0 - t), np.multiply(end.position, t))
    first, last = start.basis(), end.basis()
    direction = _between(first[2], last[2], first[1], t)
    up = (1.0 - t) * first[1] + t * last[1]
    if np.linalg.norm(np.cross(direction, up)) < 1e-3:
        up = last[1] if np.linalg.norm(np.cross(direction, last[1])) >= 1e-3 else first[1]
    angle = (1.0 - t) * start.angle + t * end.angle
    return Camera(_triple(position), _triple(_unit(direction)), _triple(_unit(up)), angle)


def _between(first: Vector, last: Vector, axis: Vector, t: float) -> Vector:
    """A unit vector a fraction of the turn from one to another; about `axis` where they are opposite."""
    across = np.cross(first, last)
    size = float(np.linalg.norm(across))
    turn = math.atan2(size, float(first @ last))
    if size < 1e-9:
        return first if turn < 1.0 else _about(axis, turn * t) @ first
    return _about(across / size, turn * t) @ first


def _rotation(camera: Camera, right: float, up: float, world: Vector) -> Vector:
    """The (3, 3) turn by a heading about the world's up and a pitch about the camera's right hand."""
    hand, _, view = camera.basis()
    pitch = math.asin(min(max(float(view @ world), -1.0), 1.0))
    # Where the camera is steeper already than we would go, only the way back is open.
    allowed = min(max(pitch + up, min(-STEEPEST, pitch)), max(STEEPEST, pitch)) - pitch
    return _about(world, -right) @ _about(hand, allowed)


def _about(axis: Vector, angle: float) -> Vector:
    x, y, z = _unit(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)


def _turned(camera: Camera, turn: Vector) -> Camera:
    _, up, view = camera.basis()
    return replace(camera, direction=_triple(turn @ view), up=_triple(turn @ up))


def _moved(camera: Camera, step: Vector) -> Camera:
    return replace(camera, position=_triple(np.add(camera.position, step)))


def _unit(v: Vector) -> Vector:
    return v / max(float(np.linalg.norm(v)), 1e-300)


def _triple(v: Vector) -> tuple[float, float, float]:
    return float(v[0]), float(v[1]), float(v[2])

"""Moving a camera: pure functions from a camera to another one, and to the frames of a film.

Two ways to move, as in every modelling program: *fly* (walk along the view, look around in place)
and *orbit* (turn around a point, which stays where it is on the screen).  A camera is turned as a
rigid body, direction and up together, about the world's up and its own right hand; so a roll that
an animated camera brought along is kept, and looking straight up or down is avoided.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import Camera, Scene
from viewer.state.plans import MOST_RUN_FRAMES

Vector = NDArray[np.float64]

STEEPEST = math.radians(89.0)
RADIANS_PER_HEIGHT = math.radians(100.0)
CROSSING_SECONDS = 8.0
SHORTEST_FLIGHT, LONGEST_FLIGHT = 0.35, 1.5
LEG = 2.0
"""Seconds from one bookmark to the next, where nothing else is said."""
_FINE = 400  # points between two bookmarks, by which the way is measured


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


# --- films -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Stop:
    """A place to fly through, and the scene's time there."""

    time: float
    camera: Camera


@dataclass(frozen=True)
class Take:
    """A frame of a film: its camera is the scene's own where that is None; `warmup` is how many frames of the scene's
    path come before it in the film, None where those before it are others, and `number` its number on that path, None
    where it is no frame of it."""

    time: float
    camera: Camera | None
    warmup: int | None = None
    number: int | None = None


def along_path(
    scene: Scene, first: int, last: int, frames: int | None = None, camera: Camera | None = None
) -> list[Take]:
    """The scene's frames `first` to `last`, or so many `frames` at even distances of time between these.

    Raises ValueError, in one line, for frames that there are not."""
    if not 0 <= first <= last < scene.frames:
        only = "is 0" if scene.frames == 1 else f"are 0 to {scene.frames - 1}"
        raise ValueError(f"frames {first} to {last}: the scene's frame numbers {only}")
    if frames is None or frames == last - first + 1:
        return [Take(scene.frame_time(n), camera, n - first, n) for n in range(first, last + 1)]
    _check(frames)
    return [Take(float(time), camera) for time in np.linspace(scene.frame_time(first), scene.frame_time(last), frames)]


def through(stops: Sequence[Stop], frames: int) -> list[Take]:
    """So many frames through bookmarks, at an even speed: a smooth way, of which each frame goes on as far.

    Turning counts as moving: by one radian as much as by the mean way between two bookmarks.  Raises ValueError where
    there are fewer than two stops."""
    if len(stops) < 2:
        raise ValueError("a film through bookmarks needs two of them at least")
    _check(frames)
    rows = np.array([[*s.camera.position, *s.camera.basis()[2], *s.camera.basis()[1], s.camera.angle, s.time]
                     for s in stops])  # fmt: skip
    fine = np.concatenate([_span(rows, n) for n in range(len(stops) - 1)] + [rows[-1:]])
    way = _measured(fine, np.linalg.norm(np.diff(rows[:, :3], axis=0), axis=1).mean())
    if way[-1] == 0.0:  # all at one place: time alone goes on
        way = np.linspace(0.0, 1.0, len(fine))
    at = np.linspace(0.0, way[-1], frames)
    takes = [
        Take(float(row[10]), Camera(_triple(row[:3]), _triple(row[3:6]), _triple(row[6:9]), float(row[9])))
        for row in np.stack([np.interp(at, way, column) for column in fine.T], axis=-1)
    ]
    takes[0], takes[-1] = (Take(stop.time, stop.camera) for stop in (stops[0], stops[-1]))
    return takes


def _check(frames: int) -> None:
    if not 2 <= frames <= MOST_RUN_FRAMES:
        raise ValueError(f"a film has 2 to {MOST_RUN_FRAMES:,} frames, not {frames:,}")


def _span(rows: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """(_FINE, 11) the way from bookmark n to the next, without its end: a Catmull-Rom curve for where the camera is and
    looks, a straight line for angle and time, which must not overshoot."""
    before, start, end, after = (rows[min(max(n + k, 0), len(rows) - 1)] for k in (-1, 0, 1, 2))
    t = np.linspace(0.0, 1.0, _FINE, endpoint=False)[:, None]
    into, out = 0.5 * (end - before), 0.5 * (after - start)
    h = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, 3 * t**2 - 2 * t**3, t**3 - t**2)
    curve = h[0] * start + h[1] * into + h[2] * end + h[3] * out
    curve[:, 9:] = start[9:] + t * (end[9:] - start[9:])
    for part in (slice(3, 6), slice(6, 9)):  # a direction: of length 1 again, and never none
        length = np.linalg.norm(curve[:, part], axis=1, keepdims=True)
        curve[:, part] = np.where(length < 1e-3, end[part], curve[:, part] / np.maximum(length, 1e-3))
    return curve


def _measured(fine: NDArray[np.float64], radian: float) -> NDArray[np.float64]:
    """(n,) how far it is to each point of the way; a turn by one radian is so far."""
    moved, *turned = (np.linalg.norm(np.diff(fine[:, i : i + 3], axis=0), axis=1) for i in (0, 3, 6))
    return np.concatenate([[0.0], np.cumsum(np.hypot(moved, (radian or 1.0) * np.maximum(*turned)))])

"""From the world onto the picture: points and lines as the camera of a frame sees them, and what hides them.

Places on the picture are 0 to 1 from the left and the top, as the pointer's are.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracer.frame import Frame
from tracer.scene.model import Camera

NEAR = 1e-6  # of the way to the farther end: what lies nearer to the camera's plane has no place
DASH = 6.0  # pixels of a frame 512 high that a dash, and the gap after it, are long
MOST_DASHES = 64  # of one line
HIDDEN = 1.01  # times the distance of what is seen there: what lies farther is behind it


class Stroke(NamedTuple):
    """A piece of a line on the picture, and whether it is seen or lies behind something."""

    start: tuple[float, float]
    end: tuple[float, float]
    seen: bool


def seen_from(camera: Camera, points: ArrayLike) -> NDArray[np.float64]:
    """Points (..., 3) along the camera's right, up and view."""
    return (np.asarray(points, np.float64) - camera.position) @ camera.basis().T


def place(frame: Frame, point: ArrayLike) -> tuple[float, float] | None:
    """Where a point is on the picture, or beside it; None for one behind the camera."""
    seen = seen_from(frame.camera, point)
    if seen[2] <= 0.0:
        return None
    u, v = _on_picture(frame, seen)
    return float(u), float(v)


def at_depth(frame: Frame, at: tuple[float, float], depth: float) -> tuple[float, float, float]:
    """The point that is seen at a place of the picture, so far along the camera's view."""
    across, half = _halves(frame)
    seen = np.array([(2.0 * at[0] - 1.0) * across * depth, (1.0 - 2.0 * at[1]) * half * depth, depth])
    x, y, z = frame.camera.position + seen @ frame.camera.basis()
    return float(x), float(y), float(z)


def seen_at(frame: Frame, x: int | NDArray[np.int64], y: int | NDArray[np.int64]) -> NDArray[np.float64]:
    """The points (..., 3) that pixels (...) show."""
    right, up, forward = frame.camera.basis()
    pixel = 2.0 * math.tan(math.radians(frame.camera.angle) / 2.0) / frame.height
    across, above = np.add(x, 0.5 - 0.5 * frame.width), np.subtract(0.5 * frame.height - 0.5, y)
    way = forward + pixel * (across[..., None] * right + above[..., None] * up)
    way *= frame.depth[y, x][..., None] / np.linalg.norm(way, axis=-1, keepdims=True)
    return np.asarray(frame.camera.position + way)


def strokes(frame: Frame, line: ArrayLike) -> list[Stroke]:
    """A line through points (n, 3) as it is drawn: what leaves the picture cut off, hidden parts in dashes."""
    corners = seen_from(frame.camera, line)
    return [stroke for a, b in pairwise(corners) for stroke in _segment(frame, a, b)]


def _halves(frame: Frame) -> tuple[float, float]:
    """Half of the picture's width and height at distance 1."""
    half = math.tan(math.radians(frame.camera.angle) / 2.0)
    return half * frame.width / frame.height, half


def _on_picture(frame: Frame, seen: NDArray) -> NDArray[np.float64]:
    """(..., 2), where points (..., 3) that the camera sees are on the picture."""
    across, half = _halves(frame)
    return 0.5 + 0.5 * seen[..., :2] / (seen[..., 2:] * (across, -half))


def _clipped(frame: Frame, a: NDArray, b: NDArray) -> tuple[NDArray, NDArray] | None:
    """What lies in front of the camera and inside the picture, of a segment that the camera sees."""
    across, half = _halves(frame)
    planes = np.array([[-1, 0, across], [1, 0, across], [0, -1, half], [0, 1, half], [0, 0, 1]], np.float64)
    least = np.array([0, 0, 0, 0, NEAR * max(np.linalg.norm(a), np.linalg.norm(b))])
    at_a, at_b = planes @ a - least, planes @ b - least
    first, last = 0.0, 1.0
    for start, end in zip(at_a, at_b):
        if start < 0.0 and end < 0.0:
            return None
        if start < 0.0:
            first = max(first, start / (start - end))
        elif end < 0.0:
            last = min(last, start / (start - end))
    return (a + first * (b - a), a + last * (b - a)) if first < last else None


def _segment(frame: Frame, a: NDArray, b: NDArray) -> list[Stroke]:
    """One segment in pieces of even length on the picture; of those that are hidden, every other one."""
    inside = _clipped(frame, a, b)
    if inside is None:
        return []
    ends = np.stack(inside)
    across, half = _halves(frame)
    places = _on_picture(frame, ends)
    length = math.hypot((places[1, 0] - places[0, 0]) * frame.width / frame.height, places[1, 1] - places[0, 1])
    pieces = min(max(1, math.ceil(512.0 * length / DASH)), MOST_DASHES)
    steps = np.linspace(0.0, 1.0, pieces + 1)[:, None]
    points = [(float(u), float(v)) for u, v in places[0] + steps * (places[1] - places[0])]
    middles = 0.5 * (steps[1:] + steps[:-1])
    at = places[0] + middles * (places[1] - places[0])
    depth = 1.0 / ((1.0 - middles) / ends[0, 2] + middles / ends[1, 2])[:, 0]  # even on the picture, not in the world
    way = np.hypot(1.0, np.hypot((2.0 * at[:, 0] - 1.0) * across, (2.0 * at[:, 1] - 1.0) * half))
    seen = depth * way <= HIDDEN * _farthest_around(frame, at)
    found: list[Stroke] = []
    for i, visible in enumerate(seen.tolist()):
        if visible and found and found[-1].seen and seen[i - 1]:
            found[-1] = found[-1]._replace(end=points[i + 1])
        elif visible or i % 2 == 0:
            found.append(Stroke(points[i], points[i + 1], visible))
    return found


def _farthest_around(frame: Frame, at: NDArray) -> NDArray:
    """(n,) the largest distance that the picture shows at places (n, 2) and next to them: a line along an edge of what
    is seen is seen."""
    x = (at[:, 0] * frame.width).astype(np.int64)[:, None] + np.array([-1, 0, 1] * 3)
    y = (at[:, 1] * frame.height).astype(np.int64)[:, None] + np.repeat([-1, 0, 1], 3)
    return frame.depth[np.clip(y, 0, frame.height - 1), np.clip(x, 0, frame.width - 1)].max(axis=1)

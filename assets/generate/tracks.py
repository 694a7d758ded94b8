"""Keyed motion (AFF `k`): sampling smooth paths into translation and rotation keys.

The first and the last key of an AFF track only shape tangents, so every track here starts one key
before the time at which it is wanted and ends one key after it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from generate.aff import numbers
from generate.mesh import Array


def axis_angle(matrix: Array) -> tuple[float, float, float, float]:
    """Axis and degrees of a (3, 3) rotation."""
    skew = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    sine, cosine = np.linalg.norm(skew) / 2, (np.trace(matrix) - 1) / 2
    angle = math.atan2(float(sine), float(cosine))
    if sine > 1e-6:
        axis = skew / (2 * sine)
    elif cosine > 0:
        return 0.0, 1.0, 0.0, 0.0
    else:  # half a turn: the axis is a column of R + 1
        columns = matrix + np.eye(3)
        axis = columns[:, np.linalg.norm(columns, axis=0).argmax()]
        axis = axis / np.linalg.norm(axis)
    return float(axis[0]), float(axis[1]), float(axis[2]), math.degrees(angle)


def key_times(start: float, end: float, keys: int) -> Array:
    """`keys` times from start to end, and one more on either side."""
    step = (end - start) / (keys - 1)
    return np.asarray(start + step * np.arange(-1, keys + 1), np.float64)


def translation(times: Array, where: Callable[[float], Sequence[float]]) -> str:
    rows = [f"{numbers((t, *where(float(t))), 4)} 0 0 0" for t in times]
    return "\n".join([f"transl {len(rows)}", *rows])


def turning(times: Array, how: Callable[[float], tuple[float, float, float, float]]) -> str:
    """Rotation keys from a function that gives axis and degrees."""
    rows = [f"{numbers((t, *how(float(t))), 5)} 0 0 0" for t in times]
    return "\n".join([f"rot {len(rows)}", *rows])


def track(name: str, *parts: str) -> str:
    return "\n".join([f"k {name} {{", *parts, "}"])


class Flight:
    """A smooth way through (time, position, target) waypoints, looking at the target."""

    def __init__(self, waypoints: Sequence[tuple[float, tuple[float, ...], tuple[float, ...]]]) -> None:
        self.times = np.array([w[0] for w in waypoints], np.float64)
        self.points = np.array([(*w[1], *w[2]) for w in waypoints], np.float64)
        gaps = np.diff(self.times)[:, None]
        slopes = np.diff(self.points, axis=0) / gaps
        self.tangents = np.zeros_like(self.points)  # at rest at both ends, so that a loop has no jolt
        self.tangents[1:-1] = (slopes[:-1] * gaps[1:] + slopes[1:] * gaps[:-1]) / (gaps[:-1] + gaps[1:])

    def at(self, time: float) -> tuple[Array, Array]:
        """Position and target at a time, at rest before the first and after the last waypoint."""
        time = min(max(time, self.times[0]), self.times[-1])
        i = min(int(np.searchsorted(self.times, time, side="right")) - 1, len(self.times) - 2)
        gap = self.times[i + 1] - self.times[i]
        u = (time - self.times[i]) / gap
        p, q, a, b = self.points[i], self.points[i + 1], self.tangents[i] * gap, self.tangents[i + 1] * gap
        blend = p * (1 + 2 * u) * (1 - u) ** 2 + a * u * (1 - u) ** 2 + q * u * u * (3 - 2 * u) + b * u * u * (u - 1)
        return blend[:3], blend[3:]

    def rotation(self, time: float) -> tuple[float, float, float, float]:
        """The camera's rotation: it looks along its own -z, with +y up."""
        position, target = self.at(time)
        back = position - target
        back = back / np.linalg.norm(back)
        right = np.cross([0.0, 1.0, 0.0], back)
        right = right / np.linalg.norm(right)
        return axis_angle(np.stack([right, np.cross(back, right), back], axis=1))

    def text(self, start: float, end: float, keys: int) -> str:
        times = key_times(start, end, keys)
        return track("camera", translation(times, lambda t: self.at(t)[0].tolist()), turning(times, self.rotation))

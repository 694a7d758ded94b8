"""A pinhole camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tracer.scene.arrays import Float64
from tracer.scene.limits import LARGEST


@dataclass(frozen=True)
class Camera:
    """A pinhole: rays through pixel centres, row 0 at the top, `angle` the vertical field of view in degrees."""

    position: tuple[float, float, float]
    direction: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    angle: float = 45.0

    def basis(self) -> Float64:
        """Right, up and forward, orthonormal, as the rows of a (3, 3) array."""
        forward, up = _moderate(self.direction), _moderate(self.up)
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, up)
        if np.linalg.norm(right) < 1e-9:  # up along the view: any right hand will do
            right = np.cross(forward, np.eye(3)[np.argmin(np.abs(forward))])
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(right, forward), forward])

    def to_json(self) -> dict[str, object]:
        return {
            "position": list(self.position),
            "direction": list(self.direction),
            "up": list(self.up),
            "angle": self.angle,
        }

    @staticmethod
    def from_json(data: dict) -> Camera:
        """The inverse of `to_json`; raises ValueError, in one line, on anything else."""
        try:
            position, direction, up = (
                tuple(map(_number, data.get(key, default)))
                for key, default in (("position", ()), ("direction", ()), ("up", (0, 1, 0)))
            )
            angle = _number(data.get("angle", 45.0))
        except (TypeError, ValueError, AttributeError, OverflowError):
            raise ValueError("a camera needs lists of numbers: position, direction, up; and an angle") from None
        vectors = (position, direction, up)
        if any(len(v) != 3 for v in vectors) or not np.all(np.isfinite([*position, *direction, *up, angle])):
            raise ValueError("a camera's position, direction and up are three finite numbers each")
        if np.abs(position).max() > LARGEST:
            raise ValueError(f"a camera's position lies within {LARGEST:g}")
        if not 0.0 < angle < 180.0 or not any(direction):
            raise ValueError("a camera's angle lies between 0 and 180 degrees, and its direction is not zero")
        return Camera(position, direction, up, angle)  # type: ignore[arg-type]


def _number(value: object) -> float:
    """A number of JSON; raises TypeError for what only looks like one: true, "3"."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(value)
    return float(value)


def _moderate(vector: tuple[float, float, float]) -> Float64:
    """(3,) a vector, scaled where its square would leave the range of float64."""
    largest = float(np.abs(vector).max())
    return np.asarray(vector, np.float64) / (1.0 if 1e-100 < largest < 1e100 else largest or 1.0)

"""Which rays a point sends on: the rules of `tracer.shading.bounce`, for one point."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.interpreted import interpreted
from tracer.methods.watching import Seen
from tracer.scene.arrays import Float32
from tracer.shading import points, wave
from tracer.shading.bounce import MIN_WEIGHT, SPLITS, reflected, refracted

_reflected, _refracted = interpreted(reflected), interpreted(refracted)
ZERO, ONE = np.float32(0), np.float32(1)


class SentRay(NamedTuple):
    """A ray that a point sends on: whether it is refracted, and its origin, direction and weight (3,)."""

    refracted: bool
    origin: Float32
    direction: Float32
    weight: Float32

    @property
    def key(self) -> bytes:
        """Its origin and direction, to the bit."""
        return bytes(self.origin.tobytes() + self.direction.tobytes())


def sent_rays(seen: Seen, row: int) -> list[SentRay]:
    """The rays that are sent on from the hit of a ray that was seen, if it has any bounces left."""

    def point(first: int) -> Float32:
        return seen.point[row, first : first + 3]

    def sent(refracts: bool, origin: Float32, way: tuple, scale: Float32) -> list[SentRay]:
        weight = seen.wave[row, wave.WEIGHT : wave.WEIGHT + 3] * scale
        if not weight.max() >= MIN_WEIGHT:
            return []
        x, y, z = way
        length = np.sqrt(x * x + y * y + z * z)
        return [SentRay(refracts, origin, np.array([x / length, y / length, z / length], np.float32), weight)]

    with np.errstate(all="ignore"):
        direction, normal = seen.wave[row, wave.DIRECTION : wave.DIRECTION + 3], point(points.NORMAL_ROW)
        through, ior = (seen.point[row, column] for column in (points.TRANSMISSION_ROW, points.IOR_ROW))
        specular, splits, rays = point(points.SPECULAR_ROW).copy(), seen.bounce[row] < SPLITS, []
        if through > ZERO:
            passes, way = _refracted(direction, normal, ONE / ior if seen.entering[row] else ior)
            goes = bool(passes) and (splits or bool(through >= specular.max()))
            if goes:
                sunk = point(points.POSITION_ROW) - seen.point[row, points.OFFSET_ROW] * point(points.GEOMETRIC_ROW)
                rays += sent(True, sunk, way, through)
            specular += ZERO if passes else through
            if not splits and goes:
                specular[:] = ZERO
        return rays + sent(False, point(points.LIFTED_ROW), _reflected(direction, normal), specular)

"""The lights of a frame, as shading reads them: each is a lamp with one sample or more."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.scene.lights import Light

COLOR, FALLS_OFF = 0, 3
LAMP_COLUMNS = 4
ROUNDED_UP = 1.000001  # times a number, in float32 no less than that


class Lamps(NamedTuple):
    """l lamps with n samples in all.

    places (l, 3) float32 are their centres, or the one sample that they have; samples (n, 3) float32 are positions,
    those of lamp i from first[i] to first[i + 1] - 1, first (l + 1,) int32; rows (l, 4) float32 are the colour of each
    sample, and 1 where it falls off with the square of the distance.  radii (l,) float32 are those of balls around
    places in which the lamp's samples lie: 0 for a single one."""

    places: NDArray[np.float32]
    samples: NDArray[np.float32]
    first: NDArray[np.int32]
    rows: NDArray[np.float32]
    radii: NDArray[np.float32]


class LampTable:
    """Lamps that keep their shape from frame to frame, wherever they are."""

    def __init__(self, lights: tuple[Light, ...]) -> None:
        self.lights = lights
        offsets = [light.offsets() for light in lights]
        counts = np.array([len(o) for o in offsets], np.int64)
        self._offsets = np.concatenate([np.empty((0, 3)), *offsets])
        self._owner = np.repeat(np.arange(len(lights)), counts)
        self._first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        self._rows = np.zeros((len(lights), LAMP_COLUMNS), np.float32)
        for row, light, count in zip(self._rows, lights, counts, strict=True):
            row[:FALLS_OFF] = np.array(light.color) / count
            row[FALLS_OFF] = light.falloff != "none"
        #: (l,) bool: lamps with one sample.
        self.single = counts == 1

    def at(self, centers: NDArray[np.float64]) -> Lamps:
        """The lamps with their centres (l, 3) there."""
        samples = (centers[self._owner] + self._offsets).astype(np.float32)
        places = centers.astype(np.float32)
        places[self.single] = samples[self._first[:-1][self.single]]
        return Lamps(places, samples, self._first, self._rows, self._radii(places, samples))

    def _radii(self, places: NDArray[np.float32], samples: NDArray[np.float32]) -> NDArray[np.float32]:
        if not len(self.lights):
            return np.empty(0, np.float32)
        away = np.linalg.norm(samples.astype(np.float64) - places[self._owner], axis=1)
        return (ROUNDED_UP * np.maximum.reduceat(away, self._first[:-1])).astype(np.float32)

"""The pictures of a zoom test, kept as it goes: the filmstrip of the paper's Figure 4.

Each is kept as a PNG.  Memory is bounded: where they take too much, every second step's is given up, then every second
of the rest, for all zoom factors alike.
"""

from __future__ import annotations

import io
import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

MOST_BYTES = 64_000_000


@dataclass(frozen=True)
class Shot:
    """The recorded picture of a step towards a primitive with one zoom factor."""

    factor: float
    number: int
    width: int
    height: int
    png: bytes

    def pixels(self) -> NDArray[np.uint8]:
        """Return (height, width, 3), row 0 at the top."""
        return self.thumbnail(self.height)

    def thumbnail(self, height: int) -> NDArray[np.uint8]:
        """Return the same, so many pixels high at most."""
        with Image.open(io.BytesIO(self.png), formats=("PNG",)) as image:
            if height < self.height:
                image.thumbnail((4 * height, height), Image.Resampling.BOX)
            return np.asarray(image.convert("RGB"))


class Filmstrip:
    """Recorded on one thread while others look."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._most_bytes = most_bytes
        self._lock = threading.Lock()
        self._shots: list[Shot] = []
        self._every = 1

    def record(self, factor: float, number: int, pixels: NDArray[np.uint8]) -> None:
        """Keep the picture of a step, (height, width, 3)."""
        if number % self._every:
            return
        file = io.BytesIO()
        Image.fromarray(pixels).save(file, "PNG", compress_level=1)
        with self._lock:
            self._shots.append(Shot(factor, number, pixels.shape[1], pixels.shape[0], file.getvalue()))
            while sum(len(one.png) for one in self._shots) > self._most_bytes and any(s.number for s in self._shots):
                self._every *= 2
                self._shots = [shot for shot in self._shots if shot.number % self._every == 0]

    def of(self, factor: float) -> list[Shot]:
        """Return the pictures that are kept of the way with a zoom factor, in their order."""
        with self._lock:
            return sorted((s for s in self._shots if s.factor == factor), key=lambda shot: shot.number)

    def nearest(self, factor: float, number: int) -> Shot | None:
        """Return the picture of a step, or else that of the nearest one that is kept."""
        return min(self.of(factor), key=lambda shot: abs(shot.number - number), default=None)

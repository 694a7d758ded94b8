"""The pictures of a zoom test, kept as it goes: the filmstrip of the paper's Figure 4.

Each is the traced picture with rings around wrong pixels, as a PNG.  Memory is bounded: where they get too many or too
large, every second step's is given up, then every second of the rest, for all zoom factors alike.
"""

from __future__ import annotations

import io
import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer.frame import Frame
from viewer.views.difference import ringed

MOST_BYTES = 64_000_000
MOST_SHOTS = 600


@dataclass(frozen=True)
class Shot:
    """The recorded picture of a step towards a primitive with one zoom factor."""

    factor: float
    number: int
    width: int
    height: int
    png: bytes

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3), row 0 at the top."""
        with Image.open(io.BytesIO(self.png), formats=("PNG",)) as image:
            return np.asarray(image.convert("RGB"))

    def thumbnail(self, height: int) -> NDArray[np.uint8]:
        """The same, so many pixels high at most."""
        with Image.open(io.BytesIO(self.png), formats=("PNG",)) as image:
            image.thumbnail((4 * height, height), Image.Resampling.BOX)
            return np.asarray(image.convert("RGB"))


class Filmstrip:
    """Recorded on one thread while others look."""

    def __init__(self, most_bytes: int = MOST_BYTES, most_shots: int = MOST_SHOTS) -> None:
        self._most = most_bytes, most_shots
        self._lock = threading.Lock()
        self._shots: dict[tuple[float, int], Shot] = {}
        self._bytes = 0
        self._every = 1

    def record(self, factor: float, number: int, frame: Frame) -> None:
        """Keep the picture of a step's verified frame."""
        if number % self._every:
            return
        file = io.BytesIO()
        Image.fromarray(ringed(frame)).save(file, "PNG", compress_level=1)
        shot = Shot(factor, number, frame.width, frame.height, file.getvalue())
        with self._lock:
            self._shots[factor, number] = shot
            self._bytes += len(shot.png)
            while len(self._shots) > 1 and (self._bytes > self._most[0] or len(self._shots) > self._most[1]):
                self._every *= 2
                self._shots = {at: kept for at, kept in self._shots.items() if at[1] % self._every == 0}
                self._bytes = sum(len(kept.png) for kept in self._shots.values())
                if self._every > 1 << 20:
                    break

    def of(self, factor: float) -> list[Shot]:
        """The pictures that are kept of the way with a zoom factor, in their order."""
        with self._lock:
            return sorted((s for s in self._shots.values() if s.factor == factor), key=lambda shot: shot.number)

    def nearest(self, factor: float, number: int) -> Shot | None:
        """The picture of a step, or else that of the nearest one that is kept."""
        return min(self.of(factor), key=lambda shot: abs(shot.number - number), default=None)

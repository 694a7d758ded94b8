"""Small pictures of frames, as text that settings can hold."""

from __future__ import annotations

import base64
import binascii
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

SIDE = 144
"""Pixels of the longer side."""
_QUALITY = 85
_LONGEST_TEXT = 200_000


@dataclass(frozen=True)
class Thumbnail:
    """A small picture; `jpeg` is its file."""

    width: int
    height: int
    jpeg: bytes

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3), row 0 at the top."""
        with Image.open(io.BytesIO(self.jpeg), formats=("JPEG",)) as image:
            return np.asarray(image.convert("RGB"))

    def thumbnail(self, height: int) -> NDArray[np.uint8]:
        """The same: it is small already."""
        return self.pixels()


def thumbnail(color: NDArray[np.float32]) -> Thumbnail:
    """Of a frame's (height, width, 3) display-referred colours."""
    step = max(1, max(color.shape[:2]) // (3 * SIDE))  # three pixels for one are as many as the eye sees of them
    pixels = np.rint(np.clip(np.nan_to_num(color[::step, ::step]), 0.0, 1.0) * 255.0).astype(np.uint8)
    image = Image.fromarray(pixels)
    image.thumbnail((SIDE, SIDE), Image.Resampling.BOX)
    file = io.BytesIO()
    image.save(file, "JPEG", quality=_QUALITY)
    return Thumbnail(*image.size, file.getvalue())


def as_text(picture: Thumbnail) -> str:
    return base64.b64encode(picture.jpeg).decode()


def from_text(text: object) -> Thumbnail | None:
    """The inverse of `as_text`; None where it is no small picture."""
    if not isinstance(text, str) or not text or len(text) > _LONGEST_TEXT:
        return None
    try:
        data = base64.b64decode(text, validate=True)
        with Image.open(io.BytesIO(data), formats=("JPEG",)) as image:
            if max(image.size) > 4 * SIDE:
                return None
            image.load()
            return Thumbnail(*image.size, data)
    except (binascii.Error, ValueError, OSError, Image.DecompressionBombError):
        return None

"""Pictures as PNG with what they carry, whole or not at all."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from viewer.output.capture import CHUNK
from viewer.util.files import write_whole


def notes(text: str) -> PngImagePlugin.PngInfo:
    """The text chunks of a picture that carries `text`."""
    info = PngImagePlugin.PngInfo()
    info.add_itxt(CHUNK, text)
    info.add_text("Software", "Shadowcull")
    return info


def encoded(pixels: NDArray[np.uint8], text: str) -> bytes:
    """The file that `write` would write."""
    file = BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, "PNG", pnginfo=notes(text))
    return file.getvalue()


def write(path: Path, pixels: NDArray[np.uint8], text: str, **options: Any) -> None:
    """Write (h, w, 3) uint8 pixels, row 0 at the top; raises OSError in one line."""
    image = Image.fromarray(np.ascontiguousarray(pixels))

    def save(file: BinaryIO) -> None:
        image.save(file, "PNG", pnginfo=notes(text), **options)

    write_whole(path, save)

"""Pictures as PNG with what they carry, and of other kinds, whole or not at all."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

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
    write_image(path, Image.fromarray(np.ascontiguousarray(pixels)), "PNG", pnginfo=notes(text), **options)


def write_image(path: Path, image: Image.Image, kind: str, **options: Any) -> None:
    """Write an image as Pillow's `kind` of file; raises OSError in one line.

    Through memory, as Pillow, where it may write into a file itself, says nothing of a disk without room for all."""
    file = BytesIO()
    image.save(file, kind, **options)
    write_whole(path, lambda target: target.write(file.getbuffer()))

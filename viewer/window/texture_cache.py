"""Recorded pictures as textures: only those that the window shows, brought to the GPU a few at a time.

Panels ask and get what is there; what they asked for is brought before the widgets of the next frame.
"""

from __future__ import annotations

from typing import Any, Protocol

import moderngl
import numpy as np
from numpy.typing import NDArray

A_FRAME = 6  # pictures brought to the GPU in one of the window's frames, at most
THUMBNAIL = 128  # pixels of height


class Recorded(Protocol):
    """A picture that is kept, (h, w, 3) uint8, and the same so many pixels high at most."""

    def pixels(self) -> NDArray[np.uint8]: ...

    def thumbnail(self, height: int) -> NDArray[np.uint8]: ...


class TextureCache:
    """Needs a current GL context for all but `texture_id`."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._textures: dict[tuple[int, bool], tuple[Recorded, Any]] = {}
        self._wanted: dict[tuple[int, bool], Recorded] = {}

    def texture_id(self, shot: Recorded, small: bool) -> int | None:
        """Name of the GL texture of a picture, or of its thumbnail; None until it is there."""
        key = id(shot), small
        self._wanted[key] = shot
        found = self._textures.get(key)
        return found[1].glo if found is not None else None

    def update(self) -> None:
        """Keep, or bring, what was asked for since the last time, and nothing else."""
        for key in [key for key in self._textures if key not in self._wanted]:
            self._textures.pop(key)[1].release()
        for key in [key for key in self._wanted if key not in self._textures][:A_FRAME]:
            shot = self._wanted[key]
            pixels = shot.thumbnail(THUMBNAIL) if key[1] else shot.pixels()
            size = pixels.shape[1], pixels.shape[0]
            texture = self._context.texture(size, 3, np.ascontiguousarray(pixels).tobytes(), alignment=1)
            filtering = moderngl.LINEAR if key[1] else moderngl.NEAREST  # a lone wrong pixel stays one
            texture.filter = (filtering, filtering)
            texture.repeat_x = texture.repeat_y = False
            self._textures[key] = shot, texture
        self._wanted.clear()

    def release(self) -> None:
        """Free everything on the GPU."""
        for _, texture in self._textures.values():
            texture.release()
        self._textures.clear()

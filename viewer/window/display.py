"""From a frame to a picture on the screen: the view's pixels as a texture, which ImGui shows as an image.

`viewer.views` makes the pixels, on one core; changing the view, the light or the selection never traces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.views import AS_SAVED, Highlight, Pixels, colorize
from viewer.views.compare import Difference, signed_picture


class DisplayError(RuntimeError):
    """The GPU does not do what is asked of it; the message is one line."""


@dataclass(frozen=True)
class InWindow:
    """What the window adds to how a frame is drawn: a bright border around the `selected` primitive, or around all of
    the selected part of the scene; whether pixels are blended where they are enlarged; and what is highlighted."""

    selected: int = -1
    selected_part: int = -1
    smooth: bool = True
    highlight: Highlight = AS_SAVED


PLAIN = InWindow()


class PictureTexture:
    """A picture on the GPU; needs a current GL context.  `version` is another one whenever the picture is."""

    def __init__(self, context: moderngl.Context) -> None:
        self.context = context
        self.version = 0
        self.picture: Any = None
        self._pixels: Pixels | None = None

    @property
    def texture_id(self) -> int | None:
        """Name of the GL texture, None while there is none; row 0 is the top."""
        return self.picture.glo if self.picture is not None else None

    def write(self, pixels: Pixels, smooth: bool) -> None:
        """Bring a picture (h, w, 3) to the GPU.  Raises DisplayError for what is too much for it."""
        size, most = (pixels.shape[1], pixels.shape[0]), self.context.info["GL_MAX_TEXTURE_SIZE"]
        if max(size) > most:
            raise DisplayError(f"{size[0]} x {size[1]} is too large for this GPU, which takes {most} pixels a side")
        _ = self.context.error  # of somebody before us
        if self.picture is None or self.picture.size != size:
            made = self.context.texture(size, 3, alignment=1)
            self.release()
            self.picture = made
            made.repeat_x = made.repeat_y = False
        self.picture.write(np.ascontiguousarray(pixels), alignment=1)
        filtering = moderngl.LINEAR if smooth else moderngl.NEAREST
        self.picture.filter = (filtering, filtering)
        problem = self.context.error
        if problem != "GL_NO_ERROR":
            raise DisplayError(f"the GPU could not draw this: {problem}")
        self._pixels = pixels
        self.version += 1

    def read(self) -> Pixels:
        """Return the picture (h, w, 3) uint8, row 0 at the top; there must be one."""
        assert self._pixels is not None
        return self._pixels

    def release(self) -> None:
        """Free it."""
        if self.picture is not None:
            self.picture.release()
        self.picture = self._pixels = None


class Display(PictureTexture):
    """The newest frame in its view."""

    def __init__(self, context: moderngl.Context | None = None) -> None:
        super().__init__(context or moderngl.create_context())
        self.frame: Frame | None = None
        self.part_of: NDArray[np.int32] | None = None
        """(primitives,) the part of the scene that each primitive belongs to, needed while one is selected."""
        self.selected = -1
        """The primitive that is drawn as selected."""
        self._drawn: tuple[Frame, object] | None = None
        self._failed: tuple[Frame, object] | None = None

    @property
    def size(self) -> tuple[int, int]:
        return (self.frame.width, self.frame.height) if self.frame is not None else (0, 0)

    def draw(self, frame: Frame | None, draw: DrawOptions, window: InWindow = PLAIN) -> None:
        """Draw a frame, unless it is there already; without one, what was drawn stays.

        What failed is not tried again, and the texture keeps what it showed, until something else is asked for.
        Raises ValueError where the frame has nothing for the view, and DisplayError for what is too much for the
        GPU."""
        self.frame = frame
        if frame is None:
            return
        wanted = frame, (draw.of_pixels(), window)
        if wanted in (self._drawn, self._failed):  # frames are equal only where they are the same
            return
        self._failed = wanted
        pixels = colorize(frame, draw, window.highlight)
        if window.selected >= 0:
            pixels[_selected_border(frame, window, self.part_of)] = 255
        self.write(pixels, window.smooth and draw.view.shows_clipped)
        self._drawn, self._failed, self.selected = wanted, None, window.selected

    def shows(self, draw: DrawOptions, window: InWindow = PLAIN) -> bool:
        """Return whether the frame is drawn like this."""
        return self._drawn == (self.frame, (draw.of_pixels(), window))

    def read_window(self, width: int, height: int) -> Pixels:
        """Return all of the window as it was just drawn, (height, width, 3) uint8, row 0 at the top."""
        data = self.context.screen.read(viewport=(0, 0, width, height), components=3, alignment=1)
        return np.ascontiguousarray(np.frombuffer(data, np.uint8).reshape(height, width, 3)[::-1])

    def release(self) -> None:
        super().release()
        self.frame = self._drawn = None


class Compared:
    """What a comparison needs on the GPU beside the live picture; nothing of it stays when the comparison ends."""

    def __init__(self, context: moderngl.Context) -> None:
        self.a = Display(context)
        self.difference = PictureTexture(context)
        self._drawn: tuple[Difference, float, bool] | None = None

    def draw_difference(self, found: Difference, limit: float, ringed: bool) -> None:
        """Draw a signed difference as far as `limit` to both sides, unless it is there."""
        if self._drawn != (found, limit, ringed):
            self.difference.write(signed_picture(found, limit, ringed), smooth=False)
            self._drawn = found, limit, ringed

    def release(self) -> None:
        self.a.release()
        self.difference.release()
        self._drawn = None


def _selected_border(frame: Frame, window: InWindow, part_of: NDArray[np.int32] | None) -> NDArray[np.bool_]:
    """Find the pixels (h, w) on either side of the border of what is selected."""
    chosen = frame.primitive == window.selected
    if window.selected_part >= 0 and part_of is not None:
        chosen = (part_of[np.maximum(frame.primitive, 0)] == window.selected_part) & (frame.primitive >= 0)
    padded = np.pad(chosen, 1, mode="edge")
    above, here, below = padded[:-2], padded[1:-1], padded[2:]
    some, every = above | here | below, above & here & below
    some = some[:, :-2] | some[:, 1:-1] | some[:, 2:]
    every = every[:, :-2] & every[:, 1:-1] & every[:, 2:]
    return some & ~every

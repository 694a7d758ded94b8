"""From a frame to a picture on the screen: the view's pixels as a texture, which ImGui shows as an image.

`viewer.views` makes the pixels, on one core; changing the view, the light or the selection never traces.  What is no
longer referred to here is freed on the GPU by `graphics.draw`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.frame import Frame
from viewer.state.draw_options import DrawOptions
from viewer.state.pixels import Zoom
from viewer.util.resources import shader_source
from viewer.views import Pixels, colorize


class DisplayError(RuntimeError):
    """The GPU does not do what is asked of it; the message is one line."""


@dataclass(frozen=True)
class InWindow:
    """What the window adds to how a frame is drawn: a bright border around the `selected` primitive, or around all of
    the selected part of the scene; and the fate that stands out."""

    selected: int = -1
    selected_part: int = -1
    fate: Fate | None = None


PLAIN = InWindow()
THUMBNAIL = 128
"""Pixels of height of small recorded pictures."""
BROUGHT_IN_A_FRAME = 6
"""Recorded pictures brought to the GPU in one of the window's frames, at most."""


class PictureTexture:
    """A picture on the GPU; needs a current GL context.  `version` is another one whenever the picture is."""

    def __init__(self, context: moderngl.Context) -> None:
        self.context = context
        self.version = 0
        self.picture: Any = None
        self._pixels: Pixels | None = None
        self._drawn: object = None
        self._failed: object = None

    @property
    def texture_id(self) -> int | None:
        """Name of the GL texture, None while there is none; row 0 is the top."""
        return self.picture.glo if self.picture is not None else None

    def update(self, wanted: object, draw: Callable[[], Pixels]) -> bool:
        """Bring what `draw` returns to the GPU, unless what is `wanted` is there already; returns whether it is now.

        What failed is not tried again, and the texture keeps what it showed, until something else is wanted.  Raises
        what `draw` does, and DisplayError for what is too much for the GPU."""
        if wanted not in (self._drawn, self._failed):
            self._failed = wanted
            self.write(draw())
            self._drawn, self._failed = wanted, None
        return wanted == self._drawn

    def write(self, pixels: Pixels) -> None:
        """Bring a picture (h, w, 3) to the GPU.  Raises DisplayError for what is too much for it."""
        size, most = (pixels.shape[1], pixels.shape[0]), self.context.info["GL_MAX_TEXTURE_SIZE"]
        if max(size) > most:
            raise DisplayError(f"{size[0]} x {size[1]} is too large for this GPU, whose limit is {most} pixels a side")
        _ = self.context.error  # of somebody before us
        if self.picture is None or self.picture.size != size:
            self.picture = self.context.texture(size, 3, alignment=1)
            self.picture.repeat_x = self.picture.repeat_y = False
        self.picture.write(np.ascontiguousarray(pixels), alignment=1)
        problem = self.context.error
        if problem != "GL_NO_ERROR":
            raise DisplayError(f"the GPU could not draw this: {problem}")
        self._pixels = pixels
        self.version += 1

    def read(self) -> Pixels:
        """Return the picture (h, w, 3) uint8, row 0 at the top; there must be one."""
        assert self._pixels is not None
        return self._pixels

    def clear(self) -> None:
        """Let it go."""
        self.picture = self._pixels = self._drawn = None


class Display(PictureTexture):
    """The newest frame in its view."""

    def __init__(self, context: moderngl.Context) -> None:
        super().__init__(context)
        self.part_of: NDArray[np.int32] | None = None
        """(primitives,) the part of the scene that each primitive belongs to, needed while one is selected."""

    def draw(self, frame: Frame | None, draw: DrawOptions, window: InWindow = PLAIN) -> bool:
        """Draw a frame, unless it is there already, and return whether it is now; without one, what was drawn stays.

        Raises ValueError where the frame has nothing for the view, and DisplayError."""
        if frame is None:
            return False

        def colored() -> Pixels:
            pixels = colorize(frame, draw, window.fate)
            if window.selected >= 0:
                pixels[_selected_border(frame, window, self.part_of)] = 255
            return pixels

        return self.update((frame, draw.of_pixels(), window), colored)  # frames are equal only where they are the same

    def read_window(self, width: int, height: int) -> Pixels:
        """Return all of the window as it was just drawn, (height, width, 3) uint8, row 0 at the top."""
        data = self.context.screen.read(viewport=(0, 0, width, height), components=3, alignment=1)
        return np.ascontiguousarray(np.frombuffer(data, np.uint8).reshape(height, width, 3)[::-1])


class Recorded(Protocol):
    """A picture that is kept, (h, w, 3) uint8, and the same so many pixels high at most."""

    def pixels(self) -> Pixels: ...

    def thumbnail(self, height: int) -> Pixels: ...


class TextureCache:
    """Recorded pictures as textures: only those that the window shows, brought to the GPU a few at a time.

    Panels ask and get what is there; what they asked for is brought before the widgets of the next frame.  Needs a
    current GL context for all but `texture_id`."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._textures: dict[tuple[Recorded, bool], PictureTexture] = {}
        self._wanted: set[tuple[Recorded, bool]] = set()

    def texture_id(self, shot: Recorded, small: bool) -> int | None:
        """Name of the GL texture of a picture, or of its thumbnail; None until it is there."""
        self._wanted.add((shot, small))
        found = self._textures.get((shot, small))
        return found.texture_id if found is not None else None

    def update(self) -> None:
        """Keep, or bring, what was asked for since the last time, and nothing else."""
        self._textures = {key: texture for key, texture in self._textures.items() if key in self._wanted}
        for shot, small in list(self._wanted - self._textures.keys())[:BROUGHT_IN_A_FRAME]:
            self._textures[shot, small] = texture = PictureTexture(self._context)
            texture.write(shot.thumbnail(THUMBNAIL) if small else shot.pixels())
        self._wanted.clear()


class Magnifier:
    """Enlarged copies of pictures with crisp pixels, by name, as ImGui itself always smooths what it enlarges.  Each
    stays until another is asked for under its name."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._targets: dict[str, Any] = {}
        self._shown: dict[str, tuple[Any, ...]] = {}

    @cached_property
    def _triangle(self) -> Any:
        """One that covers all, with the shader: compiled when it is first needed."""
        vertex, fragment = (
            "#version 330 core\n" + shader_source(name) for name in ("fullscreen.vert", "magnified.frag")
        )
        return self._context.vertex_array(self._context.program(vertex_shader=vertex, fragment_shader=fragment), [])

    def draw(self, name: str, source: Any, version: object, zoom: Zoom, size: tuple[int, int]) -> None:
        """Enlarge as much of a texture as the zoom shows to a size in pixels, unless it is there; `version` is another
        one whenever the texture's contents are."""
        wanted = source.glo, zoom, size, source.size, version
        if self._shown.get(name) == wanted:
            return
        if name not in self._targets or self._targets[name].size != size:
            self._targets[name] = self._context.framebuffer([self._context.texture(size, 4)])
        left, top, right, bottom = zoom.shown()
        program = self._triangle.program
        program["part"], program["size"] = (left, top, right - left, bottom - top), size
        source.use(0)
        window = self._context.detect_framebuffer()
        try:
            self._targets[name].use()
            self._context.enable_only(moderngl.NOTHING)
            self._triangle.render(moderngl.TRIANGLES, vertices=3)
        finally:
            window.use()
        self._shown[name] = wanted

    def texture_of(self, name: str, source: int, zoom: Zoom, size: tuple[int, int]) -> int | None:
        """Name of the GL texture with that part of that source in that size; None while there is none."""
        there = self._shown.get(name, ())[:3] == (source, zoom, size)
        return self._targets[name].color_attachments[0].glo if there else None

    def drop(self, name: str) -> None:
        """Let a copy go, if there is one."""
        self._targets.pop(name, None)
        self._shown.pop(name, None)


class Graphics:
    """What lives as long as the window's GL context: the newest frame as it is drawn, A and what B differs by while
    they are compared, recorded pictures, and what enlarges them."""

    def __init__(self, context: moderngl.Context) -> None:
        context.gc_mode = "context_gc"  # what nobody refers to is freed where `draw` says so, with the context current
        self.renderer_name: str = context.info["GL_RENDERER"]
        self.display, self.a, self.difference = Display(context), Display(context), PictureTexture(context)
        self.textures, self.magnifier = TextureCache(context), Magnifier(context)


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

"""The buffers of a frame as textures on the GPU, each brought there when a view first needs it.

Modes and counts travel as one entry per primitive, laid out in rows of a 2D texture, and shaders look them up by the
primitive's number.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.marks import wrong_marks
from viewer.state.readings import (
    cell_lights,
    cut_nodes,
    depth_range,
    lights_due,
    lights_top,
    moving_shadows,
    samples_of,
    span_of,
    tree_of,
    voxels_of,
)
from viewer.state.slices import MIDDLE, Slice, slice_codes
from viewer.state.tree_slice import tree_codes
from viewer.state.views import View, color_map

TABLE_WIDTH = 2048
NAMES = (
    "color_buffer", "primitive_buffer", "unit_buffer", "mode_table", "count_table", "depth_buffer", "normal_buffer",
    "color_map", "reference_buffer", "mark_buffer", "certificate_buffer", "cell_buffer", "saved_buffer", "cost_buffer",
    "due_rays_buffer", "penumbra_buffer", "lights_buffer", "cuts_buffer", "part_table",
    "slice_buffer", "cell_lights_buffer", "tree_buffer", "fate_buffer", "moving_buffer",
)  # fmt: skip
"""Of all textures, in the order of their units."""
# What lies on the GPU as a frame holds it: components, their kind, and the frame's attribute.
_PIXELS = {
    "color_buffer": (3, "f4", "color"),
    "depth_buffer": (1, "f4", "depth"),
    "normal_buffer": (3, "f4", "normal"),
    "primitive_buffer": (1, "i4", "primitive"),
    "reference_buffer": (3, "f4", "reference"),
    "cell_buffer": (1, "i4", "cell"),
    "saved_buffer": (1, "i4", "saved"),
    "cost_buffer": (1, "i4", "cost"),
    "due_rays_buffer": (1, "i4", "due_rays"),
}


class DisplayError(RuntimeError):
    """The GPU does not do what is asked of it; the message is one line."""


class Ranges:
    """What the first and the last colour of maps stand for in one frame, each found out once."""

    def __init__(self, frame: Frame) -> None:
        self._frame = frame

    @cached_property
    def depth(self) -> tuple[float, float]:
        """Nearest and farthest of what the frame shows."""
        return depth_range(self._frame)

    @cached_property
    def lights(self) -> NDArray[np.int32]:
        """(height, width) lights that are due at each pixel."""
        return lights_due(self._frame)

    def span(self, view: View) -> tuple[float, float]:
        """What has the first and the last colour of the map."""
        if view is View.DEPTH:
            return self.depth
        if view is View.LIGHTS:
            return 0.0, float(lights_top(self.lights))
        return span_of(self._frame, view) if view.has_range else (0.0, 1.0)


class FrameTextures:
    """Textures of the newest frame, `frame`; `serial` is another number for each, 0 while there is none."""

    def __init__(self, context: Any) -> None:
        self._context = context
        self.frame: Frame | None = None
        self.serial = 0
        self._ranges: Ranges | None = None
        self._brought: dict[
            str, tuple[int, object]
        ] = {}  # which frame's buffers, and of which light or size, are there
        self._textures: dict[str, Any] = {}
        self.part_of: NDArray[np.int32] | None = None  # of each primitive, while a part is selected
        colors = np.round(color_map() * 255.0).astype(np.uint8)
        self._textures["color_map"] = context.texture((len(colors), 1), 3, colors.tobytes(), alignment=1)
        self._textures["color_map"].repeat_x = False

    @property
    def size(self) -> tuple[int, int]:
        return (self.frame.width, self.frame.height) if self.frame is not None else (0, 0)

    def show(self, frame: Frame | None) -> None:
        """Hold the buffers of this frame from now on, or of none."""
        if frame is not self.frame:
            self.frame = frame
            self._ranges = None
            self.serial += 1

    @property
    def ranges(self) -> Ranges:
        """Of the frame; there must be one."""
        assert self.frame is not None
        if self._ranges is None:
            self._ranges = Ranges(self.frame)
        return self._ranges

    def use(self, program: Any, light: int, magnified: int, cut: Slice = MIDDLE) -> None:
        """Bind what a program reads, of this light where it is of one, in the slice `cut` where it shows one, and for
        pixels that are shown `magnified` times.

        Raises ValueError where the frame has not recorded that, and DisplayError for what is too large."""
        for unit, name in enumerate(NAMES):
            if name in program:
                self._bring(name, light, magnified, cut)
                self._textures[name].use(unit)

    def check_size(self, size: tuple[int, int]) -> None:
        """Raises DisplayError for a texture that the GPU cannot hold."""
        most = self._context.info["GL_MAX_TEXTURE_SIZE"]
        if max(size) > most:
            raise DisplayError(f"{size[0]} x {size[1]} is too large for this GPU, which takes {most} pixels a side")

    def release(self) -> None:
        """Free everything on the GPU."""
        for texture in self._textures.values():
            texture.release()
        self._textures.clear()
        self.frame = self._ranges = None

    def _bring(self, name: str, light: int, magnified: int, cut: Slice) -> None:
        """A buffer of the frame to the GPU, unless it is there."""
        frame = self.frame
        assert frame is not None
        of: dict[str, object] = dict.fromkeys(("penumbra_buffer", "fate_buffer", "moving_buffer"), light)
        of |= {"mark_buffer": magnified, "slice_buffer": (light, cut), "tree_buffer": cut}
        wanted = self.serial, of.get(name, 0)
        if name == "part_table":  # it is the scene's, whatever the frame
            wanted = id(self.part_of), 0
        if name == "color_map" or self._brought.get(name) == wanted:
            return
        if name in _PIXELS:
            components, dtype, attribute = _PIXELS[name]
            self._write(name, self.size, components, dtype, getattr(frame, attribute))
        elif name == "certificate_buffer":
            words = frame.certificates if frame.certificates is not None else np.zeros(frame.primitive.shape, np.uint32)
            self._write(name, self.size, 2, "u4", _halves(words))
        elif name == "mark_buffer":
            self._write(name, self.size, 1, "u1", wrong_marks(frame, magnified))
        elif name == "penumbra_buffer":
            self._write(name, self.size, 2, "u2", _penumbra(frame, light))
        elif name == "fate_buffer":
            self._write(name, self.size, 1, "u1", frame.fate(light))
        elif name == "moving_buffer":
            self._write(name, self.size, 1, "u1", moving_shadows(frame, light))
        elif name == "lights_buffer":
            self._write(name, self.size, 1, "i4", self.ranges.lights)
        elif name == "cuts_buffer":
            self._write(name, self.size, 1, "i4", cut_nodes(frame))
        elif name == "slice_buffer":
            self._write(name, self.size, 1, "u1", slice_codes(frame, voxels_of(frame), light, cut))
        elif name == "tree_buffer":
            self._write(name, self.size, 1, "u2", tree_codes(frame, tree_of(frame), cut))
        elif name == "cell_lights_buffer":
            self._write(name, self.size, 1, "i4", cell_lights(frame))
        elif name == "unit_buffer":
            self._write(name, self.size, 1, "i4", frame.unit)
        elif name == "part_table":
            self._write_list(name, self.part_of if self.part_of is not None else np.zeros(1, np.int32))
        elif name == "mode_table":
            self._write_table(name, "u4", _halves(frame.modes))
        elif name == "count_table":
            counts = np.stack([frame.pixel_count, frame.highest_count], axis=1).astype(np.int32, copy=False)
            self._write_table(name, "i4", counts)
        self._brought[name] = wanted

    def _write(self, name: str, size: tuple[int, int], components: int, dtype: str, data: NDArray) -> None:
        texture = self._textures.get(name)
        if texture is None or texture.size != size:
            self.check_size(size)
            if texture is not None:
                del self._textures[name]
                texture.release()
            texture = self._context.texture(size, components, dtype=dtype, alignment=1)
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            self._textures[name] = texture
        texture.write(np.ascontiguousarray(data), alignment=1)

    def _write_table(self, name: str, dtype: str, entries: NDArray) -> None:
        """Upload (n, 2) entries, one per unit, as rows of TABLE_WIDTH."""
        rows = max(1, -(-len(entries) // TABLE_WIDTH))
        table = np.zeros((rows * TABLE_WIDTH, 2), entries.dtype)
        table[: len(entries)] = entries
        self._write(name, (TABLE_WIDTH, rows), 2, dtype, table)

    def _write_list(self, name: str, entries: NDArray[np.int32]) -> None:
        """Upload (n,) entries, one per primitive, as rows of TABLE_WIDTH."""
        rows = max(1, -(-len(entries) // TABLE_WIDTH))
        table = np.zeros(rows * TABLE_WIDTH, np.int32)
        table[: len(entries)] = entries
        self._write(name, (TABLE_WIDTH, rows), 1, "i4", table)


def _penumbra(frame: Frame, light: int) -> NDArray[np.uint16]:
    """(height, width, 2) samples of a light that are due and that reach each pixel; of a pixel that is not known yet
    more reach it than are due."""
    samples = np.stack(samples_of(frame, light), axis=-1)
    if frame.shaded is not None:
        samples[~frame.shaded] = 0, 1
    return samples


def _halves(words: NDArray) -> NDArray[np.uint32]:
    """Packed words (...) of 32 or 64 bits as (..., 2) uint32: low half, high half."""
    low = (words & words.dtype.type(0xFFFFFFFF)).astype(np.uint32)
    high = (words >> np.uint64(32)).astype(np.uint32) if words.itemsize == 8 else np.zeros_like(low)
    return np.stack([low, high], axis=-1)

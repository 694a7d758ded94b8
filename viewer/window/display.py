"""From a frame's buffers to a picture on the screen, on the GPU.

A frame's buffers become textures once, when it arrives; a view is one pass of a small shader over
them into an RGBA target, which ImGui then shows as an image; the plain picture goes there as it is.
Modes and counts travel as one entry per primitive, laid out in rows of a 2D texture, and the shader
looks them up by the primitive's number.  So changing the view, the light or the selection never traces
and never uploads anything; only what the views of verified frames need is brought there when the first
of them is drawn, and what reaches the pixels from the light that is shown.

All of it runs before the widgets of a frame, and leaves the window's framebuffer bound as it was.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import OcclusionMode, has_shadow_mode
from tracer.shading.screen import to_screen
from viewer.state.views import (
    ARRIVAL_COLORS,
    BACKGROUND,
    BENEATH,
    CELL_LINE,
    CERTIFICATE_COLORS,
    GREY,
    OCCLUSION_COLORS,
    RING_DIMMING,
    SHADOW_COLORS,
    WIPE_LINE,
    WRONG,
    View,
    color_map,
    depth_range,
    samples_of,
    units_of,
    wipe_column,
    work_top,
    wrong_marks,
)
from viewer.util.resources import shader_source

if TYPE_CHECKING:
    from tracer.renderer import Frame

TABLE_WIDTH = 2048
_PICTURES = (View.COLOR, View.WIPE)
_UNITS = (
    "color_buffer", "primitive_buffer", "unit_buffer", "mode_table", "count_table", "depth_buffer", "normal_buffer",
    "color_map", "reference_buffer", "mark_buffer", "certificate_buffer", "cell_buffer", "saved_buffer", "cost_buffer",
    "due_rays_buffer", "penumbra_buffer",
)  # fmt: skip
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


@dataclass(frozen=True)
class Look:
    """How to draw a frame: everything that changes the picture without tracing.

    `marked` draws rings around wrong pixels, sized for pixels that are shown `magnified` times,
    `wipe` is the place of the line, 0 to 1 from the left, and `line` whether it is drawn.
    `shares` makes shares of the counts in maps of work; `beneath` is the brightness of the picture
    beneath the difference."""

    view: View = View.COLOR
    light: int = 0
    shading: float = 0.35
    outlines: bool = False
    selected: int = -1
    smooth: bool = True
    marked: bool = True
    magnified: int = 1
    wipe: float = 0.5
    line: bool = True
    shares: bool = False
    beneath: float = BENEATH

    @property
    def plain(self) -> bool:
        """Whether the picture is shown as it was traced: then it is brought to the target without a pass over it, which
        takes long where a processor draws."""
        return self.view is View.COLOR and not self.outlines and self.selected < 0


class Display:
    """Textures of the newest frame and the target its view is drawn into; needs a current GL context."""

    def __init__(self) -> None:
        self.context = moderngl.create_context()
        self._depths = (0, (0.0, 1.0))
        self._brought: dict[str, tuple[int, int]] = {}  # which frame's buffers, and of which light, are on the GPU
        self._frame: Frame | None = None
        self._drawn: tuple[int, Look] | None = None
        self._failed: tuple[int, Look] | None = None
        self._serial = 0
        self._marked = (0, 1)
        self._textures: dict[str, Any] = {}
        self._passes: dict[View, tuple[Any, Any]] = {}
        self._target: Any = None
        colors = np.round(color_map() * 255.0).astype(np.uint8)
        self._textures["color_map"] = self.context.texture((len(colors), 1), 3, colors.tobytes(), alignment=1)
        self._textures["color_map"].repeat_x = False

    @property
    def texture_id(self) -> int | None:
        """Name of the GL texture to show, or None while there is none; row 0 is the top."""
        return self._target.color_attachments[0].glo if self._target is not None else None

    @property
    def size(self) -> tuple[int, int]:
        return (self._frame.width, self._frame.height) if self._frame is not None else (0, 0)

    def show(self, frame: Frame | None) -> None:
        """Show this frame from now on, or none: a view brings to the GPU what it needs of it."""
        if frame is not self._frame:
            self._frame = frame
            self._serial += 1

    @property
    def depth_range(self) -> tuple[float, float]:
        """Nearest and farthest of what the frame shows."""
        if self._depths[0] != self._serial and self._frame is not None:
            self._depths = self._serial, depth_range(self._frame)
        return self._depths[1]

    def _bring(self, name: str, light: int) -> None:
        """A buffer of the frame to the GPU, unless it is there; of this light, where it is one of a light."""
        frame = self._frame
        assert frame is not None
        wanted = self._serial, light if name == "penumbra_buffer" else 0
        if self._brought.get(name) == wanted:
            return
        if name in _PIXELS:
            components, dtype, attribute = _PIXELS[name]
            self._write(name, self.size, components, dtype, getattr(frame, attribute))
        elif name == "certificate_buffer":
            words = frame.certificates if frame.certificates is not None else np.zeros(frame.primitive.shape, np.uint32)
            self._write(name, self.size, 2, "u4", _halves(words))
        elif name == "penumbra_buffer":
            self._write(name, self.size, 2, "u2", np.stack(samples_of(frame, light), axis=-1))
        elif name == "unit_buffer":
            self._write(name, self.size, 1, "i4", units_of(frame))
        elif name == "mode_table":
            self._write_table(name, "u4", _halves(frame.modes))
        elif name == "count_table":
            counts = np.stack([frame.pixel_count, frame.highest_count], axis=1).astype(np.int32, copy=False)
            self._write_table(name, "i4", counts)
        self._brought[name] = wanted

    def draw(self, look: Look) -> None:
        """Draw the view of the frame into the target, unless it is there already.

        What failed is not tried again, and the target keeps what it showed, until another frame or look is asked for.
        Raises ValueError for a view of verified frames, or of what was recorded, where the frame is none, and
        DisplayError for what is too much for the GPU."""
        wanted = self._in_look(look)
        if self._frame is None or wanted in (self._drawn, self._failed):
            return
        self._failed = wanted
        window = self.context.detect_framebuffer()
        try:
            self._draw(look)
        finally:
            window.use()
        self._drawn, self._failed = wanted, None

    def _draw(self, look: Look) -> None:
        _ = self.context.error  # of somebody before us
        target = self._fitting_target()
        try:
            self._draw_into(target, look)
        except Exception:
            if target is not self._target:
                _release_framebuffer(target)
            raise
        if target is not self._target:
            self._release_target()
            self._target = target

    def _draw_into(self, target: Any, look: Look) -> None:
        if look.view.needs_verify:
            self._mark_wrong(look.magnified)
        assert self._frame is not None
        if look.plain:
            target.color_attachments[0].write(_on_screen(self._frame.color), alignment=1)
        else:
            self._render_into(target, look)
        filtering = moderngl.LINEAR if look.smooth and look.view in _PICTURES else moderngl.NEAREST
        target.color_attachments[0].filter = (filtering, filtering)
        problem = self.context.error
        if problem != "GL_NO_ERROR":
            raise DisplayError(f"the GPU could not draw this: {problem}")

    def _render_into(self, target: Any, look: Look) -> None:
        program, triangle = self._pass(look.view)
        self._set_uniforms(program, look)
        for unit, name in enumerate(_UNITS):
            if name in program:
                self._bring(name, look.light)
                self._textures[name].use(unit)
        target.use()
        self.context.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        triangle.render(moderngl.TRIANGLES, vertices=3)

    def drawn(self, look: Look) -> bool:
        """Whether the target shows the frame in this look."""
        return self._drawn == self._in_look(look)

    def _in_look(self, look: Look) -> tuple[int, Look]:
        """The frame and all that counts of a look: little of one that shows the picture as it was traced."""
        return self._serial, Look(smooth=look.smooth) if look.plain else look

    def read(self) -> NDArray[np.uint8]:
        """The drawn view, (height, width, 3) uint8, row 0 at the top."""
        width, height = self.size
        data = self._target.read(components=3, alignment=1)
        return np.frombuffer(data, np.uint8).reshape(height, width, 3)

    def read_window(self, width: int, height: int) -> NDArray[np.uint8]:
        """All of the window as it was just drawn, (height, width, 3) uint8, row 0 at the top."""
        data = self.context.screen.read(viewport=(0, 0, width, height), components=3, alignment=1)
        return np.ascontiguousarray(np.frombuffer(data, np.uint8).reshape(height, width, 3)[::-1])

    def release(self) -> None:
        """Free everything on the GPU."""
        for program, triangle in self._passes.values():
            triangle.release()
            program.release()
        for texture in self._textures.values():
            texture.release()
        self._release_target()
        self._passes.clear()
        self._textures.clear()
        self._frame = None

    def _mark_wrong(self, magnified: int) -> None:
        """Bring the marks around wrong pixels to the GPU, once for each frame and size on screen."""
        assert self._frame is not None
        if self._marked != (self._serial, magnified):
            self._write("mark_buffer", self.size, 1, "u1", wrong_marks(self._frame, magnified))
            self._marked = self._serial, magnified

    def _write(self, name: str, size: tuple[int, int], components: int, dtype: str, data: NDArray) -> None:
        texture = self._textures.get(name)
        if texture is None or texture.size != size:
            self._check_size(size)
            if texture is not None:
                del self._textures[name]
                texture.release()
            texture = self.context.texture(size, components, dtype=dtype, alignment=1)
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            self._textures[name] = texture
        texture.write(np.ascontiguousarray(data), alignment=1)

    def _write_table(self, name: str, dtype: str, entries: NDArray) -> None:
        """Upload (n, 2) entries, one per unit, as rows of TABLE_WIDTH."""
        rows = max(1, -(-len(entries) // TABLE_WIDTH))
        table = np.zeros((rows * TABLE_WIDTH, 2), entries.dtype)
        table[: len(entries)] = entries
        self._write(name, (TABLE_WIDTH, rows), 2, dtype, table)

    def _pass(self, view: View) -> tuple[Any, Any]:
        """The compiled shader of a view, and the triangle it draws."""
        if view not in self._passes:
            version = "#version 330 core\n"
            program = self.context.program(
                vertex_shader=version + shader_source("fullscreen.vert"),
                fragment_shader=version + shader_source("common.glsl") + shader_source(f"{view.value}.frag"),
            )
            for unit, name in enumerate(_UNITS):
                if name in program:
                    program[name] = unit
            self._passes[view] = (program, self.context.vertex_array(program, []))
        return self._passes[view]

    def _set_uniforms(self, program: Any, look: Look) -> None:
        assert self._frame is not None
        frame, view, dynamic = self._frame, look.view, OCCLUSION_COLORS[OcclusionMode.DYNAMIC]
        words = frame.certificates if view is View.CERTIFICATE and frame.certificates is not None else frame.modes
        palettes = {
            View.OCCLUSION: list(OCCLUSION_COLORS.values()),
            View.SHADOW: [*SHADOW_COLORS.values(), dynamic],
            View.CERTIFICATE: [*CERTIFICATE_COLORS.values(), dynamic],
            View.PENUMBRA: list(ARRIVAL_COLORS.values()),
        }
        values: dict[str, Any] = {
            "table_width": TABLE_WIDTH,
            "background": BACKGROUND,
            "shading": look.shading,
            "outlines": look.outlines,
            "selected": look.selected,
            "light": look.light if has_shadow_mode(words, look.light) else -1,
            "range": self.depth_range if view is View.DEPTH else (0.0, 1.0),
            "top": work_top(frame, view) if view.needs_work else 1.0,
            "shares": look.shares,
            "beneath": look.beneath,
            "cell_line": CELL_LINE,
            "zoom_factor": frame.settings.zoom_factor,
            "unknown": GREY,
            "wrong_color": WRONG,
            "ring_color": tuple(RING_DIMMING * channel for channel in WRONG),
            "marked": look.marked,
            "column": wipe_column(frame.width, look.wipe),
            "line": look.line,
            "line_color": WIPE_LINE,
            "palette": palettes.get(view),
        }
        for name, value in values.items():
            if name in program:
                program[name] = value

    def _fitting_target(self) -> Any:
        """The target where it has the frame's size, else a new one."""
        if self._target is not None and self._target.size == self.size:
            return self._target
        self._check_size(self.size)
        texture = self.context.texture(self.size, 4)
        texture.repeat_x = texture.repeat_y = False
        return self.context.framebuffer([texture])

    def _release_target(self) -> None:
        if self._target is not None:
            _release_framebuffer(self._target)
            self._target = None

    def _check_size(self, size: tuple[int, int]) -> None:
        most = self.context.info["GL_MAX_TEXTURE_SIZE"]
        if max(size) > most:
            raise DisplayError(f"{size[0]} x {size[1]} is too large for this GPU, which takes {most} pixels a side")


def _on_screen(color: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Colours (height, width, 3) as a target holds them, (height, width, 4)."""
    pixels = np.empty((*color.shape[:2], 4), np.uint8)
    to_screen(np.ascontiguousarray(color, np.float32).reshape(-1, 3), pixels.reshape(-1, 4))
    return pixels


def _release_framebuffer(framebuffer: Any) -> None:
    framebuffer.color_attachments[0].release()
    framebuffer.release()


def _halves(words: NDArray) -> NDArray[np.uint32]:
    """Packed words (...) of 32 or 64 bits as (..., 2) uint32: low half, high half."""
    low = (words & words.dtype.type(0xFFFFFFFF)).astype(np.uint32)
    high = (words >> np.uint64(32)).astype(np.uint32) if words.itemsize == 8 else np.zeros_like(low)
    return np.stack([low, high], axis=-1)

"""From a frame's buffers to a picture on the screen, on the GPU.

A view is one pass of a small shader over the frame's buffers, which are textures by then (`frame_textures`), into an
RGBA target, which ImGui then shows as an image; the plain picture goes there as it is.  So changing the view, the light
or the selection never traces.

All of it runs before the widgets of a frame, and leaves the window's framebuffer bound as it was.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, has_shadow_mode
from tracer.shading.screen import to_screen
from viewer.state.marks import wipe_column
from viewer.state.slices import MIDDLE, Slice
from viewer.state.tone import NEUTRAL, Curve, Tone
from viewer.state.views import (
    ARRIVAL_COLORS,
    BACKGROUND,
    BENEATH,
    BLACK,
    CELL_LINE,
    CERTIFICATE_COLORS,
    FAINT_LINE,
    GREY,
    MOVING_SHADOW_COLORS,
    OCCLUSION_COLORS,
    PALE,
    RING_DIMMING,
    SHADOW_COLORS,
    TOO_BRIGHT,
    TREE_WAITS,
    UNTRUSTED_STRIPE,
    VOXEL_COLORS,
    WIPE_LINE,
    WRONG,
    View,
    fate_palette,
)
from viewer.window.frame_textures import NAMES, TABLE_WIDTH, DisplayError, FrameTextures
from viewer.window.passes import Passes

if TYPE_CHECKING:
    from tracer.renderer import Frame


@dataclass(frozen=True)
class Look:
    """How to draw a frame: everything that changes the picture without tracing.

    `marked` draws rings around wrong pixels, sized for pixels that are shown `magnified` times,
    `wipe` is the place of the line, 0 to 1 from the left, and `line` whether it is drawn.
    `selected` is the primitive that has a bright border, or, with `selected_part`, that whole part of the scene has it;
    `shares` makes shares of the counts in maps of work; `beneath` is the brightness of the picture
    beneath the difference.  Pictures have a `tone`, and stripes where they are cut off if that is to be seen
    (`clipping`); maps of numbers go over `span`, or, where that is None, over what the frame has; `cut` is the slice
    that is shown of space, and `fate` the one of shadow rays that stands out among the others."""

    view: View = View.COLOR
    light: int = 0
    shading: float = 0.35
    outlines: bool = False
    selected: int = -1
    selected_part: int = -1
    smooth: bool = True
    marked: bool = True
    magnified: int = 1
    wipe: float = 0.5
    line: bool = True
    shares: bool = False
    beneath: float = BENEATH
    tone: Tone = NEUTRAL
    clipping: bool = False
    span: tuple[float, float] | None = None
    fate: Fate | None = None
    cut: Slice = MIDDLE

    @property
    def plain(self) -> bool:
        """Whether the picture is shown as it was traced: then it is brought to the target without a pass over it, which
        takes long where a processor draws."""
        as_traced = self.tone.neutral and not self.clipping
        return self.view is View.COLOR and as_traced and not self.outlines and self.selected < 0


class Display:
    """Textures of the newest frame and the target its view is drawn into; needs a current GL context."""

    def __init__(self, passes: Passes | None = None) -> None:
        """`passes` are those of another display, whose context this one shares."""
        self.passes, self._shares_passes = passes or Passes(), passes is not None
        self.context = self.passes.context
        self._buffers = FrameTextures(self.context)
        self._drawn: tuple[int, Look] | None = None
        self._failed: tuple[int, Look] | None = None
        self._target: Any = None

    @property
    def texture_id(self) -> int | None:
        """Name of the GL texture to show, or None while there is none; row 0 is the top."""
        return self._target.color_attachments[0].glo if self._target is not None else None

    @property
    def picture(self) -> Any:
        """That texture, or None."""
        return self._target.color_attachments[0] if self._target is not None else None

    @property
    def version(self) -> object:
        """Another one whenever another picture has been drawn."""
        return self._drawn

    @property
    def size(self) -> tuple[int, int]:
        return self._buffers.size

    def show(self, frame: Frame | None) -> None:
        """Show this frame from now on, or none: a view brings to the GPU what it needs of it."""
        self._buffers.show(frame)

    def know_parts(self, part_of: NDArray[np.int32] | None) -> None:
        """Take (primitives,) the part of the scene that each primitive belongs to; needed while one is selected."""
        self._buffers.part_of = part_of

    def draw(self, look: Look) -> None:
        """Draw the view of the frame into the target, unless it is there already.

        What failed is not tried again, and the target keeps what it showed, until another frame or look is asked for.
        Raises ValueError for a view of verified frames, or of what was recorded, where the frame is none, and
        DisplayError for what is too much for the GPU."""
        wanted = self._in_look(look)
        if self._buffers.frame is None or wanted in (self._drawn, self._failed):
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
        frame = self._buffers.frame
        assert frame is not None
        if look.plain:
            target.color_attachments[0].write(_on_screen(frame.color), alignment=1)
        else:
            self._render_into(target, look)
        filtering = moderngl.LINEAR if look.smooth and look.view.is_smooth else moderngl.NEAREST
        target.color_attachments[0].filter = (filtering, filtering)
        problem = self.context.error
        if problem != "GL_NO_ERROR":
            raise DisplayError(f"the GPU could not draw this: {problem}")

    def _render_into(self, target: Any, look: Look) -> None:
        program, triangle = self.passes.made(look.view.value, units=NAMES)
        self._set_uniforms(program, look)
        self._buffers.use(program, look.light, look.magnified, look.cut)
        self.passes.draw(triangle, target)

    def drawn(self, look: Look) -> bool:
        """Whether the target shows the frame in this look."""
        return self._drawn == self._in_look(look)

    def _in_look(self, look: Look) -> tuple[int, Look]:
        """The frame and all that counts of a look: little of one that shows the picture as it was traced."""
        return self._buffers.serial, Look(smooth=look.smooth) if look.plain else look

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
        """Free everything on the GPU, but what it shares with others."""
        if not self._shares_passes:
            self.passes.release()
        self._buffers.release()
        self._release_target()
        self._drawn = None

    def _set_uniforms(self, program: Any, look: Look) -> None:
        frame, view, ranges = self._buffers.frame, look.view, self._buffers.ranges
        assert frame is not None
        dynamic = OCCLUSION_COLORS[OcclusionMode.DYNAMIC]
        words = frame.certificates if view is View.CERTIFICATE and frame.certificates is not None else frame.modes
        palettes = {
            View.OCCLUSION: list(OCCLUSION_COLORS.values()),
            View.SHADOW: [*SHADOW_COLORS.values(), dynamic],
            View.CERTIFICATE: [*CERTIFICATE_COLORS.values(), dynamic],
            View.PENUMBRA: list(ARRIVAL_COLORS.values()),
            View.VOXELS: list(VOXEL_COLORS.values()),
            View.TREE: list(TREE_WAITS),
            View.FATE: fate_palette(look.fate),
            View.MOVING_SHADOW: list(MOVING_SHADOW_COLORS.values()),
        }
        values: dict[str, Any] = {
            "table_width": TABLE_WIDTH,
            "background": BACKGROUND,
            "shading": look.shading,
            "outlines": look.outlines,
            "selected": look.selected,
            "selected_part": look.selected_part if self._buffers.part_of is not None else -1,
            "light": look.light if has_shadow_mode(words, look.light) else -1,
            "range": look.span or ranges.span(view),
            "curve": list(Curve).index(look.tone.curve),
            "gain": look.tone.gain,
            "white": look.tone.white,
            "clipping": look.clipping,
            "clip_colors": [TOO_BRIGHT, BLACK],
            "shares": look.shares,
            "beneath": look.beneath,
            "pale": PALE,
            "stripe": UNTRUSTED_STRIPE,
            "cell_line": FAINT_LINE if view in (View.CELL_LIGHTS, View.TREE) else CELL_LINE,
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
        self._buffers.check_size(self.size)
        texture = self.context.texture(self.size, 4)
        texture.repeat_x = texture.repeat_y = False
        return self.context.framebuffer([texture])

    def _release_target(self) -> None:
        if self._target is not None:
            _release_framebuffer(self._target)
            self._target = None


def _on_screen(color: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Colours (height, width, 3) as a target holds them, (height, width, 4)."""
    pixels = np.empty((*color.shape[:2], 4), np.uint8)
    to_screen(np.ascontiguousarray(color, np.float32).reshape(-1, 3), pixels.reshape(-1, 4))
    return pixels


def _release_framebuffer(framebuffer: Any) -> None:
    framebuffer.color_attachments[0].release()
    framebuffer.release()

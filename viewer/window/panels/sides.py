"""A and B in the window: what of them is on the GPU, what the picture shows of them, with its names and its line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from imgui_bundle import ImVec2, imgui

from tracer.frame import Frame
from tracer.method import title_of
from viewer.state.comparison import CompareMode, Side
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import DARK, HELD, LESS, LIGHT, MORE, Color
from viewer.state.picking import pixel_at
from viewer.state.views import View
from viewer.views import words_at
from viewer.views.base import Lines, Pixels
from viewer.views.compare import composed, difference_legend, signed_picture
from viewer.views.legend import Legend
from viewer.views.wipe import wipe_column
from viewer.window.display import PictureTexture
from viewer.window.panels.area import Area
from viewer.window.ui import Ui
from viewer.window.widgets import em, fitted, packed

PICTURE, OF_A = "picture", "A"
"""What the magnifier calls what fills the picture, and A beside it."""
GAP = 0.3
"""Ems between pictures side by side."""
_REACH = 0.45  # ems to either side of the line where it can be taken hold of
_LEAST = 3.0  # ems of room for a name beside the line


# --- on the GPU --------------------------------------------------------------------------------------


def draw_options(ui: Ui) -> DrawOptions:
    """Return how the newest frame is drawn: in the view that it can be drawn in, with a range for both pictures."""
    c, view = ui.controller, ui.controller.scheduler.drawn_view
    options = replace(c.session.draw, view=view, magnified=c.scheduler.magnified)
    return options.with_span(c.comparing.span(view))


def draw(ui: Ui, options: DrawOptions) -> None:
    """Bring what is to be seen besides the live picture, which is drawn with these options."""
    seen, gl = ui.controller.comparing.seen, ui.graphics
    if seen is None:
        gl.a.clear()
        gl.difference.clear()
    elif seen.difference is not None:
        wanted = seen.difference, ui.controller.comparing.limit(seen.difference), options.mark_wrong
        gl.difference.update(wanted, lambda: signed_picture(*wanted))
    else:
        gl.a.draw(seen.a.frame, replace(options, view=seen.a.view, light=seen.a.light))


def filling(ui: Ui) -> PictureTexture:
    """Return what fills the picture: B, or A, or their difference; A's part of a wipe is drawn over it."""
    seen, gl = ui.controller.comparing.seen, ui.graphics
    if seen is not None and seen.shows_a:
        return gl.a
    return gl.difference if seen is not None and seen.difference is not None else gl.display


def magnify(ui: Ui, options: DrawOptions) -> None:
    """Where single pixels are to be seen, draw what is shown as large as it is shown, with crisp pixels."""
    seen, gl, size, zoom = ui.controller.comparing.seen, ui.graphics, ui.picture.size, options.zoom
    if min(size) < 1:
        return
    smooth = options.smooth and zoom.fits
    beside = seen is not None and (seen.has_line or seen.mode is CompareMode.SIDE)
    for name, drawn in ((PICTURE, filling(ui)), (OF_A, gl.a if beside else None)):
        picture = drawn.picture if drawn is not None else None
        view = seen.a.view if seen is not None and drawn is gl.a else options.view
        blended = smooth and view.shows_clipped and drawn is not gl.difference
        enlarged = picture is not None and (size[0] > picture.size[0] or not zoom.fits)
        if drawn is not None and enlarged and not blended:
            gl.magnifier.draw(name, picture, drawn.version, zoom, size)
        else:
            gl.magnifier.drop(name)


def composed_picture(ui: Ui, b: Pixels) -> Pixels:
    """Return the picture to save: B as it was drawn, and what is compared with it."""
    seen = ui.controller.comparing.seen
    if seen is None:
        return b
    if seen.difference is not None:
        return ui.graphics.difference.read()
    return composed(ui.graphics.a.read(), b, seen.mode, ui.controller.session.draw.wipe, seen.shows_a)


# --- in words ----------------------------------------------------------------------------------------


def legend(ui: Ui) -> Legend | None:
    """Return the legend of the signed difference, while that is seen."""
    comparing = ui.controller.comparing
    found = comparing.seen.difference if comparing.seen is not None else None
    return None if found is None else difference_legend(found, comparing.limit(found))


def words(ui: Ui, options: DrawOptions, side: Side | None = None) -> tuple[Frame, Callable[[int, int], Lines]] | None:
    """Return the frame whose pixels are seen, and what says what each of them shows: those of a side, or of all that
    fills the picture; None without a frame."""
    seen = ui.controller.comparing.seen
    if side is None and seen is not None and seen.difference is not None:
        return seen.b.frame, seen.difference.words
    found = side or (seen.a if seen is not None and seen.shows_a else ui.controller.comparing.b)
    if found is None:
        return None
    width, height = found.frame.width, found.frame.height
    wiped = seen if seen is not None and side is None and seen.has_line else None
    column = wipe_column(width, options.wipe)

    def of(x: int, y: int) -> Lines:
        one = found if wiped is None else wiped.a if x < column else wiped.b
        at = pixel_at(one.frame, (x + 0.5) / width, (y + 0.5) / height)
        return words_at(one.frame, replace(options, view=one.view, light=one.light), *at)

    return found.frame, of


# --- over the picture --------------------------------------------------------------------------------


@dataclass
class WipeState:
    """Whether the pointer holds the line."""

    held: bool = False


def read_key(ui: Ui) -> None:
    """While the key is held, A is seen."""
    io, comparing = imgui.get_io(), ui.controller.comparing
    free = not (io.want_text_input or io.key_ctrl or io.key_alt or io.key_super or io.key_shift)
    comparing.held = comparing.state.on and free and ui.keyboard.is_down(ui.keymap.of("Show A"))


def area_of_b(ui: Ui, room: tuple[int, int]) -> tuple[int, int]:
    """Return the pixels that B is to have in a room for one picture: beside a picture that was kept as many as that
    has, so that both show the same; else as many as there is room for."""
    comparing, state = ui.controller.comparing, ui.controller.comparing.state
    if not state.on or state.mode is not CompareMode.SIDE or min(room) < 1:
        return room
    if not state.second:
        kept = comparing.kept
        return room if kept is None else (kept.frame.width, kept.frame.height)
    gap = round(em(GAP) * imgui.get_io().display_framebuffer_scale.x)
    return (max(1, (room[0] - gap) // 2), room[1]) if comparing.b is not None else room


def draw_picture(ui: Ui, name: str, texture: int, area: Area, right: float = 1.0) -> None:
    """Draw as much of a picture as is to be seen, up to a column, 0 to 1 from the picture's left edge."""
    left, top, end, bottom = area.zoom.shown()
    right = min(right, end)
    if right <= left:
        return
    at = ImVec2(area.corner.x + (right - left) / (end - left) * area.size.x, area.end.y)
    start, stop = ImVec2(left, top), ImVec2(right, bottom)
    crisp = ui.graphics.magnifier.texture_of(name, texture, area.zoom, ui.picture.size)
    if crisp is not None:
        texture, start, stop = crisp, ImVec2(0.0, 0.0), ImVec2((right - left) / (end - left), 1.0)
    imgui.get_window_draw_list().add_image(imgui.ImTextureRef(texture), area.corner, at, start, stop)


def draw_a(ui: Ui, area: Area, right: float = 1.0) -> None:
    """Draw A, up to a column, if it is there."""
    texture = ui.graphics.a.texture_id
    if texture is not None:
        draw_picture(ui, OF_A, texture, area, right)


def draw_wiped(ui: Ui, area: Area) -> None:
    """Draw A left of the line, where A and B are wiped."""
    seen = ui.controller.comparing.seen
    if seen is not None and seen.has_line:
        draw_a(ui, area, ui.controller.session.draw.wipe)


def drag_line(ui: Ui, area: Area) -> bool:
    """Let the pointer drag the line across the picture, which is ImGui's last item; returns whether it holds it."""
    state, there, x = ui.state(WipeState), _line_is_there(ui), imgui.get_io().mouse_pos.x
    near = there and abs(x - _line_at(ui, area)) <= em(_REACH)
    if imgui.is_item_activated() and imgui.is_mouse_clicked(imgui.MouseButton_.left):
        state.held = near
    held = state.held = state.held and there
    if held:
        ui.controller.session.set_draw(wipe=min(max(area.to_picture(x, 0.0)[0], 0.0), 1.0))
        state.held = imgui.is_item_active()
    if held or (near and imgui.is_item_hovered() and not imgui.is_item_active()):
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
    return held


def _line_is_there(ui: Ui) -> bool:
    """Whether a line is seen: between A and B, or between the culled picture and the right one."""
    seen = ui.controller.comparing.seen
    return ui.controller.scheduler.drawn_view is View.WIPE if seen is None else seen.has_line


def _line_at(ui: Ui, area: Area) -> float:
    """Where the line is on the screen: at an edge where it lies beyond what is shown."""
    return min(max(area.to_screen(ui.controller.session.draw.wipe, 0.0).x, area.corner.x), area.end.x)


def show(ui: Ui, area: Area, top: float) -> None:
    """Draw what says which is which, below the picture's title, which ends at `top`; and the line of a wipe."""
    seen, frame, y, room = ui.controller.comparing.seen, ui.controller.frame, top + em(0.2), area.size.x - em(0.6)
    corner = ImVec2(area.corner.x, y)
    if seen is None:
        if frame is not None and _line_is_there(ui):
            _line(ui, area, y, (title_of(frame.settings.method), "reference"), (None, None))
        return
    a, b = seen.names
    if seen.mode is CompareMode.SIDE:
        _label(ImVec2(area.corner.x - em(GAP) - area.size.x, area.corner.y), a, LESS, room)
        _label(corner, b, MORE, room)
    elif seen.has_line:
        _line(ui, area, y, (a, b), (LESS, MORE))
    elif seen.difference is not None:
        _label(corner, f"{b}   minus   {a}", None, room)
    else:
        _label(corner, *((a, LESS) if seen.shows_a else (b, MORE)), room)


def _label(at: ImVec2, text: str, color: Color | None, room: float, ends_there: bool = False) -> None:
    """A line on a dark ground, with a square of the colour that stands for A or B."""
    pad, line = em(0.35), imgui.get_text_line_height()
    square = 0.7 * line + pad if color is not None else 0.0
    text = fitted(text, room - square - 3.0 * pad)
    width = imgui.calc_text_size(text).x + square + 3.0 * pad
    at = ImVec2(at.x - width if ends_there else at.x, at.y)
    draw = imgui.get_window_draw_list()
    draw.add_rect_filled(at, ImVec2(at.x + width, at.y + line + 2.0 * pad), packed(DARK, 0.94), em(0.3))
    x, y = at.x + 1.5 * pad, at.y + pad + 0.18 * line
    if color is not None:
        draw.add_rect_filled(ImVec2(x, y), ImVec2(x + 0.7 * line, y + 0.7 * line), packed(color), em(0.1))
    draw.add_text(ImVec2(x + square, at.y + pad), packed(LIGHT), text)


def _line(ui: Ui, area: Area, top: float, names: tuple[str, str], colors: tuple[Color | None, Color | None]) -> None:
    """The line, with a disc on it that has an arrow to either side, and what lies left and right of it."""
    draw, x, y = imgui.get_window_draw_list(), _line_at(ui, area), (area.corner.y + area.end.y) / 2.0
    dark, bright = packed(DARK, 0.72), packed(HELD if ui.state(WipeState).held else LIGHT)
    half, radius, arrow, apart = max(1.0, em(0.05)), em(0.8), em(0.28), em(0.7)
    draw.push_clip_rect(area.corner, area.end, True)
    for wide, color in ((2.0 * half, dark), (half, bright)):
        draw.add_rect_filled(ImVec2(x - wide, area.corner.y), ImVec2(x + wide, area.end.y), color)
    draw.add_circle_filled(ImVec2(x, y), radius, dark)
    draw.add_circle(ImVec2(x, y), radius, bright, 0, max(1.5, em(0.1)))
    for side in (-1.0, 1.0):
        tip, base = x + side * 0.62 * radius, x + side * 0.22 * radius
        draw.add_triangle_filled(ImVec2(tip, y), ImVec2(base, y - arrow), ImVec2(base, y + arrow), bright)
        name, own = names[side > 0.0], colors[side > 0.0]
        room = (area.end.x - x if side > 0.0 else x - area.corner.x) - apart
        if room > em(_LEAST):
            _label(ImVec2(x + side * apart, top), name, own, room, ends_there=side < 0.0)
    draw.pop_clip_rect()

"""The traced picture in its window, and the pointer on it.

The picture keeps its aspect inside whatever room its window has; that room, in framebuffer
pixels, is the resolution at which the next frame is traced.  The pointer moves the camera only
when it was pressed on the picture itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state import navigation, verified
from viewer.state.comparison import CompareMode
from viewer.state.picking import point_at
from viewer.util.numbers import whole_percent
from viewer.window import comparing
from viewer.window.panels import (
    closeup,
    filmstrip,
    legend,
    missing,
    overlays,
    preview,
    savings,
    sides,
    slicing,
    status,
    timeline,
    tour,
    what_if,
)
from viewer.window.panels.area import Area
from viewer.window.panels.legend import LegendState
from viewer.window.style import ON_PICTURE_ERROR
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, em, paragraph

CLICK_SLACK = 4.0
BUTTONS = LEFT, RIGHT, MIDDLE = tuple(
    int(b) for b in (imgui.MouseButton_.left, imgui.MouseButton_.right, imgui.MouseButton_.middle)
)
_ALL_BUTTONS = int(
    imgui.ButtonFlags_.mouse_button_left
    | imgui.ButtonFlags_.mouse_button_right
    | imgui.ButtonFlags_.mouse_button_middle
)
FASTER = 4.0  # with Shift


def show(ui: Ui) -> None:
    """The window's content: what culling saves, the picture under it, the tour's strip and the timeline."""
    c, room = ui.controller, imgui.get_content_region_avail()
    bar = timeline.height() if c.session.animated else 0.0
    room = ImVec2(room.x, room.y - bar)
    above = savings.height(ui, ImVec2(room.x, room.y - tour.height(ui)))
    if above > 0.0:
        start = imgui.get_cursor_pos()
        ui.guard.panel("What culling saves", lambda: savings.show(ui, room.x))
        imgui.set_cursor_pos(start)
        imgui.dummy(ImVec2(room.x, above - imgui.get_style().item_spacing.y))
        room = ImVec2(room.x, room.y - above)
    strip = tour.leave_room(ui, imgui.get_cursor_screen_pos(), room)
    room = ImVec2(room.x, room.y - strip)
    scale = imgui.get_io().display_framebuffer_scale
    ui.picture.area = sides.area_of_b(ui, (max(0, int(room.x * scale.x)), max(0, int(room.y * scale.y))))
    top = imgui.get_cursor_pos()
    if room.x >= 1.0 and room.y >= 1.0 and not filmstrip.screen(ui, room):
        _picture(ui, room)
    if bar > 0.0:
        imgui.set_cursor_pos(ImVec2(top.x, top.y + room.y + strip))
        timeline.show(ui)


def _picture(ui: Ui, room: ImVec2) -> None:
    c = ui.controller
    c.selection.hovered = None
    frame = c.frame
    filling = comparing.filling(ui)
    texture = filling.texture_id if filling is not None else None
    if texture is not None and frame is None and c.reloaded:
        _last_picture(ui, room, texture)
        return
    if frame is None and preview.show(ui, room, _drag):
        return
    if frame is None or texture is None or c.session.scene is None:
        _placeholder(ui, room)
        return
    ui.pixels.enter(c.session.scene.path)
    width, height = c.traced.full_size if c.traced is not None else (1, 1)
    ui.picture.shape = width, height
    seen, gap = comparing.shown(ui), em(sides.GAP)
    beside = seen is not None and seen[2] is CompareMode.SIDE
    factor = min(((room.x - gap) / 2.0 if beside else room.x) / width, room.y / height)
    size = ImVec2(max(1.0, width * factor), max(1.0, height * factor))
    at = imgui.get_cursor_pos()
    left = at.x + (room.x - (2.0 * size.x + gap if beside else size.x)) / 2.0
    top = at.y + (room.y - size.y) / 2.0
    if beside and seen is not None and ui.graphics.compared is not None:
        area = _area(ui, "picture of A", left, top, size)
        sides.draw_picture(ui, comparing.OF_A, ui.graphics.compared.a.texture_id or 0, area)
        _pointer(ui, area, takes_edits=False)
        closeup.show(ui, area, seen[0])
        left += size.x + gap
    area = _area(ui, "picture", left, top, size)
    sides.draw_picture(ui, comparing.PICTURE, texture, area)
    if seen is not None:
        sides.draw_a(ui, area, seen)
    with _inside(area):
        overlays.show(ui, area)
    _pointer(ui, area)
    closeup.show(ui, area)
    if seen is not None:
        overlays.show_worst_pixels(ui, area, seen[1].frame)
    sides.show(ui, area)
    with _inside(area):
        what_if.show_lights(ui, area.whole, area.whole_end)
    lower = _overlay(ui, area.corner, area.end)
    if seen is not None:
        sides.show_names(ui, area, seen, lower)
    legend.show(ui, area.corner, area.end)
    missing.show(ui, area.corner, area.end)
    slicing.show(ui, area)
    closeup.menu(ui)


def _area(ui: Ui, name: str, left: float, top: float, size: ImVec2) -> Area:
    """A place for the picture in its window, which takes the pointer."""
    imgui.set_cursor_pos(ImVec2(left, top))
    corner = imgui.get_cursor_screen_pos()
    imgui.set_next_item_allow_overlap()  # what lies over the picture takes the pointer there
    imgui.invisible_button(name, size, _ALL_BUTTONS)
    scale = imgui.get_io().display_framebuffer_scale
    ui.picture.size = max(1, round(size.x * scale.x)), max(1, round(size.y * scale.y))
    return Area(corner, size, ui.controller.session.draw.zoom)


@contextmanager
def _inside(area: Area) -> Iterator[None]:
    """What is drawn over the picture does not go beyond it."""
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(area.corner, area.end, True)
    try:
        yield
    finally:
        draw.pop_clip_rect()


def _last_picture(ui: Ui, room: ImVec2, texture: int) -> None:
    """What was shown before the scene was read again, until it is traced: else each change would flash."""
    width, height = ui.picture.shape
    factor = min(room.x / width, room.y / height)
    size = ImVec2(max(1.0, width * factor), max(1.0, height * factor))
    at = imgui.get_cursor_pos()
    imgui.set_cursor_pos(ImVec2(at.x + (room.x - size.x) / 2.0, at.y + (room.y - size.y) / 2.0))
    imgui.image(imgui.ImTextureRef(texture), size)


def _placeholder(ui: Ui, room: ImVec2) -> None:
    """What stands there before the first picture."""
    c = ui.controller
    if c.loader.load_job is not None or c.loader.warm_up_job is not None:
        return  # the progress window speaks
    text = status.first_picture(c)
    if c.session.scene is None:
        text = f"Open a scene{ui.key('Open...')}, or drop one on this window"
    width = imgui.calc_text_size(text).x
    at = imgui.get_cursor_pos()
    imgui.set_cursor_pos(ImVec2(at.x + max(0.0, (room.x - width) / 2.0), at.y + room.y / 2.0))
    paragraph(text, QUIET)


def _pointer(ui: Ui, area: Area, takes_edits: bool = True) -> None:
    """Hovering, clicking and dragging on the picture, which is ImGui's last item; of lights too if it `takes_edits`."""
    c, io = ui.controller, imgui.get_io()
    if ui.picture.pivot_scene is not c.session.scene:  # a point of another scene is none to orbit around
        ui.picture.pivot, ui.picture.pivot_scene = None, c.session.scene
    u, v = area.to_picture(io.mouse_pos.x, io.mouse_pos.y)
    if imgui.is_item_hovered() and 0.0 <= u < 1.0 and 0.0 <= v < 1.0:
        c.selection.hovered = (u, v)
        if not closeup.wheel(ui, area):
            _wheel(ui, io.mouse_wheel)
    if takes_edits and what_if.handle(ui, area.whole, area.whole_size):
        return
    if sides.handle(ui, area) or closeup.drag(ui, area):
        return
    if imgui.is_item_activated():
        ui.picture.dragged = False
        ui.picture.pressed_at = (io.mouse_pos.x, io.mouse_pos.y)
        ui.picture.pressed = next((b for b in BUTTONS if imgui.is_mouse_clicked(b)), LEFT)
        point = point_at(c.frame, u, v) if c.frame is not None else None
        if point is not None:
            ui.picture.pivot = (float(point[0]), float(point[1]), float(point[2]))
    released = imgui.is_item_deactivated()
    if imgui.is_item_active() or released:  # a quick hand drags and lets go within one of our frames
        ui.picture.dragged |= math.dist(ui.picture.pressed_at, (io.mouse_pos.x, io.mouse_pos.y)) > CLICK_SLACK
        if ui.picture.dragged:
            _drag(ui, ui.picture.pressed, io.mouse_delta.x / area.size.y, io.mouse_delta.y / area.size.y)
    if released and not ui.picture.dragged and ui.picture.pressed == RIGHT:
        closeup.open_menu(ui, (u, v))
    elif released and not ui.picture.dragged:
        c.selection.select((u, v))


def _drag(ui: Ui, button: int, dx: float, dy: float) -> None:
    """Move the camera by a drag of so many picture heights."""
    if dx == 0.0 and dy == 0.0:
        return
    c = ui.controller
    camera, world = c.session.camera, c.motion.world_up
    pivot = ui.picture.pivot
    orbiting = c.preferences.navigation == "orbit" and pivot is not None
    turn = navigation.RADIANS_PER_HEIGHT
    if button == MIDDLE or (button == RIGHT and orbiting):
        distance = math.dist(pivot, camera.position) if pivot is not None else 4.0 * c.motion.pace
        c.motion.move(navigation.pan(camera, dx, -dy, distance))
    elif orbiting and pivot is not None:
        c.motion.move(navigation.orbit(camera, pivot, 2.0 * dx * turn, -2.0 * dy * turn, world))
    else:
        c.motion.move(navigation.look(camera, dx * turn, -dy * turn, world))


def _wheel(ui: Ui, notches: float) -> None:
    if notches == 0.0:
        return
    c = ui.controller
    if c.preferences.navigation == "orbit":
        at = c.selection.hovered
        point = point_at(c.frame, *at) if c.frame is not None and at is not None else None
        if point is not None:
            ui.picture.pivot = (float(point[0]), float(point[1]), float(point[2]))
        if ui.picture.pivot is not None:
            c.motion.move(navigation.dolly(c.session.camera, ui.picture.pivot, notches))
    else:
        c.preferences.speed = min(max(c.preferences.speed * 1.2**notches, 0.001), 1000.0)
        c.notices.say(f"flying speed {c.preferences.speed:.3g}")


def fly(ui: Ui) -> None:
    """Move by the keys that are held down; called once per frame, for every window but those being typed in."""
    c, io = ui.controller, imgui.get_io()
    if (
        ui.keyboard.wanted_for
        or io.want_text_input
        or io.key_ctrl
        or io.key_alt
        or io.key_super
        or c.session.seen is None
    ):
        return
    if imgui.is_popup_open("", int(imgui.PopupFlags_.any_popup_id | imgui.PopupFlags_.any_popup_level)):
        return

    def down(name: str) -> float:
        return float(name not in ui.keyboard.chorded and ui.keyboard.is_down(ui.keymap.of(name)))

    def axis(plus: str, minus: str) -> float:
        return down(plus) - down(minus)

    move = axis("Fly right", "Fly left"), axis("Fly up", "Fly down"), axis("Fly forward", "Fly back")
    if any(move):
        way = c.motion.pace * c.preferences.speed * min(io.delta_time, 0.1) * (FASTER if io.key_shift else 1.0)
        right, up, forward = (way * along for along in move)
        c.motion.move(navigation.fly(c.session.camera, right, up, forward, c.motion.world_up))


def _overlay(ui: Ui, corner: ImVec2, end: ImVec2) -> float:
    """What view it is and how coarse, in the picture's corner; returns where the room below that begins."""
    c = ui.controller
    frame, request = c.frame, c.traced.request if c.traced is not None else None
    if frame is None or request is None:
        return corner.y
    text = f"{c.scheduler.title}   {frame.width} x {frame.height}"
    if request.divisor > 1:
        text += f"   1/{request.divisor}"
    if frame.statistics.part < 1.0:
        text += f"   {whole_percent(frame.statistics.part)} shaded"
    elif request.samples > 1:
        text += f"   {c.scheduler.samples_shown} of {request.samples} samples"
    if not c.session.draw.zoom.fits:
        text += f"   {c.session.draw.zoom.scale:.3g} x"
    tone = c.session.draw.tone.in_words()
    text += f"   {tone}" if tone and c.scheduler.drawn_view.shows_picture else ""
    counter = ""
    if c.scheduler.drawn_view.needs_verify and not ui.state(LegendState).shown:
        counter = f"   {verified.in_short(frame.statistics)}"
    size = imgui.calc_text_size(text + counter)
    if end.x - corner.x < size.x + em(2.0):
        return corner.y
    pad = em(0.35)
    lower = ImVec2(corner.x + size.x + 3.0 * pad, corner.y + size.y + 2.0 * pad)
    opacity = 0.72 if c.session.draw.zoom.fits else 0.94  # there may be numbers beneath
    colors = ((0.05, 0.06, 0.08, opacity), (0.93, 0.94, 0.96, 1.0))
    back, front = (imgui.get_color_u32(ImVec4(*color)) for color in colors)
    draw = imgui.get_window_draw_list()
    draw.add_rect_filled(corner, lower, back, em(0.3))
    draw.add_text(ImVec2(corner.x + 1.5 * pad, corner.y + pad), front, text)
    if counter:
        color = imgui.get_color_u32(ON_PICTURE_ERROR) if verified.is_wrong(frame.statistics) else front
        draw.add_text(ImVec2(corner.x + 1.5 * pad + imgui.calc_text_size(text).x, corner.y + pad), color, counter)
    return lower.y

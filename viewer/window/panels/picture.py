"""The traced picture in its window, and the pointer on it.

The picture keeps its aspect inside whatever room its window has; that room, in framebuffer pixels, is the resolution at
which the next frame is traced.  The pointer moves the camera only when it was pressed on the picture itself."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui

from viewer.state import navigation, verified
from viewer.state.comparison import CompareMode
from viewer.state.picking import point_at
from viewer.state.pixels import STEP, panned
from viewer.state.views import Record
from viewer.util.numbers import whole_percent
from viewer.window.menus import ANY_POPUP
from viewer.window.panels import legend, overlays, pixels, savings, sides, status, toolbar, what_if
from viewer.window.panels.area import Area, inside, pointer, size_of, write_lines
from viewer.window.panels.view import show_words_in_space
from viewer.window.setting_rows import ALL
from viewer.window.style import ON_PICTURE_ERROR
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em

CLICK_SLACK = 4.0
BUTTONS = LEFT, RIGHT, MIDDLE = tuple(
    int(b) for b in (imgui.MouseButton_.left, imgui.MouseButton_.right, imgui.MouseButton_.middle)
)
FASTER = 4.0  # with Shift


def show(ui: Ui) -> None:
    """The window's content: what is chosen, what culling saves, the picture and the timeline."""
    c, room = ui.controller, imgui.get_content_region_avail()
    ui.guard.panel("The row above the picture", lambda: toolbar.show(ui, room.x))
    room.y -= toolbar.height()
    if c.session.animated:
        room.y -= toolbar.time_height()
    above = savings.height(ui, room)
    if above > 0.0:
        start = imgui.get_cursor_pos()
        ui.guard.panel("What culling saves", lambda: savings.show(ui, room.x))
        imgui.set_cursor_pos(start)
        imgui.dummy(ImVec2(room.x, above - imgui.get_style().item_spacing.y))  # where nothing follows, ImGui complains
        room.y -= above
    scale = imgui.get_io().display_framebuffer_scale
    ui.picture.area = sides.area_of_b(ui, (max(0, int(room.x * scale.x)), max(0, int(room.y * scale.y))))
    top = imgui.get_cursor_pos()
    if room.x >= 1.0 and room.y >= 1.0:
        _picture(ui, room)
    if c.session.animated:
        imgui.set_cursor_pos(ImVec2(top.x, top.y + room.y))
        toolbar.show_time(ui)


def _picture(ui: Ui, room: ImVec2) -> None:
    c = ui.controller
    c.selection.hovered = None
    texture = sides.filling(ui).texture_id
    if c.traced is None:
        if texture is not None and c.reloaded:  # what was shown before stays until there is news: it would flash
            left, top, size = _fitted(ui.picture.shape, room)
            imgui.set_cursor_pos(ImVec2(left, top))
            imgui.image(imgui.ImTextureRef(texture), size)
        else:
            _placeholder(ui, room)
    elif texture is not None and c.session.scene is not None:
        ui.picture.shape = c.traced.full_size
        _newest(ui, room, texture)


def _newest(ui: Ui, room: ImVec2, texture: int) -> None:
    """The newest picture, beside or over the one that it is compared with, and all that lies over it."""
    seen, gap = ui.controller.comparing.seen, em(sides.GAP)
    if seen is not None and seen.mode is CompareMode.SIDE:
        left, top, size = _fitted(ui.picture.shape, room, 2, gap)
        area = _area(ui, "picture of A", left, top, size)
        sides.draw_a(ui, area)
        _pointer(ui, area)
        pixels.draw(ui, area, seen.a)
        left += size.x + gap
    else:
        left, top, size = _fitted(ui.picture.shape, room)
    area = _area(ui, "picture", left, top, size)
    sides.draw_picture(ui, sides.PICTURE, texture, area)
    sides.draw_wiped(ui, area)
    with inside(area):
        overlays.show(ui, area)
    _pointer(ui, area)
    pixels.draw(ui, area)
    with inside(area):
        what_if.show_lights(ui, area)
    lower = _title(ui, area)
    sides.show(ui, area, lower)
    legend.show(ui, area)
    overlays.show_missing(ui, area.corner, area.end)
    show_words_in_space(ui)


def _fitted(shape: tuple[int, int], room: ImVec2, count: int = 1, gap: float = 0.0) -> tuple[float, float, ImVec2]:
    """The left and upper edge, and the size, of the first of so many pictures that fill the room side by side."""
    gap *= count - 1
    factor = min((room.x - gap) / count / shape[0], room.y / shape[1])
    size, at = ImVec2(max(1.0, shape[0] * factor), max(1.0, shape[1] * factor)), imgui.get_cursor_pos()
    return at.x + (room.x - count * size.x - gap) / 2.0, at.y + (room.y - size.y) / 2.0, size


def _area(ui: Ui, name: str, left: float, top: float, size: ImVec2) -> Area:
    """A place for the picture in its window, which takes the pointer."""
    imgui.set_cursor_pos(ImVec2(left, top))
    corner = imgui.get_cursor_screen_pos()
    imgui.set_next_item_allow_overlap()  # what lies over the picture takes the pointer there
    imgui.invisible_button(name, size, int(imgui.ButtonFlags_.mouse_button_mask_))
    scale = imgui.get_io().display_framebuffer_scale
    ui.picture.size = max(1, round(size.x * scale.x)), max(1, round(size.y * scale.y))
    return Area(corner, size, ui.controller.session.draw.zoom)


def _placeholder(ui: Ui, room: ImVec2) -> None:
    """What stands there before the first picture: what goes on, and how far it is."""
    c = ui.controller
    job, text = c.loader.warm_up_job or c.loader.load_job, status.first_picture(c)
    if c.session.scene is None and job is None:
        text = f"Open a scene{ui.key('Open...')}, or drop one on this window"
    at, width = imgui.get_cursor_pos(), min(room.x, max(imgui.calc_text_size(text).x, em(24.0)))
    left = at.x + (room.x - width) / 2.0
    imgui.set_cursor_pos(ImVec2(left, at.y + room.y / 2.0))
    clipped(text, QUIET)
    if job is not None:
        imgui.set_cursor_pos_x(left)
        imgui.progress_bar(job.fraction, ImVec2(width, 0.0), job.label)  # with the time that is left


def _title(ui: Ui, area: Area) -> float:
    """What view it is and how coarse, in the picture's corner; returns where the room below that begins."""
    c, view = ui.controller, ui.controller.scheduler.drawn_view
    if c.traced is None:
        return area.corner.y
    frame, request, draw = c.traced.frame, c.traced.request, c.session.draw
    parts = [c.scheduler.title, f"{frame.width} x {frame.height}"]
    if frame.statistics.part < 1.0:
        parts.append(f"{whole_percent(frame.statistics.part)} shaded")
    elif request.samples > 1:
        parts.append(f"{c.scheduler.samples_shown} of {request.samples} samples")
    if not draw.zoom.fits:
        parts.append(f"{draw.zoom.scale:.3g} x")
    parts += filter(None, (draw.tone.in_words() if view.shows_picture else "",))
    lines = ["   ".join(parts)]
    if area.size.x < size_of(lines)[0]:
        return area.corner.y
    write_lines(lines, area.corner)
    lower = area.corner.y + size_of(lines)[1]
    if view.records is Record.VERIFY and not legend.is_shown(ui) and verified.is_wrong(frame.statistics):
        write_lines([verified.in_short(frame.statistics)], ImVec2(area.corner.x, lower), ON_PICTURE_ERROR)
        lower += size_of(lines)[1]
    return lower


# --- the pointer and the keys that fly -------------------------------------------------------------


def _pointer(ui: Ui, area: Area) -> None:
    """Hovering, clicking and dragging on the picture, which is ImGui's last item."""
    c = ui.controller
    if ui.picture.pivot_scene is not c.session.scene:  # a point of another scene is none to orbit around
        ui.picture.pivot, ui.picture.pivot_scene = None, c.session.scene
    u, v = area.to_picture(*pointer())
    if imgui.is_item_hovered() and 0.0 <= u < 1.0 and 0.0 <= v < 1.0:
        c.selection.hovered = (u, v)
        if imgui.get_io().mouse_wheel:
            _wheel(ui, imgui.get_io().mouse_wheel, (u, v))
    if sides.drag_line(ui, area):
        return
    if imgui.is_item_activated() and not imgui.get_io().key_ctrl:
        _take_pivot(ui, (u, v))
    released = _drag(ui, area, CLICK_SLACK)
    if released and not ui.picture.dragged and ui.picture.pressed == LEFT and not ui.picture.with_ctrl:
        c.selection.select((u, v))


def _drag(ui: Ui, area: Area, slack: float) -> bool:
    """Move the camera by the pointer on the last item, or with Ctrl the picture in its room; a way of up to `slack`
    pixels is none.  Returns whether the pointer has let go."""
    c, picture, io = ui.controller, ui.picture, imgui.get_io()
    if imgui.is_item_activated():
        picture.dragged, picture.pressed_at = False, (io.mouse_pos.x, io.mouse_pos.y)
        picture.pressed = next((b for b in BUTTONS if imgui.is_mouse_clicked(b)), LEFT)
        picture.with_ctrl = io.key_ctrl and picture.pressed == LEFT
    released = imgui.is_item_deactivated()
    if not imgui.is_item_active() and not released:  # a quick hand drags and lets go within one of our frames
        return False
    if picture.with_ctrl:
        draw, by = c.session.draw, io.mouse_delta
        c.session.set_draw(zoom=panned(draw.zoom, by.x / area.size.x, by.y / area.size.y))
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_all)
        return released
    picture.dragged |= math.dist(picture.pressed_at, (io.mouse_pos.x, io.mouse_pos.y)) > slack
    dx, dy = io.mouse_delta.x / area.size.y, io.mouse_delta.y / area.size.y
    if not picture.dragged or (dx == 0.0 and dy == 0.0):
        return released
    camera, world, pivot = c.session.camera, c.motion.world_up, picture.pivot
    orbiting, turn = c.preferences.navigation == "orbit" and pivot is not None, navigation.RADIANS_PER_HEIGHT
    if picture.pressed == MIDDLE or (picture.pressed == RIGHT and orbiting):
        distance = math.dist(pivot, camera.position) if pivot is not None else 4.0 * c.motion.pace
        camera = navigation.pan(camera, dx, -dy, distance)
    elif orbiting and pivot is not None:
        camera = navigation.orbit(camera, pivot, 2.0 * dx * turn, -2.0 * dy * turn, world)
    else:
        camera = navigation.look(camera, dx * turn, -dy * turn, world)
    c.motion.move(camera)
    return released


def _take_pivot(ui: Ui, at: tuple[float, float]) -> None:
    """Orbit around what is seen at a point of the picture, from now on; the old point stays where nothing is."""
    point = point_at(ui.controller.frame, *at) if ui.controller.frame is not None else None
    if point is not None:
        ui.picture.pivot = (float(point[0]), float(point[1]), float(point[2]))


def _wheel(ui: Ui, notches: float, at: tuple[float, float]) -> None:
    """Zoom into the picture with Ctrl; else come nearer to what is seen at this point of it, or fly faster."""
    c, speed = ui.controller, ALL["speed"]
    if imgui.get_io().key_ctrl:
        pixels.zoom_by(ui, STEP**notches)
    elif c.preferences.navigation == "orbit":
        _take_pivot(ui, at)
        if ui.picture.pivot is not None:
            c.motion.move(navigation.dolly(c.session.camera, ui.picture.pivot, notches))
    else:
        c.settings.set(speed, min(max(c.preferences.speed * 1.2**notches, speed.low), speed.high))
        c.notices.say(f"flying speed {c.preferences.speed:.3g}")


def fly(ui: Ui) -> None:
    """Move by the keys that are held down; called once per frame, for every window but those being typed in."""
    c, io = ui.controller, imgui.get_io()
    chord = io.key_ctrl or io.key_alt or io.key_super
    if ui.keyboard.wanted_for or io.want_text_input or chord or c.session.scene is None:
        return
    if imgui.is_popup_open("", ANY_POPUP):
        return

    def down(name: str) -> float:
        return float(name not in ui.keyboard.chorded and ui.keyboard.is_down(ui.keymap.of(name)))

    way = c.motion.pace * c.preferences.speed * min(io.delta_time, 0.1) * (FASTER if io.key_shift else 1.0)
    axes = ("Fly right", "Fly left"), ("Fly up", "Fly down"), ("Fly forward", "Fly back")
    right, up, forward = (way * (down(plus) - down(minus)) for plus, minus in axes)
    if right or up or forward:
        c.motion.move(navigation.fly(c.session.camera, right, up, forward, c.motion.world_up))

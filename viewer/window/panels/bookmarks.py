"""The bookmarks of the scene, with their pictures: gone to, renamed, brought into another order, deleted."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.output.thumbnail import from_text
from viewer.state.preferences import Bookmark
from viewer.window.camera_commands import KEYED_BOOKMARKS
from viewer.window.panels.names import NameField, begin_edit, edit_name
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, em, fitted, heading, paragraph, tooltip

LIST = "bookmarks"
_HEIGHT = 3.2  # of a line, in ems
_MOST = 5  # lines that are seen at once
_DRAGGED = "bookmark"


@dataclass
class BookmarksState:
    """The name that is typed for a new one."""

    new: str = ""


def show(ui: Ui) -> None:
    """A part of the camera's panel."""
    state = ui.state(BookmarksState)
    c = ui.controller
    heading("Bookmarks")
    button = f"{icons.ICON_FA_BOOKMARK}##add"
    imgui.set_next_item_width(-em(2.6))
    flags = int(imgui.InputTextFlags_.enter_returns_true)
    entered, state.new = imgui.input_text_with_hint("##bookmark", "name", state.new, flags)
    imgui.same_line()
    if imgui.button(button, (-1.0, 0.0)) or entered:
        c.bookmarks.add(state.new)
        state.new = ""
    tooltip(f"keep this view: camera, time and settings{ui.key('Add bookmark')}")
    if not c.bookmarks.all:
        paragraph("None yet in this scene.", QUIET)
    number = len(c.bookmarks.all)
    if number > _MOST:
        imgui.begin_child("list", ImVec2(0.0, _MOST * (em(_HEIGHT) + imgui.get_style().item_spacing.y)))
    for index in range(number):
        imgui.push_id(index)
        done = _line(ui, index)
        imgui.pop_id()
        if done:  # the list is another one now
            break
    if number > _MOST:
        imgui.end_child()


def _line(ui: Ui, index: int) -> bool:
    """One bookmark; returns whether the list has changed."""
    c = ui.controller
    mark = c.bookmarks.all[index]
    name, height = mark.name, em(_HEIGHT)
    corner, room = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
    buttons = em(4.2)
    clicked = imgui.selectable("##go", False, 0, ImVec2(room - buttons, height))[0]
    key = ui.key(f"Go to bookmark {index + 1}") if index < KEYED_BOOKMARKS else ""
    tooltip(f"{name}: go there{key}. Drag it to another place in the list; the right button offers more.")
    changed = _reorder(ui, index)
    if imgui.begin_popup_context_item("more"):
        changed = _more(ui, index) or changed
        imgui.end_popup()
    end = imgui.get_cursor_screen_pos()
    text = corner.x + _picture(ui, mark, corner, height) + em(0.6)
    imgui.set_cursor_screen_pos(ImVec2(text, corner.y + 0.5 * (height - imgui.get_frame_height())))
    text_room = corner.x + room - buttons - text
    if ui.state(NameField).place == (LIST, index):
        imgui.set_next_item_width(text_room)
        edit_name(ui, lambda typed: c.bookmarks.rename(index, typed))
    else:
        imgui.align_text_to_frame_padding()
        imgui.text_unformatted(fitted(name, text_room))
    imgui.set_cursor_screen_pos(ImVec2(corner.x + room - buttons + em(0.4), corner.y + 0.5 * (height - em(1.3))))
    if imgui.small_button(icons.ICON_FA_PEN):
        begin_edit(ui, (LIST, index), name)
    tooltip("rename it")
    imgui.same_line()
    if imgui.small_button(icons.ICON_FA_XMARK):
        c.bookmarks.forget(index)
        changed = True
    tooltip("delete it")
    imgui.set_cursor_screen_pos(end)
    imgui.dummy(ImVec2(0.0, 0.0))
    if clicked:
        c.go_to_bookmark(index)
    return changed


def _picture(ui: Ui, mark: Bookmark, corner: ImVec2, height: float) -> float:
    """The small picture, or an empty place; returns its width."""
    room, draw = 1.6 * height, imgui.get_window_draw_list()
    text = mark.picture
    picture = ui.cached(f"picture of {id(mark)}", mark, text, lambda: from_text(text))
    texture = (
        ui.graphics.textures.texture_id(picture, True)
        if picture is not None and ui.graphics.textures is not None
        else None
    )
    low, high = ImVec2(corner.x, corner.y), ImVec2(corner.x + room, corner.y + height)
    if picture is None or texture is None:
        draw.add_rect_filled(low, high, imgui.get_color_u32(imgui.Col_.frame_bg), em(0.2))
        return room
    # As much of it as fills its place, from the middle.
    shape, wanted = picture.width / picture.height, room / height
    across, down = (min(1.0, wanted / shape), min(1.0, shape / wanted))
    uv = (0.5 - 0.5 * across, 0.5 - 0.5 * down), (0.5 + 0.5 * across, 0.5 + 0.5 * down)
    draw.add_image(imgui.ImTextureRef(texture), low, high, ImVec2(*uv[0]), ImVec2(*uv[1]))
    return room


def _reorder(ui: Ui, index: int) -> bool:
    """Dragging the line onto another; returns whether that has happened."""
    if imgui.begin_drag_drop_source():
        imgui.set_drag_drop_payload_py_id(_DRAGGED, index)
        imgui.text_unformatted(ui.controller.bookmarks.all[index].name)
        imgui.end_drag_drop_source()
    moved = False
    if imgui.begin_drag_drop_target():
        payload = imgui.accept_drag_drop_payload_py_id(_DRAGGED)
        if payload is not None:
            ui.controller.bookmarks.move(int(payload.data_id), index)
            moved = True
        imgui.end_drag_drop_target()
    return moved


def _more(ui: Ui, index: int) -> bool:
    """The menu of a bookmark; returns whether the list has changed."""
    marks, last = ui.controller.bookmarks, len(ui.controller.bookmarks.all) - 1
    if imgui.menu_item("Rename", "", False)[0]:
        begin_edit(ui, (LIST, index), marks.all[index].name)
    if imgui.menu_item("Let it be this place", "", False)[0]:
        marks.replace(index)
    for label, to, possible in (("Move up", index - 1, index > 0), ("Move down", index + 1, index < last)):
        if imgui.menu_item(label, "", False, possible)[0]:
            marks.move(index, to)
            return True
    imgui.separator()
    if imgui.menu_item("Delete", "", False)[0]:
        marks.forget(index)
        return True
    return False

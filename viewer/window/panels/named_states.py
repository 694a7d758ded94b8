"""Bookmarks, in the panel *Camera*, and presets, in a dialog: saved, applied, renamed, put in order, deleted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.named_states import BUILT_IN, NamedStates
from viewer.window.command import Command, Kind
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, em, fitted, heading, paragraph, tooltip

_ENTER = int(imgui.InputTextFlags_.enter_returns_true)
_RENAMING = _ENTER | int(imgui.InputTextFlags_.auto_select_all)
_MOST = 8  # lines that are seen at once
KEYED_BOOKMARKS = 9


@dataclass
class NameFields:
    """What is typed for a new name, by the kind of states; which one is being renamed, what is typed there, and whether
    its field is new."""

    new: dict[str, str] = field(default_factory=dict)
    place: tuple[str, int] | None = None
    text: str = ""
    fresh: bool = False


def show_bookmarks(ui: Ui) -> None:
    """A part of the camera's panel."""
    c = ui.controller

    def tip(index: int) -> str:
        return f"go there{ui.key(f'Go to bookmark {index + 1}') if index < KEYED_BOOKMARKS else ''}"

    heading("Bookmarks")
    _new(ui, c.bookmarks, "name", icons.ICON_FA_BOOKMARK, em(2.6))
    tooltip(f"keep this place: camera, time and view{ui.key('Add bookmark')}; a name of the list replaces that one")
    if not c.bookmarks.all:
        paragraph("None yet in this scene.", QUIET)
    _list(ui, c.bookmarks, c.go_to_bookmark, tip)


def show_presets(ui: Ui) -> None:
    """What is in the dialog."""
    presets = ui.controller.presets
    _new(ui, presets, "name for the settings as they are now", "Save", em(5.0))
    imgui.separator_text("Saved by you")
    if not presets.all:
        paragraph("None yet. A preset keeps settings and view; not scene, camera and time.", QUIET)
    _list(ui, presets, lambda index: presets.apply(presets.all[index].name), lambda index: "apply it")
    imgui.separator_text("Built in")
    for preset in BUILT_IN:
        if imgui.selectable(preset.name, False)[0]:
            presets.apply(preset.name)
        tooltip(preset.tip)


def preset_commands(ui: Ui) -> list[Command]:
    """Return all presets as they are now, for the menu Edit and the palette."""
    presets = ui.controller.presets
    tips = [preset.tip for preset in BUILT_IN] + ["saved by you"] * len(presets.all)
    return [
        Command(f"preset {name}", "Edit/Presets", partial(presets.apply, name), title=name, kind=Kind.PRESET,
                tip=tip, separated=number in (0, len(BUILT_IN)))
        for number, (name, tip) in enumerate(zip(presets.states, tips, strict=True))
    ]  # fmt: skip


def _new(ui: Ui, states: NamedStates, hint: str, button: str, width: float) -> None:
    """A field for a new name, and a button of this width."""
    fields = ui.state(NameFields)
    imgui.set_next_item_width(-width)
    text = fields.new.get(states.kind, "")
    entered, text = imgui.input_text_with_hint(f"##new {states.kind}", hint, text, _ENTER)
    imgui.same_line()
    if (imgui.button(f"{button}##save", ImVec2(-1.0, 0.0)) or entered) and states.save(text):
        text = ""
    fields.new[states.kind] = text


def _list(ui: Ui, states: NamedStates, apply: Callable[[int], None], tip: Callable[[int], str]) -> None:
    """The user's own, one in a line."""
    height = min(len(states.all), _MOST) * imgui.get_frame_height_with_spacing()
    if states.all and imgui.begin_child(f"own {states.kind}", ImVec2(0.0, height)):
        for index in range(len(states.all)):
            imgui.push_id(str(id(states.all[index])))  # so that a drag holds on to it; names may be alike
            changed = _line(ui, states, index, apply, tip(index))
            imgui.pop_id()
            if changed:
                break
    if height:
        imgui.end_child()


def _line(ui: Ui, states: NamedStates, index: int, apply: Callable[[int], None], tip: str) -> bool:
    """One of them; returns whether the list has changed."""
    fields, name = ui.state(NameFields), states.all[index].name
    room = imgui.get_content_region_avail().x - em(4.4)
    if fields.place == (states.kind, index):
        _rename(fields, states, index, room)
    else:
        imgui.align_text_to_frame_padding()
        clicked = imgui.selectable(f"{fitted(name, room)}###go", False, 0, ImVec2(room, 0.0))[0]
        mouse = imgui.get_mouse_pos().y
        to = index + (mouse > imgui.get_item_rect_max().y) - (mouse < imgui.get_item_rect_min().y)
        if imgui.is_item_active() and to != index and 0 <= to < len(states.all):
            states.move(index, to)
            return True
        tooltip(f"{name}: {tip}; drag it to another place in the list")
        if clicked:
            apply(index)
    imgui.same_line(room + em(0.9))
    if imgui.small_button(icons.ICON_FA_PEN):
        fields.place, fields.text, fields.fresh = (states.kind, index), name, True
    tooltip("rename it")
    imgui.same_line()
    gone = imgui.small_button(icons.ICON_FA_XMARK)
    tooltip("delete it")
    if gone:
        states.delete(index)
    return gone


def _rename(fields: NameFields, states: NamedStates, index: int, width: float) -> None:
    """A field in the name's place: Enter takes what was typed; Escape and a click elsewhere leave it."""
    fresh, fields.fresh = fields.fresh, False
    if fresh:
        imgui.set_keyboard_focus_here()
    imgui.set_next_item_width(width)
    entered, fields.text = imgui.input_text("##name", fields.text, _RENAMING)
    if entered:
        states.rename(index, fields.text)
    left = not fresh and imgui.is_item_deactivated()
    if entered or left or imgui.is_key_pressed(imgui.Key.escape):
        fields.place = None

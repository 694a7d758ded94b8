"""Presets: those of the program, and the user's own, which are saved, renamed and deleted here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.presets import BUILT_IN
from viewer.window.panels.names import NameField, begin_edit, edit_name
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import QUIET, centred, em, fitted, paragraph, tooltip

_ENTER = int(imgui.InputTextFlags_.enter_returns_true)
LIST = "presets"


@dataclass
class PresetsState:
    """The name that is typed for a new one."""

    new: str = ""


def show(ui: Ui) -> None:
    """The dialog, while it is open."""
    if Dialog.PRESETS not in ui.dialogs:
        return
    centred(em(30.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.always_auto_resize
    shown, open_ = imgui.begin("Presets", True, int(flags))
    if not open_:
        ui.close(Dialog.PRESETS)
    if shown:
        _save(ui)
        imgui.separator_text("Saved by you")
        if not ui.controller.presets.own:
            paragraph("None yet. A preset keeps method, quality, lamps, view and looks; not camera, time or scene.",
                      QUIET)  # fmt: skip
        _own(ui)
        imgui.separator_text("Built in")
        for preset in BUILT_IN:
            imgui.push_id(preset.name)
            if imgui.selectable(preset.name, False)[0]:
                ui.controller.presets.apply(preset.name)
            tooltip(preset.tip)
            imgui.pop_id()
    imgui.end()


def _save(ui: Ui) -> None:
    state = ui.state(PresetsState)
    imgui.set_next_item_width(-em(5.0))
    entered, state.new = imgui.input_text_with_hint("##new preset", "name of the settings as they are now",
                                                        state.new, _ENTER)  # fmt: skip
    imgui.same_line()
    if (imgui.button("Save", ImVec2(-1.0, 0.0)) or entered) and ui.controller.presets.save(state.new):
        state.new = ""


def _own(ui: Ui) -> None:
    presets = ui.controller.presets
    for index, preset in enumerate(presets.own):
        name = preset.name
        imgui.push_id(index)
        room = imgui.get_content_region_avail().x - em(4.4)
        if ui.state(NameField).place == (LIST, index):
            imgui.set_next_item_width(room)
            edit_name(ui, partial(presets.rename, index))
        else:
            if imgui.selectable(fitted(name, room), False, 0, ImVec2(room, 0.0))[0]:
                presets.apply(name)
            tooltip(f"{name}: apply it")
        imgui.same_line(room + em(0.9))
        if imgui.small_button(icons.ICON_FA_PEN):
            begin_edit(ui, (LIST, index), name)
        tooltip("rename it")
        imgui.same_line()
        gone = imgui.small_button(icons.ICON_FA_XMARK)
        tooltip("delete it")
        imgui.pop_id()
        if gone:
            presets.delete(index)
            break


def menu(ui: Ui) -> None:
    """Those that can be applied, in the menu Edit."""
    presets = ui.controller.presets
    for number, name in enumerate(presets.names):
        if number in (0, len(BUILT_IN)):
            imgui.separator()
        if imgui.menu_item(f"{name}##preset {number}", "", False, True)[0]:
            ui.guard.step("Applying a preset", partial(presets.apply, name))
        tooltip(presets.tip(name))

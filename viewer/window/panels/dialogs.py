"""What comes up over the window: questions, opening a file, the list of keys, presets."""

from __future__ import annotations

import glob
import os
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from imgui_bundle import ImVec2, imgui
from imgui_bundle import portable_file_dialogs as native

from viewer.services.scene_files import CAPTURE_SUFFIXES, SCENE_SUFFIXES, refusal
from viewer.window.panels import command_palette, keys, named_states, saving
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import ERROR, QUIET, begin_modal, centred, clipped, em, paragraph, seen_rows

OPEN = Dialog.OPEN_FILE.value
_PROGRAMS = ("zenity", "kdialog", "matedialog", "qarma")  # which portable_file_dialogs asks, outside macOS and Windows
_SUFFIXES = (*SCENE_SUFFIXES, *CAPTURE_SUFFIXES)
_FILTERS = ["Scenes and saved pictures", " ".join(f"*{suffix}" for suffix in _SUFFIXES)]
_LINE = int(imgui.InputTextFlags_.enter_returns_true) | int(imgui.InputTextFlags_.callback_completion)
_LIST = 14.0  # ems of height of the list of names


def show(ui: Ui) -> None:
    """Show all that are open."""
    overlay = ui.guard.overlay
    overlay("The question", lambda: _question(ui), ui.controller.questions.drop)
    overlay("The command palette", lambda: command_palette.show(ui), command_palette.close)
    for dialog, content in (
        (Dialog.OPEN_FILE, _open_file),
        (Dialog.SAVE_AS, saving.show_dialog),
        (Dialog.KEYS, partial(_window, Dialog.KEYS, 58.0, 46.0, keys.show)),
        (Dialog.PRESETS, partial(_window, Dialog.PRESETS, 30.0, 0.0, named_states.show_presets)),
    ):
        overlay(f"The dialog {dialog.value}", partial(content, ui), partial(ui.close, dialog))
    if Dialog.KEYS not in ui.dialogs:
        ui.keyboard.wanted_for = ""


def _window(dialog: Dialog, width: float, height: float, content: Callable[[Ui], None], ui: Ui) -> None:
    """Show a dialog beside which the window can be used, so many ems large; one without a height fits its content."""
    if dialog not in ui.dialogs:
        return
    centred(em(width), em(height))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_collapse
    if not height:
        flags |= imgui.WindowFlags_.no_resize | imgui.WindowFlags_.always_auto_resize
    shown, stays = imgui.begin(dialog.value, True, int(flags))
    if not stays:
        ui.close(dialog)
    if shown:
        content(ui)
    imgui.end()


def _question(ui: Ui) -> None:
    """Show a dialog with a button for each answer; Escape chooses the first, which changes nothing."""
    question = ui.controller.questions.question
    if question is None:
        return
    name = f"{question.title}###question"
    shown, closed = begin_modal(name, 30.0)
    if not shown:
        return
    paragraph(question.text)
    imgui.spacing()
    chosen = question.answers[0][0] if closed else ""
    for number, (answer, _) in enumerate(question.answers):
        if number:
            imgui.same_line()
        if imgui.button(answer):
            chosen = answer
    if chosen:
        imgui.close_current_popup()
        ui.guard.step(f"The answer {chosen}", lambda: ui.controller.questions.answer(chosen))
    imgui.end_popup()


# --- opening a file: the desktop's own dialog where it has one, else a line to type a path in ----------


@dataclass
class OpenFileState:
    """`native` is the desktop's dialog while it is open.  Else `typed` is a path, from `folder` on, `found` is what can
    be opened and begins so, and `problem` says what is wrong with it."""

    native: Any = None
    folder: Path = field(default_factory=Path.cwd)
    typed: str = ""
    found: list[str] = field(default_factory=list)
    problem: str = ""

    def type(self, text: str) -> None:
        """Take another path, and look what there is: folders, with a slash, and then files."""
        self.typed, self.problem = text, ""
        found = sorted(glob.glob(glob.escape(os.path.expanduser(text)) + "*", root_dir=self.folder), key=str.lower)
        folders = [f"{path}/" for path in found if (self.folder / path).is_dir()]
        files = [path for path in found if path.lower().endswith(_SUFFIXES) and f"{path}/" not in folders]
        self.found = folders + files


def has_native_dialog() -> bool:
    """Return whether the desktop can ask for a file itself."""
    return sys.platform in ("darwin", "win32") or any(map(shutil.which, _PROGRAMS))


def _open_file(ui: Ui) -> None:
    """Ask for a file where that is wanted, and open it."""
    state = ui.state(OpenFileState)
    if state.native is not None:
        if state.native.ready(0):
            chosen, state.native = state.native.result(), None
            if chosen:
                _open(ui, Path(chosen[0]))
    elif Dialog.OPEN_FILE in ui.dialogs and has_native_dialog():
        ui.close(Dialog.OPEN_FILE)
        state.native = native.open_file(OPEN, f"{state.folder}/", _FILTERS)
    elif Dialog.OPEN_FILE in ui.dialogs:
        _ask(ui, state)


def _open(ui: Ui, path: Path) -> None:
    ui.state(OpenFileState).folder = path.absolute().parent
    ui.controller.loader.open(path)


def _ask(ui: Ui, state: OpenFileState) -> None:
    """Show a dialog of our own, which needs nothing from the desktop."""
    if not imgui.is_popup_open(OPEN):
        state.type("")
    shown, cancelled = begin_modal(OPEN, 38.0)
    if not shown:
        return
    clipped(str(state.folder), QUIET)
    entered = _line(state)
    if state.problem:
        paragraph(state.problem, ERROR)
    entered = _names(state) or entered
    entered = imgui.button("Open", ImVec2(em(6.0), 0.0)) or entered
    imgui.same_line()
    cancelled = imgui.button("Cancel", ImVec2(em(6.0), 0.0)) or cancelled
    saved = ui.controller.preferences.picture_folder.absolute()
    imgui.same_line()
    imgui.begin_disabled(state.folder == saved or not saved.is_dir())
    if imgui.button("Saved pictures"):
        state.folder = saved
        state.type("")
    imgui.end_disabled()
    path = state.folder / os.path.expanduser(state.typed.strip())
    opened = False
    if entered and state.typed.strip() and path.is_dir():
        state.folder = Path(os.path.abspath(path))
        state.type("")
    elif entered and state.typed.strip():
        state.problem = refusal(path) or ""
        opened = not state.problem
    if cancelled or opened:
        ui.close(Dialog.OPEN_FILE)
        imgui.close_current_popup()
    imgui.end_popup()
    if opened:
        _open(ui, path)


def _names(state: OpenFileState) -> bool:
    """List what can be opened; returns whether one was clicked, which is the path then."""
    clicked = ""
    if imgui.begin_child("names", ImVec2(0.0, em(_LIST))):
        for number in seen_rows(len(state.found)):
            if imgui.selectable(state.found[number], False, int(imgui.SelectableFlags_.no_auto_close_popups))[0]:
                clicked = state.found[number]
    imgui.end_child()
    state.typed = clicked or state.typed
    return bool(clicked)


def _line(state: OpenFileState) -> bool:
    """Show the line to type in, which has the keyboard whenever nothing else wants it; returns whether Enter was
    pressed."""

    def complete(data: imgui.InputTextCallbackData) -> int:
        if state.found:
            data.delete_chars(0, data.buf_text_len)
            data.insert_chars(0, os.path.commonprefix(state.found))  # noqa: RUF071 - character by character
        return 0

    imgui.set_next_item_width(-1.0)
    if not imgui.is_any_item_active():
        imgui.set_keyboard_focus_here()
    entered, text = imgui.input_text_with_hint("##path", "a path; Tab completes it", state.typed, _LINE, complete)
    if text != state.typed:
        state.type(text)
    return bool(entered)

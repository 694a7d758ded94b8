"""Opening a file: the desktop's own dialog where it has one, else a line to type a path in, with what can be opened
there."""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from imgui_bundle import ImVec2, imgui
from imgui_bundle import portable_file_dialogs as native

from viewer.services.scene_files import CAPTURE_SUFFIXES, SCENE_SUFFIXES, is_capture, is_scene, refusal
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import ERROR, QUIET, centred, clipped, em, fitted, paragraph

TITLE = Dialog.OPEN_FILE.value
_PROGRAMS = ("zenity", "kdialog", "matedialog", "qarma")  # which portable_file_dialogs asks, outside macOS and Windows
_FILTERS = ["Scenes and saved pictures", " ".join(f"*{suffix}" for suffix in (*SCENE_SUFFIXES, *CAPTURE_SUFFIXES))]
_LINE = int(imgui.InputTextFlags_.enter_returns_true) | int(imgui.InputTextFlags_.callback_completion)


@dataclass
class OpenFileState:
    """`native` is the desktop's dialog while it is open.  Else `typed` is a path, from `folder` on, `problem` says what
    is wrong with it, and `listed` has the names that were found in which folder."""

    native: Any = None
    folder: Path = field(default_factory=Path.cwd)
    typed: str = ""
    problem: str = ""
    listed: tuple[Path, list[str]] | None = None

    def names(self) -> list[str]:
        """What can be opened in the folder of what is typed, and begins with its last part."""
        folder, part = _split(self.folder, self.typed)
        if self.listed is None or self.listed[0] != folder:  # read once, as a folder may be slow
            self.listed = folder, names_in(folder)
        return [name for name in self.listed[1] if _begins(name, part)]

    def completed(self) -> str:
        """What is typed, as far as the names agree on how it goes on."""
        part = _split(self.folder, self.typed)[1]
        common = os.path.commonprefix(self.names())  # noqa: RUF071 - character by character is what is meant
        return self.typed.removesuffix(part) + (common if len(common) >= len(part) else part)


def names_in(folder: Path) -> list[str]:
    """Folders, with a slash, and then files that may be opened; none where the folder cannot be read."""
    try:
        with os.scandir(folder) as found:
            items = [(not item.is_dir(), item.name) for item in found]
    except OSError:
        return []
    items.sort(key=lambda item: (item[0], item[1].lower()))
    return [name if is_file else f"{name}/" for is_file, name in items if not is_file or is_openable(Path(name))]


def is_openable(path: Path) -> bool:
    return is_scene(path) or is_capture(path)


def has_native_dialog() -> bool:
    """Whether the desktop can ask for a file itself."""
    return sys.platform in ("darwin", "win32") or any(map(shutil.which, _PROGRAMS))


def show(ui: Ui) -> None:
    """Ask for a file where that is wanted, and open it."""
    state = ui.state(OpenFileState)
    if state.native is not None:
        if state.native.ready(0):
            chosen, state.native = state.native.result(), None
            _open(ui, *map(Path, chosen[:1]))
    elif Dialog.OPEN_FILE in ui.dialogs and has_native_dialog():
        ui.close(Dialog.OPEN_FILE)
        state.native = native.open_file(TITLE, f"{state.folder}/", _FILTERS)
    elif Dialog.OPEN_FILE in ui.dialogs:
        _ask(ui, state)


def _open(ui: Ui, *paths: Path) -> None:
    for path in paths:
        ui.state(OpenFileState).folder = path.absolute().parent
        ui.controller.loader.open(path)


def _ask(ui: Ui, state: OpenFileState) -> None:
    """A dialog of our own, which needs nothing from the desktop."""
    if not imgui.is_popup_open(TITLE):
        imgui.open_popup(TITLE)
        state.typed = state.problem = ""
        state.listed = None
    centred(em(38.0))
    shown, stays = imgui.begin_popup_modal(TITLE, True, int(imgui.WindowFlags_.no_resize))
    if not shown:
        return
    clipped(str(state.folder), QUIET)
    entered = _line(state)
    clicked = _names(state)
    if state.problem:
        paragraph(state.problem, ERROR)
    entered = imgui.button("Open", ImVec2(em(6.0), 0.0)) or entered or clicked
    imgui.same_line()
    cancelled = imgui.button("Cancel", ImVec2(em(6.0), 0.0)) or imgui.is_key_pressed(imgui.Key.escape) or not stays
    path = _taken(state) if entered and state.typed.strip() else None
    if cancelled or path is not None:
        ui.close(Dialog.OPEN_FILE)
        imgui.close_current_popup()
    imgui.end_popup()
    if path is not None:
        _open(ui, path)


def _line(state: OpenFileState) -> bool:
    """The line to type in, which has the keyboard whenever nothing else wants it; returns whether Enter was pressed."""

    def complete(data: imgui.InputTextCallbackData) -> int:
        text = state.completed()
        data.delete_chars(0, data.buf_text_len)
        data.insert_chars(0, text)
        return 0

    imgui.set_next_item_width(-1.0)
    if not imgui.is_any_item_active():
        imgui.set_keyboard_focus_here()
    entered, text = imgui.input_text_with_hint("##path", "a path; Tab completes it", state.typed, _LINE, complete)
    if text != state.typed:
        state.typed, state.problem = text, ""
    return bool(entered)


def _names(state: OpenFileState) -> bool:
    """What may come next; a click puts it into the line, and returns whether it was that of a file."""
    clicked = ""
    if imgui.begin_child("names", ImVec2(0.0, em(12.0)), int(imgui.ChildFlags_.borders)):
        names = state.names()
        clipper = imgui.ListClipper()
        clipper.begin(len(names))
        while clipper.step():
            for name in names[clipper.display_start : clipper.display_end]:
                shown = fitted(name, imgui.get_content_region_avail().x)
                if imgui.selectable(f"{shown}##{name}", False, int(imgui.SelectableFlags_.no_auto_close_popups))[0]:
                    clicked = name
        clipper.end()
        if not names:
            imgui.text_colored(QUIET, "nothing to open here")
    imgui.end_child()
    if clicked:
        state.typed, state.problem = state.typed.removesuffix(_split(state.folder, state.typed)[1]) + clicked, ""
    return bool(clicked) and not clicked.endswith("/")


def _taken(state: OpenFileState) -> Path | None:
    """The file that is typed; of a folder what is in it is listed, and of anything else it is said why not."""
    folder, part = _split(state.folder, state.typed.strip())
    path = folder / part
    if path.is_dir():
        state.folder, state.typed, state.listed = Path(os.path.abspath(path)), "", None
        return None
    state.problem = refusal(path) or ""
    return None if state.problem else path


def _split(folder: Path, typed: str) -> tuple[Path, str]:
    """The folder that a typed path means, and its last part."""
    start = typed.rfind("/") + 1
    return folder / os.path.expanduser(typed[:start]), typed[start:]


def _begins(name: str, part: str) -> bool:
    return name.lower().startswith(part.lower()) and (part.startswith(".") or not name.startswith("."))

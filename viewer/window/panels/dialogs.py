"""What comes up over the window: opening a file, questions, the list of keys, about."""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from imgui_bundle import ImVec2, imgui
from imgui_bundle import portable_file_dialogs as native

from viewer.services.scene_files import CAPTURE_SUFFIXES, SCENE_SUFFIXES, refusal
from viewer.window.panels import command_palette, keys, named_states, saving
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import ERROR, QUIET, begin_modal, centred, clipped, em, paragraph

OPEN = Dialog.OPEN_FILE.value
_PROGRAMS = ("zenity", "kdialog", "matedialog", "qarma")  # which portable_file_dialogs asks, outside macOS and Windows
_FILTERS = ["Scenes and saved pictures", " ".join(f"*{suffix}" for suffix in (*SCENE_SUFFIXES, *CAPTURE_SUFFIXES))]
_LINE = int(imgui.InputTextFlags_.enter_returns_true) | int(imgui.InputTextFlags_.callback_completion)
_MOST = 100  # names that are listed


def show(ui: Ui) -> None:
    """Show all of them; each shows itself only when it is wanted."""
    overlay = ui.guard.overlay
    overlay(OPEN, lambda: _open_file(ui), lambda: ui.close(Dialog.OPEN_FILE))
    overlay(saving.NAME, lambda: saving.show_dialog(ui), lambda: ui.close(Dialog.SAVE_AS))
    overlay("The question", lambda: _question(ui), ui.controller.questions.drop)
    overlay("The command palette", lambda: command_palette.show(ui), command_palette.close)
    overlay("The list of keys", lambda: keys.show(ui), lambda: ui.close(Dialog.KEYS))
    overlay("The presets", lambda: named_states.show_presets(ui), lambda: ui.close(Dialog.PRESETS))
    overlay("The dialog about the program", lambda: _about(ui), lambda: ui.close(Dialog.ABOUT))


def _about(ui: Ui) -> None:
    if Dialog.ABOUT not in ui.dialogs:
        return
    centred(em(30.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    shown, open_ = imgui.begin(Dialog.ABOUT.value, True, int(flags))
    if not open_:
        ui.close(Dialog.ABOUT)
    if shown:
        paragraph("A ray tracer that remembers its shadows.\n\n")
        paragraph(
            "Shadow results are kept on each primitive and reused in later frames, so that most shadow rays need not "
            "be traced: Nah, Lee, Park and Han, A Shadow Culling Algorithm for Interactive Ray Tracing."
            f"\n\nDrawn by {ui.graphics.renderer_name}",
            QUIET,
        )
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
    """`native` is the desktop's dialog while it is open.  Else `typed` is a path, from `folder` on, `problem` says what
    is wrong with it, and `listed` has the names that were found in which folder."""

    native: Any = None
    folder: Path = field(default_factory=Path.cwd)
    typed: str = ""
    problem: str = ""
    listed: tuple[Path, list[str]] | None = None

    def names(self) -> list[str]:
        """Return what can be opened in the folder of what is typed, and begins with its last part."""
        folder, part = self.inside, self.part
        if self.listed is None or self.listed[0] != folder:  # read once, as a folder may be slow
            self.listed = folder, names_in(folder)
        hidden = part.startswith(".")
        return [n for n in self.listed[1] if n.lower().startswith(part.lower()) and (hidden or n[0] != ".")]

    def completed(self) -> str:
        """Return what is typed, as far as the names agree on how it goes on."""
        common = os.path.commonprefix(self.names())  # noqa: RUF071 - character by character is what is meant
        return self.typed.removesuffix(self.part) + (common if len(common) >= len(self.part) else self.part)

    @property
    def inside(self) -> Path:
        """The folder that the typed path is in."""
        return self.folder / os.path.expanduser(self.typed.removesuffix(self.part))

    @property
    def part(self) -> str:
        """The last part of the typed path."""
        return self.typed[self.typed.rfind("/") + 1 :]


def names_in(folder: Path) -> list[str]:
    """Return folders, with a slash, and then files that may be opened; none where the folder cannot be read."""
    try:
        with os.scandir(folder) as found:
            items = sorted((not item.is_dir(), item.name.lower(), item.name) for item in found)
    except OSError:
        return []
    openable = [(is_file, name) for is_file, _, name in items if not is_file or is_openable(Path(name))]
    return [name if is_file else f"{name}/" for is_file, name in openable]


def is_openable(path: Path) -> bool:
    """Return whether it is called like something that can be opened."""
    return path.suffix.lower() in SCENE_SUFFIXES + CAPTURE_SUFFIXES


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
        state.typed, state.problem, state.listed = "", "", None
    shown, cancelled = begin_modal(OPEN, 38.0)
    if not shown:
        return
    clipped(str(state.folder), QUIET)
    entered = _line(state)
    names = state.names()
    more = f"  and {len(names) - _MOST} more" if len(names) > _MOST else ""
    paragraph(state.problem or "  ".join(names[:_MOST]) + more, ERROR if state.problem else QUIET)
    entered = imgui.button("Open", ImVec2(em(6.0), 0.0)) or entered
    imgui.same_line()
    cancelled = imgui.button("Cancel", ImVec2(em(6.0), 0.0)) or cancelled
    path = state.inside / state.part.strip()
    opened = False
    if entered and state.typed.strip() and path.is_dir():
        state.folder, state.typed = Path(os.path.abspath(path)), ""
    elif entered and state.typed.strip():
        state.problem = refusal(path) or ""
        opened = not state.problem
    if cancelled or opened:
        ui.close(Dialog.OPEN_FILE)
        imgui.close_current_popup()
    imgui.end_popup()
    if opened:
        _open(ui, path)


def _line(state: OpenFileState) -> bool:
    """Show the line to type in, which has the keyboard whenever nothing else wants it; returns whether Enter was
    pressed."""

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

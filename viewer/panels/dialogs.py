"""What comes up over the window: opening a file, shortcuts, about."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer import opening
from viewer.commands import HELD_KEYS, MENUS, key_label
from viewer.panels import questions
from viewer.panels.widgets import ERROR, QUIET, centred, clipped, em, paragraph, tooltip
from viewer.ui import Ui

_OPEN = "Open a scene or a captured picture"


def show(ui: Ui) -> None:
    """All of them; each shows itself only when it is wanted."""
    ui.guard.overlay("The dialog that opens a file", lambda: _browser(ui), lambda: setattr(ui.browser, "open", False))
    ui.guard.overlay("The question", lambda: questions.show(ui), ui.controller.asking.drop)
    ui.guard.overlay("The list of keys", lambda: _shortcuts(ui), lambda: setattr(ui, "shortcuts_open", False))
    ui.guard.overlay("The words about the program", lambda: _about(ui), lambda: setattr(ui, "about_open", False))


def _browser(ui: Ui) -> None:
    """A file dialog of our own: it needs nothing from the desktop, and shows only what can be opened."""
    b = ui.browser
    if b.open and not imgui.is_popup_open(_OPEN):
        imgui.open_popup(_OPEN)
        b.typed = b.problem = ""
    centred(em(38.0))
    shown, stays = imgui.begin_popup_modal(_OPEN, b.open, int(imgui.WindowFlags_.no_resize))
    b.open = bool(stays)
    if not shown:
        return
    chosen = _path_line(ui)
    listed = _listing(ui)
    chosen = chosen or listed
    if b.problem:
        paragraph(b.problem, ERROR)
    if imgui.button("Open", ImVec2(em(6.0), 0.0)):
        chosen = chosen or _typed(ui)
    imgui.same_line()
    if imgui.button("Cancel", ImVec2(em(6.0), 0.0)) or imgui.is_key_pressed(imgui.Key.escape):
        b.open = False
    if chosen is not None:
        _choose(ui, chosen)
    if not b.open:
        imgui.close_current_popup()
    imgui.end_popup()


def _path_line(ui: Ui) -> Path | None:
    b = ui.browser
    if imgui.button(icons.ICON_FA_ARROW_UP):
        b.folder = b.folder.parent
    tooltip("the folder above")
    imgui.same_line()
    if imgui.button(icons.ICON_FA_HOUSE):
        b.folder = Path.home()
    tooltip("home")
    imgui.same_line()
    clipped(str(b.folder))
    imgui.set_next_item_width(-1.0)
    if imgui.is_window_appearing():
        imgui.set_keyboard_focus_here()
    flags = int(imgui.InputTextFlags_.enter_returns_true)
    entered, b.typed = imgui.input_text_with_hint("##path", "a path, or choose below", b.typed, flags)
    return _typed(ui) if entered else None


def _typed(ui: Ui) -> Path | None:
    text = ui.browser.typed.strip()
    return ui.browser.folder / Path(text).expanduser() if text else None


def _listing(ui: Ui) -> Path | None:
    """The folders and files of the folder; returns one that was chosen by a double click."""
    b = ui.browser
    chosen = None
    if imgui.begin_child("files", ImVec2(0.0, em(18.0)), int(imgui.ChildFlags_.borders)):
        folders, files = _entries(b.folder)
        if isinstance(files, str):
            paragraph(files, ERROR)
            files = []
        for folder in folders:
            if imgui.selectable(f"{icons.ICON_FA_FOLDER}  {folder.name}", False, _NO_CLOSE)[0]:
                chosen = folder
        for file in files:
            icon = icons.ICON_FA_CUBES if opening.is_scene(file) else icons.ICON_FA_IMAGE
            if imgui.selectable(f"{icon}  {file.name}", b.typed == file.name, _NO_CLOSE)[0]:
                b.typed = file.name
                if imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
                    chosen = file
        if not folders and not files:
            imgui.text_colored(QUIET, "nothing to open here")
    imgui.end_child()
    return chosen


def _entries(folder: Path) -> tuple[list[Path], list[Path] | str]:
    """Sub-folders and openable files, by name; or why there are none."""
    try:
        entries = sorted(folder.iterdir(), key=lambda p: p.name.lower())
        visible = [p for p in entries if not p.name.startswith(".")]
        folders = [p for p in visible if p.is_dir()]
        return folders, [p for p in visible if (opening.is_scene(p) or opening.is_capture(p)) and p.is_file()]
    except OSError as error:
        return [], f"{folder}: {error.strerror or error}"


def _choose(ui: Ui, path: Path) -> None:
    b = ui.browser
    if path.is_dir():
        b.folder, b.typed, b.problem = path, "", ""
        return
    problem = opening.refusal(path)
    b.problem = problem or ""
    if problem is None:
        b.folder, b.typed, b.open = path.parent, "", False
        ui.controller.opener.open(path)


def _shortcuts(ui: Ui) -> None:
    if not ui.shortcuts_open:
        return
    centred(em(46.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    shown, open_ = imgui.begin("Keyboard and mouse", True, int(flags))
    ui.shortcuts_open = bool(open_)
    if shown:
        if imgui.begin_table("keys", 2, int(imgui.TableFlags_.sizing_stretch_same)):
            imgui.table_next_column()
            for menu in MENUS[:2]:
                _keys(menu, [(key_label(c.key), c.name) for c in ui.commands if c.menu == menu and c.key])
            imgui.table_next_column()
            for menu in MENUS[2:]:
                _keys(menu, [(key_label(c.key), c.name) for c in ui.commands if c.menu == menu and c.key])
            imgui.end_table()
        _keys("On the picture", list(HELD_KEYS), wide=True)
    imgui.end()


def _keys(title: str, lines: list[tuple[str, str]], wide: bool = False) -> None:
    imgui.separator_text(title)
    if not imgui.begin_table(f"keys of {title}", 2):
        return
    imgui.table_setup_column("key", int(imgui.TableColumnFlags_.width_fixed), em(8.5 if wide else 5.5))
    imgui.table_setup_column("meaning", int(imgui.TableColumnFlags_.width_stretch))
    for key, meaning in lines:
        imgui.table_next_column()
        imgui.text_unformatted(key)
        imgui.table_next_column()
        paragraph(meaning, QUIET)
    imgui.end_table()


def _about(ui: Ui) -> None:
    if not ui.about_open:
        return
    centred(em(30.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    shown, open_ = imgui.begin("About Shadowcull", True, int(flags))
    ui.about_open = bool(open_)
    if shown:
        paragraph("A ray tracer that remembers its shadows.")
        imgui.spacing()
        paragraph(
            "Shadow results are kept on each primitive and reused in later frames, so that most shadow rays need not "
            "be traced: Nah, Lee, Park and Han, A Shadow Culling Algorithm for Interactive Ray Tracing.",
            QUIET,
        )
        imgui.spacing()
        paragraph(f"Drawn by {ui.renderer_name}" if ui.renderer_name else "", QUIET)
    imgui.end()


_NO_CLOSE = int(imgui.SelectableFlags_.no_auto_close_popups)

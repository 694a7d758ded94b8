"""Panels and menus: opened, closed, hidden; themes and sizes."""

from __future__ import annotations

from unittest import mock

import glfw
import numpy as np
from imgui_bundle import glfw_utils, hello_imgui, imgui

from tests.sweeps import cases
from tests.viewer.driver import Driver
from viewer.state.views import View
from viewer.window import style as window_style
from viewer.window.layout import PANELS, PICTURE
from viewer.window.ui import Dialog


def panels(d: Driver) -> None:
    """The cross closes one panel of several behind each other's tabs, and the default layout brings all back.  Every
    panel, dialog and menu is shown once, as a new user would open them."""
    docking = d.app.params.docking_params
    is_open = lambda: {w.label for w in docking.dockable_windows if w.is_visible}  # noqa: E731
    first = is_open()
    d.show_panel("Culling")
    d.context.window_close("//Culling")
    d.frames(3)
    assert is_open() == first - {"Culling"}
    d.show_panel("Log")
    docking.dockable_window_of_name("Figure 1").is_visible = False
    d.choose("View/Default layout")
    assert is_open() == first
    docked = d.panel("View").dock_node
    assert docked is not None and d.panel("Culling").dock_id == docked.id_

    left, top, right, bottom = d.picture_edges()
    assert (right - left) * (bottom - top) > 0.5 * d.app.ui.picture.area[0] * d.app.ui.picture.area[1]
    for key, workspace, there in (("F3", "Measure", "Hunt"), ("F4", "Debug", "Find"), ("F2", "Explore", "Figure 1")):
        d.press(key).frames(5)
        assert hello_imgui.current_layout_name() == workspace and docking.layout_name == workspace
        assert there in is_open() and ("Log" in is_open()) == (workspace == "Debug")
    # The picture has its share of the window in each, also in one that was resized while another was shown.
    for size, least in (((900, 600), (0.25, 0.25, 0.50)), ((1280, 800), (0.33, 0.33, 0.60))):
        d.resize(*size)
        for key, part in zip(("F3", "F4", "F2"), least):
            width, height = d.press(key).frames(8).ui.picture.area
            assert width * height >= part * size[0] * size[1], f"{d.ui.workspace} at {size}: {width} x {height}"
    d.show_panel("Plots").press("F3", "F2").frames(5)
    assert "Plots" in is_open(), "a workspace stays as it was left"
    d.press("B")
    for label in ("Camera", "Rendering", "Saving", "Scene", "View", "Experiment", "Zoom test", "Plots"):
        docking.focus_dockable_window(label)
        d.frames(3)
    d.press("F1")
    assert Dialog.KEYS in d.ui.dialogs
    d.press("F1")
    d.choose("Help/About Shadowcull")
    d.expect("A Shadow Culling Algorithm for Interactive Ray Tracing")
    d.click("//About Shadowcull###question/Close")
    d.press("Ctrl+O")
    assert d.ui.dialogs == [Dialog.OPEN_FILE]
    before = d.c.session.draw.view
    d.press("5")
    assert d.c.session.draw.view is before, "a key reached the window behind a dialog"
    d.press("Escape")
    assert not d.ui.dialogs
    d.choose("View/Depth")
    assert d.c.session.draw.view is View.DEPTH
    traced = d.c.history.frames
    d.press("K")
    d.wait(lambda: d.c.history.frames >= traced + 3, "frames at idle")
    d.press("K")


def looks(d: Driver) -> None:
    """Theme and size of the interface change at once and are kept; settings are reset when the user agrees."""
    p, small = d.c.preferences, imgui.get_font_size()
    d.c.bookmarks.save("here")
    d.c.presets.save("mine")

    def brightness() -> float:
        """Of the window where nothing is drawn: the menu bar's right end."""
        return float(d.window()[6, -40:].mean())

    assert brightness() < 60.0
    d.choose("View/Light theme")
    assert p.theme == "light" and brightness() > 200.0
    d.press("Ctrl+Equal", "Ctrl+Equal", "Ctrl+Equal").frames(2)
    assert p.ui_scale == 1.5 and abs(imgui.get_font_size() - 1.5 * small) <= 1.0
    d.press("Ctrl+0").frames(2)
    assert p.ui_scale == 1.0 and imgui.get_font_size() == small and d.c.session.draw.view is View.COLOR
    d.press("Ctrl+Minus", "4")
    for answer, after in (("Keep them", "light"), ("Reset", "dark")):
        d.choose("File/Reset settings...").click(f"//Reset all settings?###question/{answer}")
        assert p.theme == after
    assert p.ui_scale == 1.0 and d.c.session.draw.view is View.COLOR and brightness() < 60.0
    assert p.recent and d.c.bookmarks.all[0].name == "here" and d.c.presets.all


def hiding(d: Driver) -> None:
    """Tab leaves the picture alone, and brings back what was there, where it was; F11 fills the screen, and back."""
    d.resize(1280, 800).settle()
    for label in ("Camera", "Log"):
        d.show_panel(label)
    docking = d.app.params.docking_params
    docking.dockable_window_of_name("Saving").is_visible = False
    d.frames(4)
    before = _places_of_panels()
    assert {"Camera", "Log", "Inspector"} < set(before)
    d.press("Tab")
    there = _places_of_panels()
    assert set(there) == {PICTURE} and there[PICTURE][2] * there[PICTURE][3] > 0.9 * 1280 * 800
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size and d.c.scheduler.inputs.size[0] > 1200
    d.hold("D", 0.1)
    assert not d.c.session.on_path, "keys fly while the panels are hidden"
    d.press("Tab").frames(3)
    _came_back(before)
    assert not docking.dockable_window_of_name("Saving").is_visible

    d.press("Tab").resize(1000, 700).resize(1280, 800).press("Tab").frames(3)
    _came_back(before)
    _shares(d)
    _denser_screen(d)

    window = glfw_utils.glfw_window_hello_imgui()
    place = (*glfw.get_window_pos(window), *glfw.get_window_size(window))
    mode = glfw.get_video_mode(glfw.get_primary_monitor()).size
    for full in (True, False):
        d.press("F11").frames(3)
        size = (mode.width, mode.height) if full else place[2:]
        assert bool(glfw.get_window_monitor(window)) == full and tuple(glfw.get_window_size(window)) == size
        d.settle()
    assert tuple(glfw.get_window_pos(window)) == place[:2]
    _came_back(before)
    d.press("F11")  # so it is closed


def _shares(d: Driver) -> None:
    """Panels keep their shares of the window, whatever sizes it has meanwhile, and however often."""
    before = _places_of_panels()
    for size in ((1024, 700), (900, 600), (1600, 1000), *((width, 800) for width in range(1280, 1000, cases(-56, -7)))):
        d.resize(*size)
        there = _places_of_panels()
        assert set(there) == set(before) and 0.7 < there[PICTURE][2] / size[0] < 0.8
    d.resize(1280, 800)
    _came_back(before)


def _denser_screen(d: Driver) -> None:
    """Letters and lengths follow the screen, and go back with it."""
    style = imgui.get_style()

    def lengths() -> tuple[float, ...]:
        return style.frame_padding.x, style.item_spacing.x, style.scrollbar_size, style.indent_spacing

    before = lengths()
    for scale in (2.0, 1.5, 1.0):
        with mock.patch.object(window_style, "content_scale", lambda scale=scale: scale):
            d.frames(3)
            assert style.font_scale_dpi == scale and np.allclose(lengths(), np.multiply(before, scale), atol=1.0)
    assert lengths() == before
    d.frames(3)


def _came_back(before: dict[str, tuple[float, ...]]) -> None:
    there = _places_of_panels()
    assert set(there) == set(before)
    for label, place in there.items():
        assert np.allclose(place, before[label], atol=2.0), f"{label} is at {place}, and was at {before[label]}"


def _places_of_panels() -> dict[str, tuple[float, ...]]:
    """Where each panel is that is drawn."""
    found = {}
    for label in PANELS:
        window = imgui.internal.find_window_by_name(label)
        if window is not None and window.was_active and not window.hidden:
            found[label] = (window.pos.x, window.pos.y, window.size.x, window.size.y)
    return found

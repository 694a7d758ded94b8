"""Panels and menus: opened, closed, hidden, folded; themes and sizes."""

from __future__ import annotations

import glfw
from imgui_bundle import glfw_utils, imgui

from tests.sweeps import cases
from tests.viewer.driver import Driver
from viewer.state import codec
from viewer.state.views import View
from viewer.window.layout import PANELS, PICTURE
from viewer.window.ui import Dialog

KEY = imgui.Key
SIDES = [label for label in PANELS if label != PICTURE]


def panels(d: Driver) -> None:
    """Every panel, dialog and menu is shown once, as a new user would open them."""
    d.settle()
    d.press(KEY.b)
    for label in ("Camera", "Rendering", "Saving", "Scene", "View", "Experiment", "Zoom test", "Plots"):
        d.app.params.docking_params.focus_dockable_window(label)
        d.frames(3)
    d.press(KEY.f1)
    assert Dialog.KEYS in d.ui.dialogs
    d.frames(3)
    d.press(KEY.f1)
    d.context.menu_click("//##MainMenuBar/Help/About Shadowcull")
    d.frames(3)
    assert Dialog.ABOUT in d.ui.dialogs
    d.ui.close(Dialog.ABOUT)
    d.press(int(KEY.o) | int(KEY.mod_ctrl))
    d.frames(4)
    assert d.ui.dialogs == [Dialog.OPEN_FILE]
    d.frames(2)
    before = d.c.session.draw.view
    d.context.key_press(KEY._5)
    d.frames(2)
    assert d.c.session.draw.view is before, "a key reached the window behind a dialog"
    d.press(KEY.escape)
    assert not d.ui.dialogs
    d.context.menu_click("//##MainMenuBar/View/Depth")
    d.frames(2)
    assert d.c.session.draw.view is View.DEPTH
    d.c.session.set_pace(keep_tracing=True)
    traced = d.c.history.frames
    d.c.scheduler.trace_again()
    d.wait(lambda: d.c.history.frames >= traced + 3, "frames at idle")
    d.c.session.set_pace(keep_tracing=False)


def closing_panels(d: Driver) -> None:
    """The cross closes one panel of several behind each other's tabs, and the default layout brings all back."""
    d.settle()
    docking = d.app.params.docking_params
    closed = lambda: [w.label for w in docking.dockable_windows if not w.is_visible]  # noqa: E731
    d.ui.show_panel("Camera")
    d.frames(3)
    d.context.window_close("//Camera")
    d.frames(3)
    assert closed() == ["Camera"]
    for label in ("Scene", "View", "Plots", "Log"):
        docking.dockable_window_of_name(label).is_visible = False
    d.frames(3)
    d.context.menu_click("//##MainMenuBar/View/Default layout")
    d.frames(6)
    assert not closed()
    docked = imgui.internal.find_window_by_name("Scene").dock_node
    assert docked is not None and imgui.internal.find_window_by_name("Camera").dock_id == docked.id_


def looks(d: Driver) -> None:
    """Theme and size of the interface change at once and are kept; settings are reset when the user agrees."""
    d.settle()
    p, small = d.c.preferences, imgui.get_font_size()
    d.c.bookmarks.save("here")
    d.c.presets.save("mine")

    def brightness() -> float:
        """Of the window where nothing is drawn: the menu bar's right end."""
        return float(d.window()[6, -40:].mean())

    assert brightness() < 60.0
    d.context.menu_click("//##MainMenuBar/View/Light theme")
    d.frames(4)
    assert p.theme == "light" and brightness() > 200.0
    for _ in range(3):
        d.press(int(KEY.equal) | int(KEY.mod_ctrl))
    d.frames(4)
    assert p.ui_scale == 1.5 and abs(imgui.get_font_size() - 1.5 * small) <= 1.0
    d.press(int(KEY._0) | int(KEY.mod_ctrl))
    d.frames(4)
    assert p.ui_scale == 1.0 and imgui.get_font_size() == small and d.c.session.draw.view is View.COLOR
    d.press(int(KEY.minus) | int(KEY.mod_ctrl))
    d.press(KEY._4)
    for answer, after in (("Keep them", "light"), ("Reset", "dark")):
        d.context.menu_click("//##MainMenuBar/File/Reset settings...")
        d.frames(3)
        d.context.item_click(f"//Reset all settings?###question/{answer}")
        d.frames(4)
        assert p.theme == after
    assert p.ui_scale == 1.0 and d.c.session.draw.view is View.COLOR and brightness() < 60.0
    assert p.recent and d.c.bookmarks.all[0].name == "here" and d.c.presets.all

    # What is open now is where the next start may begin; a scene that has gone since is told of.
    d.context.menu_click("//##MainMenuBar/File/Start where I left off")
    d.hold(KEY.d, 0.2)
    d.settle()
    camera, path = d.c.session.camera, d.c.session.scene.path
    place = codec.state_to_json(d.c.session.state)
    d.press(KEY.r)
    d.settle()
    assert p.start_where_left and d.c.session.camera != camera
    p.last = place  # it follows the camera, so that it is there whenever the program ends
    assert d.c.loader.go_on()
    d.wait(lambda: d.c.session.camera == camera, "the place that was left")
    assert d.c.session.scene.path == path
    d.settle()
    p.last = place | {"scene": str(d.folder / "gone.aff")}
    assert not d.c.loader.go_on() and "the scene is gone" in d.c.notices.message.text
    d.settle()


def hiding(d: Driver) -> None:
    """Tab leaves the picture alone, and brings back what was there, where it was; F11 fills the screen, and back."""
    d.resize(1280, 800)
    d.settle()
    for label in ("Camera", "Experiment"):
        d.ui.show_panel(label)
        d.frames(4)
    docking = d.app.params.docking_params
    docking.dockable_window_of_name("Saving").is_visible = False
    d.frames(4)
    before = _places_of_panels()
    assert {"Camera", "Experiment", "Statistics", "Inspector"} < set(before)
    d.press(KEY.tab)
    d.frames(3)
    assert set(_places_of_panels()) == {PICTURE} and _picture_share() > 0.9
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size and d.c.scheduler.inputs.size[0] > 1200
    d.hold(KEY.d, 0.1)
    assert not d.c.session.on_path, "keys fly while the panels are hidden"
    d.press(KEY.tab)
    d.frames(5)
    assert _places_of_panels() == before, (
        f"the panels did not come back as they were: {_places_of_panels()} for {before}"
    )
    assert not docking.dockable_window_of_name("Saving").is_visible

    d.press(KEY.tab)
    d.resize(1000, 700)
    d.resize(1280, 800)
    d.press(KEY.tab)
    d.frames(5)
    assert _places_of_panels() == before, "a hidden panel lost its share of the window"

    window = glfw_utils.glfw_window_hello_imgui()
    place = (*glfw.get_window_pos(window), *glfw.get_window_size(window))
    mode = glfw.get_video_mode(glfw.get_primary_monitor()).size
    d.press(KEY.f11)
    d.frames(5)
    assert glfw.get_window_monitor(window) and tuple(glfw.get_window_size(window)) == (mode.width, mode.height)
    d.settle()
    d.press(KEY.f11)
    d.frames(5)
    assert not glfw.get_window_monitor(window)
    assert (*glfw.get_window_pos(window), *glfw.get_window_size(window)) == place
    d.settle()
    assert _places_of_panels() == before
    d.press(KEY.f11)  # the window's own size is what is kept when it is closed like that
    d.frames(5)


def folding(d: Driver) -> None:
    """In a small window the panels fold into a strip, which opens one at a time, and the picture keeps most of it."""
    d.resize(1440, 900)
    d.settle()
    before = _places_of_panels()
    for size in ((1280, 800), (1024, 700)):
        d.resize(*size)
        there = _places_of_panels()
        assert set(there) == set(before), "panels are docked at this size"
        for label, (x, y, width, height) in there.items():
            most = 0.4 if PANELS[label].space.startswith(("Left", "Right")) else 0.9
            assert 0.13 < width / size[0] < most and height > 0.12 * size[1], f"{label} at {size}: {width} x {height}"
            assert x >= 0 and y >= 0 and x + width <= size[0] and y + height <= size[1]
        assert there[PICTURE][2] > 0.45 * size[0]
    for size in ((900, 600), (480, 360)):
        d.resize(*size)
        assert d.ui.fold.folded and set(_places_of_panels()) == {PICTURE} and _picture_share() > 0.7
        for label in SIDES:
            d.context.item_click(f"//##strip/{PANELS[label].icon}##{label}")
            d.frames(3)
            drawer = imgui.internal.find_window_by_name("##drawer")
            assert d.ui.fold.drawer == label and drawer.active
            assert drawer.pos.x >= 0.1 * size[0], "some of the picture stays to be seen"
        d.press(KEY.escape)
        assert not d.ui.fold.drawer
        d.ui.show_panel("Statistics")
        d.press(KEY.tab)
        d.frames(3)
        assert not imgui.internal.find_window_by_name("##strip").active, "Tab hides the strip too"
        d.press(KEY.tab)
        d.frames(3)
        assert d.ui.fold.drawer == "Statistics"
        d.context.menu_click(f"//##MainMenuBar/{'Menu/' if size[0] < 700 else ''}Panels/Statistics")
        d.frames(2)
        assert not d.ui.fold.drawer
        d.settle()
    d.resize(1440, 900)
    there = _places_of_panels()
    assert set(there) == set(before)
    for label, place in there.items():
        assert max(abs(a - b) for a, b in zip(place, before[label], strict=True)) <= 2.0, f"{label} moved"
    for width in range(1440, 1200, cases(-28, -7)):  # as a hand drags the window's corner
        d.resize(width, 900)
    d.resize(1440, 900)
    assert abs(_places_of_panels()["Statistics"][2] - before["Statistics"][2]) <= 2.0, "shares must not wear off"


def _places_of_panels() -> dict[str, tuple[float, ...]]:
    """Where each panel is that is drawn."""
    found = {}
    for label in PANELS:
        window = imgui.internal.find_window_by_name(label)
        if window is not None and window.was_active and not window.hidden:
            found[label] = (window.pos.x, window.pos.y, window.size.x, window.size.y)
    return found


def _picture_share() -> float:
    """How much of the window the picture's panel fills."""
    *_, width, height = _places_of_panels()[PICTURE]
    size = imgui.get_io().display_size
    return width * height / (size.x * size.y)

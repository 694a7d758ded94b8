"""How the window is laid out: hidden, folded and docked panels, and the tour.  Each function is run by
`tests.viewer.window`."""

from __future__ import annotations

import glfw
from imgui_bundle import glfw_utils, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.window import Driver
from viewer.panels.catalogue import PANELS, PICTURE
from viewer.panels.status import doing
from viewer.preferences import load_preferences
from viewer.tour import STEPS
from viewer.views import View

KEY = imgui.Key
SIDES = [label for label in PANELS if label != PICTURE]


def resize(d: Driver, width: int, height: int) -> None:
    """Give the window another size, and wait until its panels have taken their places."""
    glfw.set_window_size(glfw_utils.glfw_window_hello_imgui(), width, height)
    d.wait(lambda: imgui.get_io().display_size.x == width, "the window's new size", 20.0)
    d.frames(5)


def _places() -> dict[str, tuple[float, ...]]:
    """Where each panel is that is drawn."""
    found = {}
    for label in PANELS:
        window = imgui.internal.find_window_by_name(label)
        if window is not None and window.was_active and not window.hidden:
            found[label] = (window.pos.x, window.pos.y, window.size.x, window.size.y)
    return found


def _picture_share() -> float:
    """How much of the window the picture's panel fills."""
    *_, width, height = _places()[PICTURE]
    size = imgui.get_io().display_size
    return width * height / (size.x * size.y)


def hiding(d: Driver) -> None:
    """Tab leaves the picture alone, and brings back what was there, where it was; F11 fills the screen, and back."""
    resize(d, 1280, 800)
    d.settle()
    for label in ("Camera", "Experiment"):
        d.ui.show_panel(label)
        d.frames(4)
    docking = d.app.params.docking_params
    docking.dockable_window_of_name("Saving").is_visible = False
    d.frames(4)
    before = _places()
    assert {"Camera", "Experiment", "Statistics", "Inspector"} < set(before)
    d.press(KEY.tab)
    d.frames(3)
    assert set(_places()) == {PICTURE} and _picture_share() > 0.9
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.size and d.c.size[0] > 1200
    d.hold(KEY.d, 0.1)
    assert not d.c.session.follow, "keys fly while the panels are hidden"
    d.press(KEY.tab)
    d.frames(5)
    assert _places() == before, f"the panels did not come back as they were: {_places()} for {before}"
    assert not docking.dockable_window_of_name("Saving").is_visible

    d.press(KEY.tab)
    resize(d, 1000, 700)
    resize(d, 1280, 800)
    d.press(KEY.tab)
    d.frames(5)
    assert _places() == before, "a hidden panel lost its share of the window"

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
    assert _places() == before
    d.press(KEY.f11)  # the window's own size is what is kept when it is closed like that
    d.frames(5)


def folding(d: Driver) -> None:
    """In a small window the panels fold into a strip, which opens one at a time, and the picture keeps most of it."""
    resize(d, 1440, 900)
    d.settle()
    before = _places()
    for size in ((1280, 800), (900, 600)):
        resize(d, *size)
        there = _places()
        assert set(there) == set(before), "panels are docked at this size"
        for label, (x, y, width, height) in there.items():
            most = 0.4 if PANELS[label].space.startswith(("Left", "Right")) else 0.9
            assert 0.13 < width / size[0] < most and height > 0.12 * size[1], f"{label} at {size}: {width} x {height}"
            assert x >= 0 and y >= 0 and x + width <= size[0] and y + height <= size[1]
        assert there[PICTURE][2] > 0.45 * size[0]
    for size in ((700, 500), (480, 360)):
        resize(d, *size)
        assert d.ui.fold.folded and set(_places()) == {PICTURE} and _picture_share() > 0.7
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
        d.context.menu_click("//##MainMenuBar/Panels/Statistics")
        d.frames(2)
        assert not d.ui.fold.drawer
        d.settle()
    resize(d, 1440, 900)
    there = _places()
    assert set(there) == set(before)
    for label, place in there.items():
        assert max(abs(a - b) for a, b in zip(place, before[label], strict=True)) <= 2.0, f"{label} moved"
    for width in range(1440, 1200, -7):  # as a hand drags the window's corner
        resize(d, width, 900)
    resize(d, 1440, 900)
    assert abs(_places()["Statistics"][2] - before["Statistics"][2]) <= 2.0, "shares must not wear off"


def touring(d: Driver) -> None:
    """The tour comes on the first start; a step is done by doing it, by "Show me", or skipped; Help has it again."""
    tour = d.ui.tour
    assert tour.at == 0 and not d.c.preferences.tour, "a first start begins with the tour, and only that one"
    d.settle()
    assert doing(d.c).startswith("idle")
    show, skip = f"//###tour/{icons.ICON_FA_PLAY}  Show me", "//###tour/Skip"
    finish = "//###tour/Finish"
    d.frames(5)
    assert tour.at == 0, "nothing has been done yet"
    d.hold(KEY.w, 0.1)
    assert tour.at == 1 and STEPS[1].title == "Turn culling off and on"
    d.press(KEY.c)
    assert tour.at == 1, "off, but not on again"
    d.press(KEY.c)
    assert tour.at == 2
    d.press(KEY._3)
    d.press(KEY._1)
    assert tour.at == 2
    d.press(KEY._2)
    d.frames(2)
    assert tour.at == 3
    d.settle()
    d.context.mouse_move_to_pos((d.picture_edges()[0] + 3.0, d.picture_edges()[1] + 30.0))
    d.context.mouse_click(0)  # the sky
    d.frames(5)
    assert tour.at == 3
    d.context.item_click(show)
    d.wait(lambda: tour.at == 4, "a shadow that was clicked", 60.0)
    assert d.c.selected is not None and any(one.blocked_at is not None for one in d.c.explaining.answer.lights)
    d.c.runner.zoom_plan.steps, d.c.runner.zoom_plan.size = 3, (32, 32)
    d.context.item_click(show)
    d.wait(lambda: tour.at is None, "the zoom test", 120.0)
    assert d.c.runner.zoom_test is not None and d.c.runner.zoom_test.whole
    d.settle()

    d.context.menu_click("//##MainMenuBar/Help/Tour")
    d.frames(3)
    assert tour.at == 0
    camera = d.c.session.camera
    d.context.item_click(show)
    d.wait(lambda: tour.at == 1, "the flight that is shown", 30.0)
    assert d.c.session.camera != camera
    method = d.c.session.settings.method
    d.context.item_click(show)
    d.wait(lambda: tour.at == 2, "culling off and on", 30.0)
    assert d.c.session.settings.method == method
    d.context.item_click(show)
    d.wait(lambda: tour.at == 3, "the modes", 30.0)
    assert d.c.session.view is View.COLOR
    d.frames(5)
    if tour.at == 3:  # a pixel in shadow may be selected still
        d.context.item_click(skip)
    d.frames(2)
    assert tour.at == 4
    d.context.item_click(finish)
    d.frames(2)
    assert tour.at is None
    d.press(KEY.c)
    d.settle()
    d.c.save_preferences()
    assert not load_preferences()[0].tour

"""How the window is laid out: hidden, folded and docked panels, and the tour.  Each function is run by
`tests.viewer.window`."""

from __future__ import annotations

import ctypes
from typing import Any

import glfw
import numpy as np
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
    d.settle()
    assert not d.c.frame.statistics.shadow.culled and "Choose paper" in tour.step.text(d.c)
    d.press(KEY._3)
    d.press(KEY._1)
    assert tour.at == 1 and tour.done == {0}
    d.press(KEY._2)
    assert tour.at == 1 and tour.done == {0, 2}, "a later step that is done early counts"
    d.c.change(method="paper")
    d.settle()
    assert tour.at == 1 and "Press C twice" in tour.step.text(d.c)
    d.press(KEY.c)
    d.settle()
    assert tour.at == 1 and "Press C twice" in tour.step.text(d.c), "off, but not on again"
    d.press(KEY.c)
    d.settle()
    assert tour.at == 3
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
    for size in ((1400, 900), (480, 360), (900, 600)):
        resize(d, *size)
        window = imgui.internal.find_window_by_name("###tour")
        assert window.pos.x >= 0 and window.pos.x + window.size.x <= size[0], f"the tour is cut off at {size}"
        assert window.pos.y >= 0 and window.pos.y + window.size.y <= size[1], f"the tour is cut off at {size}"
    camera = d.c.session.camera
    d.context.item_click(show)
    d.wait(lambda: tour.at == 1, "the flight that is shown", 30.0)
    assert d.c.session.camera != camera
    d.c.change(method="auto")
    method = d.c.session.settings.method
    d.context.item_click(show)
    d.wait(lambda: tour.at == 2, "culling off and on", 30.0)
    assert d.c.session.settings.method == method
    d.context.item_click(show)
    d.wait(lambda: tour.at == 3, "the modes", 30.0)
    assert d.c.session.view is View.COLOR
    d.frames(5)
    assert tour.at == 3
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


def fitting(d: Driver) -> None:
    """No text is cut off at the edge of what it lies in, and no widget lies over another, at any size."""
    resize(d, 1280, 800)
    d.settle()
    d.context.mouse_move_to_pos(d.picture_centre())
    d.context.mouse_click(0)
    d.settle()
    for method, size in (("certified", (1600, 1000)), ("certified", (1280, 800)), ("paper", (900, 600))):
        d.c.change(method=method)
        resize(d, *size)
        d.settle()
        for label in SIDES:
            d.ui.show_panel(label)
            d.frames(5)
            _check_fit(d, f"{label} at {size}")
    for size in ((700, 500), (480, 360)):
        resize(d, *size)
        for label in SIDES:
            d.ui.show_panel(label)
            d.frames(5)
            _check_fit(d, f"{label} at {size}")
        d.press(KEY.escape)
    d.settle()


def _check_fit(d: Driver, where: str) -> None:
    letters, cut = _cut_text()
    assert letters > 100, f"{where}: only {letters} letters are seen"
    assert not cut, f"{where}: text is cut off: {cut}"
    too_wide = []
    for window in _windows():
        over = window.content_size_ideal.x - (window.inner_rect.max.x - window.inner_rect.min.x)
        if over > 1.0 and not window.flags & int(imgui.WindowFlags_.horizontal_scrollbar):
            too_wide.append(f"{window.name}: {over:.0f} pixels")
    assert not too_wide, f"{where}: content is wider than its window: {too_wide}"


def _windows() -> list[Any]:
    """All windows that were drawn in the last frame, but for the dock's, whose tabs scroll, and the test engine's."""
    context, skipped = imgui.get_current_context(), ("MainDockSpace", "Dear ImGui Test Engine")
    return [w for w in context.windows if w.was_active and not w.hidden and not w.name.startswith(skipped)]


def _cut_text() -> tuple[int, list[str]]:
    """How many letters are drawn; and where those are, and in which window, that the left or right edge of what they
    are drawn in cuts."""
    number, cut = 0, []
    for window in _windows():
        draw = window.draw_list
        vertices = _copied(draw.vtx_buffer, _VERTEX)
        indices = _copied(draw.idx_buffer, np.dtype(f"u{imgui.INDEX_SIZE}"))
        for n in range(draw.cmd_buffer.size()):
            command = draw.cmd_buffer[n]
            used = indices[command.idx_offset :][: command.elem_count].astype(int) + command.vtx_offset
            first = used[: max(len(used) - 5, 0)]
            after = np.stack([used[k : k + len(first)] - first for k in range(6)], axis=1)
            begins = first[(after == (0, 1, 2, 0, 2, 3)).all(axis=1)]  # rectangles, letters among them
            low, high = vertices[begins], vertices[begins + 2]
            texels, size = high["uv"] - low["uv"], high["at"] - low["at"]
            letters = (texels > 0.0).all(axis=1) & (size > 1.0).all(axis=1) & (size < 40.0).all(axis=1)
            left, right = low["at"][:, 0], high["at"][:, 0]
            inside = (left < command.clip_rect.z) & (right > command.clip_rect.x)
            seen = (high["at"][:, 1] > command.clip_rect.y) & (low["at"][:, 1] < command.clip_rect.w)
            number += int((letters & inside & seen).sum())
            over = (left < command.clip_rect.x - 1.0) | (right > command.clip_rect.z + 1.0)
            cut += [f"{window.name} {at}" for at in low["at"][letters & inside & seen & over].astype(int).tolist()]
    return number, cut


_VERTEX = np.dtype([("at", np.float32, 2), ("uv", np.float32, 2), ("color", np.uint32)])


def _copied(buffer: Any, of: np.dtype) -> np.ndarray:
    """What a buffer of ImGui's holds."""
    size = buffer.size() * of.itemsize
    return np.frombuffer(ctypes.string_at(buffer.data_address(), size) if size else b"", of)

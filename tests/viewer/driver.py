"""A user's hands and eyes in the real window: what scenarios drive it with.

Items are called as ImGui's test engine does, "//Panel/**/label": a panel, any groups in it, and a label.  What is not
there fails within seconds, with its name.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from imgui_bundle import glfw_utils, hello_imgui, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from tests.sweeps import cases
from tests.viewer.fakes import with_certificates
from tracer.experiments.runner import Run
from tracer.frame import Frame
from viewer.state.views import View
from viewer.views import colorize
from viewer.window.app import App
from viewer.window.keyboard import chord

PATIENCE = 240.0  # a first run compiles the kernels
SOON = 5.0  # seconds within which an item that is to be used must be there
SIZES = ((1280, 800), (1600, 1000))  # of windows that people have
FASTEST = 1000.0  # frames a second: they are counted here, not timed
# Seconds from frame to frame while it waits, and while it traces, which needs the processor, unless there is news; and
# while it only makes sure that nothing more comes.
SELDOM, BUSY, SETTLING = 0.02, 0.05, 0.004
RASTERIZER_DISCARD = 0x8C89  # what OpenGL calls: to draw up to where pixels would be filled

Rect = tuple[float, float, float, float]
T = TypeVar("T")


class Hands:
    """The test engine's context, which fails as soon as an item is not there, or anything else cannot be done."""

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        act = getattr(self._context, name)

        def checked(*arguments: Any) -> Any:
            wanted = arguments[0] if arguments and isinstance(arguments[0], str) else ""
            end = time.monotonic() + SOON
            while (
                name != "item_exists" and name.startswith(("item_", "mouse_")) and wanted.startswith("//")
                and not self._context.item_exists(wanted)
            ):  # fmt: skip
                assert time.monotonic() < end, f"there is no item {wanted!r}"
                self._context.yield_()
            found = act(*arguments)
            assert not self._context.is_error(), f"{name} failed: {', '.join(map(repr, arguments))}"
            return found

        return checked


class Driver:
    """The window under test, its controller, and hands on keyboard and pointer."""

    def __init__(self, app: App, context, folder: Path, dozes: bool = False) -> None:
        """`dozes`: the window rests when nothing moves, as for a user, else it draws frame after frame."""
        self.app, self.ui, self.c = app, app.ui, app.controller
        self.context, self.folder = Hands(context), folder
        self._in_frame: list[Callable[[], None]] = []
        self._of_window: list[Callable[[], None]] = []  # done when the window is drawn, pixels and all
        self._reading: list[str] | None = None  # what the window's next frame writes is wanted
        stay_awake = app._set_frame_rate
        self._news = threading.Event()

        def tell() -> None:
            self._news.set()
            hello_imgui.request_refresh()

        app.controller.wake.connect(tell)

        def with_errands() -> None:
            while self._in_frame:
                self._in_frame.pop()()
            stay_awake()
            if not dozes:
                app.params.fps_idling.enable_idling = False

        app._set_frame_rate = with_errands  # type: ignore[method-assign]
        if not dozes:
            app.params.fps_idling.fps_max = FASTEST
        self._watch_frames()

    def _watch_frames(self) -> None:
        """Fill the window's pixels in those frames only of which a picture is taken: where a processor draws, that is
        half of the time that a scenario takes.  All else is done in each frame, and the views are drawn as ever.  And
        have ImGui's own log say what a frame writes, where that is wanted: from the menus, which come first, on."""
        app, call, context = self.app, self.app.params.callbacks, imgui.get_current_context()
        show_menus, before_render, before_swap = call.show_menus, call.before_imgui_render, call.before_swap
        filled = True

        def begin() -> None:
            if self._reading is not None:
                imgui.internal.log_to_buffer(0)
                context.log_window = imgui.internal.find_window_by_name("Debug##Default")  # not the menus' alone
            show_menus()

        def render() -> None:
            nonlocal filled
            if self._reading is not None and context.log_enabled:
                self._reading.append(context.log_buffer.c_str())
                imgui.log_finish()
            before_render()
            filled = bool(self._of_window) or app._capture_this_frame
            if not filled:
                self.ui.graphics.display.context.enable_direct(RASTERIZER_DISCARD)

        def swap() -> None:
            if not filled:
                self.ui.graphics.display.context.disable_direct(RASTERIZER_DISCARD)
            before_swap()
            while filled and self._of_window:
                self._of_window.pop()()

        call.show_menus, call.before_imgui_render, call.before_swap = begin, render, swap

    # Waiting

    def wait(self, until: Callable[[], bool], what: str, patience: float = PATIENCE, seldom: float = SELDOM) -> None:
        end = time.monotonic() + patience
        while not until():
            said = self.c.notices.message
            assert self.c.frame is not None or said is None or not said.error, said.text
            assert time.monotonic() < end, f"waited in vain: {what}; the status says {said}"
            self._news.wait(BUSY if self.c.active else seldom)
            self._news.clear()
            self.context.yield_()
        self.context.yield_()

    def frames(self, count: int) -> None:
        self.context.yield_(count)

    def pause(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            time.sleep(SELDOM)
            self.frames(1)

    def settle(self) -> None:
        """Until everything is loaded and traced, and has been drawn."""
        quiet, traced = 0, -1

        def rested() -> bool:
            """Whether nothing has come for some of the window's frames: in one of them a frame may be taken, and the
            next be asked for and traced."""
            nonlocal quiet, traced
            still = self.c.frame is not None and not self.c.active and self.c.history.frames == traced
            quiet, traced = quiet + 1 if still else 0, self.c.history.frames
            return quiet >= 5

        self.frames(1)
        self.wait(rested, "an idle picture", seldom=SETTLING)
        self.frames(2)

    def change(self, **settings: Any) -> None:
        """Change settings of the tracer, and wait for their picture."""
        self.c.settings.change(**settings)
        self.settle()

    def see(self, view: View) -> None:
        """Choose a view, and wait for its picture."""
        self.c.session.set_draw(view=view)
        self.settle()

    def open(self, path: Path) -> None:
        """Let a scene go over the window, and wait for its picture."""
        self.drop(path)
        self.wait(lambda: self.c.session.scene.path.name == path.name, f"the scene {path.name}")
        self.settle()

    # Eyes

    def text(self) -> str:
        """Return all that the window writes where it can be seen, but for what is written over the picture."""
        self._reading = found = []
        while not found:
            self.frames(1)
        self._reading = None
        return found[0]

    def expect(self, *texts: str, patience: float = 20.0) -> None:
        """Wait until the window writes all of these."""
        end = time.monotonic() + patience
        while missing := [text for text in texts if text not in (seen := self.text())]:
            assert time.monotonic() < end, f"the window does not say {missing[0]!r}, but: {seen}"

    @property
    def said(self) -> str:
        """The newest notice."""
        message = self.c.notices.message
        return "" if message is None else message.text

    def place(self, item: str) -> Rect:
        """Left, top, right and bottom of an item."""
        area = self.context.item_info(item).rect_full
        return area.min.x, area.min.y, area.max.x, area.max.y

    def has(self, item: str) -> bool:
        """Whether an item is there."""
        return bool(self.context.item_exists(item))

    def inside(self, look: Callable[[], T]) -> T:
        """Return what is seen where GL work is done: scenarios run on a thread without the window's context."""
        got: list[T] = []
        self._in_frame.append(lambda: got.append(look()))
        self.wait(lambda: bool(got), "the window's next frame")
        return got[0]

    def shown(self) -> np.ndarray:
        """The drawn view, (h, w, 3) uint8."""
        return self.inside(self.ui.graphics.display.read)

    def expect_picture(self, most: int = 2, **options: Any) -> None:
        """The picture is that which the command line draws of the frame with what is chosen, to so many steps."""
        draw = replace(self.c.session.draw, **options)
        off = np.abs(self.shown().astype(int) - colorize(self.c.frame, draw))
        assert off.max() <= most, f"{draw.view}: off by {off.max()} at {np.argwhere(off > most)[:3].tolist()}"

    def window(self) -> np.ndarray:
        """All of the window as it is drawn next."""
        got: list[np.ndarray] = []
        size = glfw.get_framebuffer_size(glfw_utils.glfw_window_hello_imgui())
        self._of_window.append(lambda: got.append(self.ui.graphics.display.read_window(*size)))
        while not got:
            self.context.yield_()
        return got[0]

    def certify(self) -> None:
        """Frames from now on come with cells and certificates drawn by lot, and with work where that was asked for."""
        renderer = self.c.renderer._renderer
        refine = renderer.refine

        def with_more(*arguments, **options):
            for frame in refine(*arguments, **options):
                more = with_certificates(frame)
                yield more if frame.settings.record_work else replace(more, saved=None, cost=None, due_rays=None)

        renderer.refine = with_more

    def fix_resolution(self, width: int, height: int) -> None:
        """Pictures of this size from now on, whatever room the window has: smaller ones take less of everything."""
        self.c.session.set_pace(fixed_size=True, width=width, height=height)

    def slow_down(self, run: Run) -> None:
        """Let a run take its time: it is to last, not to keep the processor busy."""
        progressed = run.progressed

        def slowly(label: str, frame: Frame | None = None) -> None:
            time.sleep(0.05)
            progressed(label, frame)

        run.progressed = slowly  # type: ignore[method-assign]

    def resize(self, width: int, height: int) -> None:
        """Give the window another size, and wait until its panels have taken their places."""
        glfw.set_window_size(glfw_utils.glfw_window_hello_imgui(), width, height)
        self.wait(lambda: imgui.get_io().display_size.x == width, "the window's new size", 20.0)
        self.frames(5)

    def sizes(self) -> Iterator[tuple[int, int]]:
        """Give the window each of SIZES, one after another, with an idle picture in it; the smaller alone but for
        `make test-all`."""
        for size in cases(SIZES[:1], SIZES):
            self.resize(*size)
            self.settle()
            yield size

    def scroll_down(self, panel: str) -> None:
        """To the end of everything that scrolls in a panel."""
        for window in imgui.get_current_context().windows:
            if window.was_active and window.name.startswith((panel, f"{panel}/")):
                imgui.internal.set_scroll_y(window, window.scroll_max.y)
        self.frames(3)

    # Hands

    def press(self, key: int | str, count: int = 1) -> None:
        """Press a key, also by its name: "Ctrl+O"."""
        self.context.key_press(chord(key) if isinstance(key, str) else key, count)
        self.frames(2)

    def type(self, text: str) -> None:
        self.context.key_chars(text)
        self.frames(2)

    def click(self, item: str, frames: int = 3) -> None:
        """Click an item, and let some of the window's frames follow."""
        self.context.item_click(item)
        self.frames(frames)

    def choose(self, entry: str) -> None:
        """Choose an entry of a menu: "View/Depth"."""
        self.context.menu_click(f"//##MainMenuBar/{entry}")
        self.frames(3)

    def enter(self, item: str, value: float | str) -> None:
        """Give a field another value."""
        self.context.item_input_value(item, value)
        self.frames(3)

    def hover(self, item: str) -> None:
        self.context.mouse_move(item)
        self.frames(3)

    def show_panel(self, name: str) -> None:
        self.ui.show_panel(name)
        self.frames(4)

    def point(self, across: float, down: float) -> None:
        """Rest the pointer on the picture, 0 to 1 across and down."""
        left, top, right, bottom = self.picture_edges()
        self.context.mouse_move_to_pos((left + across * (right - left), top + down * (bottom - top)))
        self.frames(2)

    def pick(self, across: float, down: float, button: int = 0) -> None:
        """Click the picture there."""
        self.point(across, down)
        self.context.mouse_click(button)
        self.frames(3)

    def hold(self, key: int, seconds: float) -> None:
        self.context.key_down(key)
        self.pause(seconds)
        self.context.key_up(key)
        self.frames(2)

    def picture_centre(self) -> tuple[float, float]:
        left, top, right, bottom = self.picture_edges()
        return 0.5 * (left + right), 0.5 * (top + bottom)

    def picture_edges(self) -> Rect:
        """Left, top, right and bottom of the picture inside its window."""
        return self.place("//Picture/picture")

    def drag(self, start: tuple[float, float], by: tuple[float, float], button: int = 0) -> None:
        self.context.mouse_move_to_pos(start)
        self.frames(2)
        self.context.mouse_down(button)
        self.context.mouse_move_to_pos((start[0] + by[0], start[1] + by[1]))
        self.frames(2)
        self.context.mouse_up(button)
        self.frames(2)

    def drop(self, *paths: Path) -> None:
        """What GLFW calls when files are let go over the window."""
        self.app._dropped(None, [str(p) for p in paths])
        self.frames(3)

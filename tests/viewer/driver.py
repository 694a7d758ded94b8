"""A user's hands and eyes in the real window: what scenarios drive it with."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from imgui_bundle import glfw_utils, hello_imgui, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from tests.sweeps import cases
from tests.viewer.fakes import with_certificates
from tracer.experiments.runner import Run
from tracer.frame import Frame
from viewer.window.app import App

PATIENCE = 240.0  # a first run compiles the kernels
SIZES = ((1280, 800), (1600, 1000))  # of windows that people have
FASTEST = 1000.0  # frames a second: they are counted here, not timed
# Seconds from frame to frame while it waits, and while it traces, which needs the processor, unless there is news; and
# while it only makes sure that nothing more comes.
SELDOM, BUSY, SETTLING = 0.02, 0.05, 0.004
RASTERIZER_DISCARD = 0x8C89  # what OpenGL calls: to draw up to where pixels would be filled


class Driver:
    """The window under test, its controller, and hands on keyboard and pointer."""

    def __init__(self, app: App, context, folder: Path, dozes: bool = False) -> None:
        """`dozes`: the window rests when nothing moves, as for a user, else it draws frame after frame."""
        self.app, self.ui, self.c = app, app.ui, app.controller
        self.context, self.folder = context, folder
        self._in_frame: list[Callable[[], None]] = []
        self._of_window: list[Callable[[], None]] = []  # done when the window is drawn, pixels and all
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
        self._fill_only_what_is_seen()

    def _fill_only_what_is_seen(self) -> None:
        """Fill the window's pixels in those frames only of which a picture is taken: where a processor draws, that is
        half of the time that a scenario takes.  All else is done in each frame, and the views are drawn as ever."""
        app, call = self.app, self.app.params.callbacks
        before_render, before_swap = call.before_imgui_render, call.before_swap
        filled = True

        def begin() -> None:
            nonlocal filled
            before_render()
            filled = bool(self._of_window) or app._capture_this_frame
            if not filled:
                self.ui.graphics.display.context.enable_direct(RASTERIZER_DISCARD)

        def end() -> None:
            if not filled:
                self.ui.graphics.display.context.disable_direct(RASTERIZER_DISCARD)
            before_swap()
            while filled and self._of_window:
                self._of_window.pop()()

        call.before_imgui_render, call.before_swap = begin, end

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

    def shown(self) -> np.ndarray:
        """The drawn view, read where GL work is done: scenarios run on a thread without the window's context."""
        got: list[np.ndarray] = []
        self._in_frame.append(lambda: got.append(self.ui.graphics.display.read()))
        self.wait(lambda: bool(got), "the picture to be read")
        return got[0]

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

    def press(self, key: int, count: int = 1) -> None:
        self.context.key_press(key, count)
        self.frames(2)

    def hold(self, key: int, seconds: float) -> None:
        self.context.key_down(key)
        self.pause(seconds)
        self.context.key_up(key)
        self.frames(2)

    def picture_centre(self) -> tuple[float, float]:
        left, top, right, bottom = self.picture_edges()
        return 0.5 * (left + right), 0.5 * (top + bottom)

    def picture_edges(self) -> tuple[float, float, float, float]:
        """Left, top, right and bottom of the picture inside its window."""
        area = self.context.item_info("//Picture/picture").rect_full
        return area.min.x, area.min.y, area.max.x, area.max.y

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

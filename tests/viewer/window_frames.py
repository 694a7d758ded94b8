"""What the test engine does in the frames of the real window."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from imgui_bundle import hello_imgui, imgui

from viewer.window.app import App

SOON = 5.0  # seconds within which an item that is to be used must be there
FASTEST = 1000.0  # frames a second: they are counted here, not timed
RASTERIZER_DISCARD = 0x8C89  # what OpenGL calls: to draw up to where pixels would be filled


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


class WindowFrames:
    """What is to be done in the window's next frames, on its own thread: `in_frame`, where GL work can be done;
    `of_window`, when the window is drawn, pixels and all.  What a frame writes goes to `reading`, where that is wanted,
    and `news` is set when the window should wake."""

    def __init__(self, app: App, dozes: bool) -> None:
        self.in_frame: list[Callable[[], None]] = []
        self.of_window: list[Callable[[], None]] = []
        self.reading: list[str] | None = None
        self.news = threading.Event()
        stay_awake = app._set_frame_rate

        def tell() -> None:
            self.news.set()
            hello_imgui.request_refresh()

        app.controller.wake.connect(tell)

        def with_errands() -> None:
            while self.in_frame:
                self.in_frame.pop()()
            stay_awake()
            if not dozes:
                app.params.fps_idling.enable_idling = False

        app._set_frame_rate = with_errands  # type: ignore[method-assign]
        if not dozes:
            app.params.fps_idling.fps_max = FASTEST
        self._watch(app)

    def _watch(self, app: App) -> None:
        """Fill the window's pixels in those frames only of which a picture is taken: where a processor draws, that is
        half of the time that a scenario takes.  All else is done in each frame, and the views are drawn as ever.  And
        have ImGui's own log say what a frame writes, where that is wanted: from the menus, which come first, on."""
        call, context = app.params.callbacks, imgui.get_current_context()
        show_menus, before_render, before_swap = call.show_menus, call.before_imgui_render, call.before_swap
        filled = True

        def begin() -> None:
            if self.reading is not None:
                imgui.internal.log_to_buffer(0)
                context.log_window = imgui.internal.find_window_by_name("Debug##Default")  # not the menus' alone
            show_menus()

        def render() -> None:
            nonlocal filled
            if self.reading is not None and context.log_enabled:
                self.reading.append(context.log_buffer.c_str())
                imgui.log_finish()
            before_render()
            filled = bool(self.of_window) or app._capture_this_frame
            if not filled:
                app.ui.graphics.display.context.enable_direct(RASTERIZER_DISCARD)

        def swap() -> None:
            if not filled:
                app.ui.graphics.display.context.disable_direct(RASTERIZER_DISCARD)
            before_swap()
            while filled and self.of_window:
                self.of_window.pop()()

        call.show_menus, call.before_imgui_render, call.before_swap = begin, render, swap

"""Runs one scenario in the real window, in a process of its own.

    python -m tests.viewer.window SCENARIO SCENE FOLDER

ImGui's test engine drives the keyboard and the pointer; a scenario is a function of a `Driver` in
`tests.viewer.scenarios`, and what it asserts is this process's exit code.
"""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from imgui_bundle import hello_imgui, imgui, immapp
from imgui_bundle.immapp import testing

from tests.viewer.conftest import with_certificates
from viewer import app as viewer_app
from viewer.app import App

PATIENCE = 240.0  # a first run compiles the kernels


class Driver:
    """The window under test, its controller, and hands on keyboard and pointer."""

    def __init__(self, app: App, context, folder: Path) -> None:
        self.app, self.ui, self.c = app, app.ui, app.controller
        self.context, self.folder = context, folder
        self._in_frame: list[Callable[[], None]] = []
        stay_awake = app._stay_awake

        def with_errands() -> None:
            while self._in_frame:
                self._in_frame.pop()()
            stay_awake()

        app._stay_awake = with_errands  # type: ignore[method-assign]

    def wait(self, until: Callable[[], bool], what: str, patience: float = PATIENCE) -> None:
        end = time.monotonic() + patience
        while not until():
            assert self.c.frame is not None or self.c.message is None or not self.c.message.error, self.c.message.text
            assert time.monotonic() < end, f"waited in vain: {what}; the status says {self.c.message}"
            self.context.yield_()
        self.context.yield_()

    def frames(self, count: int) -> None:
        self.context.yield_(count)

    def settle(self) -> None:
        """Until everything is loaded and traced, and has been drawn."""
        quiet = 0

        def rested() -> bool:  # the fine frame is asked for one frame after the motion ends: one quiet frame may lie
            nonlocal quiet
            quiet = quiet + 1 if self.c.frame is not None and not self.c.active else 0
            return quiet >= 5

        self.frames(3)
        self.wait(rested, "a picture at rest")
        self.frames(3)

    def shown(self) -> np.ndarray:
        """The drawn view, read where GL work is done: scenarios run on a thread without the window's context."""
        got: list[np.ndarray] = []
        self._in_frame.append(lambda: got.append(self.ui.display.read()))
        self.wait(lambda: bool(got), "the picture to be read")
        return got[0]

    def certify(self) -> None:
        """Frames from now on come with cells and certificates drawn by lot, and with work where that was asked for."""
        renderer = self.c.render._renderer
        refine = renderer.refine

        def with_more(*arguments, **options):
            for frame in refine(*arguments, **options):
                more = with_certificates(frame)
                yield more if frame.settings.record_work else replace(more, saved=None, cost=None, due_rays=None)

        renderer.refine = with_more

    def press(self, key: int, count: int = 1) -> None:
        self.context.key_press(key, count)
        self.frames(2)

    def hold(self, key: int, seconds: float) -> None:
        self.context.key_down(key)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.frames(1)
        self.context.key_up(key)
        self.frames(2)

    def picture_centre(self) -> tuple[float, float]:
        window = imgui.internal.find_window_by_name("Picture")
        return window.pos.x + 0.5 * window.size.x, window.pos.y + 0.45 * window.size.y

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


def main(name: str, scene: str, folder: str) -> int:
    from tests.viewer import layouts, scenarios, seeing

    viewer_app.WINDOW_SIZE = (960, 640)
    app = App(Path(scene))
    if name != "touring":
        app.ui.tour.end()  # it comes by itself on the first start
    app.controller.preferences.screenshot_folder = str(Path(folder) / "pictures")
    app.controller.preferences.dynamic_resolution = True
    app.controller.change(samples=1)  # else pictures at rest go on changing
    failed: list[BaseException] = []

    def test(context) -> None:
        engine = imgui.test_engine.get_io(hello_imgui.get_imgui_test_engine())
        engine.config_watchdog_warning = engine.config_watchdog_kill_test = 2.0 * PATIENCE
        try:
            scenario = next(getattr(module, name) for module in (layouts, seeing, scenarios) if hasattr(module, name))
            scenario(Driver(app, context, Path(folder)))
        except BaseException as error:
            failed.append(error)
            traceback.print_exc()

    def runner(params, add_ons: immapp.AddOnsParams) -> None:
        # The scenario says itself what went wrong; the engine only notices that a window closed meanwhile.
        testing.run(test_function=test, runner_params=params, add_ons_params=add_ons, raise_on_error=False)

    code = app.run(runner)
    stuck = app.controller.render._thread.is_alive()
    if stuck:
        print("the render thread outlived the window", file=sys.stderr)
    return 1 if failed or stuck else code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

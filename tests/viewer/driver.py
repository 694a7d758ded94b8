"""A user's hands and eyes in the real window: what scenarios drive it with.

Items are called as ImGui's test engine does, "//Panel/**/label": a panel, any groups in it, and a label.  What is not
there fails within seconds, with its name."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Self, TypeVar

import numpy as np
from imgui_bundle import glfw_utils, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from PIL import Image

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from tests.sweeps import cases
from tests.viewer.fakes import with_certificates
from tests.viewer.window_frames import Hands, WindowFrames
from tracer.experiments.runner import Run
from tracer.frame import Frame
from viewer.state.views import View
from viewer.views import colorize
from viewer.window.app import App
from viewer.window.command import Command
from viewer.window.keyboard import chord

PATIENCE = 240.0  # a first run compiles the kernels
SIZES = ((1280, 800), (1600, 1000))  # of windows that people have
SMALL = (1024, 620)  # a window that is soon drawn, and just does not fold its panels
# Seconds from frame to frame while it waits, and while it traces, which needs the processor, unless there is news; and
# while it only makes sure that nothing more comes.
SELDOM, BUSY, SETTLING = 0.02, 0.05, 0.004

Rect = tuple[float, float, float, float]
T = TypeVar("T")


class Driver:
    """The window under test, its controller, and hands on keyboard and pointer."""

    def __init__(self, app: App, context, folder: Path, dozes: bool = False) -> None:
        """`dozes`: the window rests when nothing moves, as for a user, else it draws frame after frame."""
        self.app, self.ui, self.c = app, app.ui, app.controller
        self.context, self.folder, self.pictures = Hands(context), folder, folder / "pictures"
        self._frames = WindowFrames(app, dozes)

    # Waiting

    def wait(self, until: Callable[[], bool], what: str, patience: float = PATIENCE, seldom: float = SELDOM) -> Self:
        end = time.monotonic() + patience
        while not until():
            said = self.c.notices.message
            assert self.c.frame is not None or said is None or not said.error, said.text
            assert time.monotonic() < end, f"waited in vain: {what}; the status says {said}"
            self._frames.news.wait(BUSY if self.c.active else seldom)
            self._frames.news.clear()
            self.context.yield_()
        return self.frames(1)

    def frames(self, count: int) -> Self:
        self.context.yield_(count)
        return self

    def pause(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            time.sleep(SELDOM)
            self.frames(1)

    def settle(self) -> Self:
        """Until everything is loaded, traced, written and at its end, no camera glides, and it has been drawn."""
        quiet, traced = 0, -1

        def rested() -> bool:
            """Whether nothing has come for some of the window's frames: in one of them a frame may be taken, and the
            next be asked for and traced."""
            nonlocal quiet, traced
            still = self.c.frame is not None and not self.c.active and self.c.history.frames == traced
            quiet, traced = quiet + 1 if still else 0, self.c.history.frames
            return quiet >= 3

        self.frames(1)
        return self.wait(rested, "an idle picture", seldom=SETTLING).frames(2)

    def change(self, **settings: Any) -> Self:
        """Change settings of the tracer, and wait for their picture."""
        self.c.settings.change(**settings)
        return self.settle()

    def see(self, view: View, **more: Any) -> Self:
        """Choose a view, and more of how frames are drawn, and wait for its picture."""
        self.c.session.set_draw(view=view, **more)
        return self.settle()

    def open(self, path: Path) -> None:
        """Let a scene go over the window, and wait for its picture."""
        self.drop(path).settle()
        assert self.c.session.scene.path.name == path.name, self.said

    # Eyes

    def text(self) -> str:
        """Return all that the window writes where it can be seen, but for what is written over the picture."""
        self._frames.reading = found = []
        while not found:
            self.frames(1)
        self._frames.reading = None
        return found[0]

    def expect(self, *texts: str, patience: float = 20.0) -> Self:
        """Wait until the window writes all of these."""
        end = time.monotonic() + patience
        while missing := [text for text in texts if text not in (seen := self.text())]:
            assert time.monotonic() < end, f"the window does not say {missing[0]!r}, but: {seen}"
        return self

    @property
    def said(self) -> str:
        """The newest notice."""
        message = self.c.notices.message
        return "" if message is None else message.text

    def place(self, item: str) -> Rect:
        """Left, top, right and bottom of an item."""
        area = self.context.item_info(item).rect_full
        return area.min.x, area.min.y, area.max.x, area.max.y

    def middle(self, item: str) -> tuple[float, float]:
        """The middle of an item."""
        left, top, right, bottom = self.place(item)
        return 0.5 * (left + right), 0.5 * (top + bottom)

    def panel(self, name: str) -> Any:
        """ImGui's window of a panel."""
        return imgui.internal.find_window_by_name(name)

    def lines_drawn(self) -> int:
        """How much is drawn over the picture, in corners of triangles."""
        return self.panel("Picture").draw_list.vtx_buffer.size()

    def command(self, name: str) -> Command:
        return next(command for command in self.ui.commands if command.name == name)

    def has(self, item: str) -> bool:
        """Whether an item is there."""
        return bool(self.context.item_exists(item))

    def inside(self, look: Callable[[], T]) -> T:
        """Return what is seen where GL work is done: scenarios run on a thread without the window's context."""
        got: list[T] = []
        self._frames.in_frame.append(lambda: got.append(look()))
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

    def saved(self, name: str) -> np.ndarray:
        """The picture as it is saved now, under this name."""
        self.c.preferences.screenshot_template = name
        (self.pictures / name).unlink(missing_ok=True)
        self.press("F12").settle()
        return self.read(name)

    def read(self, name: str) -> np.ndarray:
        """A picture that was saved."""
        with Image.open(self.pictures / name) as image:
            return np.asarray(image)

    def places(self, here: np.ndarray, reach: int = 2) -> list[tuple[float, float]]:
        """Where pixels (h, w) lie on the picture that are `here`, with the like around them, as no hand is steady: from
        its middle on."""
        frame = self.c.frame
        inside = here.copy()
        for shift in (-reach, reach):
            for axis in (0, 1):
                same = np.roll(frame.primitive, shift, axis) == frame.primitive
                inside &= np.roll(here, shift, axis) & same
        inside[:reach], inside[-reach:], inside[:, :reach], inside[:, -reach:] = False, False, False, False
        found = [((x + 0.5) / frame.width, (y + 0.5) / frame.height) for y, x in np.argwhere(inside).tolist()]
        return sorted(found, key=lambda place: math.dist(place, (0.5, 0.5)))

    def window(self) -> np.ndarray:
        """All of the window as it is drawn next."""
        got: list[np.ndarray] = []
        size = glfw.get_framebuffer_size(glfw_utils.glfw_window_hello_imgui())
        self._frames.of_window.append(lambda: got.append(self.ui.graphics.display.read_window(*size)))
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

    def resize(self, width: int, height: int) -> Self:
        """Give the window another size, and wait until its panels have taken their places."""
        glfw.set_window_size(glfw_utils.glfw_window_hello_imgui(), width, height)
        self.wait(lambda: imgui.get_io().display_size.x == width, "the window's new size", 20.0)
        return self.frames(5)

    def sizes(self) -> Iterator[tuple[int, int]]:
        """Give the window each of SIZES, one after another, with an idle picture in it; the smaller alone but for
        `make test-all`."""
        for size in cases(SIZES[:1], SIZES):
            self.resize(*size).settle()
            yield size

    def scroll_down(self, panel: str) -> Self:
        """To the end of everything that scrolls in a panel."""
        for window in imgui.get_current_context().windows:
            if window.was_active and window.name.startswith((panel, f"{panel}/")):
                imgui.internal.set_scroll_y(window, window.scroll_max.y)
        return self.frames(2)

    # Hands: some of the window's frames follow on each

    def press(self, *keys: str) -> Self:
        """Press keys by their names, one after another: "Ctrl+O"."""
        for key in keys:
            self.context.key_press(chord(key))
            self.frames(2)
        return self

    @contextmanager
    def held(self, key: str) -> Iterator[None]:
        """Hold a key, or Ctrl alone, meanwhile."""
        number = imgui.Key.mod_ctrl if key == "Ctrl" else chord(key)
        self.context.key_down(number)
        self.frames(2)
        yield
        self.context.key_up(number)
        self.frames(2)

    def hold(self, key: str, seconds: float) -> Self:
        with self.held(key):
            self.pause(seconds)
        return self

    def type(self, text: str) -> Self:
        self.context.key_chars(text)
        return self.frames(2)

    def click(self, item: str) -> Self:
        self.context.item_click(item)
        return self.frames(2)

    def start(self, panel: str) -> Self:
        """Begin a panel's run."""
        return self.click(f"//{panel}/**/{icons.ICON_FA_PLAY}  Start")

    def choose(self, entry: str) -> Self:
        """Choose an entry of a menu: "View/Depth"."""
        self.context.menu_click(f"//##MainMenuBar/{entry}")
        return self.frames(2)

    def enter(self, item: str, value: float | str) -> Self:
        """Give a field another value."""
        self.context.item_input_value(item, value)
        return self.frames(2)

    def hover(self, item: str) -> Self:
        self.context.mouse_move(item)
        return self.frames(2)

    def show_panel(self, name: str) -> Self:
        self.ui.show_panel(name)
        return self.frames(4)

    def on_picture(self, across: float, down: float) -> tuple[float, float]:
        """Where in the window a place on the picture is, 0 to 1 across and down."""
        left, top, right, bottom = self.picture_edges()
        return left + across * (right - left), top + down * (bottom - top)

    def picture_edges(self) -> Rect:
        """Left, top, right and bottom of the picture inside its window."""
        return self.place("//Picture/picture")

    def move_to(self, x: float, y: float) -> Self:
        """Rest the pointer there in the window."""
        self.context.mouse_move_to_pos((x, y))
        return self.frames(2)

    def point(self, across: float, down: float) -> Self:
        """Rest the pointer on the picture, 0 to 1 across and down."""
        return self.move_to(*self.on_picture(across, down))

    def pick(self, across: float = 0.5, down: float = 0.5) -> Self:
        """Click the picture there."""
        return self.point(across, down).click_here()

    def click_here(self, button: int = 0) -> Self:
        """Click where the pointer is."""
        self.context.mouse_click(button)
        return self.frames(2)

    def drag(self, start: tuple[float, float], by: tuple[float, float], button: int = 0) -> Self:
        self.move_to(*start)
        self.context.mouse_down(button)
        self.move_to(start[0] + by[0], start[1] + by[1])
        self.context.mouse_up(button)
        return self.frames(2)

    def drop(self, *paths: Path) -> Self:
        """What GLFW calls when files are let go over the window."""
        self.app._dropped(None, [str(p) for p in paths])
        return self.frames(2)

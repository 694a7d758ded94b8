"""The window with the table of half a million primitives open: its frames, and how soon a click is seen.

    make table                                  500,000 triangles
    make table ARGS="--triangles 100000"        fewer

A bumpy sphere of so many triangles, in 200 named parts, is opened in the real window, and ImGui's test engine plays the
user, seeded: it scrolls the table, drags its scroll bar, sorts by one column after another, types into the filter,
turns the camera, and clicks in the picture.  A frame is timed from when the window begins it until it is on the screen.
A click is timed from when the button is let go until a frame is on the screen whose picture has the border around the
primitive and whose table shows its row.  Sorting and filtering are timed from the beginning of the frame in which a
header's click, or a letter, has come, until their rows are on the screen.  The same motion without the table says what
the table costs.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
import traceback
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from imgui_bundle import hello_imgui, imgui, immapp
from imgui_bundle.immapp import testing
from rich.table import Table

from tests.bench.frame_times import in_words, machine
from tests.bench.meshes import bumpy_sphere, frequency_for
from tests.tracing.worlds import scene
from tests.viewer.driver import Driver
from tracer.scene.model import Camera, Scene
from viewer.cli.console import print_table
from viewer.state import navigation
from viewer.state.scene_rows import Level
from viewer.util.messages import say
from viewer.util.screen import has_display, no_display_reason
from viewer.window import gl_window
from viewer.window.app import FASTEST, FASTEST_BY_PROCESSOR, App
from viewer.window.panels import find
from viewer.window.panels.find import FindState

CAMERA = Camera((0.6, 0.9, 2.6), (-0.2, -0.3, -0.93), angle=40.0)
LIGHTS = [(1.6, 1.2, 0.4), (-2.0, 2.0, 1.5)]
PARTS = 200
SORTED = ("Number", "Pixels", "Shadow", "Occlusion", "Pixels")  # whose headers are in sight
TYPED = ("pixels>3", "shadow:full", "part-1", "number>250000 share<50", "is:unseen")
LONGEST = 600.0  # seconds that the user may take


def half_a_million(triangles: int) -> Scene:
    """A bumpy sphere of at least so many triangles, in parts that have names."""
    made = scene(bumpy_sphere(frequency_for(triangles)), lights=LIGHTS, camera=CAMERA)
    static, *others = made.objects
    parts = tuple(f"part-{number}" for number in range(PARTS))
    part_of = (np.arange(made.triangle_count) * PARTS // made.triangle_count).astype(np.int32)
    return replace(made, objects=(replace(static, parts=parts, part_of=part_of), *others), path=Path("sphere.aff"))


class Watch:
    """Times the frames of a window by what the user does, and says when what was waited for is on the screen."""

    def __init__(self, app: App) -> None:
        self.app, self.doing = app, ""
        self.frames: dict[str, list[float]] = defaultdict(list)
        self.answers: dict[str, list[float]] = defaultdict(list)
        self.rows: set[int] = set()
        self.most_rows, self.renderer = 0, ""
        self._awaited: tuple[str, Callable[[], bool], Callable[[], bool]] | None = None
        self._since: float | None = None
        self._before, self._began, row = app.before_widgets, 0.0, find._row
        app.params.callbacks.pre_new_frame = self.before
        app.params.callbacks.after_swap = self.after

        def noted(ui: Any, table: Any, listing: Any, number: int, *how: bool) -> None:
            self.rows.add(number)
            row(ui, table, listing, number, *how)

        find._row = noted

    def before(self) -> None:
        self._began = time.perf_counter()
        self.rows.clear()
        self._before()

    def after(self) -> None:
        now, self.renderer = time.perf_counter(), self.app.ui.graphics.renderer_name
        if self.doing:
            self.frames[self.doing].append(now - self._began)
        self.most_rows = max(self.most_rows, len(self.rows))
        if self._awaited is None:
            return
        what, asked, seen = self._awaited
        if self._since is None and asked():
            self._since = self._began  # the window has heard of it in this frame
        if self._since is not None and seen():
            self.answers[what].append(now - self._since)
            self._awaited = None

    def wait_for(self, what: str, seen: Callable[[], bool], asked: Callable[[], bool] | None = None) -> None:
        """From now on, or from the frame in which it was `asked()` for, until one is on the screen with `seen()`."""
        self._since = time.perf_counter() if asked is None else None
        self._awaited = what, asked or (lambda: True), seen

    @property
    def waits(self) -> bool:
        return self._awaited is not None


class User:
    """What somebody does with the table."""

    def __init__(self, app: App, driver: Driver, watch: Watch, clicks: int) -> None:
        self.app, self.d, self.watch, self.clicks = app, driver, watch, clicks
        self.c, self.table = app.controller, app.controller.table
        self.lots = np.random.default_rng(1)

    def play(self) -> None:
        d, c = self.d, self.c
        d.settle()
        c.settings.change(method="paper")
        d.settle()
        self._turn("motion, no table")
        d.ui.show_panel("Find")
        self.table.level = Level.PRIMITIVES
        self._known()
        self._scroll()
        self._sort()
        self._filter()
        self._turn("motion, table open")
        self._known()
        self._click()

    def _known(self) -> None:
        self.d.frames(3)
        self.d.settle()
        self.d.wait(lambda: not self.table.busy and self._shown(), "the rows")
        self.d.frames(3)

    def _scroll(self) -> None:
        d = self.d
        area = d.context.item_info("//Find/**/Number").rect_full
        d.context.mouse_move_to_pos((area.min.x + 40.0, area.max.y + 60.0))
        self.watch.doing = "scrolling by the wheel"
        for _ in range(120):
            d.context.mouse_wheel_y(-float(self.lots.integers(1, 12)))
        self.watch.doing = "dragging the scroll bar"
        inner = next(w for w in imgui.get_current_context().windows if w.was_active and "tablePrimitives" in w.name)
        for _ in range(120):
            imgui.internal.set_scroll_y(inner, float(self.lots.uniform()) * inner.scroll_max.y)
            d.frames(1)
        self.watch.doing = ""

    def _shown(self) -> bool:
        """Whether the rows are there that are asked for, and on the screen."""
        listing = self.table.listing
        return (
            listing is not None
            and listing.order == self.table.order
            and self.app.ui.state(FindState).order == listing.order
        )

    def _wait(self) -> None:
        self.d.wait(lambda: not self.watch.waits, "an answer on the screen", 60.0)

    def _sort(self) -> None:
        for title in SORTED * 4:
            self.watch.doing = "sorting"
            before = self.table.order
            self.watch.wait_for("sorted rows", self._shown, lambda before=before: self.table.order != before)
            self.d.context.item_click(f"//Find/**/{title}")
            self._wait()
            self.watch.doing = ""

    def _filter(self) -> None:
        self.d.context.item_click("//Find/##filterPrimitives")
        for text in TYPED:
            self.watch.doing = "typing a filter"
            for letter in text:
                before = self.table.order
                self.watch.wait_for("filtered rows", self._shown, lambda before=before: self.table.order != before)
                self.d.context.key_chars(letter)
                self._wait()
            self.d.context.key_press(int(imgui.Key.a) | int(imgui.Key.mod_ctrl))
            self.d.context.key_press(imgui.Key.delete)
            self.watch.doing = ""
        self.d.context.key_press(imgui.Key.escape)
        self.table.filter("")
        self._known()

    def _turn(self, what: str) -> None:
        c, end = self.c, time.monotonic() + 5.0
        self.watch.doing = what
        while time.monotonic() < end:
            c.motion.move(navigation.orbit(c.session.camera, (0.0, 0.0, 0.0), 0.01, 0.0, c.motion.world_up))
            self.d.frames(1)
        self.watch.doing = ""
        self.d.settle()

    def _click(self) -> None:
        """At pixels drawn by lot, each of another primitive."""
        d, c = self.d, self.c
        left, top, right, bottom = d.picture_edges()
        hit = np.argwhere(c.frame.primitive >= 0)
        for y, x in hit[self.lots.choice(len(hit), self.clicks, replace=False)].tolist():
            frame = c.frame
            primitive = int(frame.primitive[y, x])
            at = left + (x + 0.5) / frame.width * (right - left), top + (y + 0.5) / frame.height * (bottom - top)
            d.context.mouse_move_to_pos(at)
            d.context.mouse_down(0)

            def seen(primitive: int = primitive) -> bool:
                drawn: Any = self.app.ui.graphics.display._drawn  # frame, options, what the window adds
                return drawn is not None and drawn[2].selected == primitive and primitive in self.watch.rows

            self.watch.doing = "clicking"
            self.watch.wait_for("a click is seen", seen)
            d.context.mouse_up(0)
            self._wait()
            self.watch.doing = ""
            d.pause(0.1)


def measure(triangles: int, size: tuple[int, int], clicks: int) -> dict[str, Any]:
    """What the window took; RuntimeError where the user could not do something."""
    gl_window.first_size = lambda: size
    made = half_a_million(triangles)
    app = App(None, scene=made)
    app.ui.tour.end()
    app.params.app_window_params.restore_previous_geometry = False
    app.controller.settings.change(samples=1)  # else idle pictures go on changing
    watch, failed = Watch(app), []

    def test(context: Any) -> None:
        engine = imgui.test_engine.get_io(hello_imgui.get_imgui_test_engine())
        engine.config_watchdog_warning = engine.config_watchdog_kill_test = LONGEST
        driver = Driver(app, context, Path("."))
        app.params.fps_idling.fps_max = FASTEST_BY_PROCESSOR if app.drawn_by_processor else FASTEST  # as for a user
        try:
            User(app, driver, watch, clicks).play()
        except BaseException:
            failed.append(traceback.format_exc())

    def runner(params: hello_imgui.RunnerParams, add_ons: immapp.AddOnsParams) -> None:
        testing.run(test_function=test, runner_params=params, add_ons_params=add_ons, raise_on_error=False)

    app.run(runner)
    if failed:
        raise RuntimeError(failed[0])
    return {
        "triangles": made.triangle_count,
        "renderer": watch.renderer,
        "frames": dict(watch.frames),
        "answers": dict(watch.answers),
        "most_rows": watch.most_rows,
    }


def quartiles(seconds: list[float]) -> list[str]:
    """Number, quartiles and the largest, in milliseconds."""
    spread = 1e3 * np.percentile(seconds, (25, 50, 75, 100))
    return [str(len(seconds)), *(f"{value:.1f}" for value in spread)]


def _table(title: str, first: str, times: dict[str, list[float]]) -> Table:
    made = Table(title=title, title_justify="left", title_style="bold")
    made.add_column(first)
    for heading in ("number", "1st quartile, ms", "median, ms", "3rd quartile, ms", "longest, ms"):
        made.add_column(heading, justify="right")
    for what, seconds in times.items():
        made.add_row(what, *quartiles(seconds))
    return made


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make table", description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", type=int, default=505_000, help="at least about so many (default: 505000)")
    parser.add_argument("--clicks", type=int, default=60, help="in the picture (default: 60)")
    parser.add_argument("--size", default="1440x900", help="of the window (default: 1440x900)")
    parser.add_argument("--json", type=Path, default=Path("out/table.json"), help="(default: out/table.json)")
    options = parser.parse_args(arguments)
    if not has_display():
        say(f"no window can be timed: {no_display_reason()}")
        return 1
    about = machine()
    width, height = (int(side) for side in options.size.split("x"))
    with tempfile.TemporaryDirectory() as settings:
        os.environ["SHADOWCULL_CONFIG_DIR"] = settings
        try:
            found = measure(options.triangles, (width, height), options.clicks)
        except RuntimeError as error:
            say(error)
            return 1
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({"machine": about, "size": options.size} | found, indent=1) + "\n")
    print_table(_table(f"Frames of the window, {options.size}, {found['triangles']} rows", "while", found["frames"]))
    print_table(_table("Until it is on the screen", "what", found["answers"]))
    print(f"at most {found['most_rows']} rows were drawn in a frame; drawn by {found['renderer']}")
    print(f"{in_words(about)}; all in {options.json}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""The window, opened for `tests.bench.window_times`: a process of its own that times every frame it draws.

    python -m tests.bench.window_server SCENE WxH SECONDS SPAWNED

Once the picture is there at full resolution, the same picture is traced again and again for so many
seconds, then the camera turns for as long, then nothing happens, and the window is closed.  Prints one
line of JSON: what was seen how long after SPAWNED, a `time.time()`, and of each frame what went on, how
many seconds it took until it was on the screen, and for how many its own thread was at work; of all
that went on how many cores other processes had meanwhile; and the seconds of processors that the start took.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from imgui_bundle import hello_imgui

from viewer.state import navigation
from viewer.window.app import App

TURN = 0.01  # radians a frame
STATES = ("starting", "compiling", "opening", "first picture", "tracing", "moving", "at rest", "closing")


def busy() -> float:
    """Seconds that all cores together have been at work since the system's start."""
    user, nice, system, _idle, _waiting, *interrupts = map(int, Path("/proc/stat").read_text().split()[1:8])
    return (user + nice + system + sum(interrupts)) / os.sysconf("SC_CLK_TCK")


class Watch:
    """Hooks into a window's frame: counts, and plays the part of the user."""

    def __init__(self, app: App, seconds: float, spawned: float) -> None:
        self.app, self.c = app, app.controller
        self.seconds, self.spawned = seconds, spawned
        self.state, self.since = "starting", time.perf_counter()
        self.seen: dict[str, float] = {}
        self.worked: dict[str, float] = {}
        self.frames: dict[str, list[tuple[float, float]]] = {state: [] for state in STATES}
        self.renderer = ""
        self.traced: dict[str, int] = dict.fromkeys(STATES, 0)
        self.others: dict[str, float] = {}
        self._mark = self._now()
        self._before = app.before_widgets
        self._began = self._worked = 0.0
        app.params.callbacks.pre_new_frame = self.before
        app.params.callbacks.after_swap = self.after

    def before(self) -> None:
        self._advance(time.perf_counter())
        self._began, self._worked = time.perf_counter(), time.thread_time()
        had = self.c.frame
        self._before()
        self.traced[self.state] += self.c.frame is not had

    def after(self) -> None:
        self.frames[self.state].append((time.perf_counter() - self._began, time.thread_time() - self._worked))
        self._saw("window")
        self.renderer = self.app.ui.graphics.renderer_name
        if self.c.traced is not None and self.app.ui.graphics.display.texture_id is not None:
            self._saw("first picture")
            if self.c.traced.request.divisor == 1 and self.c.traced.whole:
                self._saw("full picture")

    def _now(self) -> tuple[float, float, float]:
        return time.perf_counter(), busy(), time.process_time()

    def _saw(self, what: str) -> None:
        if what not in self.seen:
            self.seen[what] = time.time() - self.spawned
            self.worked[what] = sum(os.times()[:4])

    def _advance(self, now: float) -> None:
        c, state = self.c, self.state
        if "full picture" not in self.seen or c.loader.busy:
            warming, loading = c.loader.warm_up_job is not None, c.loader.load_job is not None
            state = "compiling" if warming else "opening" if loading else "first picture" if c.session.scene else state
        elif state == "tracing" and now - self.since > self.seconds:
            state = "moving"
            c.session.set_pace(keep_tracing=False)
        elif state == "moving" and now - self.since > self.seconds:
            state = "at rest"
        elif state == "at rest":
            hello_imgui.request_refresh()
            if now - self.since > self.seconds:
                state, self.app.params.app_shall_exit = "closing", True
        elif state not in ("tracing", "moving", "closing"):
            state = "tracing"
            c.session.set_pace(keep_tracing=True)
            c.scheduler.trace_again()
        if state != self.state:
            mark = self._now()
            passed, worked, own = (b - a for a, b in zip(self._mark, mark))
            self.others[self.state] = max(0.0, worked - own) / passed
            self.state, self.since, self._mark = state, now, mark
        if state == "moving":
            c.motion.move(navigation.look(c.session.camera, TURN, 0.0, c.motion.world_up))

    def report(self) -> dict[str, Any]:
        return {
            "renderer": self.renderer,
            "seen": self.seen,
            "worked": self.worked,
            "load": os.getloadavg()[0],
            "frames": self.frames,
            "traced": self.traced,
            "others": self.others,
        }


def main() -> int:
    scene, size, seconds, spawned = sys.argv[1:]
    app = App(Path(scene))
    app.ui.tour.end()
    app.controller.settings.change(samples=1)  # at rest nothing is to go on
    width, height = (int(side) for side in size.split("x"))
    geometry = app.params.app_window_params
    geometry.window_geometry.size, geometry.restore_previous_geometry = (width, height), False
    watch = Watch(app, float(seconds), float(spawned))
    code = app.run()
    print(json.dumps(watch.report()), flush=True)
    return code


if __name__ == "__main__":
    sys.exit(main())

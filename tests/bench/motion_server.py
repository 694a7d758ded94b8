"""The window in motion: a process of its own that keeps what it showed, and holds it against the exact pictures.

    python -m tests.bench.motion_server SCENE WxH WAY BURSTS OUT.json

In bursts of some seconds the scene's path is played, or the camera led by a hand, each from another place;
then nothing moves until the picture is whole.  WAY is "parts", how the window works, or "coarse", its
resolution divided until whole frames come in time.  Once the window is closed, some of the pictures that it
showed are compared, pixel by pixel, with the exact picture of their own moment, and what the paper's modes saved
is held against what they save where the same moments are traced as whole frames.
"""

from __future__ import annotations

import json
import sys
import time
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

from tests.viewer.drawn import picture
from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.shading.blocks import TURNS
from tracer.statistics import FrameStatistics
from viewer.services.frame_budget import AT_ONCE, FINER_BELOW, LARGEST_DIVISOR, FrameBudget, Plan, divided
from viewer.state import navigation
from viewer.window.app import App

BURST = 2.0  # seconds of motion
KEPT = 8  # pictures of a burst that are compared, evenly spread
PATIENCE = 60.0  # seconds until a picture is whole
# A hand's motion, recorded with a mouse and at the keys, eight keys a second: radians a second to the right and up,
# and paces a second to the right and forward.  Between them it changes evenly.
HAND = (
    (0.0, 0.0, 0.0, 0.0), (0.31, -0.02, 0.0, 0.1), (0.82, 0.05, 0.0, 0.3), (1.1, 0.12, 0.0, 0.3), (0.74, 0.2, 0.0, 0.3),
    (0.22, 0.11, 0.0, 0.3), (-0.35, -0.06, 0.2, 0.3), (-0.91, -0.22, 0.3, 0.2), (-1.24, -0.15, 0.3, 0.1),
    (-0.66, 0.0, 0.3, 0.3), (-0.18, 0.08, 0.1, 0.4), (0.4, 0.1, -0.2, 0.4), (0.95, -0.04, -0.3, 0.3),
    (0.6, -0.12, -0.3, 0.2), (0.25, -0.06, -0.2, 0.2), (0.1, 0.0, 0.0, 0.1), (0.0, 0.0, 0.0, 0.0),
)  # fmt: skip


class CoarserInMotion(FrameBudget):
    """The way that frames were made quick before: whole ones, at the finest resolution that comes in time."""

    def forget(self) -> None:
        super().forget()
        self._each, self._divided_by = 0.0, 2

    def observe(self, statistics: FrameStatistics, pixels: int, lamp_samples: int = 1) -> None:
        cost = statistics.seconds / max(pixels, 1)
        self._each = self._each + 0.4 * (cost - self._each) if self._each else cost

    def plan(
        self,
        width: int,
        height: int,
        seconds: float,
        coarse: bool = True,
        playing: bool = True,
        lamp_samples: int = 1,
    ) -> Plan:
        if not coarse:
            return AT_ONCE
        for divisor in range(1, LARGEST_DIVISOR + 1):
            w, h = divided(width, height, divisor)
            if self._each * w * h <= (FINER_BELOW * seconds if divisor < self._divided_by else seconds):
                break
        self._divided_by = divisor
        return Plan(divisor, AT_ONCE.parts)


WAYS = {"parts": FrameBudget, "coarse": CoarserInMotion}


@dataclass
class Burst:
    """What happened in and after some seconds of motion: pictures shown, the window's own frames (seconds), how long
    after the last motion the picture was whole, and what a whole frame takes there."""

    kind: str
    shown: list[Frame] = field(default_factory=list)
    frames: list[float] = field(default_factory=list)
    seconds: float = 0.0
    settled: float = 0.0
    full: float = 0.0


class Script:
    """Plays the part of the user, hooked into the window's frame."""

    def __init__(self, app: App, bursts: int) -> None:
        self.app, self.c = app, app.controller
        self.todo = [Burst("path" if n % 2 == 0 else "hand") for n in range(bursts)]
        self.count, self.done = bursts, []
        self.burst: Burst | None = None
        self.since = self.last_motion = self.began = time.perf_counter()
        self.state = "starting"
        self._before = app.before_widgets
        app.params.callbacks.pre_new_frame = self.before
        app.params.callbacks.after_swap = self.after

    def before(self) -> None:
        self.began = time.perf_counter()
        self._lead(self.began)
        had = self.c.traced
        self._before()
        if self.c.notices.newest_fault is not None:  # the window lives on, but what it shows is worth nothing
            raise RuntimeError(self.c.notices.newest_fault.as_text)
        new = self.c.traced
        if new is had or new is None or self.burst is None:
            return
        if self.state == "moving" and (had is None or had.request is not new.request):
            self.burst.shown.append(new.frame)
        whole = new.whole and new.request.divisor == 1
        if self.state == "settling" and whole and new.request.camera == self.c.session.camera:
            self.burst.settled = time.perf_counter() - self.last_motion
            self.state, self.since = "whole", time.perf_counter()
        elif self.state == "whole" and new.whole and new.request.parts == AT_ONCE.parts:
            self.burst.full = new.frame.statistics.seconds

    def after(self) -> None:
        if self.burst is not None and self.state == "moving":
            self.burst.frames.append(time.perf_counter() - self.began)

    def _lead(self, now: float) -> None:
        c = self.c
        if self.state == "starting":
            if c.traced is not None and c.traced.whole and not c.active and c.loader.warm_up_job is None:
                self._next(now)
        elif self.state == "moving":
            if now - self.since < BURST:
                self.last_motion = now
                if self.burst is not None and self.burst.kind == "hand":
                    self._by_hand(now - self.since)
            else:
                assert self.burst is not None
                self.burst.seconds, self.state = now - self.since, "settling"
                c.session.playing = False
        elif self.state == "settling":
            if now - self.last_motion > PATIENCE:
                raise RuntimeError("the picture does not become whole")
        elif self.state == "whole":
            if self.burst is not None and self.burst.full == 0.0 and not c.active:
                c.session.set_pace(progressive=False)  # a whole frame, all at once
                c.scheduler.trace_again()
            elif self.burst is not None and self.burst.full > 0.0 and not c.active:
                c.session.set_pace(progressive=True)
                self.done.append(self.burst)
                self._next(now)

    def _next(self, now: float) -> None:
        c = self.c
        if not self.todo:
            self.state, self.app.params.app_shall_exit = "closing", True
            return
        self.burst, self.state = self.todo.pop(0), "moving"
        scene = c.session.scene
        assert scene is not None
        c.session.go_to_frame(round((len(self.done) + 0.3) / self.count * (scene.frames - 1)))
        c.motion.follow_path(True)
        if self.burst.kind == "hand":
            self._start, self._at = c.session.camera, 0.0
        else:
            c.session.playing = True
        self.since = self.last_motion = now

    def _by_hand(self, at: float) -> None:
        """Lead the camera on to where the hand has it so many seconds after it began."""
        step, self._at = at - self._at, at
        place = min(at / BURST, 1.0) * (len(HAND) - 1)
        turn, tilt, right, forward = (np.interp(place, range(len(HAND)), column) for column in zip(*HAND))
        up, pace = self.c.motion.world_up, self.c.motion.pace
        camera = navigation.look(self.c.session.camera, turn * step, tilt * step, up)
        self.c.motion.move(navigation.fly(camera, right * pace * step, 0.0, forward * pace * step, up))


def compared(burst: Burst, size: tuple[int, int], renderer: Renderer) -> list[dict[str, float]]:
    """How like the exact picture of their moment some of a burst's pictures are."""
    kept = [burst.shown[round(n)] for n in np.linspace(1, len(burst.shown) - 1, min(KEPT, len(burst.shown) - 1))]
    found, exactly = [], {"width": size[0], "height": size[1], "method": "none", "modes": False}
    for frame in kept:
        renderer.settings = replace(frame.settings, **exactly)
        exact = picture(renderer.render(frame.time, frame.camera))
        shown = on_screen(picture(frame), size)
        found.append(
            {
                "ssim": float(structural_similarity(exact, shown, channel_axis=2)),
                "psnr": float(min(peak_signal_noise_ratio(exact, shown) if (exact != shown).any() else 99.0, 99.0)),
                "part": frame.statistics.part,
                "divisor": size[0] / frame.width,
            }
        )
    return found


def savings(burst: Burst, size: tuple[int, int], renderer: Renderer) -> dict[str, float]:
    """What culling by the paper's modes saved of the shadow rays of a burst's pictures, as the window showed them, and
    what it saves where each of their moments is traced as a whole, as `bench` does, both beginning without modes; and
    the shares of wrong answers."""
    whole, parts = Counts(), Counts()
    renderer.settings = settings = replace(burst.shown[0].settings, verify=True, method="paper", samples=1)
    renderer.reset_modes()
    for frame in burst.shown:
        renderer.settings = replace(settings, width=size[0], height=size[1])
        whole.add(renderer.render(frame.time, frame.camera))
    renderer.reset_modes()
    for frame in burst.shown:
        renderer.settings = replace(settings, width=frame.width, height=frame.height)
        part = max(0.5, round(32 * frame.statistics.part) / 2)
        with closing(renderer.refine(frame.time, frame.camera, parts=sorted({part, TURNS}))) as refining:
            parts.add(next(refining))
    shown = Counts()
    for frame in burst.shown:
        shown.add(frame)
    return {
        "saved": shown.saved_share,
        "saved_verified": parts.saved_share,
        "saved_whole": whole.saved_share,
        "wrong": parts.wrong_share,
        "wrong_whole": whole.wrong_share,
    }


@dataclass
class Counts:
    """Shadow rays of some frames."""

    due: int = 0
    saved: int = 0
    wrong: int = 0

    def add(self, frame: Frame) -> None:
        shadow = frame.statistics.shadow
        self.due += shadow.due
        self.saved += shadow.culled + shadow.dynamic_only
        self.wrong += shadow.wrong

    @property
    def saved_share(self) -> float:
        return self.saved / max(self.due, 1)

    @property
    def wrong_share(self) -> float:
        return self.wrong / max(self.due, 1)


def on_screen(pixels: NDArray[np.uint8], size: tuple[int, int]) -> NDArray[np.uint8]:
    """As the window shows a picture that is smaller than its place: smoothly enlarged."""
    if pixels.shape[1::-1] == size:
        return pixels
    return np.asarray(Image.fromarray(pixels).resize(size, Image.Resampling.BILINEAR))


def main() -> int:
    path, window, way, bursts, out = sys.argv[1:]
    app = App(Path(path))
    app.controller.scheduler.budget = WAYS[way]()
    app.controller.settings.change(samples=1, method="paper")
    app.ui.tour.end()
    width, height = (int(side) for side in window.split("x"))
    geometry = app.params.app_window_params
    geometry.window_geometry.size, geometry.restore_previous_geometry = (width, height), False
    script = Script(app, int(bursts))
    code = app.run()
    size, scene = app.controller.scheduler.inputs.size, app.controller.session.scene
    assert scene is not None
    renderer = Renderer(scene, app.controller.session.settings)
    told = []
    for burst in script.done:
        about = {"kind": burst.kind, "seconds": burst.seconds, "pictures": len(burst.shown), "window": burst.frames}
        about |= {"settled": burst.settled, "full": burst.full}
        told.append(about | {"compared": compared(burst, size, renderer), **savings(burst, size, renderer)})
    Path(out).write_text(json.dumps({"size": size, "bursts": told}))
    return code


if __name__ == "__main__":
    sys.exit(main())

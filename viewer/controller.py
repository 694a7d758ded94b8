"""Between the widgets and the threads: what happens when something was asked for.

The controller owns the session, the render thread and the background jobs.  Panels and commands
call it; the window calls `tick` once per frame.  It knows neither widgets nor GL, so that tests
can drive it without a window.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from tracer.compilation import warm_up
from tracer.renderer import Frame, Settings
from tracer.scene.load import scene_info
from tracer.scene.model import Camera, Scene
from viewer import capture, navigation, opening
from viewer.history import History
from viewer.jobs import Job
from viewer.picking import Pick, pick, refreshed
from viewer.preferences import Preferences, default_screenshot_folder, save_preferences
from viewer.render_thread import RenderRequest, RenderThread, Traced
from viewer.resolution import ResolutionControl, divided
from viewer.session import Session, Snapshot
from viewer.views import View

AT_REST_AFTER = 0.25
GLIDE_SECONDS = 0.35
LONGEST_STEP = 0.25
INFO_SECONDS = 6.0


@dataclass(frozen=True)
class Message:
    """One line for the status bar."""

    text: str
    error: bool
    at: float


@dataclass(frozen=True)
class Glide:
    """A camera on its way to another place."""

    start: Camera
    end: Camera
    began: float


class Controller:
    """See the module.  `wake` makes the window draw a frame soon; it may be called from any thread."""

    def __init__(self, preferences: Preferences, wake: Callable[[], None] = lambda: None) -> None:
        self.preferences = preferences
        self.session = Session(settings=_settings_from(preferences), view=_view_from(preferences))
        self.wake = wake
        self.render = RenderThread(lambda: self.wake())
        self.resolution = ResolutionControl()
        self.history = History()
        self.traced: Traced | None = None
        self.info: dict[str, Any] = {}
        self.selected: Pick | None = None
        self.hovered: tuple[float, float] | None = None
        self.message: Message | None = None
        self.warm_up_job: Job[None] | None = None
        self.load_job: Job[opening.Opened] | None = None
        self.drawn_seconds = 0.0
        self.size = (0, 0)
        self._saving: list[Job[Path]] = []
        self._abandoned: list[Job] = []
        self._restore_after_load: Snapshot | None = None
        self._glide: Glide | None = None
        self._moving_until = 0.0
        self._serial = 0
        self._last_request: RenderRequest | None = None
        self._last_tick = time.monotonic()

    # --- the frame -------------------------------------------------------------------------------

    def tick(self, size: tuple[int, int]) -> Frame | None:
        """One step of everything: `size` is what the picture's window has room for, in pixels (0 if hidden).

        Returns the frame that has just come, if one has."""
        now = time.monotonic()
        step, self._last_tick = min(now - self._last_tick, LONGEST_STEP), now
        if size != self.size:
            self.size = size
            self.moved()
        self._follow_jobs()
        frame = self._take_frame()
        self._pass_time(step)
        self._follow_glide(now)
        self._request(now)
        return frame

    @property
    def frame(self) -> Frame | None:
        """The newest traced frame."""
        return self.traced.frame if self.traced is not None else None

    @property
    def moving(self) -> bool:
        """Whether frames should come fast rather than fine."""
        real_time = self.session.playing and not self.preferences.every_frame
        return real_time or self._glide is not None or time.monotonic() < self._moving_until

    @property
    def active(self) -> bool:
        """Whether the window must not doze."""
        jobs = (self.warm_up_job, self.load_job, *self._saving)
        return self.moving or self.session.playing or self.render.busy or any(j is not None for j in jobs)

    def _follow_jobs(self) -> None:
        if self.warm_up_job is not None and self.warm_up_job.done:
            job, self.warm_up_job = self.warm_up_job, None
            if job.error:
                self.say(f"kernels not compiled: {job.error}", error=True)
        if self.load_job is not None and self.load_job.done:
            load, self.load_job = self.load_job, None
            self._loaded(load)
        for save in [s for s in self._saving if s.done]:
            self._saving.remove(save)
            self.say(save.error or f"saved {save.result}", error=save.error is not None)
        self._abandoned = [job for job in self._abandoned if not job.done]

    def _take_frame(self) -> Frame | None:
        error = self.render.take_error()
        if error:
            self.say(error, error=True)
            self.session.playing = False
        traced = self.render.take()
        if traced is None:
            return None
        self.traced = traced
        frame = traced.frame
        self.resolution.observe(frame.statistics.seconds, frame.width * frame.height)
        self.history.add(frame, self.drawn_seconds)
        if self.selected is not None:
            self.selected = refreshed(self.selected, frame)
        if self.session.playing and self.preferences.every_frame:
            if traced.request.time == self.session.time:
                self.session.advance_frame(self.preferences.loop)
        elif self.preferences.keep_tracing and not self.moving:
            self._serial += 1
        return frame

    def _pass_time(self, step: float) -> None:
        if self.session.playing and not self.preferences.every_frame:
            self.session.advance(step * self.preferences.playback_rate, self.preferences.loop)

    def _follow_glide(self, now: float) -> None:
        if self._glide is not None:
            t = (now - self._glide.began) / GLIDE_SECONDS
            self.session.move(navigation.blend(self._glide.start, self._glide.end, t))
            if t >= 1.0:
                self._glide = None

    def _request(self, now: float) -> None:
        """Ask for what should be seen now, unless it has been asked for, or is there."""
        width, height = self.full_size
        if self.session.scene is None or width < 1 or height < 1:
            return
        moving = self.moving
        coarse = moving and self.preferences.dynamic_resolution
        divisor = self.resolution.choose(width, height, self.preferences.target_fps) if coarse else 1
        width, height = divided(width, height, divisor)
        settings = replace(self.session.settings, width=width, height=height)
        wanted = RenderRequest(self.session.time, self.session.camera, settings, moving, divisor, self._serial)
        if wanted == self._last_request or self._same_picture(wanted):
            return
        self._last_request = wanted
        self.render.submit(wanted)

    def _same_picture(self, wanted: RenderRequest) -> bool:
        if self.traced is None or self.render.busy:
            return False
        return replace(self.traced.request, interactive=wanted.interactive) == wanted

    @property
    def full_size(self) -> tuple[int, int]:
        """The resolution at rest: the window's, or the fixed one (0, 0 while there is nowhere to show it)."""
        if self.preferences.fixed_resolution and min(self.size) > 0:
            return self.preferences.fixed_width, self.preferences.fixed_height
        return self.size

    @property
    def traced_full_size(self) -> tuple[int, int]:
        """The size whose aspect the newest frame has: its own, or what it is a coarser version of."""
        if self.frame is None:
            return 1, 1
        divisor = self.traced.request.divisor if self.traced is not None else 1
        return self.frame.width * divisor, self.frame.height * divisor

    @property
    def view_title(self) -> str:
        """The view, and the light where it shows one."""
        view = self.session.view
        return f"{view.title}, light {self.session.light}" if view is View.SHADOW else view.title

    # --- messages and selection ------------------------------------------------------------------

    def say(self, text: str, error: bool = False) -> None:
        """Show one line in the status bar: a notice for some seconds, an error until the next."""
        self.message = Message(" ".join(text.split()), error, time.monotonic())
        self.wake()

    @property
    def current_message(self) -> Message | None:
        if self.message is not None and not self.message.error and time.monotonic() - self.message.at > INFO_SECONDS:
            self.message = None
        return self.message

    def pick(self, at: tuple[float, float] | None) -> Pick | None:
        """What lies under a point of the picture."""
        if at is None or self.frame is None or self.session.scene is None:
            return None
        return pick(self.frame, self.session.scene, *at)

    def select(self, at: tuple[float, float]) -> None:
        """Keep what is under a point of the picture in view of the inspector; nothing there: forget it."""
        found = self.pick(at)
        self.selected = found if found is not None and found.primitive >= 0 else None

    # --- opening ---------------------------------------------------------------------------------

    def start(self, path: Path | None) -> None:
        """Compile or load the kernels in the background, and open a first scene meanwhile."""
        self.warm_up_job = Job("Preparing kernels", warm_up, lambda: self.wake())
        if path is not None:
            self.open(path)

    def open(self, path: Path) -> None:
        """Open a scene, or restore what a captured picture shows; anything else is one line."""
        refused = opening.refusal(path)
        if refused:
            self.say(refused, error=True)
        elif opening.is_capture(path):
            self.restore_capture(path)
        else:
            self._load(path, None)

    def restore_capture(self, path: Path) -> None:
        """Bring back scene, camera, time, settings and view of a captured picture."""
        try:
            snapshot = capture.read(path)
        except capture.CaptureError as error:
            self.say(str(error), error=True)
            return
        scene = opening.find_scene(snapshot.scene, path)
        if scene is None:
            self.say(f"{path.name}: its scene is gone: {snapshot.scene}", error=True)
        elif self.session.scene is not None and _same_file(scene, self.session.scene):
            self.restore(snapshot)
            self.say(f"restored {path.name}")
        else:
            self._load(scene, snapshot)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of the open scene."""
        self._glide = None
        self.session.restore(snapshot)
        self._store_settings()
        self.preferences.view = self.session.view.value

    def reload(self) -> None:
        """Read the scene's file again and keep the place."""
        if self.session.scene is not None:
            self._load(Path(self.session.scene.path), self.session.snapshot())

    def cancel_load(self) -> None:
        """Give up the load that is under way; the scene that is open stays."""
        if self.load_job is not None:
            self.load_job.cancel()

    def _load(self, path: Path, then: Snapshot | None) -> None:
        if self.load_job is not None:
            self.load_job.cancel()
            self._abandoned.append(self.load_job)
        self._restore_after_load = then
        settings = self.session.settings

        def ready() -> bool:
            return self.warm_up_job is None or self.warm_up_job.done

        self.load_job = Job(
            f"Loading {path.name}", lambda p: opening.open_scene(path, settings, ready, p), lambda: self.wake()
        )

    def _loaded(self, job: Job[opening.Opened]) -> None:
        if job.cancelled:
            self.say("loading cancelled" + (": the scene that was open stays" if self.session.scene else ""))
        elif job.error is not None or job.result is None:
            self.say(job.error or "nothing was loaded", error=True)
        else:
            opened = job.result
            self._show(opened)
            count = len(opened.scene.warnings)
            warned = f", {count} warning{'s' * (count > 1)}" if count else ""
            self.say(f"{opened.scene.path.name} opened in {opened.seconds:.1f} s{warned}")

    def _show(self, opened: opening.Opened) -> None:
        self.session.open(opened.scene)
        self.info = scene_info(opened.scene)
        self.render.use(opened.renderer)
        self.history.clear()
        self.resolution.forget()
        self.traced = self.selected = self._glide = self._last_request = None
        if self._restore_after_load is not None:
            self.restore(self._restore_after_load)
            self._restore_after_load = None
        self.preferences.remember_scene(Path(opened.scene.path).absolute())
        self.save_preferences()

    # --- settings --------------------------------------------------------------------------------

    def change(self, **changes: Any) -> None:
        """Change fields of `tracer.Settings`; a value that is no good is one line and changes nothing."""
        try:
            settings = replace(self.session.settings, **changes)
            settings.validated()
        except ValueError as error:
            self.say(str(error), error=True)
            return
        self.session.settings = settings
        self._store_settings()

    def set_view(self, view: View) -> None:
        self.session.view = view
        self.preferences.view = view.value

    def set_light(self, light: int) -> None:
        """Choose the light of the shadow view; counts around."""
        lights = len(self.session.scene.lights) if self.session.scene is not None else 0
        self.session.light = light % lights if lights else 0

    def toggle_culling(self) -> None:
        self.change(method="none" if self.session.settings.method != "none" else "paper")

    def reset_modes(self) -> None:
        """Forget all that was learnt about shadows, and look again."""
        self.render.reset_modes()
        self.trace_again()

    def trace_again(self) -> None:
        """Trace the same frame once more: the modes may have learnt from the last."""
        self._serial += 1

    def _store_settings(self) -> None:
        s, p = self.session.settings, self.preferences
        p.culling, p.symmetric, p.zoom_factor = s.method != "none", s.symmetric, s.zoom_factor
        p.depth, p.samples, p.threads, p.verify = s.depth, s.samples, s.threads, s.verify

    # --- camera and time -------------------------------------------------------------------------

    @property
    def world_up(self) -> navigation.Vector:
        scene = self.session.scene
        return navigation.world_up(scene.camera) if scene is not None else np.array([0.0, 1.0, 0.0])

    @property
    def pace(self) -> float:
        """World units per second at speed 1."""
        low, high = self.info.get("bounds") or ((0.0, 0.0, 0.0), (8.0, 8.0, 8.0))
        return navigation.pace(low, high)

    def moved(self) -> None:
        """Note that the picture is changing under the user's hand: coarse frames for a moment."""
        self._moving_until = time.monotonic() + AT_REST_AFTER

    def move(self, camera: Camera) -> None:
        """Take the camera in hand and put it there."""
        self._glide = None
        self.session.move(camera)
        self.moved()

    def glide(self, camera: Camera) -> None:
        """Move the camera there in a moment's time."""
        self._glide = Glide(self.session.camera, camera, time.monotonic())

    def follow_path(self, follow: bool) -> None:
        """Put the camera on the scene's own path, or take it off where it is."""
        self._glide = None
        self.session.free_camera = None if follow else self.session.camera

    def reset_camera(self) -> None:
        """Back to the scene's own camera, now."""
        self.follow_path(True)

    def toggle_play(self) -> None:
        if not self.session.animated:
            self.say("this scene has no animation")
            return
        scene = self.session.scene
        if not self.session.playing and scene is not None and self.session.time >= scene.time_range[1]:
            self.session.go_to_frame(0)
        self.session.playing = not self.session.playing

    def step(self, frames: int) -> None:
        """Stop, and go so many frames on (or back)."""
        self.session.playing = False
        self.session.go_to_frame(self.session.frame + frames)

    # --- bookmarks and captures ------------------------------------------------------------------

    @property
    def bookmarks(self) -> list[dict]:
        """The bookmarks of the open scene: {"name": ..., "state": a snapshot's JSON}."""
        if self.session.scene is None:
            return []
        return self.preferences.bookmarks.setdefault(str(Path(self.session.scene.path).absolute()), [])

    def add_bookmark(self, name: str = "") -> None:
        if self.session.scene is None:
            return
        name = name.strip() or f"frame {self.session.frame}"
        self.bookmarks.append({"name": name, "state": self.session.snapshot().to_json()})
        self.save_preferences()
        self.say(f"bookmarked as {name!r}")

    def go_to_bookmark(self, index: int) -> None:
        """Glide to a bookmark and take over its time and view; settings stay as they are."""
        try:
            snapshot = Snapshot.from_json(self.bookmarks[index]["state"])
        except (ValueError, KeyError, TypeError, IndexError) as error:
            self.say(f"this bookmark is damaged: {error}", error=True)
            return
        start = self.session.camera
        self.session.restore(replace(snapshot, settings={}))
        if not snapshot.follow:
            self._glide = Glide(start, snapshot.camera, time.monotonic())

    def capture(self, pixels: np.ndarray | None) -> None:
        """Save a picture, (h, w, 3) uint8, under the user's template; the file is written on a thread."""
        frame = self.frame
        if frame is None or pixels is None or self.session.scene is None:
            self.say("there is no picture to save yet", error=True)
            return
        session, preferences = self.session, self.preferences
        height, width = pixels.shape[:2]
        values = {
            "scene": session.scene.path.stem if session.scene else "",
            "view": session.view.value,
            "frame": session.frame,
            "seconds": frame.time,
            "method": frame.settings.method,
            "light": session.light,
            "width": width,
            "height": height,
        }
        snapshot = replace(session.snapshot(), time=frame.time, camera=frame.camera)
        text = capture.metadata(snapshot, session.frame, (frame.width, frame.height), frame.statistics.to_dict())
        folder = Path(preferences.screenshot_folder or default_screenshot_folder()).expanduser()
        try:
            name = capture.file_name(preferences.screenshot_template, values)
        except capture.CaptureError as error:
            self.say(str(error), error=True)
            return
        self._saving.append(Job("Saving", lambda _: capture.save(pixels, folder, name, text), lambda: self.wake()))

    # --- the end ---------------------------------------------------------------------------------

    def save_preferences(self) -> None:
        error = save_preferences(self.preferences)
        if error:
            self.say(error, error=True)

    def close(self, timeout: float = 30.0) -> bool:
        """Stop everything, finish writing pictures and save the preferences; false if something would not stop."""
        deadline = time.monotonic() + timeout
        jobs = [job for job in (self.warm_up_job, self.load_job, *self._abandoned) if job is not None]
        for job in jobs:
            job.cancel()
        stopped = self.render.close(timeout)
        for job in (*self._saving, *jobs):
            stopped &= job.join(max(0.0, deadline - time.monotonic()))
        self.save_preferences()
        return stopped


def _settings_from(p: Preferences) -> Settings:
    method = "paper" if p.culling else "none"
    common = {"symmetric": p.symmetric, "zoom_factor": p.zoom_factor, "depth": p.depth, "samples": p.samples}
    settings = replace(Settings(), method=method, threads=p.threads, verify=p.verify, **common)  # type: ignore[arg-type]
    try:
        settings.validated()
    except ValueError:
        return Settings()
    return settings


def _view_from(p: Preferences) -> View:
    return View(p.view) if p.view in set(View) else View.COLOR


def _same_file(path: Path, scene: Scene) -> bool:
    try:
        return path.samefile(scene.path)
    except OSError:
        return False

"""Opens scenes and saved pictures beside the window, reads a scene again when its files change, and compiles kernels.

While a scene is read the one that is open stays usable, and it stays open if the reading fails or
is cancelled.  A second request to open takes the place of the first."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from tracer.compiling.compilation import can_draw, compiled_before, make_ready, ready_for, warm_up
from tracer.method import title_of
from tracer.renderer import Renderer, Settings
from tracer.scene.files import Stamp, noting
from tracer.scene.load import load_visible_scene, scene_info
from tracer.scene.mesh_options import IN_STUDIO, MeshOptions
from tracer.scene.model import Progress, Scene
from tracer.scene.studio import model_bounds, up_in_studio
from viewer.output import capture
from viewer.services.jobs import Job
from viewer.services.scene_files import FileWatch, find_scene, is_capture, refusal
from viewer.state.draw_options import AROUND
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.views import paint

Built = tuple[Renderer, dict[str, Any]]
"""The renderer that holds a scene's trees, and what `scene_info` says of the scene."""


def build(scene: Scene, settings: Settings, progress: Progress) -> Built:
    """Build the trees of a scene.  Raises SceneError or Cancelled."""
    lights, accelerator = len(scene.lights), settings.accelerator
    if not can_draw(lights, accelerator):  # many lights need wider words, and kernels for them
        warm_up(progress, lights, accelerator)
    renderer, info, model = Renderer(scene, settings, progress), scene_info(scene), model_bounds(scene)
    if model is not None:  # what the camera goes around is the model, not the floor
        info["bounds"] = model.tolist()
    return renderer, info


@dataclass
class Arrival:
    """What is opened: the renderer of a scene, None where it is open already, and what `scene_info` says of it; the
    place in it to go to, if not where it begins; and one line that says so.  `again` says that it is the scene that was
    open, read again, and what of it had `changed` where this is why: the place stays.  `meshes` says how meshes are
    read, and `files` which were come to."""

    meshes: MeshOptions = IN_STUDIO
    place: ViewState | None = None
    again: bool = False
    changed: str = ""
    files: dict[Path, Stamp] = field(default_factory=dict)
    renderer: Renderer | None = None
    info: dict[str, Any] = field(default_factory=dict)
    text: str = ""
    began: float = field(default_factory=time.perf_counter)


class SceneLoader:
    """Reads scenes, and runs `build`, on threads; `take_finished` hands out what has come."""

    def __init__(
        self, session: Session, preferences: Preferences, notices: Notices,
        ask_first: Callable[[str, Callable[[], None]], None], wake: Callable[[], None] = lambda: None,
    ) -> None:  # fmt: skip
        """`ask_first(name, go_on)` calls `go_on` at once, or when the user agrees to open what is called so."""
        self._session, self._preferences, self._notices = session, preferences, notices
        self._ask_first, self._wake = ask_first, wake
        self.warm_up_job: Job[None] | None = None
        self.method_job: Job[None] | None = None
        self.compiles = False  # whether this is a first start, whose kernels are to be compiled
        self.folders: tuple[Path, ...] = ()  # besides a scene's own, that it may read files from
        self.meshes = IN_STUDIO  # how the next mesh is read
        self.watch = FileWatch()  # of what the newest scene was read from, or what was missed
        self.load_job: Job[Built] | None = None
        self._coming = Arrival()  # of that job
        self._cancelled: list[Job] = []  # some end late, as within a library that reads a mesh
        self._restored: Arrival | None = None
        self._given: dict[str, Any] = {}  # settings from the command line, for what is opened first

    @property
    def busy(self) -> bool:
        return not (self.load_job is None and self._restored is None and self.warm_up_job is None)

    def start(self, settings: Mapping[str, Any], folders: Sequence[Path] = (), meshes: MeshOptions = IN_STUDIO) -> None:
        """Compile or load the kernels in the background; a first scene is opened meanwhile.

        `settings` hold for what is opened first, also where a saved place in it has others.  All scenes may read files
        from `folders` besides their own. `meshes` says how meshes are read; which way is up holds for the first."""
        self.folders, self.meshes = tuple(folders), meshes
        self._given = dict(settings)
        self._session.set_settings(**self._given)
        self.compiles = not compiled_before()
        title = "Compiling the tracer (first start only)" if self.compiles else "Loading the tracer"
        self.warm_up_job = Job(title, _warm_up, self._wake)

    def compile_method(self) -> None:
        """Compile in the background what the chosen method has of its own, the first time that it is chosen."""
        if self.method_job is not None and self.method_job.done:
            job, self.method_job = self.method_job, None
            self._report(job, f"{job.title} failed: ")
        scene, settings = self._session.scene, self._session.settings
        if scene is None or self.method_job is not None or not can_draw(len(scene.lights), settings.accelerator):
            return
        what = settings.method, len(scene.lights), settings.accelerator
        if not ready_for(*what):
            title = f"compiling the kernels of {title_of(settings.method)}"
            self.method_job = Job(title, partial(make_ready, *what), self._wake)

    def _report(self, job: Job[Any], before: str = "", after: str = "") -> None:
        """Say why a job has failed, if it has."""
        if job.failure is not None:
            self._notices.report(replace(job.failure, text=f"{before}{job.failure.text}{after}"))

    # --- what is opened ---------------------------------------------------------------------------

    def take(self, scene: Scene) -> None:
        """Show a scene that a script has loaded, or made."""
        self._given = {}
        up = up_in_studio(scene)
        meshes = MeshOptions(up is not None, up)  # as far as it shows how it was read
        self._start(f"Opening {scene.path.name}", lambda progress: scene, Arrival(meshes))

    def open(self, path: Path) -> None:
        """Open a scene, or restore what a saved picture shows; anything else is one line."""
        refused = refusal(path)
        if refused:
            self._notices.say(refused, error=True)
        elif is_capture(path):
            self._ask_first(path.name, lambda: self._restore_capture(path))
        else:
            self._ask_first(path.name, lambda: self._begin(path))

    def reload(self) -> None:
        """Read the scene's file again and keep the place."""
        if self._session.scene is not None:
            path = Path(self._session.scene.path)
            self._ask_first(f"{path.name} again", lambda: self._begin(path, again=True))

    def reload_changed(self, allowed: bool) -> None:
        """Read the scene again where a file that it was read from has changed; once in each frame of the window."""
        allowed = allowed and self._preferences.watch_scene and self.load_job is None
        if allowed and self._session.scene is not None and (changed := self.watch.changed()):
            self._begin(Path(self._session.scene.path), again=True, changed=changed)

    def read_as(self, meshes: MeshOptions) -> None:
        """Read the mesh that is open in another way, and look at it from its first camera.

        Whether it gets a studio holds for what is opened after it too."""
        if self._session.scene is not None:
            path = Path(self._session.scene.path)

            def go_on() -> None:
                self.meshes = replace(self.meshes, studio=meshes.studio)
                self._begin(path, meshes=meshes)

            self._ask_first(f"{path.name} again", go_on)

    def _restore_capture(self, path: Path) -> None:
        """Bring back scene, camera, time, settings and view of a saved picture."""
        session = self._session
        try:
            state = self._as_here(capture.read(path))
        except capture.CaptureError as error:
            self._notices.say(str(error), error=True)
            return
        found, scene = find_scene(state.scene, path), session.scene
        if found is None:
            self._notices.say(f"{path.name}: its scene was not found: {state.scene}", error=True)
        elif (
            scene is None
            or self.load_job is not None
            or state.meshes != session.state.meshes
            or session.state.scene != str(found.absolute())
        ):
            self._begin(found, state)
        else:
            self._restored = Arrival(place=state, text=f"restored {path.name}")
            self._wake()

    def _as_here(self, state: ViewState) -> ViewState:
        """A state from a picture, with what the window shows around pictures, and not in them, as it is here."""
        here = self._session.state
        around = {name: getattr(here.draw, name) for name in (*AROUND, "magnified")}
        return replace(state, pace=here.pace).with_draw(**around)

    def _begin(
        self, path: Path, place: ViewState | None = None, again: bool = False, meshes: MeshOptions | None = None,
        changed: str = "",
    ) -> None:  # fmt: skip
        """Read a scene in the place of what is being read now."""
        if place is not None:
            place = place.with_settings(**self._given)
        self._given = {}
        if meshes is None and (place is not None or again):
            meshes = (place or self._session.state).meshes
        elif meshes is None:
            meshes, self.meshes = self.meshes, replace(self.meshes, up=None)
        coming = Arrival(meshes.of_file(path), place, again, changed)

        def read(progress: Progress) -> Scene:
            # A scene of a million pieces has no circles of objects, and Python's search for them would stop the window
            # for up to a second each time.
            gc.disable()
            try:
                with noting(coming.files):
                    return load_visible_scene(path, progress, self.folders, coming.meshes)
            finally:
                gc.enable()

        self._start(f"Loading {path.name}", read, coming)

    def _start(self, title: str, read: Callable[[Progress], Scene], coming: Arrival) -> None:
        """Read a scene on a thread, and open it."""
        self._give_up()
        settings, kernels = self._session.settings, self.warm_up_job

        def work(progress: Progress) -> Built:
            scene = read(progress)
            while not (kernels is None or kernels.done or can_draw()):
                progress(f"{scene.path.name} is read; waiting for the tracer", 1.0)
                time.sleep(0.02)
            return build(scene, settings, progress)

        self.load_job, self._coming = Job(title, work, self._wake), coming

    def cancel(self) -> None:
        """Give up the load that is under way; the scene that is open stays."""
        if self.load_job is not None:
            self._give_up()
            stays = "; the open scene stays" if self._session.scene is not None else ""
            self._notices.say(f"loading cancelled{stays}")

    def _give_up(self) -> None:
        if self.load_job is not None:
            self.load_job.cancel()
            self._cancelled.append(self.load_job)
            self.load_job, self._coming = None, Arrival()

    def close(self) -> list[Job]:
        """Ask everything to stop; returns the jobs, to be waited for."""
        jobs = [job for job in (self.warm_up_job, self.method_job, self.load_job, *self._cancelled) if job is not None]
        for job in jobs:
            job.cancel()
        return jobs

    # --- what has come ----------------------------------------------------------------------------

    def take_finished(self) -> Arrival | None:
        """Take up what the jobs have finished; returns what has been opened, once."""
        self._cancelled = [job for job in self._cancelled if not job.done]
        if self.warm_up_job is not None and self.warm_up_job.done:
            job, self.warm_up_job = self.warm_up_job, None
            self._report(job, "the tracer could not be compiled: ")
        arrival, self._restored = self._restored, None
        if self.load_job is None or not self.load_job.done:
            return arrival
        load, came = self.load_job, self._coming
        self.load_job, self._coming = None, Arrival()
        if load.result is None:
            if came.again:
                self.watch.files = self.watch.files | came.files  # what was not come to may be mended too
            self._report(load, after=" (the open scene stays as it is)" if came.again else "")
            return arrival
        came.renderer, came.info = load.result
        self.watch.files = came.files
        self._session.change(meshes=came.meshes)
        scene = came.renderer.scene
        up, count = up_in_studio(scene), len(scene.warnings)
        seconds = time.perf_counter() - came.began
        came.text = f"{scene.path.name} {'reloaded' if came.again else 'opened'} in {seconds:.1f} s"
        came.text += f", with {up} up" if up else ""
        came.text += f", {count} warning{'s' * (count > 1)}" if count else ""
        came.text += f": {came.changed} changed" if came.changed else ""
        return came


def _warm_up(progress: Progress) -> None:
    """Make all kernels ready: those that draw pictures, then those that trace them."""
    progress("what draws pictures", 0.0)
    paint.make_ready()
    warm_up(progress)

"""Opens scenes and saved pictures beside the window, and prepares the kernels.

While a scene is read the one that is open stays usable, and it stays open if the reading fails or
is cancelled.  A second request to open takes the place of the first.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from tracer.compilation import can_draw, compiled_before, make_ready, ready_for, warm_up
from tracer.scene.files import Stamp
from tracer.scene.mesh_options import IN_STUDIO, MeshOptions
from tracer.scene.model import Camera, Progress, Scene
from tracer.scene.studio import up_in_studio
from viewer.output import capture
from viewer.services import scene_files
from viewer.services.jobs import Job
from viewer.state import codec
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.util.messages import ERROR, say
from viewer.views import paint

PATIENCE = 0.5
"""Seconds that a load which was cancelled may take to end."""


@dataclass(frozen=True)
class Arrival:
    """What has been opened: a scene, None where it is open already; the place in it to go to, if not where it begins;
    and one line that says so.  `again` says that it is the scene that was open, read again: the place stays."""

    opened: scene_files.Opened | None
    place: ViewState | None
    text: str
    again: bool = False


@dataclass
class _Load:
    """What is being read: the place to go to then, whether it is the scene that is open, and what of that had `changed`
    where this is why; how meshes are read; the files that were come to, and the scene once it waits for kernels."""

    job: Job[scene_files.Opened]
    meshes: MeshOptions
    place: ViewState | None = None
    again: bool = False
    changed: str = ""
    files: dict[Path, Stamp] = field(default_factory=dict)
    seen: list[Scene] = field(default_factory=list)
    cancelled_at: float = 0.0


class SceneLoader:
    """Runs `scene_files.open_scene` on threads; `take_finished` hands out what has come."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        notices: Notices,
        ask_first: Callable[[str, Callable[[], None]], None],
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        """`ask_first(name, go_on)` calls `go_on` at once, or when the user agrees to open what is called so."""
        self._session, self._preferences, self._notices = session, preferences, notices
        self._ask_first, self._wake = ask_first, wake
        self.warm_up_job: Job[None] | None = None
        self.method_job: Job[None] | None = None
        self.compiles = False  # whether this is a first start, whose kernels are to be compiled
        self.folders: tuple[Path, ...] = ()  # besides a scene's own, that it may read files from
        self.meshes = IN_STUDIO  # how the next mesh is read
        self.files: dict[Path, Stamp] = {}  # that the newest scene was read from, or that were missed
        self._load: _Load | None = None
        self._abandoned: list[Job] = []
        self._restored: Arrival | None = None
        self._from_shell = False  # whether what is being opened was named on the command line
        self._given: dict[str, Any] = {}  # settings from there, for what is opened first

    @property
    def load_job(self) -> Job[scene_files.Opened] | None:
        """The load that is under way."""
        return self._load.job if self._load is not None else None

    @property
    def busy(self) -> bool:
        return self._load is not None or self._restored is not None or self.warm_up_job is not None

    @property
    def waiting(self) -> tuple[Scene, float | None, Camera | None] | None:
        """The scene that has been read and waits for kernels to be compiled, with the time and the camera that it is to
        be seen at, where these are not its own."""
        if self._load is None or not self._load.seen:
            return None
        place = self._load.place
        if place is None:
            return self._load.seen[0], None, None
        return self._load.seen[0], place.time, place.camera

    @property
    def ready(self) -> bool:
        """Whether all kernels are; those that make certificates come last, and pictures without them look the same."""
        return self.warm_up_job is None

    def start(
        self,
        path: Path | None,
        settings: Mapping[str, Any] | None = None,
        folders: Sequence[Path] = (),
        meshes: MeshOptions = IN_STUDIO,
    ) -> None:
        """Compile or load the kernels in the background, and open a first scene meanwhile.

        `settings` hold for what is opened first, also where a saved place in it has others.  All scenes may read files
        from `folders` besides their own. `meshes` says how meshes are read; which way is up holds for the first."""
        self.folders, self.meshes = tuple(folders), meshes
        self._given = dict(settings or {})
        self._session.set_settings(**self._given)
        self.compiles = not compiled_before()
        title = "Compiling the tracer (first start only)" if self.compiles else "Loading the tracer"
        self.warm_up_job = Job(title, _warm_up, self._wake)
        if path is not None:
            self._from_shell = True
            self._open(path)

    def prepare(self, method: str, lights: int, accelerator: str) -> None:
        """Compile in the background what a method has of its own, the first time that it is chosen."""
        if self.method_job is not None and self.method_job.done:
            job, self.method_job = self.method_job, None
            if job.failure is not None:
                self._notices.report(replace(job.failure, text=f"{job.title} failed: {job.failure.text}"))
        if self.method_job is None and can_draw(lights, accelerator) and not ready_for(method, lights, accelerator):
            compile_it = partial(make_ready, method, lights, accelerator)
            self.method_job = Job(f"compiling the kernels of {method}", compile_it, self._wake)

    def take_finished(self) -> Arrival | None:
        """Take up what the jobs have finished; returns what has been opened, once."""
        if self.warm_up_job is not None and self.warm_up_job.done:
            job, self.warm_up_job = self.warm_up_job, None
            if job.failure is not None:
                self._notices.report(replace(job.failure, text=f"the tracer could not be compiled: {job.failure.text}"))
        load, arrival = self._load, self._restored
        self._restored = None
        if load is not None and load.job.done:
            self._load = None
            arrival = self._loaded(load)
        elif load is not None and load.job.stopping and time.monotonic() - load.cancelled_at > PATIENCE:
            # It cannot stop at once, as within a library that reads a mesh: it ends by itself, and nothing comes of it.
            self._abandoned.append(load.job)
            self._load = None
            self._say_cancelled()
        self._abandoned = [job for job in self._abandoned if not job.done]
        return arrival

    def take(self, scene: Scene) -> None:
        """Show a scene that a script has loaded, or made."""
        self._given = {}
        up = up_in_studio(scene)
        meshes = MeshOptions(up is not None, up)  # as far as it shows how it was read
        self._start(f"Opening {scene.path.name}", lambda progress: scene, meshes)

    def open(self, path: Path) -> None:
        """Open a scene, or restore what a saved picture shows; anything else is one line."""
        self._from_shell = False
        self._open(path)

    def _open(self, path: Path) -> None:
        refused = scene_files.refusal(path)
        if refused:
            self._refuse(refused)
        elif scene_files.is_capture(path):
            self._ask_first(path.name, lambda: self._restore_capture(path))
        else:
            self._ask_first(path.name, lambda: self._begin(path, None))

    def go_on(self) -> bool:
        """Open what was open when the window was last closed, as it was seen; where it has gone, only say so."""
        last = self._preferences.last
        if not last:
            return False
        try:
            state = codec.state_from_json(last, self._session.state)
        except ValueError as error:
            self._notices.say(f"cannot start where you left off: {error}", error=True)
            return False
        found = scene_files.find_scene(state.scene, Path(state.scene))
        if found is None:
            self._notices.say(f"cannot start where you left off: the scene is gone: {state.scene}", error=True)
            return False
        self._begin(found, state)
        return True

    def reload(self) -> None:
        """Read the scene's file again and keep the place."""
        session = self._session
        if session.scene is not None:
            path = Path(session.scene.path)
            self._ask_first(f"{path.name} again", lambda: self._begin(path, None, again=True))

    def reload_changed(self, changed: str) -> None:
        """The same for a scene that has changed on the disk, where nothing is to be asked first."""
        if self._session.scene is not None:
            self._from_shell = False
            self._begin(Path(self._session.scene.path), None, again=True, changed=changed)

    def read_as(self, meshes: MeshOptions) -> None:
        """Read the mesh that is open in another way, and look at it from its first camera.

        Whether it gets a studio holds for what is opened after it too."""
        if self._session.scene is not None:
            path = Path(self._session.scene.path)

            def go_on() -> None:
                self.meshes = replace(self.meshes, studio=meshes.studio)
                self._begin(path, None, meshes=meshes)

            self._ask_first(f"{path.name} again", go_on)

    def cancel(self) -> None:
        """Give up the load that is under way; the scene that is open stays."""
        if self._load is not None and not self._load.job.stopping:
            self._load.job.cancel()
            self._load.cancelled_at = time.monotonic()

    def _say_cancelled(self) -> None:
        stays = ": the scene that was open stays" if self._session.scene is not None else ""
        self._notices.say(f"loading cancelled{stays}")

    def cancel_all(self) -> list[Job]:
        """Ask every job to stop; returns them, to be waited for."""
        jobs = [job for job in (self.warm_up_job, self.method_job, self.load_job, *self._abandoned) if job is not None]
        for job in jobs:
            job.cancel()
        return jobs

    def _restore_capture(self, path: Path) -> None:
        """Bring back scene, camera, time, settings and view of a saved picture."""
        try:
            state = self._as_here(capture.read(path))
        except capture.CaptureError as error:
            self._refuse(str(error))
            return
        found = scene_files.find_scene(state.scene, path)
        scene = self._session.scene
        if found is None:
            self._refuse(f"{path.name}: its scene was not found: {state.scene}")
        elif (
            scene is not None
            and self._load is None
            and _same_file(found, scene)
            and state.meshes == self._session.meshes
        ):
            self._restored = Arrival(None, state, f"restored {path.name}")
            self._wake()
        else:
            self._begin(found, state)

    def _as_here(self, state: ViewState) -> ViewState:
        """A state from a picture, with what the window shows around pictures, and not in them, as it is here."""
        here = self._session.state
        draw = here.draw
        return replace(state, pace=here.pace).with_draw(
            legend=draw.legend, legend_at=draw.legend_at, rays=draw.rays, smooth=draw.smooth, zoom=draw.zoom,
            savings=draw.savings, caption=draw.caption, magnified=draw.magnified,
        )  # fmt: skip

    def _refuse(self, why: str) -> None:
        self._tell_shell(why)
        self._notices.say(why, error=True)

    def _tell_shell(self, why: str) -> None:
        """What was named on the command line is missed there too: the window stays open, and empty."""
        if self._from_shell:
            say(why, ERROR)

    def _begin(
        self,
        path: Path,
        place: ViewState | None,
        again: bool = False,
        meshes: MeshOptions | None = None,
        changed: str = "",
    ) -> None:
        """Read a scene in the place of what is being read now."""
        if self._load is not None:
            self._load.job.cancel()
            self._abandoned.append(self._load.job)
        if place is not None:
            place = place.with_settings(**self._given)
        self._given = {}
        if meshes is None and place is not None:
            meshes = place.meshes
        elif meshes is None and again:
            meshes = self._session.meshes
        elif meshes is None:
            meshes, self.meshes = self.meshes, replace(self.meshes, up=None)
        meshes, files = meshes.of_file(path), dict[Path, Stamp]()
        self._start(
            f"Loading {path.name}",
            lambda progress: scene_files.read_scene(path, progress, self.folders, meshes, files),
            meshes, place=place, again=again, changed=changed, files=files,
        )  # fmt: skip

    def _start(self, title: str, read: Callable[[Progress], Scene], meshes: MeshOptions, **more: Any) -> None:
        """Read a scene on a thread, and open it; `more` are fields of the load."""
        settings, seen = self._session.settings, list[Scene]()

        def work(progress: Progress) -> scene_files.Opened:
            return scene_files.open_scene(lambda: read(progress), settings, self._kernels_ready, progress, seen.append)

        self._load = _Load(Job(title, work, self._wake), meshes, seen=seen, **more)

    def _kernels_ready(self) -> bool:
        job = self.warm_up_job
        return job is None or job.done or can_draw()

    def _loaded(self, load: _Load) -> Arrival | None:
        job, again = load.job, load.again
        if again and job.result is None and not job.cancelled:
            self.files = self.files | load.files  # what was not come to may be mended too
        elif job.result is not None:
            self.files = load.files
        if job.cancelled:
            self._say_cancelled()
        elif job.failure is not None:
            self._tell_shell(job.failure.text)
            stays = " (the scene as it was stays)" if again else ""
            self._notices.report(replace(job.failure, text=f"{job.failure.text}{stays}"))
        elif job.result is not None:
            opened = job.result
            self._session.change(meshes=load.meshes)
            up = up_in_studio(opened.scene)
            standing = f", with {up} up" if up else ""
            count = len(opened.scene.warnings)
            warned = f", {count} warning{'s' * (count > 1)}" if count else ""
            name, done = opened.scene.path.name, "reloaded" if again else "opened"
            said = f"{name} {done} in {opened.seconds:.1f} s{standing}{warned}"
            return Arrival(opened, load.place, f"{said}: {load.changed} changed" if load.changed else said, again)
        return None


def _same_file(path: Path, scene: Scene) -> bool:
    try:
        return path.samefile(scene.path)
    except OSError:
        return False


def _warm_up(progress: Progress) -> None:
    """Make all kernels ready: those that draw pictures, then those that trace them."""
    progress("what draws pictures", 0.0)
    paint.make_ready()
    warm_up(progress)

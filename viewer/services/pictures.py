"""What makes the window's pictures again, and how they leave it: as a command, as files, or to tev."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.util.text import shell_line
from viewer.output import capture, commands, exr, other_programs
from viewer.output.commands import CHANCE, chance, needs_history
from viewer.services import stills
from viewer.services.capture_service import CaptureService
from viewer.services.frame_scheduler import FrameScheduler
from viewer.services.history import FrameHistory
from viewer.services.runs import FileRun, Runs
from viewer.services.scene_loader import SceneLoader
from viewer.state.notices import Notices
from viewer.state.pixels import FIT
from viewer.state.plans import PicturePlan
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import Record, View
from viewer.util.files import write_new

UNKNOWN = "its modes were learnt from other frames as well"


class PictureRun(FileRun):
    """One picture being traced beside what the window shows; its results are its file."""

    name = "picture"

    def __init__(self, scene: Scene, state: ViewState, folder: Path, ending: str) -> None:
        self.state, self.folder, self.ending = state, folder, ending
        super().__init__(scene, 1 + state.warmup.repeats)

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Path]:
        (width, height), as_exr = self.state.size, self.ending == exr.ENDING
        renderer = Renderer(scene, self.state.settings, world=world)

        def tell(done: int, total: int) -> None:
            self.traced, self.label = done, f"{width} x {height}"

        frame = stills.trace(renderer, self.state, as_exr, tell, cancel)
        pixels, _ = (frame.pixels, "") if as_exr else stills.draw(frame, scene, self.state)
        text = stills.text(pixels, frame, scene, self.state)

        def write(path: Path) -> None:
            if as_exr:
                exr.write(path, frame, text)
            else:
                capture.write(path, pixels, text)

        stem = f"{Path(scene.path).stem}-{self.state.draw.view.value}-{width}x{height}"
        self.output = write_new(self.folder, stem, self.ending, write)
        self.traced = self.frames
        yield self.output


class Pictures:
    """`plan` is what the dialog says."""

    def __init__(
        self, session: Session, preferences: Preferences, scheduler: FrameScheduler, history: FrameHistory,
        loader: SceneLoader, runs: Runs, files: CaptureService, notices: Notices,
    ) -> None:  # fmt: skip
        self._session, self._preferences, self._scheduler, self._history = session, preferences, scheduler, history
        self._loader, self._runs, self._files, self._notices = loader, runs, files, notices
        self.plan = PicturePlan()

    # --- states ------------------------------------------------------------------------------------

    def state_of(self, frame: Frame, view: View) -> ViewState | None:
        """Return what makes a frame's picture again in a view; None without a scene."""
        session = self._session
        if session.scene is None:
            return None
        draw = replace(
            session.draw, view=view, legend=self._preferences.legend_in_pictures, zoom=FIT,
            magnified=self._scheduler.magnified if view.records is Record.VERIFY else 1,
            savings="" if self._preferences.savings_in_pictures else None,
        ).as_needed()  # fmt: skip
        state = replace(session.state_of(frame), draw=draw, warmup=Warmup())
        state = state.with_settings(verify=session.settings.verify, modes=False)
        if not needs_history(state):
            return state
        why, repeats = chance(state), self._history.repeats_of(frame)
        if why or repeats is None:
            return state.with_warmup(unknown=why or UNKNOWN)
        return state.with_warmup(repeats=repeats)

    def now(self) -> ViewState | None:
        """Return what makes the picture that the window shows, or will show when it has all its samples; None before
        one."""
        session, frame = self._session, self._scheduler.frame
        if session.scene is None or frame is None:
            return None
        width, height = self._scheduler.inputs.full_size
        settings: Settings = replace(
            self._scheduler.inputs.settings, width=width, height=height, samples=session.settings.samples
        )
        as_wanted = replace(frame, time=session.time, camera=session.camera, settings=settings)
        return self.state_of(as_wanted, session.draw.view)

    def command(self) -> str | None:
        """Return the command line that makes the picture again; None, and one line, where there is no picture."""
        state = self.now()
        if state is None:
            self._notices.say("there is no picture yet", error=True)
            return None
        name = f"{Path(state.scene).stem}-{state.draw.view.value}-{self._session.frame:04d}.png"
        words = commands.words(state, self._session.scene, name, self._loader.folders)
        line = shell_line(["shadowcull", *words])
        why, forgets = state.warmup.unknown, " (Backspace forgets them)" if state.warmup.unknown != CHANCE else ""
        self._notices.say(f"copied, but the picture may differ: {why}{forgets}" if why else f"copied: {line}")
        return line

    # --- as a file of its own -----------------------------------------------------------------------

    @property
    def size(self) -> tuple[int, int]:
        """Of the picture that is planned; 0, 0 before there is one to take it of."""
        width, height = self._scheduler.inputs.full_size if self.now() is not None else (0, 0)
        return width * self.plan.multiple, height * self.plan.multiple

    def save(self) -> bool:
        """Begin to trace and write what is planned; returns whether it has begun, and else has said why not."""

        def make(scene: Scene) -> PictureRun:
            state = self.now()
            if state is None:
                raise ValueError("there is no picture to save yet")
            return PictureRun(scene, self._planned(state, scene), self._preferences.picture_folder, self.plan.ending)

        return self._runs.start(make)

    def _planned(self, state: ViewState, scene: Scene) -> ViewState:
        plan = self.plan
        width, height = self.size
        stills.check_size(width, height)
        if plan.ending == exr.ENDING:
            exr.check()
        settings = replace(state.settings, width=width, height=height, samples=plan.samples).validated()
        # Modes are those of a resolution, and begin anew in another; once more, and they show what they are.
        wanted = replace(state, settings=settings)
        wanted = replace(wanted, warmup=Warmup(repeats=int(needs_history(wanted)), unknown=chance(wanted)))
        wanted = wanted.with_draw(magnified=1, legend=plan.legend, caption=plan.caption)
        stills.check_lights(wanted, scene, plan.ending == exr.ENDING)
        return stills.with_caption_filled(wanted, scene)

    # --- what is shown, elsewhere ------------------------------------------------------------------

    def to_tev(self, frame: Frame | None) -> None:
        """Send the frame and its buffers to where the preferences say."""
        scene = self._session.scene
        if frame is None or scene is None:
            self._notices.say("there is no picture to send yet", error=True)
            return
        try:
            to = other_programs.address(self._preferences.tev)
        except ValueError as error:
            self._notices.say(str(error), error=True)
            return
        name = f"{scene.path.stem} frame {self._session.frame_at(frame.time)} {frame.settings.method}"

        def work() -> str:
            other_programs.send(to, name, frame)
            return f"sent to {to[0]}:{to[1]} as {name!r}"

        self._files.begin("Sending", work)

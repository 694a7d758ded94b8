"""The recipes of what the window shows: of its picture as it will be at rest, and of a frame that is there."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path

from tracer.frame import Frame, Settings
from tracer.scene.edits import NO_EDITS
from viewer.output import commands
from viewer.output.commands import BUILT, cannot_come_back, needs_history
from viewer.services.frame_history import FrameHistory
from viewer.services.frame_scheduler import FrameScheduler
from viewer.services.scene_loader import SceneLoader
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import View
from viewer.state.zooming import FIT

UNKNOWN = "its modes were learnt from other frames as well"


class Recipes:
    """See the module."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        scheduler: FrameScheduler,
        history: FrameHistory,
        loader: SceneLoader,
        notices: Notices,
    ) -> None:
        self._session, self._preferences, self._scheduler, self._history = session, preferences, scheduler, history
        self._loader, self._notices = loader, notices

    def of(self, frame: Frame, view: View, legend: bool | None = None) -> ViewState | None:
        """What makes a frame's picture again, in a view and with a legend or not; None without a scene."""
        session, scene = self._session, self._session.scene
        if scene is None:
            return None
        follow = session.on_path and frame.camera == scene.camera_at(frame.time)
        settings = replace(frame.settings, verify=session.settings.verify, modes=False)
        with_legend = self._preferences.legend_in_pictures if legend is None else legend
        draw = replace(
            session.draw, view=view, legend=with_legend, zoom=FIT,
            magnified=self._scheduler.magnified if view.needs_verify else 1,
            savings="" if self._preferences.savings_in_pictures else None,
        ).as_needed()  # fmt: skip
        state = replace(
            session.state, time=frame.time, camera=None if follow else frame.camera, settings=settings, draw=draw,
            edits=session.edited.edits if session.edited is not None else NO_EDITS, warmup=Warmup(),
        )  # fmt: skip
        if not needs_history(state):
            return state
        why, repeats = cannot_come_back(frame.settings, draw), self._history.repeats_of(frame)
        if why or repeats is None:
            return state.with_warmup(unknown=why or UNKNOWN)
        return state.with_warmup(repeats=repeats)

    @property
    def folders(self) -> tuple[Path, ...]:
        """Those that scenes may read files from besides their own."""
        return tuple(self._loader.folders)

    def now(self) -> ViewState | None:
        """What makes the picture that the window shows, or will show when it has all its samples; None before one."""
        session, frame = self._session, self._scheduler.frame
        if session.scene is None or frame is None:
            return None
        width, height = self._scheduler.full_size
        settings: Settings = replace(
            self._scheduler.settings, width=width, height=height, samples=session.settings.samples
        )
        as_wanted = replace(frame, time=session.time, camera=session.camera, settings=settings)
        return self.of(as_wanted, session.draw.view)

    def command(self) -> str | None:
        """The command line that makes the picture again; None, and one line, where there is no picture."""
        found = self.now()
        if found is None:
            self._notices.say("there is no picture yet", error=True)
            return None
        name = f"{Path(found.scene).stem}-{found.draw.view.value}-{self._session.frame:04d}.png"
        words = shlex.join(["shadowcull", *commands.words(found, self._session.scene, name, self.folders)])
        try:
            words.encode()
        except UnicodeEncodeError:
            self._notices.say("not copied: the name of the scene's file is no text", error=True)
            return None
        if found.warmup.unknown == BUILT:
            self._notices.say(f"copied, but the picture may differ: {found.warmup.unknown}")
        elif found.warmup.unknown:
            self._notices.say(f"copied, but the picture may differ: {found.warmup.unknown} (Backspace forgets them)")
        else:
            self._notices.say(f"copied: {words}")
        return words

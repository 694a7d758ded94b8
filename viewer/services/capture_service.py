"""Files that the window writes, pictures among them, and pictures that it copies.

Each is done on a thread of its own, so that the window does not wait for a disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.scene.model import Scene
from viewer.output import capture, other_programs
from viewer.output.overlays import with_legend
from viewer.services import stills
from viewer.services.jobs import Job
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.views.legend import Legend

T = TypeVar("T")
Pixels = NDArray[np.uint8]


class CaptureService:
    """`saving` are the jobs that write files now, and those that bring pictures elsewhere."""

    def __init__(
        self, session: Session, preferences: Preferences, notices: Notices, wake: Callable[[], None] = lambda: None
    ) -> None:
        self._session, self._preferences, self._notices, self._wake = session, preferences, notices, wake
        self.saving: list[Job[Any]] = []

    @property
    def busy(self) -> bool:
        return bool(self.saving)

    def report_saved(self) -> None:
        """Report the files that have been written, or could not be."""
        for job in [job for job in self.saving if job.done]:
            self.saving.remove(job)
            if job.failure is not None:
                self._notices.report(job.failure)
            elif isinstance(job.result, Path):
                self._notices.say(f"saved {job.result}", file=job.result)
            elif job.result is not None:
                self._notices.say(job.result)

    def write(self, save: Callable[[], Path]) -> Job[Path]:
        """Let `save` write a file, whose path it returns, on a thread of its own."""
        return self.begin("Saving", save)

    def begin(self, title: str, work: Callable[[], T]) -> Job[T]:
        """Let `work` do something of this kind on a thread of its own, and say at its end what it returns."""
        job = Job(title, lambda _: work(), self._wake)
        self.saving.append(job)
        return job

    def capture(
        self, frame: Frame | None, pixels: Pixels | None, legend: Legend | None = None, state: ViewState | None = None
    ) -> None:
        """Save a picture, (h, w, 3) uint8, of a frame, named by the user's template.

        With the state that makes it again, which says what else is drawn; without one it shows more than a picture, as
        the window, or two, and gets the legend alone."""
        session, preferences, scene = self._session, self._preferences, self._session.scene
        if frame is None or pixels is None or scene is None:
            self._notices.say("there is no picture to save yet", error=True)
            return
        height, width = pixels.shape[:2]
        values = stills.fields_of(session.state_of(frame), scene) | {"width": width, "height": height}
        try:
            name = capture.file_name(preferences.screenshot_template, values)
        except capture.CaptureError as error:
            self._notices.say(str(error), error=True)
            return
        folder, finish = preferences.picture_folder, self._finishing(frame, pixels, scene, legend, state)
        self.write(lambda: capture.save(*finish(), folder, name))

    def copy(
        self, frame: Frame | None, pixels: Pixels | None, legend: Legend | None = None, state: ViewState | None = None
    ) -> None:
        """Put a picture on the clipboard; as `capture`."""
        scene = self._session.scene
        if frame is None or pixels is None or scene is None:
            self._notices.say("there is no picture to copy yet", error=True)
            return
        if other_programs.clipboard_command() is None:
            self._notices.say(other_programs.NO_CLIPBOARD, error=True)
            return
        finish = self._finishing(frame, pixels, scene, legend, state)

        def work() -> str:
            drawn, text = finish()
            other_programs.copy(capture.encoded(drawn, text))
            return f"picture copied, {drawn.shape[1]} x {drawn.shape[0]}"

        self.begin("Copying", work)

    def _finishing(
        self, frame: Frame, pixels: Pixels, scene: Scene, legend: Legend | None, state: ViewState | None
    ) -> Callable[[], tuple[Pixels, str]]:
        """Return what draws the rest of a picture and gives what it carries, which may take a while."""
        session, place = self._session, self._session.draw.legend_at
        # What the picture shows: another moment than the session's where a run goes on, or a finer frame is to come.
        here = session.state_of(frame).with_settings(verify=session.settings.verify)  # a view may verify by itself

        def finish() -> tuple[Pixels, str]:
            if state is not None:
                drawn, _ = stills.draw(frame, scene, state, pixels)
                return drawn, stills.text(drawn, frame, scene, state)
            described = with_legend(pixels, legend, place) if legend is not None else None
            text = stills.carried(here, frame, scene, window=True).text()
            return pixels if described is None else described, text

        return finish

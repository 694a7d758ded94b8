"""Files that the window writes: pictures, and the results of runs.

Each is written on a thread of its own, so that the window does not wait for a disk.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.output import capture
from viewer.output.overlays import with_legend
from viewer.output.savings_picture import with_savings
from viewer.services import stills
from viewer.services.jobs import Job
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.views.legend import Legend

T = TypeVar("T")


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
            elif job.result is not None:
                self._notices.say(f"saved {job.result}" if isinstance(job.result, Path) else job.result)

    def write(self, save: Callable[[], Path]) -> Job[Path]:
        """Let `save` write a file, whose path it returns, on a thread of its own."""

        return self.begin("Saving", save)

    def begin(self, title: str, work: Callable[[], T]) -> Job[T]:
        """Let `work` do something of this kind on a thread of its own, and say at its end what it returns."""
        job = Job(title, lambda _: work(), self._wake)
        self.saving.append(job)
        return job

    def capture(
        self,
        frame: Frame | None,
        pixels: NDArray[np.uint8] | None,
        legend: Legend | None = None,
        state: ViewState | None = None,
    ) -> None:
        """Save a picture, (h, w, 3) uint8, of a frame, with its legend, named by the user's template.

        With the state that makes it again; without one it shows more than a picture, as the window, or two."""
        session, preferences, scene = self._session, self._preferences, self._session.scene
        if frame is None or pixels is None or scene is None:
            self._notices.say("there is no picture to save yet", error=True)
            return
        # What the picture shows: another moment than the session's where a run goes on, or a finer frame is to come.
        number = session.frame_at(frame.time)
        height, width = pixels.shape[:2]
        values = {
            "scene": scene.path.stem,
            "view": session.draw.view.value,
            "frame": number,
            "seconds": frame.time,
            "method": frame.settings.method,
            "light": session.draw.light,
            "width": width,
            "height": height,
        }
        here = session.state_of(frame).with_settings(verify=session.settings.verify)  # a view may verify by itself
        size = (frame.width, frame.height)
        text = capture.metadata(here, frame.camera, number, size, frame.statistics.to_dict(), {"window": state is None})
        folder = preferences.picture_folder
        try:
            name = capture.file_name(preferences.screenshot_template, values)
        except capture.CaptureError as error:
            self._notices.say(str(error), error=True)
            return
        place = session.draw.legend_at

        def save() -> Path:
            described = with_legend(pixels, legend, place) if legend is not None else None
            saved = pixels if described is None else described
            if state is not None:
                saved = with_savings(saved, frame, state.draw.savings)
            if state is None:
                return capture.save(saved, folder, name, text)
            kept = state if described is not None else state.with_draw(legend=False)
            return capture.save(saved, folder, name, stills.text(saved, frame, scene, kept, by_gpu=True))

        self.write(save)

"""What is kept: bookmarks in the preferences, and pictures in files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import Progress
from viewer.output import capture
from viewer.output.legend import Legend
from viewer.output.legend_picture import with_legend
from viewer.services.jobs import Job
from viewer.state.preferences import default_screenshot_folder
from viewer.state.session import Snapshot, settings_to_json

if TYPE_CHECKING:
    from viewer.services.controller import Controller


class Keeper:
    """Adds and finds bookmarks; writes pictures on threads, so that the window does not wait for a disk."""

    def __init__(self, controller: Controller) -> None:
        self._c = controller
        self.saving: list[Job[Path]] = []

    @property
    def busy(self) -> bool:
        return bool(self.saving)

    def follow(self) -> None:
        """Tell of the pictures that have been written, or could not be."""
        for job in [job for job in self.saving if job.done]:
            self.saving.remove(job)
            if job.failure is not None:
                self._c.report(job.failure)
            else:
                self._c.say(f"saved {job.result}")

    @property
    def bookmarks(self) -> list[dict]:
        """The bookmarks of the open scene: {"name": ..., "state": a snapshot's JSON}."""
        scene = self._c.session.scene
        if scene is None:
            return []
        return self._c.preferences.bookmarks.setdefault(str(Path(scene.path).absolute()), [])

    def add_bookmark(self, name: str = "") -> None:
        session = self._c.session
        if session.scene is None:
            return
        name = name.strip() or f"frame {session.frame}"
        self.bookmarks.append({"name": name, "state": session.snapshot().to_json()})
        self._c.save_preferences()
        self._c.say(f"bookmarked as {name!r}")

    def forget_bookmark(self, index: int) -> None:
        del self.bookmarks[index]
        self._c.save_preferences()

    def go_to_bookmark(self, index: int) -> None:
        """Glide to a bookmark and take over its time and view; settings stay as they are."""
        if self._c.runner.refuses():
            return
        try:
            snapshot = Snapshot.from_json(self.bookmarks[index]["state"])
        except (ValueError, KeyError, TypeError, IndexError) as error:
            self._c.say(f"this bookmark is damaged: {error}", error=True)
            return
        start = self._c.session.camera
        self._c.restore(replace(snapshot, settings={}))
        if not snapshot.follow:
            self._c.glide(snapshot.camera, start)

    def capture(self, pixels: NDArray[np.uint8] | None, legend: Legend | None = None) -> None:
        """Save a picture, (h, w, 3) uint8, of the newest frame, with its legend, named by the user's template."""
        session, preferences, frame = self._c.session, self._c.preferences, self._c.frame
        if frame is None or pixels is None or session.scene is None:
            self._c.say("there is no picture to save yet", error=True)
            return
        # What the picture shows: another moment than the session's where a run goes on, or a finer frame is to come.
        number = session.frame_at(frame.time)
        follow = session.follow and frame.camera == session.scene.camera_at(frame.time)
        height, width = pixels.shape[:2]
        values = {
            "scene": session.scene.path.stem,
            "view": session.view.value,
            "frame": number,
            "seconds": frame.time,
            "method": frame.settings.method,
            "light": session.light,
            "width": width,
            "height": height,
        }
        settings = replace(frame.settings, verify=session.settings.verify)  # a view may have verified by itself
        now = session.snapshot()
        snapshot = replace(
            now, time=frame.time, camera=frame.camera, follow=follow, settings=settings_to_json(settings)
        )
        size = (frame.width, frame.height)
        text = capture.metadata(snapshot, number, size, frame.statistics.to_dict())
        folder = Path(preferences.screenshot_folder or default_screenshot_folder()).expanduser()
        try:
            name = capture.file_name(preferences.screenshot_template, values)
        except capture.CaptureError as error:
            self._c.say(str(error), error=True)
            return
        place = preferences.legend_x, preferences.legend_y

        def save(_: Progress) -> Path:
            described = with_legend(pixels, legend, place) if legend is not None else None
            return capture.save(pixels if described is None else described, folder, name, text)

        self.saving.append(Job("Saving", save, lambda: self._c.wake()))

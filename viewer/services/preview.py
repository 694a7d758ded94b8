"""What is seen of a scene while the kernels that trace it are compiled: its geometry, for the GPU to draw.

Only where no scene is open, and kernels are not there: else a picture stays, or comes soon.  The camera can be moved;
where it is when the first traced picture comes, that begins.
"""

from __future__ import annotations

from collections.abc import Callable

from tracer.scene.camera import Camera
from tracer.scene.framing import bounds
from tracer.scene.model import Progress, Scene
from viewer.services.jobs import Job
from viewer.services.motion import Motion
from viewer.services.scene_loader import SceneLoader
from viewer.state.notices import Notices
from viewer.state.preview_geometry import MOST_READ, PreviewGeometry, preview_geometry
from viewer.state.session import Session


class Preview:
    """`geometry` is what is to be drawn now, of `session.previewed`, or None."""

    def __init__(
        self, session: Session, loader: SceneLoader, motion: Motion, notices: Notices, wake: Callable[[], None]
    ) -> None:
        self._session, self._loader, self._motion = session, loader, motion
        self._notices, self._wake = notices, wake
        self.geometry: PreviewGeometry | None = None
        self._scene: Scene | None = None
        self._start: Camera | None = None
        self._job: Job[PreviewGeometry] | None = None

    @property
    def flown(self) -> Camera | None:
        """Where the user has moved the camera to; None where it is as it was."""
        seen = self._scene is not None and self._session.free_camera not in (None, self._start)
        return self._session.free_camera if seen else None

    def follow(self, traced: bool) -> None:
        """Begin or end; `traced` says that a traced picture is there."""
        session, waiting = self._session, self._loader.waiting
        if self._scene is not None and (traced or (waiting is None and session.scene is not self._scene)):
            self._leave()
        if session.scene is None and waiting is not None and waiting[0] is not self._scene:
            self._leave()
            self._enter(*waiting)
        if self._job is not None and self._job.done:
            job, self._job = self._job, None
            if job.failure is not None:
                self._notices.report(job.failure)
            self.geometry = job.result

    def _enter(self, scene: Scene, time: float | None, camera: Camera | None) -> None:
        session = self._session
        if scene.triangle_count > MOST_READ:
            return
        self._scene = session.previewed = scene
        self._start = session.free_camera = camera
        start = session.time = scene.time_range[0] if time is None else time

        def gather(progress: Progress) -> PreviewGeometry:
            return preview_geometry(scene, start, progress)

        box = bounds(scene.objects, scene.animation, start)
        self._motion.enter(None if box is None else (box[0].tolist(), box[1].tolist()))
        self._job = Job("The preview", gather, self._wake)

    def _leave(self) -> None:
        if self._job is not None:
            self._job.cancel()
        session = self._session
        if session.scene is None:
            session.free_camera = None
        session.previewed = self._scene = self._start = self._job = self.geometry = None

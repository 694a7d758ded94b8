"""What is seen of a scene while the kernels that trace it are compiled: its geometry, for the GPU to draw.

Only where no scene is open, and kernels are not there: else a picture stays, or comes soon.  The camera can be moved;
where it is when the first traced picture comes, that begins.
"""

from __future__ import annotations

from collections.abc import Callable

from tracer.scene.camera import Camera
from tracer.scene.framing import bounds
from tracer.scene.model import Progress, Scene
from tracer.scene.studio import model_bounds
from viewer.services.jobs import Job
from viewer.services.motion import Corner, Motion
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
        self._job: Job[tuple[PreviewGeometry, tuple[Corner, Corner] | None]] | None = None

    @property
    def flown(self) -> Camera | None:
        """Where the user has moved the camera to; None where it is as it was."""
        seen = self._scene is not None and self._session.state.camera not in (None, self._start)
        return self._session.state.camera if seen else None

    def update(self, traced: bool) -> None:
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
            elif job.result is not None:
                self.geometry, box = job.result
                self._motion.enter(box)

    def _enter(self, scene: Scene, time: float | None, camera: Camera | None) -> None:
        session = self._session
        if scene.primitive_count > MOST_READ:
            return
        self._scene = session.previewed = scene
        self._start = camera
        start = scene.time_range[0] if time is None else time
        session.change(camera=camera, time=start)

        def gather(progress: Progress) -> tuple[PreviewGeometry, tuple[Corner, Corner] | None]:
            return preview_geometry(scene, start, progress), _bounds(scene)

        self._job = Job("The preview", gather, self._wake)

    def _leave(self) -> None:
        if self._job is not None:
            self._job.cancel()
        session = self._session
        if session.scene is None:
            session.change(camera=None)
        session.previewed = self._scene = self._start = self._job = self.geometry = None


def _bounds(scene: Scene) -> tuple[Corner, Corner] | None:
    """Least and greatest corner of what the camera goes around: the same as once the scene is traced, so that it is
    as fast then."""
    box = model_bounds(scene)
    if box is None:
        box = bounds(scene.objects, scene.animation, scene.time_range[0])
    return None if box is None else (box[0].tolist(), box[1].tolist())

"""What is seen of a scene while the kernels that trace it are compiled: its triangles, for the GPU to draw.

Only where no scene is open, and kernels are not there: else a picture stays, or comes soon.  The camera can be moved;
where it is when the first traced picture comes, that begins.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Float32, Float64
from tracer.scene.camera import Camera
from tracer.scene.chains import Chains
from tracer.scene.deformation import deformed
from tracer.scene.lamps import LampTable
from tracer.scene.limits import LARGEST, SMALLEST
from tracer.scene.model import CONE, Progress, Quadrics, Scene
from viewer.services.jobs import Job
from viewer.services.motion import Motion
from viewer.services.scene_loader import Arrival, SceneLoader
from viewer.state.notices import Notices
from viewer.state.session import Session

MOST_TRIANGLES = 500_000
"""Of a scene that is previewed at all, those of its spheres and cones among them: more take long to draw."""
ROUND_TRIANGLES = 100_000
"""Of all spheres and cones together, about."""
MOST_LIGHTS = 8
BRIGHTNESS = 1.3
"""Of all lights together."""
MIRROR = 0.4
"""How bright mirrors are, at most, which have hardly a colour of their own."""
CLEAR = 0.5
"""Of its light that a surface lets through which is left out."""

VERTEX = np.dtype([("position", "f4", 3), ("normal", "f4", 3), ("color", "f4", 3)])


@dataclass(frozen=True)
class PreviewGeometry:
    """Triangles in world space: vertices (3 n,) VERTEX, three for each; the brightest lights (l, 6) float32, place and
    colour; box (2, 3) around everything."""

    vertices: NDArray[np.void]
    lights: Float32
    ambient: tuple[float, float, float]
    background: tuple[float, float, float]
    box: Float64


class Preview:
    """`geometry` is what is to be drawn now, of `session.previewed`, or None."""

    def __init__(
        self, session: Session, loader: SceneLoader, motion: Motion, notices: Notices, wake: Callable[[], None]
    ) -> None:
        self._session, self._loader, self._motion = session, loader, motion
        self._notices, self._wake = notices, wake
        self.geometry: PreviewGeometry | None = None
        self._start: Camera | None = None
        self._job: Job[PreviewGeometry] | None = None

    @property
    def flown(self) -> Camera | None:
        """Where the user has moved the camera to; None where it is as it was."""
        camera = self._session.state.camera
        return camera if self._session.previewed is not None and camera != self._start else None

    def update(self, traced: bool) -> None:
        """Begin or end; `traced` says that a traced picture is there."""
        session, waiting = self._session, self._loader.waiting
        shown = session.previewed
        if shown is not None and (traced or (waiting is None and session.scene is not shown)):
            self._leave()
        if session.scene is None and waiting is not None and waiting.waits is not shown:
            self._leave()
            self._enter(waiting)
        if self._job is not None and self._job.done:
            job, self._job = self._job, None
            if job.failure is not None:
                self._notices.report(job.failure)
            self.geometry = job.result
            if self.geometry is not None:
                self._motion.enter(tuple(self.geometry.box.tolist()))

    def _enter(self, waiting: Arrival) -> None:
        scene, place = waiting.waits, waiting.place
        if scene is None or triangles_of(scene) > MOST_TRIANGLES:
            return
        start, camera = (scene.time_range[0], None) if place is None else (place.time, place.camera)
        self._session.previewed, self._start = scene, camera
        self._session.change(camera=camera, time=start)
        self._job = Job("The preview", lambda progress: preview_geometry(scene, start, progress), self._wake)

    def _leave(self) -> None:
        if self._job is not None:
            self._job.cancel()
        if self._session.scene is None:
            self._session.change(camera=None)
        self._session.previewed = self._start = self._job = self.geometry = None


# --- its triangles ---------------------------------------------------------------------------------


def triangles_of(scene: Scene) -> int:
    """Return how many triangles the preview of a scene has."""
    return scene.triangle_count + (scene.primitive_count - scene.triangle_count) * 4 * _rings(scene) ** 2


def _rings(scene: Scene) -> int:
    """Of each sphere and cone: the rounder, the fewer there are."""
    number = max(scene.primitive_count - scene.triangle_count, 1)
    return int(np.clip(np.sqrt(ROUND_TRIANGLES / (4 * number)), 3, 32))


def preview_geometry(scene: Scene, time: float, progress: Progress) -> PreviewGeometry:
    """Gather what is seen of a scene at a time, but for what is clear."""
    chains, rings = Chains(scene.animation, [o.chain for o in scene.objects]), _rings(scene)
    matrices, visible = chains.matrices(time), chains.visible(time)
    diffuse, ambient, specular = (
        np.array([getattr(m, name) for m in scene.materials], np.float32).reshape(-1, 3)
        for name in ("diffuse", "ambient", "specular")
    )
    colors = np.maximum.reduce([diffuse, ambient, np.minimum(MIRROR, 0.35 * specular)])
    # A texture is its mean colour, and the last of them none.
    textures = np.array([*(t.pixels.mean(axis=(0, 1)) / 255.0 for t in scene.textures), (1, 1, 1)], np.float32)
    clear = np.array([m.transmission > CLEAR for m in scene.materials], np.bool_)
    pieces = [np.empty((0, 3), VERTEX)]
    for done, (o, matrix, seen) in enumerate(zip(scene.objects, matrices, visible, strict=True)):
        if done % 64 == 0:
            progress("preparing a preview", done / len(scene.objects))
        if not seen or not _placed(matrix):
            continue
        corners, normals = o.triangles.corners, o.triangles.normals
        if o.deformation is not None:
            corners, normals = deformed(o.deformation, time)
        flat = corners, normals, o.triangles.material, o.triangles.texture
        for at, outwards, material, texture in (flat, _facets(o.quadrics, rings)):
            opaque, tint = ~clear[material], colors[material] * textures[texture]
            pieces.append(_in_world(at[opaque], outwards[opaque], matrix, tint[opaque]))
    soup = np.concatenate(pieces).reshape(-1)
    points = soup["position"][np.isfinite(soup["position"]).all(axis=1)].astype(np.float64)
    box = np.stack([points.min(axis=0), points.max(axis=0)]) if len(points) else np.zeros((2, 3))
    sky = np.multiply(scene.ambient, ambient.sum() / max(float(diffuse.sum()), 1e-12))
    return PreviewGeometry(soup, _lights(scene, time), tuple(sky.tolist()), scene.background, box)


def _placed(matrix: Float64) -> bool:
    """Whether an object is somewhere, and not scaled to nothing."""
    with np.errstate(all="ignore"):
        if not (np.abs(matrix) <= min(LARGEST, 1 / SMALLEST)).all():
            return False
        return abs(float(np.linalg.det(matrix[:3, :3]))) > 0.0


def _in_world(at: NDArray, outwards: NDArray, matrix: Float64, colors: Float32) -> NDArray[np.void]:
    """(n, 3) VERTEX of triangles with corners and normals (n, 3, 3), and a colour each, placed by a matrix."""
    made = np.empty(at.shape[:2], VERTEX)
    with np.errstate(all="ignore"):
        made["position"] = at @ matrix[:3, :3].T + matrix[:3, 3]
        made["normal"] = outwards @ np.linalg.inv(matrix[:3, :3])
    made["color"] = colors[:, None]
    return made


def _facets(q: Quadrics, rings: int) -> tuple[NDArray, NDArray, NDArray, int]:
    """Corners and normals (n, 3, 3), materials (n,) and no texture of triangles in the place of spheres and cones."""
    across, along = (part.reshape(-1, 1) for part in np.mgrid[: 2 * rings, :rings])
    turn = (np.pi / rings * (across + np.array([0, 1, 0, 1, 1, 0]))).ravel()  # two triangles for each piece of a grid
    up = ((along + np.array([0, 0, 1, 0, 1, 1])) / rings).ravel()
    x, y, wide = np.cos(turn), np.sin(turn), np.sin(np.pi * up)
    sphere = np.stack([x * wide, y * wide, -np.cos(np.pi * up)], axis=-1)
    lower, upper = q.radii[:, :1], q.radii[:, 1:]
    radius, level = lower + (upper - lower) * up, np.zeros((len(q), 1))
    cones = np.stack([radius * x, radius * y, level + up], axis=-1)
    leaning = np.stack([level + x, level + y, level * up + lower - upper], axis=-1)
    is_cone, to_object = (q.kind == CONE)[:, None, None], q.to_object[:, :, :3]
    points = np.where(is_cone, cones, sphere) @ to_object.transpose(0, 2, 1) + q.to_object[:, None, :, 3]
    outwards = np.where(is_cone, leaning, sphere) @ np.linalg.pinv(to_object)
    return points.reshape(-1, 3, 3), outwards.reshape(-1, 3, 3), np.repeat(q.material, 4 * rings**2), -1


def _lights(scene: Scene, time: float) -> Float32:
    """The brightest, which shine from their centres, and as brightly as all together should."""
    places = LampTable(scene.lights).at(scene.light_positions(time)).places.reshape(-1, 3)
    colors = np.array([light.color for light in scene.lights], np.float32).reshape(-1, 3)
    brightest = np.argsort(-colors.sum(axis=1), kind="stable")[:MOST_LIGHTS]
    shine = colors[brightest]
    shine *= BRIGHTNESS / max(float(shine.sum(axis=0).max(initial=0.0)), 1e-12)
    return np.concatenate([places[brightest], shine], axis=1).astype(np.float32)

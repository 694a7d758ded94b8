"""A preview of a scene by the GPU alone, while the tracer's kernels are compiled: no shadows, no reflections."""

from __future__ import annotations

import math
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.scene.camera import Camera
from viewer.services.preview import MOST_LIGHTS, VERTEX, PreviewGeometry
from viewer.util.resources import shader_source

_NEAREST = 2e-4  # of the way to the farthest that is drawn
_VERSION = "#version 330 core\n"


class PreviewDisplay:
    """A geometry on the GPU, and the target that it is drawn into; needs a current GL context, and what it draws
    changes the framebuffer and the depth test."""

    def __init__(self, context: Any, geometry: PreviewGeometry) -> None:
        self.geometry, self._context = geometry, context
        self._owned: list[Any] = []
        self._program: Any = None
        self._array: Any = None
        self._target: Any = None
        self._drawn: object = None

    @property
    def texture_id(self) -> int | None:
        """Name of the GL texture to show, or None while there is none; row 0 is the top."""
        return self._target.color_attachments[0].glo if self._target is not None else None

    def draw(self, camera: Camera, size: tuple[int, int]) -> None:
        """Draw it in so many pixels, unless that is in the target already."""
        if (camera, size) == self._drawn:
            return
        if self._array is None and len(self.geometry.vertices):
            self._upload()
        target = self._fitting_target(size)
        target.use()
        self._context.enable_only(moderngl.DEPTH_TEST)
        target.clear(*self.geometry.background, 1.0, depth=1.0)
        if self._array is not None:
            self._place(camera, size)
            self._array.render(moderngl.TRIANGLES)
        self._drawn = camera, size

    def release(self) -> None:
        """Free everything on the GPU."""
        self._release_target()
        for made in reversed(self._owned):
            made.release()
        self._owned.clear()

    def _upload(self) -> None:
        sources = {
            f"{stage}_shader": _VERSION + shader_source(f"preview.{ending}")
            for stage, ending in (("vertex", "vert"), ("fragment", "frag"))
        }
        self._program = self._context.program(**sources)
        self._owned.append(self._program)
        buffer = self._context.buffer(self.geometry.vertices)
        self._owned.append(buffer)
        self._array = self._context.vertex_array(self._program, [(buffer, "3f4 3f4 3f4", *(VERTEX.names or ()))])
        self._owned.append(self._array)

    def _place(self, camera: Camera, size: tuple[int, int]) -> None:
        """The camera, and the lights."""
        g, half = self.geometry, math.tan(math.radians(camera.angle) / 2.0)
        lights = np.zeros((2 * MOST_LIGHTS, 3), np.float32)
        lights[: 2 * len(g.lights)] = g.lights.reshape(-1, 3)
        self._range = _range(camera, g.box)
        program = self._program
        program["eye"], program["slope"] = camera.position, (half * size[0] / size[1], half)
        program["near_far"], program["sky"] = self._range, g.ambient
        program["light_count"] = len(g.lights)
        program["lights"].write(lights.tobytes())
        # Its columns are the axes, so that p * view is p in them.
        program["view"].write(camera.basis().astype(np.float32).tobytes())

    def _fitting_target(self, size: tuple[int, int]) -> Any:
        if self._target is None or self._target.size != size:
            self._release_target()
            color, depth = self._context.texture(size, 4), self._context.depth_texture(size)
            color.repeat_x = color.repeat_y = False
            self._target = self._context.framebuffer([color], depth)
        return self._target

    def _release_target(self) -> None:
        if self._target is not None:
            for made in (self._target, *self._target.color_attachments, self._target.depth_attachment):
                made.release()
            self._target = None


def _range(camera: Camera, box: NDArray[np.float64]) -> tuple[float, float]:
    """The nearest and the farthest that is drawn: all of the box, and not too close for the depth buffer."""
    corners = np.array([[box[i][0], box[j][1], box[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    ahead = (corners - camera.position) @ camera.basis()[2]
    far = max(float(ahead.max()), 1e-3 * float(np.linalg.norm(box[1] - box[0])), 1e-12) * 1.01
    return max(float(ahead.min()) * 0.99, far * _NEAREST), far

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
from viewer.window.display import drawing_into

_NEAREST = 2e-4  # of the way to the farthest that is drawn
_VERSION = "#version 330 core\n"


class PreviewDisplay:
    """A geometry on the GPU, and the target that it is drawn into; needs a current GL context."""

    def __init__(self, context: moderngl.Context, geometry: PreviewGeometry) -> None:
        self.geometry, self._context = geometry, context
        vertex, fragment = (_VERSION + shader_source(f"preview.{ending}") for ending in ("vert", "frag"))
        self._program: Any = context.program(vertex_shader=vertex, fragment_shader=fragment)
        self._array: Any = None
        if len(geometry.vertices):
            content = (context.buffer(geometry.vertices), "3f4 3f4 3f4", *(VERTEX.names or ()))
            self._array = context.vertex_array(self._program, [content])
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
        if self._target is None or self._target.size != size:
            color, depth = self._context.texture(size, 4), self._context.depth_texture(size)
            color.repeat_x = color.repeat_y = False
            self._target = self._context.framebuffer([color], depth)
        with drawing_into(self._target, moderngl.DEPTH_TEST):
            self._target.clear(*self.geometry.background, 1.0, depth=1.0)
            if self._array is not None:
                self._place(camera, size)
                self._array.render(moderngl.TRIANGLES)
        self._drawn = camera, size

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


def _range(camera: Camera, box: NDArray[np.float64]) -> tuple[float, float]:
    """The nearest and the farthest that is drawn: all of the box, and not too close for the depth buffer."""
    corners = np.array([[box[i][0], box[j][1], box[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    ahead = (corners - camera.position) @ camera.basis()[2]
    far = max(float(ahead.max()), 1e-3 * float(np.linalg.norm(box[1] - box[0])), 1e-12) * 1.01
    return max(float(ahead.min()) * 0.99, far * _NEAREST), far

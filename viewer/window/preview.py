"""A preview of a scene by the GPU alone, while the tracer's kernels are compiled: no shadows, no reflections.

What is drawn comes to the GPU piece by piece, so that none of the window's frames waits long.
"""

from __future__ import annotations

import math
import time
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from tracer.scene.camera import Camera
from viewer.state.preview_geometry import MATERIAL, QUADRIC, VERTEX, PreviewGeometry
from viewer.util.resources import shader_source

PIECE = 1 << 20  # bytes that come to the GPU at once
SMOOTH = 0.05  # seconds to draw one picture, at most, while the camera moves: else it becomes coarser
COARSEST = 4
BRIGHTEST = 1.5  # of all lights together that do not fall off with distance
FACETS = 100_000  # triangles of spheres and cones, about
LARGEST, ROUNDEST = 16, 32  # so many of them are the roundest, of so many rings
LEAST = 3  # rings of the others
A_ROW = 1024  # materials in a row of their texture
_NEAREST = 2e-4  # of the way to the farthest that is drawn


class PreviewDisplay:
    """A geometry on the GPU, and the target that it is drawn into; needs a current GL context, and what it draws
    changes the framebuffer and the depth test."""

    def __init__(self, context: Any, geometry: PreviewGeometry) -> None:
        self.geometry, self._context = geometry, context
        self._owned: list[Any] = []
        self._pieces: list[tuple[Any, NDArray[np.void]]] = []  # buffers that are not filled yet
        self._images = list(enumerate(geometry.images))  # that are not there yet
        self._textures: dict[int, Any] = {}
        self._come = 0  # bytes of the first of these
        self._drawn: object = None
        self._target: Any = None
        self._coarse = 1
        try:
            self._make(geometry)
        except Exception:
            self.release()
            raise

    def _make(self, geometry: PreviewGeometry) -> None:
        fragment = shader_source("preview.frag")
        self._soup = self._program("preview.vert", fragment)
        self._round = self._program("preview-quadric.vert", fragment)
        self._vertices = self._buffer(geometry.vertices)
        self._soup_array = self._array(self._soup, self._vertices, _layout(VERTEX, self._soup))
        self._materials = self._kept(self._material_texture())
        large, small = geometry.quadrics[:LARGEST], geometry.quadrics[LARGEST:]
        rings = min(ROUNDEST, max(LEAST, math.isqrt(FACETS // (4 * max(len(small), 1)))))
        layout = _layout(QUADRIC, self._round, "/i")
        self._rounds = [
            (self._array(self._round, self._buffer(part), layout), len(part), of)
            for part, of in ((large, ROUNDEST), (small, rings))
            if len(part)
        ]

    @property
    def texture_id(self) -> int | None:
        """Name of the GL texture to show, or None while there is none; row 0 is the top."""
        return self._target.color_attachments[0].glo if self._target is not None else None

    @property
    def whole(self) -> bool:
        """Whether everything has come to the GPU."""
        return not self._pieces and not self._images

    def bring(self, size: int = PIECE) -> bool:
        """Bring the next piece to the GPU; whether there was any."""
        if self._images:
            number, pixels = self._images.pop(0)
            self._textures[number] = self._image(pixels)
        elif self._pieces:
            buffer, data = self._pieces[0]
            raw = data.view(np.uint8)
            piece = raw[self._come : self._come + size]
            buffer.write(piece, offset=self._come)
            self._come += len(piece)
            if self._come == len(raw):
                self._pieces.pop(0)
                self._come = 0
        else:
            return False
        return True

    def draw(self, camera: Camera, size: tuple[int, int], hurried: bool = False) -> None:
        """Draw it, unless that is in the target already; coarser if hurried, and that takes long."""
        wanted = camera, size, self._coarse if hurried else 1
        if wanted == self._drawn:
            return
        began = time.perf_counter()
        divisor = wanted[2]
        most = self._context.info["GL_MAX_TEXTURE_SIZE"]
        target = self._fitting_target((min(max(1, size[0] // divisor), most), min(max(1, size[1] // divisor), most)))
        target.use()
        self._context.enable_only(moderngl.DEPTH_TEST)
        target.clear(*self.geometry.background, 1.0, depth=1.0)
        for program in (self._soup, self._round):
            self._place(program, camera, size)
        self._draw_triangles()
        self._draw_quadrics()
        self._context.finish()
        if hurried and time.perf_counter() - began > SMOOTH:
            self._coarse = min(2 * self._coarse, COARSEST)
        self._drawn = wanted

    def release(self) -> None:
        """Free everything on the GPU."""
        self._release_target()
        for made in reversed(self._owned):
            made.release()
        self._owned.clear()

    # --- what is made once -----------------------------------------------------------------------

    def _kept(self, made: Any) -> Any:
        self._owned.append(made)
        return made

    def _program(self, vertex: str, fragment: str) -> Any:
        version = "#version 330 core\n"
        source = version + shader_source("preview.glsl") + shader_source(vertex)
        return self._kept(self._context.program(vertex_shader=source, fragment_shader=version + fragment))

    def _buffer(self, data: NDArray[np.void]) -> Any:
        if not len(data):
            return None
        buffer = self._kept(self._context.buffer(reserve=data.nbytes))
        self._pieces.append((buffer, data))
        return buffer

    def _array(self, program: Any, buffer: Any, layout: tuple[str, ...]) -> Any:
        if buffer is None:
            return None
        return self._kept(self._context.vertex_array(program, [(buffer, *layout)]))

    def _material_texture(self) -> Any:
        rows = self.geometry.materials
        lines = max(1, -(-len(rows) // A_ROW))
        table = np.zeros(lines * A_ROW, MATERIAL)
        table[: len(rows)] = rows
        texture = self._context.texture((3 * A_ROW, lines), 4, table.tobytes(), dtype="f4")
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return texture

    def _image(self, pixels: NDArray[np.uint8]) -> Any:
        texture = self._kept(self._context.texture(pixels.shape[1::-1], 3, pixels.tobytes(), alignment=1))
        texture.build_mipmaps()
        return texture

    # --- a picture -------------------------------------------------------------------------------

    def _place(self, program: Any, camera: Camera, size: tuple[int, int]) -> None:
        """The camera, and the light."""
        g, basis = self.geometry, camera.basis()
        half = math.tan(math.radians(camera.angle) / 2.0)
        self._range = _range(camera, g.box)
        lamps = np.zeros((16, 4), np.float32)
        lamps[: 2 * len(g.lights)] = _dimmed(g.lights).reshape(-1, 4)
        values = {
            "eye": camera.position, "slope": (half * size[0] / size[1], half), "near_far": self._range,
            "sky": g.ambient, "materials_a_row": A_ROW, "lamp_count": len(g.lights), "materials": 0, "image": 1,
        }  # fmt: skip
        for name, value in values.items():
            if name in program:
                program[name] = value
        program["view"].write(
            basis.astype(np.float32).tobytes()
        )  # its columns are the axes, so that p * view is p in them
        program["lamps"].write(lamps.tobytes())

    def _draw_triangles(self) -> None:
        if self._soup_array is None:
            return
        self._materials.use(0)
        for number, first, count in self.geometry.batches:
            texture = self._textures.get(number)
            self._soup["textured"] = texture is not None
            if texture is not None:
                texture.use(1)
            self._soup_array.render(moderngl.TRIANGLES, vertices=count, first=first)

    def _draw_quadrics(self) -> None:
        self._materials.use(0)
        self._round["textured"] = False
        for array, count, rings in self._rounds:
            self._round["rings"], self._round["sectors"] = rings, 2 * rings
            array.render(moderngl.TRIANGLES, vertices=12 * rings**2, instances=count)

    def _fitting_target(self, size: tuple[int, int]) -> Any:
        if self._target is None or self._target.size != size:
            self._release_target()
            color, depth = self._context.texture(size, 4), self._context.depth_texture(size)
            color.repeat_x = color.repeat_y = False
            self._target = self._context.framebuffer([color], depth)
        return self._target

    def _release_target(self) -> None:
        if self._target is not None:
            color, depth = self._target.color_attachments[0], self._target.depth_attachment
            self._target.release()
            color.release()
            depth.release()
            self._target = None


def _layout(record: np.dtype, program: Any, each: str = "") -> tuple[str, ...]:
    """The fields of a record as ModernGL wants them: a format, and their names in the shader."""
    formats, names = [], []
    for field in record.names or ():
        shape = record[field].shape
        rows, columns = (1, (shape or (1,))[0]) if len(shape) < 2 else shape
        for row in range(rows):
            name = field if rows == 1 else f"row_{'xyz'[row]}"
            present = name in program
            formats.append(f"{columns}f4" if present else f"{4 * columns}x")
            names += [name] * present
    return (" ".join(formats) + each, *names)


def _dimmed(lights: NDArray[np.float32]) -> NDArray[np.float32]:
    """Lights that nothing shades, less bright where all together would wash the picture out."""
    made, constant = lights.copy(), lights[:, 7] == 0.0
    made[constant, 4:7] *= min(1.0, BRIGHTEST / max(float(lights[constant, 4:7].sum(axis=0).max(initial=0.0)), 1e-6))
    return made


def _range(camera: Camera, box: NDArray[np.float64]) -> tuple[float, float]:
    """The nearest and the farthest that is drawn: all of the box, and not too close for the depth buffer."""
    corners = np.array([[box[i][0], box[j][1], box[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    ahead = (corners - camera.position) @ camera.basis()[2]
    far = max(float(ahead.max()), 1e-3 * float(np.linalg.norm(box[1] - box[0])), 1e-12) * 1.01
    return max(float(ahead.min()) * 0.99, far * _NEAREST), far

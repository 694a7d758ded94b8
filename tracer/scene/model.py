"""What is in the world, as plain arrays; nothing here knows of rays.

A scene is a list of *objects*.  Object 0 is everything that never moves, already in world
space; every other object is dynamic: it has geometry in its own space and either a chain of
transforms that are evaluated for each frame, or triangles that deform by keyframes.

Primitives are numbered over the whole scene: first all triangles, object by object, then all quadrics (spheres and
cones), object by object.  Frames, modes and pictures of modes refer to primitives by these numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tracer.scene.animation import Animation
from tracer.scene.arrays import Float32, Float64, Int32
from tracer.scene.camera import Camera
from tracer.scene.deformation import Deformation
from tracer.scene.lights import Light

SPHERE = 0
CONE = 1

Progress = Callable[[str, float], None]
"""Called with what is being done and the fraction done (0 to 1); raises `Cancelled` to stop."""


class SceneError(Exception):
    """A scene cannot be read; the message is one line naming file and line."""


class Cancelled(Exception):
    """The user stopped a long operation; nothing that was loaded before is lost."""


@dataclass(frozen=True)
class Material:
    """Whitted material (AFF `f` and `fm`).  Colours are (r, g, b) in linear units.

    `exponent` is the Phong exponent (4 x `shine` of an AFF file), `transmission` scales a
    refracted ray and is 0 for an opaque surface, `ior` is the index of refraction inside.
    """

    name: str = "material"
    ambient: tuple[float, float, float] = (0.1, 0.1, 0.1)
    diffuse: tuple[float, float, float] = (0.7, 0.7, 0.7)
    specular: tuple[float, float, float] = (0.0, 0.0, 0.0)
    exponent: float = 1.0
    transmission: float = 0.0
    ior: float = 1.0


@dataclass(frozen=True)
class Texture:
    """An image that repeats in u and v; v = 0 is the bottom row.  pixels (h, w, 3) uint8, row 0 at the top."""

    name: str
    pixels: NDArray[np.uint8]


@dataclass(frozen=True)
class Triangles:
    """n triangles as structure of arrays, corners counter-clockwise seen from outside.

    corners (n, 3, 3) float32; normals (n, 3, 3) float32, per corner and of unit length (the
    geometric normal thrice where the file gives none); uvs (n, 3, 2) float32; material (n,)
    int32 into `Scene.materials`; texture (n,) int32 into `Scene.textures`, -1 for none.
    """

    corners: Float32
    normals: Float32
    uvs: Float32
    material: Int32
    texture: Int32

    def __len__(self) -> int:
        return len(self.corners)


@dataclass(frozen=True)
class Quadrics:
    """m spheres and cones, each an affine image of a canonical one, so that any transform fits.

    kind (m,) int32: SPHERE is the unit sphere; CONE is x^2 + y^2 = (r0 + (r1 - r0) z)^2 for
    0 <= z <= 1, open.  to_object (m, 3, 4) float64 takes canonical to object space; radii (m, 2)
    float32 are a cone's r0 and r1 in canonical space; inside (m,) bool is true where the file's
    negative radius says that the surface is meant to be seen from inside; material (m,) int32.
    """

    kind: Int32
    to_object: Float64
    radii: Float32
    inside: NDArray[np.bool_]
    material: Int32

    def __len__(self) -> int:
        return len(self.kind)


@dataclass(frozen=True)
class SceneObject:
    """Geometry that moves as one.  Object 0 of a scene is static and has no chain.

    chain, outermost first, holds (4, 4) float64 matrices and names of tracks
    (`Scene.animation.tracks`); empty for world space.  Where `deformation` is set, `triangles`
    holds its first key.  Static geometry has `parts`, the names of what it is put together from, and
    part_of (primitives,) int32, which of them each triangle, and then each quadric, belongs to.
    """

    name: str
    triangles: Triangles
    quadrics: Quadrics
    chain: tuple[Float64 | str, ...] = ()
    deformation: Deformation | None = None
    parts: tuple[str, ...] = ()
    part_of: Int32 | None = None


def empty_triangles() -> Triangles:
    return Triangles(
        np.empty((0, 3, 3), np.float32),
        np.empty((0, 3, 3), np.float32),
        np.empty((0, 3, 2), np.float32),
        np.empty(0, np.int32),
        np.empty(0, np.int32),
    )


def empty_quadrics() -> Quadrics:
    return Quadrics(
        np.empty(0, np.int32),
        np.empty((0, 3, 4), np.float64),
        np.empty((0, 2), np.float32),
        np.empty(0, np.bool_),
        np.empty(0, np.int32),
    )


@dataclass(frozen=True)
class Scene:
    """A world and how it changes.  `animation` (see `tracer.scene.animation`) holds the tracks;
    time runs from `time_range[0]` to `time_range[1]` seconds in `frames` frames."""

    path: Path
    objects: tuple[SceneObject, ...]
    materials: tuple[Material, ...]
    textures: tuple[Texture, ...]
    lights: tuple[Light, ...]
    camera: Camera
    animation: Animation
    background: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ambient: tuple[float, float, float] = (1.0, 1.0, 1.0)
    time_range: tuple[float, float] = (0.0, 0.0)
    frames: int = 1
    warnings: tuple[str, ...] = field(default=())

    @cached_property
    def triangle_offsets(self) -> Int32:
        """(objects + 1,) number of the first triangle of each object; the last entry is their total."""
        return np.concatenate([[0], np.cumsum([len(o.triangles) for o in self.objects])]).astype(np.int32)

    @cached_property
    def quadric_offsets(self) -> Int32:
        """(objects + 1,) number of the first quadric primitive of each object (counted after all triangles)."""
        counts = np.cumsum([len(o.quadrics) for o in self.objects])
        return (self.triangle_offsets[-1] + np.concatenate([[0], counts])).astype(np.int32)

    @property
    def triangle_count(self) -> int:
        return int(self.triangle_offsets[-1])

    @property
    def primitive_count(self) -> int:
        return int(self.quadric_offsets[-1])

    def object_of(self, primitive: int) -> int:
        """Index into `objects` of the object that holds a primitive."""
        offsets = self.triangle_offsets if primitive < self.triangle_count else self.quadric_offsets
        return int(np.searchsorted(offsets, primitive, side="right")) - 1

    def place_of(self, primitive: int) -> tuple[SceneObject, int]:
        """The object that holds a primitive, and its place there: the triangles, then the quadrics."""
        o = self.object_of(primitive)
        if primitive < self.triangle_count:
            return self.objects[o], primitive - int(self.triangle_offsets[o])
        return self.objects[o], len(self.objects[o].triangles) + primitive - int(self.quadric_offsets[o])

    def name_of(self, primitive: int) -> str:
        """The name of the object that holds a primitive; of static geometry, the name of the part."""
        held, place = self.place_of(primitive)
        return held.name if held.part_of is None else held.parts[int(held.part_of[place])]

    def material_of(self, primitive: int) -> Material:
        held, place = self.place_of(primitive)
        quadric = place - len(held.triangles)
        return self.materials[int(held.quadrics.material[quadric] if quadric >= 0 else held.triangles.material[place])]

    def frame_time(self, frame: int) -> float:
        """Time of a frame: t0 + i (t1 - t0) / (N - 1) (AFF `a`)."""
        start, end = self.time_range
        return start if self.frames < 2 else start + frame * (end - start) / (self.frames - 1)

    def camera_at(self, time: float) -> Camera:
        """The scene's own camera at a time; its fixed one where no track moves it."""
        return self.animation.camera(self.camera, time)

    def light_positions(self, time: float) -> Float64:
        """(lights, 3) float64: where the lights are; a moving one is displaced by its translation track."""
        positions = np.array([light.position for light in self.lights], np.float64).reshape(-1, 3)
        for i, light in enumerate(self.lights):
            if light.track is not None:
                positions[i] += self.animation.translation(light.track, time)
        return positions

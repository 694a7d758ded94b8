"""The things of a scene (`tracer.scene.things`) by number, and what each primitive is, of a scene as it was read.

All is kept as arrays over primitives, as a scene may have millions of these."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import CONE, Scene
from tracer.scene.things import once_per_scene, things

KINDS = ("triangle", "sphere", "cone")


@dataclass(frozen=True)
class Parts:
    """Of p parts and n primitives.

    Attributes
    ----------
    names : tuple of p str
        Those of the things, in their order.
    part_of : (n,) int32
        The part of each primitive.
    moving : (p,) bool
        Which can move.
    kind : (n,) int8
        Into `KINDS`.
    material, texture : (n,) int32
        Into the scene's materials and textures; -1 for no texture.
    """

    names: tuple[str, ...]
    part_of: NDArray[np.int32]
    moving: NDArray[np.bool_]
    kind: NDArray[np.int8]
    material: NDArray[np.int32]
    texture: NDArray[np.int32]

    @cached_property
    def sizes(self) -> NDArray[np.int32]:
        """(p,) primitives of each part."""
        return np.bincount(self.part_of, minlength=len(self.names)).astype(np.int32)

    def primitives_of(self, part: int) -> NDArray[np.int64]:
        """Numbers of a part's primitives."""
        return np.flatnonzero(self.part_of == part)


@once_per_scene
def parts_of(scene: Scene) -> Parts:
    """Return the parts of a scene as it was read."""
    total = scene.primitive_count
    part_of, kind = np.zeros(total, np.int32), np.zeros(total, np.int8)
    material, texture = np.zeros(total, np.int32), np.full(total, -1, np.int32)
    found = things(scene)
    first: dict[int, int] = {}  # the number of an object's first part
    for number, thing in enumerate(found):
        first.setdefault(thing.index, number)
    for index, held in enumerate(scene.objects):
        start, count = int(scene.triangle_offsets[index]), len(held.triangles)
        begin, quadrics = int(scene.quadric_offsets[index]), len(held.quadrics)
        triangles, others = slice(start, start + count), slice(begin, begin + quadrics)
        mine = np.zeros(count + quadrics, np.int32) if held.part_of is None else held.part_of
        part_of[triangles], part_of[others] = mine[:count] + first.get(index, 0), mine[count:] + first.get(index, 0)
        material[triangles], material[others] = held.triangles.material, held.quadrics.material
        texture[triangles] = held.triangles.texture
        kind[others] = np.where(held.quadrics.kind == CONE, 2, 1)
    moving = np.array([thing.moves for thing in found], np.bool_)
    return Parts(tuple(thing.name for thing in found), part_of, moving, kind, material, texture)

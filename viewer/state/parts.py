"""The parts of a scene that have names: each piece of its static geometry, and each dynamic object.

They are numbered in the order of the scene: static parts first.  All is kept as arrays over primitives, as a scene may
have millions of these.
"""

from __future__ import annotations

import weakref
from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import CONE, Scene

KINDS = ("triangle", "sphere", "cone")
_KEPT = 2  # scenes whose parts are remembered


@dataclass(frozen=True)
class Parts:
    """Of p parts and n primitives.

    Attributes
    ----------
    names : tuple of p str
        As the scene gives them; dynamic objects may share one.
    part_of : (n,) int32
        The part of each primitive.
    moving : (p,) bool
        Which are dynamic objects.
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


_known: OrderedDict[int, tuple[weakref.ref[Scene], Parts]] = OrderedDict()


def parts_of(scene: Scene) -> Parts:
    """The parts of a scene, found once."""
    known = _known.get(id(scene))
    if known is None or known[0]() is not scene:
        known = _known[id(scene)] = weakref.ref(scene), _found(scene)
        while len(_known) > _KEPT:
            _known.popitem(last=False)
    return known[1]


def _found(scene: Scene) -> Parts:
    total = scene.primitive_count
    part_of, kind = np.zeros(total, np.int32), np.zeros(total, np.int8)
    material, texture = np.zeros(total, np.int32), np.full(total, -1, np.int32)
    names: list[str] = []
    moving: list[bool] = []
    for index, held in enumerate(scene.objects):
        first, count = int(scene.triangle_offsets[index]), len(held.triangles)
        quadric, quadrics = int(scene.quadric_offsets[index]), len(held.quadrics)
        triangles, others = slice(first, first + count), slice(quadric, quadric + quadrics)
        if held.part_of is None:
            part_of[triangles] = part_of[others] = len(names)
            mine: tuple[str, ...] = (held.name,)
        else:
            part_of[triangles] = held.part_of[:count] + len(names)
            part_of[others] = held.part_of[count : count + quadrics] + len(names)
            mine = held.parts
        names += mine
        moving += [index > 0] * len(mine)
        material[triangles], material[others] = held.triangles.material, held.quadrics.material
        texture[triangles] = held.triangles.texture
        kind[others] = np.where(held.quadrics.kind == CONE, 2, 1)
    return Parts(tuple(names), part_of, np.array(moving, np.bool_), kind, material, texture)

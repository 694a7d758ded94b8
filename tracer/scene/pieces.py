"""Shapes as a file gives them: in the file's own space, in double precision, with where they were read for messages."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from tracer.scene.animation import Chain
from tracer.scene.arrays import BLOCK, Float32, Float64

T = TypeVar("T")


class Place(Protocol):
    """Where something was written, for messages."""

    @property
    def source(self) -> Hashable:
        """What messages are counted by, such as the file."""

    @property
    def part(self) -> str:
        """What people call the thing it belongs to: its mesh, or the file it is in."""

    def __call__(self, item: int = 0) -> str:
        """The words for it; of a mesh, `item` is a triangle's number."""


@dataclass(frozen=True)
class TextureName:
    """A texture as a file names it."""

    name: str
    place: Place


@dataclass(frozen=True)
class Mesh:
    """n triangles: corners (n, 3, 3), and where the file has them normals (n, 3, 3) and uvs (n, 3, 2), all float64.

    In uvs v = 0 is the bottom row of an image.
    """

    corners: Float64
    place: Place
    normals: Float64 | None = None
    uvs: Float64 | None = None
    texture: TextureName | None = None

    def __len__(self) -> int:
        return len(self.corners)

    def blocks(self) -> Iterator[Mesh]:
        """The same, in as many parts as one wants to hold in memory several times."""
        if len(self) <= BLOCK:
            yield self
            return
        for start in range(0, len(self), BLOCK):
            part = slice(start, start + BLOCK)
            normals, uvs = (None if a is None else a[part] for a in (self.normals, self.uvs))
            yield replace(self, corners=self.corners[part], normals=normals, uvs=uvs)


@dataclass(frozen=True)
class IndexedMesh:
    """The same as a file has it, in a third of the memory: vertices (k, 3) and faces (n, 3); normals are those
    of corners (n, 3, 3) or of vertices (k, 3), uvs (k, 2) those of vertices."""

    vertices: Float32 | Float64
    faces: NDArray[np.integer]
    place: Place
    normals: Float32 | Float64 | None = None
    uvs: Float64 | None = None
    texture: TextureName | None = None

    def __len__(self) -> int:
        return len(self.faces)

    def blocks(self) -> Iterator[Mesh]:
        """As triangles by themselves, a part after the other."""
        for start in range(0, len(self), BLOCK):
            faces = self.faces[start : start + BLOCK]
            normals = self.normals
            if normals is not None:
                normals = normals[start : start + BLOCK] if normals.ndim == 3 else normals[faces]
            wide = None if normals is None else normals.astype(np.float64)
            corners = self.vertices[faces].astype(np.float64)
            yield Mesh(corners, self.place, wide, None if self.uvs is None else self.uvs[faces])


@dataclass(frozen=True)
class Morph:
    """One keyframed triangle: times (k,) ascending, corners and normals (k, 3, 3), all float64."""

    times: Float64
    corners: Float64
    normals: Float64
    place: Place


@dataclass(frozen=True)
class Quadric:
    """One sphere or cone: `kind`, radii and `inside` as in `Quadrics`; placed (4, 4) canonical to file space."""

    kind: int
    placed: Float64
    radii: tuple[float, float]
    inside: bool
    place: Place


@dataclass(frozen=True)
class Piece(Generic[T]):
    """A shape with the transforms it stands under, its material, and its texture (-1 for none)."""

    shape: T
    chain: Chain
    material: int
    texture: int = -1

"""From pieces under nested transforms to the objects of a scene.

While a file is read nobody knows which `x` moves: its `k` may come later.  So a piece is kept
with its whole chain of transforms, and only at the end chains are *resolved*: names without
tracks fall away, neighbouring matrices merge, and the matrix after the last moving name is
baked into the vertices.  What shares the rest of the chain moves as one object; an empty rest
is object 0, the static world.
"""

from __future__ import annotations

from collections.abc import Container, Iterable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from tracer.scene.aff_blocks import Mesh, Morph, Place, Quadric
from tracer.scene.aff_tokens import AffFile
from tracer.scene.animation import Chain
from tracer.scene.model import (
    CONE,
    Deformation,
    Float64,
    Quadrics,
    SceneObject,
    Triangles,
    empty_quadrics,
    empty_triangles,
)
from tracer.scene.normals import unit_normals

T = TypeVar("T")


@dataclass(frozen=True)
class Piece(Generic[T]):
    """A shape with the chain it stands under, its material, and its texture (-1 for none)."""

    shape: T
    chain: Chain
    material: int
    texture: int = -1


@dataclass
class Group:
    """Pieces that share a resolved chain; each comes with the matrix to bake into it."""

    name: str
    chain: Chain
    meshes: list[tuple[Piece[Mesh], Float64]] = field(default_factory=list)
    quadrics: list[tuple[Piece[Quadric], Float64]] = field(default_factory=list)
    morphs: dict[int, list[tuple[Piece[Morph], Float64]]] = field(default_factory=dict)  # by number of keys


class Losses:
    """What had to be dropped, counted per file and cause; each file is named with the first line concerned."""

    def __init__(self) -> None:
        self._found: dict[tuple[AffFile, str], tuple[str, int]] = {}

    def add(self, place: Place, item: int, what: str) -> None:
        first, count = self._found.get((place.file, what), (place(item), 0))
        self._found[place.file, what] = first, count + 1

    def warnings(self) -> Iterable[str]:
        for (_, what), (first, count) in self._found.items():
            more = f"; dropped {count} of this kind, here and after it" if count > 1 else "; dropped"
            yield f"{first}: {what}{more}"


def resolve(chain: Chain, moving: Container[str]) -> tuple[Chain, Float64]:
    """The chain without what stands still at its end, and that (4, 4) end."""
    merged: list[Float64 | str] = []
    for element in chain:
        if isinstance(element, str):
            if element in moving:
                merged.append(element)
        elif merged and not isinstance(merged[-1], str):
            merged[-1] = merged[-1] @ element
        elif not np.array_equal(element, np.eye(4)):
            merged.append(element)
    if merged and not isinstance(merged[-1], str):
        return tuple(merged[:-1]), merged[-1]
    return tuple(merged), np.eye(4)


@dataclass
class Geometry:
    """All pieces of a scene, in the order in which they were read."""

    meshes: list[Piece[Mesh]] = field(default_factory=list)
    quadrics: list[Piece[Quadric]] = field(default_factory=list)
    morphs: list[Piece[Morph]] = field(default_factory=list)

    def objects(self, moving: Container[str]) -> tuple[tuple[SceneObject, ...], list[str]]:
        """The objects, of which the first is static, and what is to be warned of; `moving` holds the tracks' names."""
        losses = Losses()
        rigid: list[SceneObject] = []
        deforming: list[SceneObject] = []
        with np.errstate(all="ignore"):  # numbers that overflow are found, and named, afterwards
            for group in self._groups(moving):
                triangles, quadrics = _triangles(group.meshes, losses), _quadrics(group.quadrics, losses)
                if not group.chain or len(triangles) or len(quadrics):
                    rigid.append(SceneObject(group.name, triangles, quadrics, group.chain))
                name = f"{group.name} (deforming)" if group.chain else "deforming"
                for pieces in group.morphs.values():
                    triangles, deformation = _deforming(pieces, losses)
                    if len(triangles):
                        deforming.append(SceneObject(name, triangles, empty_quadrics(), group.chain, deformation))
        return tuple(rigid + deforming), list(losses.warnings())

    def _groups(self, moving: Container[str]) -> Iterable[Group]:
        resolved: dict[int, tuple[Group, Float64]] = {}  # by the chain's identity: many pieces share one
        groups: dict[tuple[bytes | str, ...], Group] = {(): Group("static", ())}

        def group_of(chain: Chain) -> tuple[Group, Float64]:
            if id(chain) not in resolved:
                rest, baked = resolve(chain, moving)
                key = tuple(e if isinstance(e, str) else e.tobytes() for e in rest)
                name = "/".join(e for e in rest if isinstance(e, str))
                resolved[id(chain)] = groups.setdefault(key, Group(name, rest)), baked
            return resolved[id(chain)]

        for mesh in self.meshes:
            group, baked = group_of(mesh.chain)
            group.meshes.append((mesh, baked))
        for quadric in self.quadrics:
            group, baked = group_of(quadric.chain)
            group.quadrics.append((quadric, baked))
        for morph in self.morphs:
            group, baked = group_of(morph.chain)
            group.morphs.setdefault(len(morph.shape.times), []).append((morph, baked))
        return groups.values()


def _normal_matrix(matrix: Float64) -> Float64:
    """(3, 3) that takes normals along: the inverse transpose up to a positive scale, also of a singular matrix."""
    x, y, z = matrix[:3, :3].T
    cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
    return -cofactors if _mirrors(matrix) else cofactors


def _mirrors(matrix: Float64) -> bool:
    return bool(np.linalg.det(matrix[:3, :3]) < 0)


def _placed(corners: Float64, normals: Float64 | None, matrix: Float64) -> tuple[Float64, Float64]:
    """Corners and normals (..., 3, 3) under a matrix, still counter-clockwise from outside; no normals become zero."""
    corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
    normals = np.zeros_like(corners) if normals is None else normals @ _normal_matrix(matrix).T
    if _mirrors(matrix):
        corners, normals = corners[..., [0, 2, 1], :], normals[..., [0, 2, 1], :]
    return corners, normals


def _kept(corners: Float64, places: list[Place], lengths: NDArray[np.intp], losses: Losses) -> NDArray[np.bool_]:
    """(n,) which of n triangles (n, ..., 3, 3) are good; the others are lost."""
    good = np.isfinite(corners.astype(np.float32)).reshape(len(corners), -1).all(axis=1)
    starts = np.concatenate([[0], np.cumsum(lengths)])
    for bad in np.flatnonzero(~good):
        piece = int(np.searchsorted(starts, bad, side="right")) - 1
        what = "a triangle with a corner that is not a finite number"
        losses.add(places[piece], int(bad - starts[piece]), what)
    return good


def _triangles(pieces: list[tuple[Piece[Mesh], Float64]], losses: Losses) -> Triangles:
    if not pieces:
        return empty_triangles()
    placed = [_placed(piece.shape.corners, piece.shape.normals, baked) for piece, baked in pieces]
    lengths = np.array([len(corners) for corners, _ in placed])
    corners = np.concatenate([c for c, _ in placed])
    normals = np.concatenate([n for _, n in placed])
    uvs = np.concatenate([_uvs(piece.shape, baked) for piece, baked in pieces])
    material = np.repeat(np.array([piece.material for piece, _ in pieces], np.int32), lengths)
    texture = np.repeat(np.array([piece.texture for piece, _ in pieces], np.int32), lengths)
    good = _kept(corners, [piece.shape.place for piece, _ in pieces], lengths, losses)
    if not good.all():
        corners, normals, uvs = corners[good], normals[good], uvs[good]
        material, texture = material[good], texture[good]
    return Triangles(corners.astype(np.float32), unit_normals(normals, corners), uvs, material, texture)


def _uvs(mesh: Mesh, matrix: Float64) -> NDArray[np.float32]:
    if mesh.uvs is None:
        return np.zeros((len(mesh.corners), 3, 2), np.float32)
    uvs = mesh.uvs[:, [0, 2, 1]] if _mirrors(matrix) else mesh.uvs
    return np.nan_to_num(uvs.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0)


def _quadrics(pieces: list[tuple[Piece[Quadric], Float64]], losses: Losses) -> Quadrics:
    good: list[tuple[Piece[Quadric], Float64]] = []
    for piece, baked in pieces:
        placed, radii = baked @ piece.shape.placed, piece.shape.radii
        what = "cone" if piece.shape.kind == CONE else "sphere"
        if not np.isfinite(placed.astype(np.float32)).all() or not np.isfinite(np.array(radii, np.float32)).all():
            losses.add(piece.shape.place, 0, f"a {what} with a number that is not finite")
        elif max(radii) == 0 or abs(np.linalg.det(placed[:3, :3])) == 0:
            losses.add(piece.shape.place, 0, f"a {what} without extent")
        else:
            good.append((piece, placed))
    if not good:
        return empty_quadrics()
    return Quadrics(
        np.array([piece.shape.kind for piece, _ in good], np.int32),
        np.stack([placed[:3] for _, placed in good]),
        np.array([piece.shape.radii for piece, _ in good], np.float32),
        np.array([piece.shape.inside for piece, _ in good], np.bool_),
        np.array([piece.material for piece, _ in good], np.int32),
    )


def _deforming(pieces: list[tuple[Piece[Morph], Float64]], losses: Losses) -> tuple[Triangles, Deformation]:
    placed = [_placed(piece.shape.corners, piece.shape.normals, baked) for piece, baked in pieces]
    corners, normals = np.stack([c for c, _ in placed]), np.stack([n for _, n in placed])
    times = np.stack([piece.shape.times for piece, _ in pieces])
    everything = np.concatenate([corners.reshape(len(corners), -1), times], axis=1)
    good = _kept(everything, [piece.shape.place for piece, _ in pieces], np.ones(len(pieces), np.intp), losses)
    corners, normals, times = corners[good], np.nan_to_num(normals[good], posinf=0.0, neginf=0.0), times[good]
    material = np.array([piece.material for piece, _ in pieces], np.int32)[good]
    first = Triangles(
        corners[:, 0].astype(np.float32),
        unit_normals(normals[:, 0], corners[:, 0]),
        np.zeros((len(corners), 3, 2), np.float32),
        material,
        np.full(len(corners), -1, np.int32),
    )
    return first, Deformation(times, corners.astype(np.float32), normals.astype(np.float32))

"""From pieces under nested transforms to the objects of a scene.

While a file is being read it is not known yet which transforms `x` are animated: a `k` for one may come later.  So
every piece keeps its whole chain of transforms, and only at the end chains are *resolved*: names without tracks are
dropped, neighbouring matrices are multiplied, and the matrix after the last animated name is baked into the vertices.
Pieces that have the rest of the chain in common move as one object; those with nothing left are object 0, the static
geometry.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.scene.animation import Chain
from tracer.scene.arrays import BLOCK, Float64
from tracer.scene.bounds import quadric_boxes
from tracer.scene.deformation import Deformation
from tracer.scene.limits import LARGEST, SMALLEST
from tracer.scene.model import CONE, Quadrics, SceneObject, Triangles, empty_quadrics, empty_triangles
from tracer.scene.normals import unit_normals
from tracer.scene.pieces import IndexedMesh, Mesh, Morph, Piece, Place, Quadric

PIECES_BETWEEN_REPORTS = 4096


@dataclass
class Group:
    """Pieces that share a resolved chain; each comes with the matrix to bake into it."""

    name: str
    chain: Chain
    meshes: list[tuple[Piece[Mesh | IndexedMesh], Float64]] = field(default_factory=list)
    quadrics: list[tuple[Piece[Quadric], Float64]] = field(default_factory=list)
    morphs: dict[int, list[tuple[Piece[Morph], Float64]]] = field(default_factory=dict)  # by number of keys


class Remarks:
    """Warnings about pieces, counted by source and kind; each names the first place in its source."""

    def __init__(self) -> None:
        self._found: dict[tuple[Hashable, str], tuple[str, int]] = {}

    def add(self, place: Place, item: int, what: str) -> None:
        first, count = self._found.get((place.source, what), ("", 0))
        self._found[place.source, what] = first or place(item), count + 1

    def warnings(self) -> Iterable[str]:
        for (_, what), (first, count) in self._found.items():
            yield f"{first}: {what}" + (f" (the first of {count} in this file)" if count > 1 else "")


def resolve(chain: Chain, moving: Container[str]) -> tuple[Chain, Float64]:
    """The chain without the matrices at its end, and their product (4, 4)."""
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

    meshes: list[Piece[Mesh | IndexedMesh]] = field(default_factory=list)
    quadrics: list[Piece[Quadric]] = field(default_factory=list)
    morphs: list[Piece[Morph]] = field(default_factory=list)

    def objects(
        self, moving: Container[str], report: Callable[[], None] = lambda: None
    ) -> tuple[tuple[SceneObject, ...], list[str]]:
        """The objects, of which the first is static, and what is to be warned of; `moving` holds the tracks' names.
        `report` is called again and again on the way, and may raise Cancelled."""
        remarks = Remarks()
        rigid: list[SceneObject] = []
        deforming: list[SceneObject] = []
        with np.errstate(all="ignore"):  # numbers that overflow are found, and named, afterwards
            for group in self._groups(moving):
                triangles, meshes = _triangles(group.meshes, remarks, report)
                quadrics, others = _quadrics(group.quadrics, remarks, report)
                made = SceneObject(group.name, triangles, quadrics, group.chain)
                if not group.chain:
                    rigid.append(_with_parts(made, [*meshes, *others]))
                elif len(triangles) or len(quadrics):
                    rigid.append(made)
                name = f"{group.name} (deforming)" if group.chain else "deforming"
                for pieces in group.morphs.values():
                    triangles, deformation = _deforming(pieces, remarks)
                    if len(triangles):
                        deforming.append(SceneObject(name, triangles, empty_quadrics(), group.chain, deformation))
        return tuple(rigid + deforming), list(remarks.warnings())

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


def under_matrix(corners: Float64, normals: Float64 | None, matrix: Float64) -> tuple[Float64, Float64]:
    """Corners and normals (..., 3, 3) under a matrix, still counter-clockwise from outside; no normals become zero."""
    if np.array_equal(matrix, np.eye(4)):
        return corners, np.zeros_like(corners) if normals is None else normals
    corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
    normals = np.zeros_like(corners) if normals is None else normals @ _normal_matrix(matrix).T
    if _mirrors(matrix):
        corners, normals = corners[..., [0, 2, 1], :], normals[..., [0, 2, 1], :]
    return corners, normals


class _Origin:
    """Which piece, and which of its triangles, each of n triangles in a row came from."""

    def __init__(self, places: Sequence[Place], lengths: Sequence[int]) -> None:
        self._places = places
        self._starts = np.concatenate([[0], np.cumsum(lengths)])

    def remark(self, which: NDArray[np.bool_], what: str, remarks: Remarks) -> None:
        for triangle in np.flatnonzero(which):
            piece = int(np.searchsorted(self._starts, triangle, side="right")) - 1
            remarks.add(self._places[piece], int(triangle - self._starts[piece]), what)

    def remark_lost(self, finite: NDArray[np.bool_], good: NDArray[np.bool_], remarks: Remarks) -> None:
        """Say of what is not `good` why it is dropped."""
        self.remark(~finite, "a triangle with a corner that is not a finite number is dropped; correct it", remarks)
        self.remark(finite & ~good, f"a triangle with a corner beyond {LARGEST:g} is dropped; bring it nearer", remarks)


def _finite(corners: Float64) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(n,) which of n triangles (n, ...) are finite, and which of these tracing can bear."""
    others = tuple(range(1, corners.ndim))
    return np.all(np.isfinite(corners), axis=others), np.all(np.abs(corners) <= LARGEST, axis=others)


Counted = tuple[Piece, int]
"""A piece, and how many primitives of an object in a row are of it."""


def _with_parts(static: SceneObject, counted: list[Counted]) -> SceneObject:
    """Static geometry, with the names of its parts: of the innermost transform, else of the mesh or the file."""
    named = [
        (next((e for e in reversed(piece.chain) if isinstance(e, str)), piece.shape.place.part), count)
        for piece, count in counted
    ]
    numbers = {name: number for number, name in enumerate(dict.fromkeys(name for name, _ in named))}
    part_of = np.repeat(
        np.array([numbers[name] for name, _ in named], np.int32), np.array([count for _, count in named], np.int64)
    )
    return replace(static, parts=tuple(numbers), part_of=part_of)


def _told(pieces: list[Any], report: Callable[[], None]) -> Iterator[Any]:
    """The pieces; `report` is called now and then."""
    for number, piece in enumerate(pieces):
        if number % PIECES_BETWEEN_REPORTS == 0:
            report()
        yield piece


Meshes = list[tuple[Piece[Mesh | IndexedMesh], Float64]]


def _blocks(pieces: Meshes, report: Callable[[], None]) -> Iterator[tuple[list[Mesh], Float64]]:
    """All meshes in their order, with the matrix to bake into them: those in a row that have the same one at once, as a
    scene may consist of a million polygons, but not too many triangles, as others consist of one mesh of millions."""
    run: list[Mesh] = []
    triangles, kind, matrix = 0, None, np.eye(4)
    for piece, baked in _told(pieces, report):
        for mesh in piece.shape.blocks():
            if run and (kind != (id(baked), mesh.normals is None) or triangles + len(mesh) > BLOCK):
                report()
                yield run, matrix
                run, triangles = [], 0
            kind, matrix = (id(baked), mesh.normals is None), baked
            run.append(mesh)
            triangles += len(mesh)
    if run:
        yield run, matrix


def _triangles(pieces: Meshes, remarks: Remarks, report: Callable[[], None]) -> tuple[Triangles, list[Counted]]:
    """All triangles of an object.  Those without area stay, although no ray meets them: BART counts them."""
    if not pieces:
        return empty_triangles(), []
    lengths = [len(piece.shape) for piece, _ in pieces]
    n = sum(lengths)
    single, units = np.empty((n, 3, 3), np.float32), np.empty((n, 3, 3), np.float32)
    uvs = np.zeros((n, 3, 2), np.float32)
    good, finite, flat = np.empty(n, np.bool_), np.empty(n, np.bool_), np.empty(n, np.bool_)
    start = 0
    for run, matrix in _blocks(pieces, report):
        bare = run[0].normals is None
        normals = None if bare else np.concatenate([mesh.normals for mesh in run])
        corners, normals = under_matrix(np.concatenate([mesh.corners for mesh in run]), normals, matrix)
        part = slice(start, start + len(corners))
        start = part.stop
        finite[part], good[part] = _finite(corners)
        single[part] = rounded = corners.astype(np.float32)
        flat[part] = good[part] & ~np.cross(rounded[:, 1] - rounded[:, 0], rounded[:, 2] - rounded[:, 0]).any(axis=1)
        if any(mesh.uvs is not None for mesh in run):  # else what is 0 everywhere takes no memory
            uvs[part] = np.concatenate([_uvs(mesh, matrix) for mesh in run])
        units[part] = unit_normals(normals, corners)
    material = np.repeat(np.array([piece.material for piece, _ in pieces], np.int32), lengths)
    texture = np.repeat(np.array([piece.texture for piece, _ in pieces], np.int32), lengths)
    origin = _Origin([piece.shape.place for piece, _ in pieces], lengths)
    origin.remark_lost(finite, good, remarks)
    kept = lengths if good.all() else np.diff(np.concatenate([[0], np.cumsum(good)])[np.cumsum([0, *lengths])])
    counted: list[Counted] = [(piece, int(count)) for (piece, _), count in zip(pieces, kept)]
    if flat.any():
        origin.remark(flat, "a triangle without area is kept, but no ray can meet it", remarks)
    if not good.all():
        single, units, uvs, material, texture = single[good], units[good], uvs[good], material[good], texture[good]
    return Triangles(single, units, uvs, material, texture), counted


def _uvs(mesh: Mesh, matrix: Float64) -> NDArray[np.float32]:
    if mesh.uvs is None:
        return np.zeros((len(mesh.corners), 3, 2), np.float32)
    uvs = mesh.uvs[:, [0, 2, 1]] if _mirrors(matrix) else mesh.uvs
    return np.nan_to_num(uvs.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0)


def _reach(quadric: Quadric, placed: Float64) -> float:
    """The largest coordinate of a quadric under a matrix (4, 4)."""
    kind, radii = np.array([quadric.kind], np.int32), np.array([quadric.radii])
    return float(np.abs(quadric_boxes(kind, radii, placed[None, :3])).max())


def _invertible(linear: Float64) -> bool:
    """Whether rays can be brought to the space that a matrix (3, 3) maps from."""
    try:
        return bool(np.abs(np.linalg.inv(linear)).max() <= 1 / SMALLEST)
    except np.linalg.LinAlgError:
        return False


def _quadrics(
    pieces: list[tuple[Piece[Quadric], Float64]], remarks: Remarks, report: Callable[[], None]
) -> tuple[Quadrics, list[Counted]]:
    good: list[tuple[Piece[Quadric], Float64]] = []
    for piece, baked in _told(pieces, report):
        placed, radii = baked @ piece.shape.placed, piece.shape.radii
        what = "a cone" if piece.shape.kind == CONE else "a sphere"
        if not np.isfinite(np.append(placed, radii)).all():
            remarks.add(piece.shape.place, 0, f"{what} with a number that is not finite is dropped; correct it")
        elif not _reach(piece.shape, placed) <= LARGEST:
            too_large = f"{what} beyond {LARGEST:g} is dropped; make it smaller or bring it nearer"
            remarks.add(piece.shape.place, 0, too_large)
        elif max(radii) == 0 or not _invertible(placed[:3, :3]):
            remarks.add(piece.shape.place, 0, f"{what} without extent is dropped; give it a radius and a length")
        else:
            good.append((piece, placed))
    if not good:
        return empty_quadrics(), []
    quadrics = Quadrics(
        np.array([piece.shape.kind for piece, _ in good], np.int32),
        np.stack([placed[:3] for _, placed in good]),
        np.array([piece.shape.radii for piece, _ in good], np.float32),
        np.array([piece.shape.inside for piece, _ in good], np.bool_),
        np.array([piece.material for piece, _ in good], np.int32),
    )
    return quadrics, [(piece, 1) for piece, _ in good]


def _deforming(pieces: list[tuple[Piece[Morph], Float64]], remarks: Remarks) -> tuple[Triangles, Deformation]:
    placed = [under_matrix(piece.shape.corners, piece.shape.normals, baked) for piece, baked in pieces]
    corners, normals = np.stack([c for c, _ in placed]), np.stack([n for _, n in placed])
    times = np.stack([piece.shape.times for piece, _ in pieces])
    origin = _Origin([piece.shape.place for piece, _ in pieces], [1] * len(pieces))
    finite, good = _finite(np.concatenate([corners.reshape(len(corners), -1), times], axis=1))
    origin.remark_lost(finite, good, remarks)
    corners, times = corners[good], times[good]
    single = np.nan_to_num(normals[good].astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0)
    first = Triangles(
        corners[:, 0].astype(np.float32),
        unit_normals(single[:, 0], corners[:, 0]),
        np.zeros((len(corners), 3, 2), np.float32),
        np.array([piece.material for piece, _ in pieces], np.int32)[good],
        np.full(len(corners), -1, np.int32),
    )
    return first, Deformation(times, corners.astype(np.float32), single)

"""The statements of AFF that carry geometry or tracks, read into arrays in the file's own space.

Nothing here knows of transforms, materials or what came before: a block means the same wherever
it is included, which is why meshes can be remembered by their place in the file.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tracer.scene.aff_tokens import AffFile, Cursor, quoted
from tracer.scene.animation import Keys, TrackSet
from tracer.scene.arrays import Float64
from tracer.scene.model import CONE, SPHERE
from tracer.scene.pieces import Mesh, Morph, Quadric, TextureName


@dataclass(frozen=True)
class WordPlace:
    """The word at `index` of a file, and `stride` words on for each further item."""

    source: AffFile
    index: int
    stride: int = 0

    @property
    def part(self) -> str:
        return self.source.path.stem

    def __call__(self, item: int = 0) -> str:
        """`file:line` of an item."""
        return self.source.place(self.index + item * self.stride)


def _turned(uvs: Float64) -> Float64:
    """AFF counts v from the top row of an image, our arrays from the bottom row."""
    return uvs * (1.0, -1.0) + (0.0, 1.0)


def _texture_name(at: Cursor) -> TextureName:
    return TextureName(at.name("the name of a texture"), WordPlace(at.file, at.position - 1))


def read_mesh(at: Cursor) -> Mesh:
    """`m`, remembered by position: a file included again costs nothing here."""
    start = at.position
    if start not in at.file.memo:
        at.file.memo[start] = (_read_mesh(at), at.position)
    mesh, at.position = at.file.memo[start]
    return mesh


def _read_mesh(at: Cursor) -> Mesh:
    at.expect(b"vertices", "of a mesh")
    pools = {"vertices": at.numbers(3 * at.count("vertices"), "vertices", finite=False).reshape(-1, 3)}
    texture = None
    if at.peek() == b"normals":
        at.word("normals")
        pools["normals"] = at.numbers(3 * at.count("normals"), "normals", finite=False).reshape(-1, 3)
    if at.peek() == b"texturecoords":
        at.word("texturecoords")
        count = at.count("texturecoords")
        texture = _texture_name(at)
        coordinates = at.numbers(2 * count, "texturecoords", finite=False).reshape(-1, 2)
        pools["texturecoords"] = _turned(coordinates)
    at.expect(b"triangles", "of a mesh")
    count, stride = at.count("triangles"), 3 * len(pools)
    start = at.position
    rows = at.indices(count * stride, "triangles").reshape(count, stride)
    arrays = {}
    for column, (name, pool) in enumerate(pools.items()):
        index = rows[:, 3 * column : 3 * column + 3]
        if index.size and (index.min() < 0 or index.max() >= len(pool)):
            row, corner = np.argwhere((index < 0) | (index >= len(pool)))[0]
            what = f"index {index[row, corner]} into {name} is out of range; there are {len(pool)}, counted from 0"
            raise at.error(what, start + int(row) * stride + 3 * column + int(corner))
        arrays[name] = pool[index]
    place = WordPlace(at.file, start, stride)
    return Mesh(arrays["vertices"], place, arrays.get("normals"), arrays.get("texturecoords"), texture)


def read_polygon(at: Cursor, with_normals: bool) -> Mesh:
    """`p` and `pp`: a convex polygon as the fan from its first corner."""
    place = WordPlace(at.file, at.position - 1)
    count = at.count("corners of a polygon", least=3)
    rows = at.numbers(count * (6 if with_normals else 3), "a polygon", finite=False).reshape(count, -1)
    fan = np.stack([np.zeros(count - 2, np.int64), np.arange(1, count - 1), np.arange(2, count)], axis=1)
    corners = rows[fan]
    return Mesh(corners[..., :3], place, corners[..., 3:] if with_normals else None)


def read_textured_triangle(at: Cursor, with_normals: bool) -> Mesh:
    """`tt` and `ttp`."""
    place = WordPlace(at.file, at.position - 1)
    texture = _texture_name(at)
    rows = at.numbers(24 if with_normals else 15, "a textured triangle", finite=False).reshape(1, 3, -1)
    normals = rows[..., 3:6] if with_normals else None
    return Mesh(rows[..., :3], place, normals, _turned(rows[..., -2:]), texture)


def read_morph(at: Cursor) -> Morph:
    """`tpa`; keys that are out of order are sorted by time."""
    place = WordPlace(at.file, at.position - 1)
    count = at.count("keys of an animated triangle", least=1)
    rows = at.numbers(19 * count, "an animated triangle", finite=False).reshape(count, 19)
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    corners = rows[:, 1:].reshape(count, 3, 6)
    return Morph(rows[:, 0], corners[..., :3], corners[..., 3:], place)


def read_sphere(at: Cursor) -> Quadric:
    """`s`; a negative radius means that it is seen from inside."""
    place = WordPlace(at.file, at.position - 1)
    x, y, z, radius = at.numbers(4, "a sphere", finite=False).tolist()
    placed = np.diag([abs(radius)] * 3 + [1.0])
    placed[:3, 3] = x, y, z
    return Quadric(SPHERE, placed, (1.0, 1.0), radius < 0, place)


def read_cone(at: Cursor) -> Quadric:
    """`c`; negative radii mean that it is seen from inside."""
    place = WordPlace(at.file, at.position - 1)
    numbers = at.numbers(8, "a cone", finite=False)
    base, apex = numbers[:3], numbers[4:7]
    radii = (abs(float(numbers[3])), abs(float(numbers[7])))
    placed = np.eye(4)
    axis = apex - base
    across = np.eye(3)[np.argmin(np.abs(axis))]
    right = np.cross(across, axis)
    length = float(np.linalg.norm(right))
    if length > 0:
        right /= length
        placed[:3, 0], placed[:3, 1] = right, np.cross(axis / np.linalg.norm(axis), right)
    placed[:3, 2], placed[:3, 3] = axis, base
    return Quadric(CONE, placed, radii, bool(min(numbers[3], numbers[7]) < 0), place)


def read_tracks(at: Cursor) -> TrackSet:
    """What stands between the braces of `k`."""
    at.expect(b"{", "of the tracks")
    parts: dict[str, Keys | None] = {"transl": None, "rot": None, "scale": None}
    visibility: Float64 | None = None
    while (word := at.word("a track or '}'")) != b"}":
        kind = word.decode("latin-1")
        if kind == "visibility":
            visibility = at.numbers(2 * at.count("keys of visibility"), "visibility").reshape(-1, 2)
        elif kind in parts:
            count = at.count(f"keys of {kind}", least=4)
            values = 4 if kind == "rot" else 3
            rows = at.numbers(count * (4 + values), kind).reshape(count, -1)
            parts[kind] = Keys(rows[:, 0], rows[:, 1 : 1 + values], rows[:, 1 + values :])
        else:
            raise at.error(f"unknown track {quoted(word)}; there are transl, rot, scale and visibility")
    return TrackSet(parts["transl"], parts["rot"], parts["scale"], visibility)

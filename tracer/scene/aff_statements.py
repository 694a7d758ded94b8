"""The statements of AFF that carry geometry, tracks or lights, read into arrays in the file's own space.

Of geometry and tracks nothing here knows of transforms, materials or what came before: a block means the same wherever
it is included, which is why meshes can be remembered by their place in the file.

Lights are AFF's own points, `l` and `la`, and `lamp`, a statement of ours for lights of some size.

    lamp point     at x y z
    lamp sphere    at x y z  radius r
    lamp rectangle at x y z  edges x y z  x y z
    lamp dome      at x y z  radius r  [up x y z]

each with [samples n] [color r g b] [falloff none | inverse-square] [name track], in any order.  Words introduce the
values as they do in `v`.  BART's own reader takes the first letters for those of `la` and stops at the word after them,
which is no number: a file with lamps is refused there, and not shown with other lights.

A lamp is placed, turned and scaled by the static transforms around it.  As a light of `la`, it moves by the translation
track of its name, but does not turn: what asks for more is warned of.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tracer.scene.aff_tokens import AffFile, Cursor, quoted
from tracer.scene.animation import Chain, Keys, TrackSet
from tracer.scene.arrays import Float64, Vector, vector
from tracer.scene.assembly import resolve
from tracer.scene.lights import DEFAULT_SAMPLES, FALLOFFS, KINDS, MAX_SAMPLES, Light
from tracer.scene.limits import LARGEST
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


_SIMILAR = 1e-6  # part of its square by which a scale may differ between directions
_NUMBERS = {b"at": 3, b"radius": 1, b"edges": 6, b"up": 3, b"color": 3}
_OF_ALL = (b"at", b"color", b"falloff", b"name")
_OWN = {
    "point": (),
    "sphere": (b"radius", b"samples"),
    "rectangle": (b"edges", b"samples"),
    "dome": (b"radius", b"up", b"samples"),
}
_NEEDED = {"point": (), "sphere": (b"radius",), "rectangle": (b"edges",), "dome": (b"radius",)}
_WORDS = (*_NUMBERS, b"samples", b"falloff", b"name")
_FALLOFFS = {falloff.replace(" ", "-").encode(): falloff for falloff in FALLOFFS}


@dataclass(frozen=True)
class FoundLight:
    """A light in world space, with the transforms around it and its place in the file."""

    light: Light
    chain: Chain
    place: WordPlace
    plain: bool = False
    """Whether it is a position alone, without a colour and anything else."""


def read_light(at: Cursor, chain: Chain, number: int, name: str | None = None) -> FoundLight:
    """`l` and, with a name, `la`; `number` counts the lights before it."""
    place = WordPlace(at.file, at.position - 1)
    position = at.numbers(3, "the position of a light")
    plain = not at.at_number()
    color = (1.0, 1.0, 1.0) if plain else at.triple("the colour of a light")
    light = Light(name or f"light {number}", _moved(_static(chain), position), color, name)
    return FoundLight(light, chain, place, plain)


def read_lamp(at: Cursor, chain: Chain, number: int) -> FoundLight:
    """`lamp`."""
    place = WordPlace(at.file, at.position - 1)
    kind = at.word("the kind of a lamp").decode("latin-1")
    if kind not in KINDS:
        raise at.error(f"{quoted(kind.encode('latin-1'))} is no kind of lamp; there are {', '.join(KINDS)}")
    given = _read_words(at, kind)
    for word in (b"at", *_NEEDED[kind]):
        if word not in given:
            raise at.error(f"the {kind} lamp has no '{word.decode()}'; add it", place.index)
    matrix = _static(chain)
    linear = matrix[:3, :3]
    edges: Iterable[Float64] = ()
    if kind == "rectangle":
        edges = given[b"edges"].reshape(2, 3)
    elif kind == "dome":
        edges = [given.get(b"up", np.array([0.0, 1.0, 0.0]))]
        if not (linear @ edges[0]).any():
            raise at.error("'up' of a dome has no length; give the direction of its top", place.index)
    name = given.get(b"name")
    light = Light(
        name or f"light {number}",
        _moved(matrix, given[b"at"]),
        vector(given.get(b"color", np.ones(3))),
        name,
        kind,
        radius=float(given.get(b"radius", np.zeros(1))[0]) * _scale(linear),
        edges=tuple(_moved(linear, edge) for edge in edges),
        samples=1 if kind == "point" else given.get(b"samples", DEFAULT_SAMPLES),
        falloff=given.get(b"falloff", "none"),
    )
    return FoundLight(light, chain, place)


def _read_words(at: Cursor, kind: str) -> dict[bytes, Any]:
    """What the words of a lamp introduce: numbers as arrays, samples, a falloff, a name."""
    given: dict[bytes, Any] = {}
    known = (*_OF_ALL, *_OWN[kind])
    while at.peek() in _WORDS:
        word = at.word("a lamp")
        what = f"{word.decode()} of the lamp"
        if word not in known:
            takes = ", ".join(w.decode() for w in known)
            raise at.error(f"a {kind} lamp has no '{word.decode()}', it takes {takes}; remove it")
        if word == b"samples":
            given[word] = at.count("samples", least=1, most=MAX_SAMPLES)
        elif word == b"falloff":
            falloff = at.word(what)
            if falloff not in _FALLOFFS:
                raise at.error(f"{quoted(falloff)} is no falloff; there are {b', '.join(_FALLOFFS).decode()}")
            given[word] = _FALLOFFS[falloff]
        elif word == b"name":
            given[word] = at.name("the name of a lamp")
        else:
            given[word] = at.numbers(_NUMBERS[word], what)
            if word == b"radius" and given[word][0] < 0:
                raise at.error(f"a radius of {given[word][0]:g}; give 0 or more")
    return given


def dimmed(found: list[FoundLight]) -> list[FoundLight]:
    """The lights of an NFF file: where none has a colour, each of n is white of intensity sqrt(n) / n. The format
    leaves it to the program; this is what the Standard Procedural Databases, its home, are commonly drawn with, and all
    lights at full intensity would wash them out."""
    if not all(one.plain for one in found):
        return found
    share = len(found) ** -0.5 if found else 1.0
    return [replace(one, light=replace(one.light, color=(share, share, share))) for one in found]


def settled(found: Iterable[FoundLight], tracks: Mapping[str, TrackSet]) -> tuple[tuple[Light, ...], list[str]]:
    """The lights, once all tracks are known, and warnings; only those that a track moves keep its name."""
    lights, warnings = [], []
    for one in found:
        light = one.light
        lengths = (*light.position, light.radius, *(x for edge in light.edges for x in edge))
        if not all(abs(x) <= LARGEST for x in lengths):
            warnings.append(f"{one.place()}: a light beyond {LARGEST:g} is left out; bring it nearer")
            continue
        of_name = tracks.get(light.track or "")
        moves = of_name is not None and of_name.translation is not None
        lights.append(light if moves else replace(light, track=None))
        warnings += [f"{one.place()}: {what}" for what in _left_out(one, tracks, of_name)]
    return tuple(lights), warnings


def _left_out(found: FoundLight, tracks: Mapping[str, TrackSet], of_name: TrackSet | None) -> Iterable[str]:
    """What is asked of a light that it does not do."""
    light = found.light
    round_ = light.kind in ("sphere", "dome")
    if any(isinstance(e, str) and e in tracks for e in found.chain):
        if light.kind == "point":
            yield "a light does not move with the transform around it; use 'la'"
        else:
            yield "a lamp neither moves nor turns with the transform around it; name a translation track with 'name'"
    if of_name is not None and light.kind != "point":
        turns = of_name.rotation is not None and light.kind != "sphere"
        if turns or of_name.scale is not None:
            name = quoted(os.fsencode(light.name))
            yield f"the track {name} moves the lamp, but neither turns nor scales it; only its translation counts"
    if round_ and not _is_similar(_static(found.chain)[:3, :3]):
        yield f"a {light.kind} lamp stays round under a transform that scales it unevenly; scale it alike in x, y and z"


def _static(chain: Chain) -> Float64:
    """(4, 4): the product of a chain's matrices, as if its tracks did nothing."""
    return resolve(chain, ())[1]


def _moved(matrix: Float64, place: Float64) -> Vector:
    """A point under a matrix (4, 4), or a direction under one (3, 3)."""
    moved = matrix[:3, :3] @ place
    return vector(moved + matrix[:3, 3] if len(matrix) == 4 else moved)


def _scale(linear: Float64) -> float:
    """The factor by which a matrix (3, 3) scales lengths, on average."""
    return float(abs(np.linalg.det(linear))) ** (1 / 3)


def _is_similar(linear: Float64) -> bool:
    """Whether a matrix (3, 3) scales all directions alike."""
    square = _scale(linear) ** 2
    return bool(np.abs(linear.T @ linear - square * np.eye(3)).max() <= _SIMILAR * square)

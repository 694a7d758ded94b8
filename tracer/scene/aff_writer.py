"""Writing a scene as AFF: its numbers in full, so that what is read is the same up to the last bit of normals.

Textures are left out, as they would be files of their own.  Names of objects and lights become words, as AFF has them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from tracer.scene.animation import Chain, Keys, TrackSet
from tracer.scene.arrays import Float64
from tracer.scene.lights import Light
from tracer.scene.model import SPHERE, Scene, SceneObject
from tracer.scene.normals import geometric_normals


def as_word(name: str) -> str:
    """Return a name as a word of AFF."""
    return re.sub(r"[^\w.:/+-]", "_", name) or "_"


def aff_text(scene: Scene) -> str:
    """Return what a file of the scene holds."""
    camera, (start, end) = scene.camera, scene.time_range
    at = np.add(camera.position, camera.direction)
    lines = [
        f"b {_numbers(scene.background)}",
        f"am {_numbers(scene.ambient)}",
        f"v from {_numbers(camera.position)} at {_numbers(at)} up {_numbers(camera.up)} angle {camera.angle!r}",
        f"a {_numbers((start, end))} {scene.frames}",
    ]
    shown = [one for one in scene.objects if len(one.triangles) or len(one.quadrics)]
    names = {e for one in shown for e in one.chain if isinstance(e, str)} | {light.track for light in scene.lights}
    tracks = {name: track for name, track in scene.animation.tracks.items() if name in names}
    still = "still"  # a track that moves nothing, so that what could move stays no part of what never moves
    while still in names:
        still += "_"
    for name, track in tracks.items():
        lines += _tracks(name, track)
    if any(one.chain and not any(isinstance(e, str) for e in one.chain) for one in shown):
        lines.append(f"k {still} {{ visibility 1 0 1 }}")
    lines += map(_light, scene.lights)
    for one in shown:
        before, after = _opened(one.chain, still)
        lines += [*before, *_geometry(scene, one, {*tracks, still}), *after]
    return "\n".join(lines) + "\n"


def _numbers(values: ArrayLike) -> str:
    """The shortest texts that are read as these numbers again, of float32 or of float64."""
    return " ".join(map(str, np.asarray(values).ravel()))


def _tracks(name: str, tracks: TrackSet) -> list[str]:
    lines = [f"k {name} {{"]
    kinds: dict[str, Keys | None] = {"transl": tracks.translation, "rot": tracks.rotation, "scale": tracks.scale}
    for kind, keys in kinds.items():
        if keys is not None:
            lines.append(f"{kind} {len(keys.times)}")
            lines += map(_numbers, np.column_stack([keys.times, keys.values, keys.shape]))
    if tracks.visibility is not None:
        lines += [f"visibility {len(tracks.visibility)}", *map(_numbers, tracks.visibility)]
    return [*lines, "}"]


def _light(light: Light) -> str:
    name, color = light.track or as_word(light.name), _numbers(light.color)
    if light.kind == "point" and light.falloff == "none":
        return f"la {name} {_numbers(light.position)} {color}"
    words = [f"lamp {light.kind} at {_numbers(light.position)} color {color} name {name}"]
    words.append(f"falloff {light.falloff.replace(' ', '-')}")
    if light.kind != "point":
        words.append(f"samples {light.samples}")
    if light.kind in ("sphere", "dome"):
        words.append(f"radius {light.radius!r}")
    if light.edges:
        words.append(f"{'edges' if light.kind == 'rectangle' else 'up'} {_numbers(light.edges)}")
    return " ".join(words)


# --- transforms ------------------------------------------------------------------------------------


def _opened(chain: Chain, still: str) -> tuple[list[str], list[str]]:
    """What opens the transforms of a chain, and what closes them; one without tracks goes by the track `still`."""
    lines = [] if not chain or any(isinstance(e, str) for e in chain) else [f"x {still} {{"]
    for element in chain:
        lines += [f"x {element} {{"] if isinstance(element, str) else _matrix(element)
    return lines, ["}"] * len(lines)


def _matrix(matrix: Float64) -> list[str]:
    """Two transforms whose product is an affine matrix (4, 4): of its singular values, scales between two turns."""
    turn, scales, other = np.linalg.svd(matrix[:3, :3])
    for mirrored in (turn.T, other):  # its last axis, with the scale along it
        if np.linalg.det(mirrored) < 0:
            mirrored[2] *= -1.0
            scales[2] *= -1.0
    outer = f"xs {_numbers(scales)} {_turn(turn)} {_numbers(matrix[:3, 3])} {{"
    return [outer, f"xs 1 1 1 {_turn(other)} 0 0 0 {{"]


def _turn(rotation: Float64) -> str:
    """The axis of a rotation (3, 3), and its angle in degrees."""
    skew = (rotation - rotation.T) / 2.0
    sines = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    axis = sines
    if np.trace(rotation) < 0.0:  # near 180 degrees, sines say little
        axis = np.linalg.eigh(rotation + rotation.T)[1][:, 2]
    axis = axis / max(float(np.linalg.norm(axis)), 1e-300)
    angle = np.degrees(np.arctan2(sines @ axis, (np.trace(rotation) - 1.0) / 2.0))
    return f"{_numbers(axis)} {_numbers(angle)}"


# --- geometry --------------------------------------------------------------------------------------


def _geometry(scene: Scene, one: SceneObject, tracks: set[str]) -> Iterator[str]:
    """The primitives of an object in their order, below the names of their parts, each run with its material."""
    t, q = one.triangles, one.quadrics
    material = np.concatenate([t.material, q.material])
    part_of = one.part_of if one.part_of is not None else np.full(len(material), -1)
    as_read = np.array(_numbers(t.corners).split(), np.float64).reshape(-1, 3, 3)
    flat = (t.normals == geometric_normals(as_read)[:, None].astype(np.float32)).all(axis=(1, 2))
    last, opened = (-2, -1), False
    for place in range(len(material)):
        now = int(part_of[place]), int(material[place])
        if now != last:
            name = as_word(one.parts[now[0]]) if now[0] >= 0 else ""
            yield from ["}"] if opened else []
            opened = bool(name) and name not in tracks
            m = scene.materials[now[1]]
            colors = _numbers((m.ambient, m.diffuse, m.specular))
            yield f"fm {colors} {m.exponent / 4.0!r} {m.transmission!r} {m.ior!r}"
            yield from [f"x {name} {{"] if opened else []
            last = now
        yield from _quadric(one, place - len(t)) if place >= len(t) else _triangle(one, place, bool(flat[place]))
    yield from ["}"] if opened else []


def _triangle(one: SceneObject, place: int, flat: bool) -> list[str]:
    """The lines of a triangle; one that is `flat` has the normal that is read where none is given."""
    deformation = one.deformation
    if deformation is not None:
        times = deformation.times[place]
        keys = np.stack([deformation.corners[place], deformation.normals[place]], axis=2)  # (keys, 3, 2, 3)
        return [f"tpa {len(times)}", *(f"{time} {_numbers(key)}" for time, key in zip(times, keys, strict=True))]
    corners, normals = one.triangles.corners[place], one.triangles.normals[place]
    if flat:
        return [f"p 3  {'  '.join(map(_numbers, corners))}"]
    return [f"pp 3  {'  '.join(f'{_numbers(c)} {_numbers(n)}' for c, n in zip(corners, normals, strict=True))}"]


def _quadric(one: SceneObject, number: int) -> list[str]:
    q = one.quadrics
    matrix, sign = q.to_object[number], -1.0 if q.inside[number] else 1.0
    if q.kind[number] == SPHERE:
        radius = float(matrix[0, 0])
        if (matrix[:, :3] == radius * np.eye(3)).all() and radius > 0.0:
            return [f"s {_numbers(matrix[:, 3])} {sign * radius!r}"]
        inner = f"s 0 0 0 {sign}"
    else:
        below, above = (sign * q.radii[number]).tolist()
        inner = f"c 0 0 0 {below!r}  0 0 1 {above!r}"
    return [*_matrix(matrix), inner, "}}"]

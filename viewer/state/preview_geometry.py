"""A scene as a rasteriser draws it, at one moment: triangles, spheres, cones and lights in flat arrays, bounded.

No kernel is needed for that, so that it can be seen while the kernels are compiled.  Of too many triangles,
the corners that share a cell of a grid become one, and what shrinks to a line or a point is left out (Rossignac,
Borrel: Multi-resolution 3D approximations for rendering complex scenes, 1993).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer.scene.arrays import Float32, Float64
from tracer.scene.chains import Chains
from tracer.scene.deformation import deformed
from tracer.scene.framing import quadric_box
from tracer.scene.lamps import LampTable
from tracer.scene.limits import LARGEST, SMALLEST
from tracer.scene.model import Progress, Scene, SceneObject

MOST_TRIANGLES = 300_000
MOST_QUADRICS = 12_000
MOST_READ = 3_000_000
"""Primitives of a scene that is previewed at all: gathering more takes too much memory and time."""
MOST_LIGHTS = 8
"""More are replaced by the brightest of them."""
MOST_TEXELS = 1024
"""A side of a texture."""
_CELLS = 1 << 20  # of a grid, on either side of the origin
_COARSER = 1.4 ** np.arange(24)  # grids that are tried

VERTEX = np.dtype([("position", "f4", 3), ("normal", "f4", 3), ("uv", "f4", 2), ("material", "f4")])
QUADRIC = np.dtype([("to_world", "f4", (3, 4)), ("radii", "f4", 2), ("kind", "f4"), ("material", "f4")])
MATERIAL = np.dtype([("ambient", "f4", 4), ("diffuse", "f4", 4), ("specular", "f4", 4)])
"""The fourth numbers: the part of light that passes through, nothing, and Phong's exponent."""


@dataclass(frozen=True)
class PreviewGeometry:
    """In world space: vertices (3 n,) VERTEX, three for each triangle; batches of them that share a texture, its
    number or -1, their first and how many; quadrics (m,) QUADRIC, the largest first; materials (k,) MATERIAL; images of
    the textures; lights (l, 8) float32: place, 0, colour, and 1 where it falls off with
    distance; box (2, 3) around everything.  `left_out` primitives of the scene, of `of`, are not there."""

    vertices: NDArray[np.void]
    batches: tuple[tuple[int, int, int], ...]
    quadrics: NDArray[np.void]
    materials: NDArray[np.void]
    images: tuple[NDArray[np.uint8], ...]
    lights: Float32
    ambient: tuple[float, float, float]
    background: tuple[float, float, float]
    box: Float64
    left_out: int
    of: int


def preview_geometry(
    scene: Scene, time: float, progress: Progress, most: int = MOST_TRIANGLES, most_quadrics: int = MOST_QUADRICS
) -> PreviewGeometry:
    """Gather it; more triangles, or spheres and cones, than that are simplified."""
    chains = Chains(scene.animation, [o.chain for o in scene.objects])
    matrices, visible = chains.matrices(time), chains.visible(time)
    soups, quadrics, textures = [], [], []
    for done, (o, matrix, seen) in enumerate(zip(scene.objects, matrices, visible, strict=True)):
        if done % 64 == 0:
            progress("preparing a preview", 0.5 * done / len(scene.objects))
        if not seen or not _placed(matrix):
            continue
        if len(o.triangles):
            soups.append(_triangles(o, matrix, time))
            textures.append(o.triangles.texture)
        if len(o.quadrics):
            quadrics.append(_quadrics(o, matrix))
    soup = np.concatenate(soups) if soups else np.empty((0, 3), VERTEX)
    texture = np.concatenate(textures) if textures else np.empty(0, np.int32)
    round_ones = np.concatenate(quadrics) if quadrics else np.empty(0, QUADRIC)
    there = len(soup) + len(round_ones)
    progress("preparing a preview", 0.6)
    soup, texture = _fewer(soup, texture, most)
    round_ones = _largest(round_ones, most_quadrics)
    order = np.argsort(texture, kind="stable")
    soup, texture = soup[order], texture[order]
    numbers, first, count = np.unique(texture, return_index=True, return_counts=True)
    batches = tuple((int(n), 3 * int(f), 3 * int(c)) for n, f, c in zip(numbers, first, count, strict=True))
    progress("preparing a preview", 0.8)
    return PreviewGeometry(
        vertices=np.ascontiguousarray(soup.reshape(-1)),
        batches=batches,
        quadrics=round_ones,
        materials=_materials(scene),
        images=tuple(_image(t.pixels) for t in scene.textures),
        lights=_lights(scene, time),
        ambient=scene.ambient,
        background=scene.background,
        box=_box(soup, round_ones),
        left_out=there - len(soup) - len(round_ones),
        of=there,
    )


def _placed(matrix: Float64) -> bool:
    """Whether an object is somewhere, and not scaled to nothing."""
    with np.errstate(all="ignore"):
        if not (np.abs(matrix) <= min(LARGEST, 1 / SMALLEST)).all():
            return False
        return abs(float(np.linalg.det(matrix[:3, :3]))) > 0.0


def _triangles(o: SceneObject, matrix: Float64, time: float) -> NDArray[np.void]:
    """(n, 3) VERTEX in world space."""
    corners, normals = o.triangles.corners, o.triangles.normals
    if o.deformation is not None:
        corners, normals = deformed(o.deformation, time)
    made = np.empty((len(corners), 3), VERTEX)
    if o.chain:
        with np.errstate(all="ignore"):
            linear = matrix[:3, :3].astype(np.float32)
            corners = corners @ linear.T + matrix[:3, 3].astype(np.float32)
            normals = normals @ np.linalg.inv(matrix[:3, :3]).astype(np.float32)
    made["position"], made["normal"], made["uv"] = corners, normals, o.triangles.uvs
    made["material"] = o.triangles.material[:, None]
    return made


def _quadrics(o: SceneObject, matrix: Float64) -> NDArray[np.void]:
    q = o.quadrics
    made = np.empty(len(q), QUADRIC)
    placed = np.concatenate([q.to_object, np.broadcast_to(np.array([[0.0, 0.0, 0.0, 1.0]]), (len(q), 1, 4))], axis=1)
    made["to_world"] = (matrix @ placed)[:, :3]
    made["radii"], made["kind"], made["material"] = q.radii, q.kind, q.material
    return made


def _fewer(soup: NDArray[np.void], texture: NDArray[np.int32], most: int) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """See the module."""
    if len(soup) <= most:
        return soup, texture
    points = soup["position"].reshape(-1, 3)
    low, high = np.percentile(points[:: 1 + len(points) // 10_000], (5, 95), axis=0)
    finest = float((high - low).max()) / 512 or 1.0  # a floor that reaches far does not count
    for coarser in _COARSER:
        with np.errstate(all="ignore"):  # what lies beyond all numbers falls anywhere
            cell = (
                np.clip(np.floor(points / np.float32(finest * coarser)), -_CELLS, _CELLS - 1).astype(np.int64) + _CELLS
            )
        key = ((cell[:, 0] * 2 * _CELLS + cell[:, 1]) * 2 * _CELLS + cell[:, 2]).reshape(-1, 3)
        a, b, c = key.T
        stay = np.flatnonzero((a != b) & (b != c) & (a != c))
        if len(stay) <= most:
            break
    stay = stay[:most]
    made = soup[stay]
    _, of = np.unique(key[stay].reshape(-1), return_inverse=True)
    count = np.bincount(of)
    for axis in range(3):
        mean = np.bincount(of, made["position"].reshape(-1, 3)[:, axis]) / count
        made["position"][:, :, axis] = mean[of].reshape(-1, 3)
    return made, texture[stay]


def _largest(quadrics: NDArray[np.void], most: int) -> NDArray[np.void]:
    """The largest, in the order of their size."""
    size = np.linalg.norm(quadrics["to_world"][:, :, :3], axis=(1, 2))
    quadrics = quadrics[np.argsort(-size, kind="stable")]
    return quadrics[:most]


def _materials(scene: Scene) -> NDArray[np.void]:
    made = np.zeros(len(scene.materials), MATERIAL)
    for row, m in zip(made, scene.materials, strict=True):
        row["ambient"] = (*m.ambient, m.transmission)
        row["diffuse"][:3] = m.diffuse
        row["specular"] = (*m.specular, m.exponent)
    return made


def _image(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A texture, at most so large, row 0 at the bottom."""
    image = Image.fromarray(pixels)
    image.thumbnail((MOST_TEXELS, MOST_TEXELS), Image.Resampling.BOX)
    return np.ascontiguousarray(np.asarray(image)[::-1])


def _lights(scene: Scene, time: float) -> Float32:
    """Lamps shine from their centres; of too many, the brightest shine as brightly as all together."""
    places = LampTable(scene.lights).at(scene.light_positions(time)).places.reshape(-1, 3)
    colors = np.array([light.color for light in scene.lights], np.float32).reshape(-1, 3)
    falls = np.array([light.falloff != "none" for light in scene.lights], np.bool_)
    rows = []
    for fall in (False, True):  # each kind by itself, as their brightness cannot be compared
        kind = np.flatnonzero(falls == fall)
        most = MOST_LIGHTS if falls.all() or not falls.any() else MOST_LIGHTS // 2
        kept = kind[np.argsort(-colors[kind].sum(axis=1), kind="stable")[:most]]
        scale = colors[kind].sum() / max(float(colors[kept].sum()), 1e-12) if len(kind) else 1.0
        rows += [(*places[k], 0.0, *(scale * colors[k]), float(fall)) for k in sorted(kept.tolist())]
    return np.array(rows, np.float32).reshape(-1, 8)


def _box(soup: NDArray[np.void], quadrics: NDArray[np.void]) -> Float64:
    corners = [soup["position"].reshape(-1, 3).astype(np.float64)]
    for q in quadrics:
        corners.append(np.stack(quadric_box(int(q["kind"]), q["to_world"].astype(np.float64), q["radii"])))
    points = np.concatenate(corners)
    points = points[np.isfinite(points).all(axis=1)]
    return np.stack([points.min(axis=0), points.max(axis=0)]) if len(points) else np.zeros((2, 3))

"""What trimesh says of a surface, as materials of Whitted's kind.

Pictures of meshes should look as their makers meant, but a Whitted mirror is sharp where theirs
is blurred.  So only what is smooth reflects: the specular part falls with roughness, and an OBJ
material mirrors only where its illumination model asks for ray tracing (3 and more).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer.scene.arrays import vector
from tracer.scene.model import Material, SceneError, Texture
from tracer.scene.textures import check_pixels, texture_of

AMBIENT = 0.15
"""Ambient colour as a part of the diffuse one; the files have none that fits point lights."""

MOST_COLOURS = 1024
"""Coloured faces share materials: with more colours than these, they are rounded to 16 steps per channel."""

Part = tuple[NDArray[np.intp] | slice, int, int]


class MaterialTable:
    """Materials and textures of a mesh file, each once."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.materials: list[Material] = []
        self.textures: list[Texture] = []
        self.warnings: list[str] = []
        self._materials: dict[Material, int] = {}
        self._textures: dict[int, int] = {}
        self._images: list[Any] = []  # kept alive: textures are known by their identity

    def parts(self, mesh: Any, where: str) -> Iterator[Part]:
        """Which triangles of a mesh have which material and texture (-1 for none)."""
        visual = mesh.visual
        if visual.kind == "texture" and visual.material is not None and not _is_made_up(visual.material):
            material, image = _material(visual.material)
            yield slice(None), self._number(material), self._texture(image, where)
        elif visual.kind in ("face", "vertex"):
            yield from self._coloured(np.asarray(visual.face_colors)[:, :3])
        else:
            yield slice(None), self.plain(), -1

    def plain(self) -> int:
        """The number of the material of surfaces of which a file says nothing."""
        return self._number(Material("plain", (0.12, 0.12, 0.12), (0.75, 0.75, 0.75)))

    def _coloured(self, colours: NDArray[np.uint8]) -> Iterator[Part]:
        if len(np.unique(colours, axis=0)) > MOST_COLOURS:
            colours = colours // 17 * 17
        unique, inverse = np.unique(colours, axis=0, return_inverse=True)
        order = np.argsort(inverse.reshape(-1), kind="stable")
        counts = np.bincount(inverse.reshape(-1), minlength=len(unique))
        for colour, which in zip(unique, np.split(order, np.cumsum(counts)[:-1]), strict=True):
            name = "colour #" + bytes(colour.astype(np.uint8)).hex()
            yield which, self._number(_plain(name, colour / 255.0)), -1

    def _number(self, material: Material) -> int:
        if material not in self._materials:
            self._materials[material] = len(self.materials)
            self.materials.append(material)
        return self._materials[material]

    def _texture(self, image: Any, where: str) -> int:
        if image is None:
            return -1
        if not isinstance(image, Image.Image):
            self.warnings.append(f"{where}: its texture is no image of the file; the surface keeps its material colour")
            return -1
        if id(image) not in self._textures:
            name = Path(str(image.info.get("file_path", ""))).name or f"texture {len(self.textures)}"
            self._images.append(image)
            try:
                self._textures[id(image)] = len(self.textures)
                self.textures.append(texture_of(image, name))
                check_pixels(self.textures)
            except SceneError as error:
                self._textures[id(image)] = -1
                self.warnings.append(f"{where}: texture {name!a}: {error}; the surface keeps its material colour")
        return self._textures[id(image)]


def _is_made_up(given: Any) -> bool:
    """Whether the material stands for none: trimesh gives a dark image of four pixels, which is from no file, to an OBJ
    with texture coordinates and without a material."""
    image = getattr(given, "image", None)
    return image is not None and image.format is None and not given.kwargs


def _material(given: Any) -> tuple[Material, Any]:
    """The material and the image (or None) of a trimesh material."""
    if hasattr(given, "materials"):  # several in one: they cannot be told apart per triangle
        given = next(iter(given.materials), None)
    if given is not None and hasattr(given, "baseColorFactor"):
        return _physical(given), given.baseColorTexture
    return _simple(given), getattr(given, "image", None)


def _physical(given: Any) -> Material:
    """glTF: base colour (linear light, so brought to display values), metalness and roughness."""
    factor = given.baseColorFactor
    base = np.ones(4) if factor is None else np.append(np.asarray(factor, np.float64), [1.0] * 4)[:4]
    if factor is not None and np.asarray(factor).dtype.kind in "ui":
        base[: len(factor)] /= 255.0
    colour = _displayed(np.clip(base[:3], 0.0, 1.0))
    metal = 1.0 if given.metallicFactor is None else float(np.clip(given.metallicFactor, 0.0, 1.0))
    rough = 1.0 if given.roughnessFactor is None else float(np.clip(given.roughnessFactor, 0.0, 1.0))
    mirror = metal * (1.0 - rough)
    diffuse = colour * (1.0 - mirror)
    specular = colour * mirror + 0.04 * (1.0 - metal) * (1.0 - rough)
    clear = 1.0 - float(np.clip(base[3], 0.0, 1.0)) if given.alphaMode == "BLEND" else 0.0
    exponent = float(np.clip(2.0 / max(rough, 0.03) ** 4 - 2.0, 1.0, 1000.0))
    return Material(str(given.name), vector(AMBIENT * diffuse), vector(diffuse), vector(specular), exponent, clear)


def _simple(given: Any) -> Material:
    """OBJ: Kd, Ks, Ns, d or Tr, Ni and illum."""
    other = getattr(given, "kwargs", {})
    diffuse = np.asarray(getattr(given, "diffuse", (190, 190, 190, 255)))[:3] / 255.0
    specular = np.asarray(getattr(given, "specular", (0, 0, 0, 255)))[:3] / 255.0
    if "specular" not in other and "ks" not in other:
        specular = np.zeros(3)
    if _first(other, "illum", 2.0) < 3.0:
        specular = 0.1 * specular
    clear = 1.0 - _first(other, "d", 1.0 - _first(other, "tr", 0.0))
    exponent = max(1.0, float(getattr(given, "glossiness", 1.0)))
    ior = _first(other, "ni", 1.0)
    name = str(getattr(given, "name", "material"))
    return Material(
        name,
        vector(AMBIENT * diffuse),
        vector(diffuse),
        vector(specular),
        exponent,
        float(np.clip(clear, 0.0, 1.0)),
        ior if ior > 0.0 else 1.0,
    )


def _plain(name: str, colour: NDArray[np.float64]) -> Material:
    return Material(name, vector(AMBIENT * colour), vector(colour))


def _first(values: dict[str, Any], key: str, otherwise: float) -> float:
    """The first number of an MTL entry."""
    value = values.get(key, otherwise)
    try:
        number = float(value[0] if isinstance(value, (list, tuple)) else value)
    except (TypeError, ValueError, IndexError):
        return otherwise
    return number if np.isfinite(number) else otherwise


def _displayed(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """The sRGB transfer function: what a display shows for linear light."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)

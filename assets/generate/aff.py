"""Writing AFF: models made of meshes, spheres and cones in materials, which can hold one another.

Every model becomes a file of its own; a model placed in another is an `i` under an `xs`, so what
appears many times (chess pieces, chairs, glasses) is written once.  Every statement of a material
stands right before the geometry that wears it, because in AFF the current material is one global.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from generate.mesh import Array, Mesh, face_normals, join

Point = Sequence[float]
Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """An `fm` statement, and the texture that its meshes wear, if any."""

    name: str
    diffuse: Colour
    ambient: Colour
    specular: Colour = (0.0, 0.0, 0.0)
    shine: float = 5.0
    transmission: float = 0.0
    ior: float = 1.0
    texture: str | None = None

    def text(self) -> str:
        colours = "  ".join(numbers(c, 3) for c in (self.ambient, self.diffuse, self.specular))
        rest = " ".join(number(x, 3) for x in (self.shine, self.transmission, self.ior))
        return f"# {self.name}\nfm {colours}  {rest}"


def number(value: float, decimals: int = 4) -> str:
    """Trimmed decimals.  The small bias keeps ties, which an ulp would tip either way, from being ties."""
    text = f"{value + 3e-9:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def numbers(values: Iterable[float], decimals: int = 4) -> str:
    return " ".join(number(float(v), decimals) for v in values)


@dataclass(frozen=True)
class Lamp:
    """A light that falls off with the square of the distance: a point or, given two edges, a rectangle of samples.

    `colour` is what arrives at a distance of 1 m from all of it.
    """

    at: Point
    colour: Colour
    edges: tuple[Point, Point] | None = None
    samples: int = 1

    def text(self) -> str:
        words = ["lamp point" if self.edges is None else "lamp rectangle", f"at {numbers(self.at)}"]
        if self.edges is not None:
            first, second = (numbers(edge) for edge in self.edges)
            words.append(f"edges {first}  {second}  samples {self.samples}")
        return "  ".join([*words, f"color {numbers(self.colour, 4)}", "falloff inverse-square"])


@dataclass
class Model:
    """What one AFF file holds.  `decimals` are those of positions, in metres."""

    name: str
    decimals: int = 4
    meshes: dict[Material, list[Mesh]] = field(default_factory=dict)
    quadrics: dict[Material, list[str]] = field(default_factory=dict)
    placed: list[tuple[Model, str]] = field(default_factory=list)
    bare: list[str] = field(default_factory=list)
    lamps: list[Lamp] = field(default_factory=list)

    def add(self, material: Material, *meshes: Mesh) -> None:
        self.meshes.setdefault(material, []).extend(meshes)

    def shape(self, mesh: Mesh) -> None:
        """A mesh without a material of its own: it wears what the holder wears where it is placed."""
        self.bare.append(mesh_text(mesh, None, self.decimals))

    def sphere(self, material: Material, centre: Point, radius: float) -> None:
        statement = f"s {numbers((*centre, radius), self.decimals)}"
        self.quadrics.setdefault(material, []).append(statement)

    def cone(self, material: Material, base: Point, r0: float, apex: Point, r1: float) -> None:
        """An open cone or cylinder; negative radii are meant to be seen from inside."""
        statement = f"c {numbers((*base, r0), self.decimals)}  {numbers((*apex, r1), self.decimals)}"
        self.quadrics.setdefault(material, []).append(statement)

    def place(
        self,
        model: Model,
        at: Point = (0, 0, 0),
        turn: float = 0.0,
        scale: float = 1.0,
        material: Material | None = None,
    ) -> None:
        """Holds another model: scaled, turned about y by degrees, then moved; in a material, if it has none itself."""
        transform = f"xs {numbers((scale,) * 3, 5)}  0 1 0 {number(turn)}  {numbers(at, 5)}"
        if material is not None:
            transform = f"{material.text()}\n{transform}"
        self.placed.append((model, transform))

    def animate(self, model: Model, track: str) -> None:
        """Holds another model that the named tracks move."""
        self.placed.append((model, f"x {track}"))

    def files(self) -> dict[str, Model]:
        """Every model that this one holds, itself included, by name."""
        found = {self.name: self}
        for model, _ in self.placed:
            found.update(model.files())
        return found

    def text(self) -> str:
        blocks = list(self.bare)
        for material in dict.fromkeys([*self.meshes, *self.quadrics]):
            block = [material.text()]
            if material in self.meshes:
                block.append(mesh_text(join(self.meshes[material]), material.texture, self.decimals))
            block.extend(self.quadrics.get(material, []))
            blocks.append("\n".join(block))
        if self.lamps:
            blocks.append("\n".join(lamp.text() for lamp in self.lamps))
        for model, transform in self.placed:
            blocks.append(f"{transform} {{ i 0 {model.name}.aff }}")
        return "\n\n".join(blocks) + "\n"


def mesh_text(mesh: Mesh, texture: str | None, decimals: int = 4) -> str:
    """An `m` statement: indexed, without normals where all are the geometric ones."""
    flat = bool(np.abs(mesh.normals - face_normals(mesh.corners)[:, None]).max() < 1e-3)
    vertices, v = indexed(mesh.corners, decimals)
    keep = (v[:, 0] != v[:, 1]) & (v[:, 1] != v[:, 2]) & (v[:, 2] != v[:, 0])
    lines = ["m", f"vertices {len(vertices)}", *vertices]
    columns = [v]
    if not flat:
        normals, n = indexed(mesh.normals, 3)
        lines += [f"normals {len(normals)}", *normals]
        columns.append(n)
    if texture is not None:
        uvs = mesh.uvs.copy()
        uvs[..., 1] = 1.0 - uvs[..., 1]  # an AFF file counts v from the top of the image
        coordinates, t = indexed(uvs, 3)
        lines += [f"texturecoords {len(coordinates)} ../textures/{texture}.ppm", *coordinates]
        columns.append(t)
    table = np.concatenate(columns, axis=1)[keep]
    lines.append(f"triangles {len(table)}")
    lines += [" ".join(map(str, row)) for row in table.tolist()]
    return "\n".join(lines)


def indexed(corners: Array, decimals: int) -> tuple[list[str], np.ndarray]:
    """The distinct rows of (n, 3, k), as text in order of appearance, and each corner's index (n, 3)."""
    index: dict[str, int] = {}
    rows = [numbers(row, decimals) for row in corners.reshape(-1, corners.shape[2]).tolist()]
    where = [index.setdefault(row, len(index)) for row in rows]
    return list(index), np.asarray(where).reshape(-1, 3)

"""What shading reads: materials, textures and lights as flat arrays, made once per scene."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import aligned_rows
from tracer.scene.lights import Lamps, LampTable
from tracer.scene.model import Scene
from tracer.shading.textures import mapping_rows, pack_textures

# Columns of a material's row: three colours, then these; SHINE is the largest of the specular colour.
AMBIENT, DIFFUSE, SPECULAR, EXPONENT, TRANSMISSION, IOR, SHINE = 0, 3, 6, 9, 10, 11, 12
MATERIAL_COLUMNS = 16


class ShadingData(NamedTuple):
    """attributes (p, 16) float32 (`tracer.geometry.primitives`), materials (m, 16) float32, mappings (t, 8) float32,
    texels and texture_levels (`tracer.shading.textures`); the frame's lamps; ambient and background (3,), float32."""

    attributes: NDArray[np.float32]
    materials: NDArray[np.float32]
    mappings: NDArray[np.float32]
    texels: NDArray[np.uint32]
    texture_levels: NDArray[np.int32]
    lamps: Lamps
    ambient: NDArray[np.float32]
    background: NDArray[np.float32]


def make_shading_data(scene: Scene, attributes: NDArray[np.float32]) -> ShadingData:
    """Gather what shading reads of a scene; attributes (p, 16) are shared with the world, which moves them."""
    materials = aligned_rows(len(scene.materials), MATERIAL_COLUMNS)
    materials[:] = 0
    for row, m in zip(materials, scene.materials, strict=True):
        row[:SHINE] = *m.ambient, *m.diffuse, *m.specular, m.exponent, m.transmission, m.ior
        row[SHINE] = row[SPECULAR : SPECULAR + 3].max()
    texels, levels, numbers = pack_textures(scene.textures)
    triangles = [o.triangles for o in scene.objects]
    uvs = np.concatenate([t.uvs for t in triangles]).reshape(-1, 6)
    return ShadingData(
        attributes=attributes,
        materials=materials,
        mappings=mapping_rows(uvs, np.concatenate([t.texture for t in triangles]), levels, numbers),
        texels=texels,
        texture_levels=levels,
        lamps=LampTable(scene.lights).at(scene.light_positions(scene.time_range[0])),
        ambient=np.array(scene.ambient, np.float32),
        background=np.array(scene.background, np.float32),
    )

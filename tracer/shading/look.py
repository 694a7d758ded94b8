"""How surfaces look: materials, textures and lights as flat arrays, made once per scene."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import Scene
from tracer.shading.textures import pack_textures

# Columns of a material's row: three colours, then these.
AMBIENT, DIFFUSE, SPECULAR, EXPONENT, TRANSMISSION, IOR = 0, 3, 6, 9, 10, 11


class Look(NamedTuple):
    """normals (t, 9) and uvs (t, 6) float32 and texture (t,) int32 of triangles; material (p,) int32
    of primitives, into materials (m, 12) float32; texels, texture_levels and texture_table as
    `pack_textures` makes them; lights (l, 3) and light_colors (l, 3); ambient and background (3,),
    float32."""

    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    texture: NDArray[np.int32]
    material: NDArray[np.int32]
    materials: NDArray[np.float32]
    texels: NDArray[np.uint8]
    texture_levels: NDArray[np.int64]
    texture_table: NDArray[np.int64]
    lights: NDArray[np.float32]
    light_colors: NDArray[np.float32]
    ambient: NDArray[np.float32]
    background: NDArray[np.float32]


def make_look(scene: Scene, normals: NDArray[np.float32]) -> Look:
    """Gather a scene's look; normals (t, 9) are shared with the world, which moves them."""
    triangles = [o.triangles for o in scene.objects]
    materials = np.array(
        [[*m.ambient, *m.diffuse, *m.specular, m.exponent, m.transmission, m.ior] for m in scene.materials], np.float32
    )
    texels, levels, table = pack_textures(scene.textures)
    return Look(
        normals=normals,
        uvs=np.concatenate([t.uvs for t in triangles]).reshape(-1, 6),
        texture=np.concatenate([t.texture for t in triangles]),
        material=np.concatenate([t.material for t in triangles] + [o.quadrics.material for o in scene.objects]),
        materials=materials.reshape(-1, 12),
        texels=texels,
        texture_levels=levels,
        texture_table=table,
        lights=np.array([light.position for light in scene.lights], np.float32).reshape(-1, 3),
        light_colors=np.array([light.color for light in scene.lights], np.float32).reshape(-1, 3),
        ambient=np.array(scene.ambient, np.float32),
        background=np.array(scene.background, np.float32),
    )

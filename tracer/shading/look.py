"""How surfaces look: materials, textures and lights as flat arrays, made once per scene."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.kernels import inlined
from tracer.scene.model import Scene

# Columns of a material's row: three colours, then these.
AMBIENT, DIFFUSE, SPECULAR, EXPONENT, TRANSMISSION, IOR = 0, 3, 6, 9, 10, 11


class Look(NamedTuple):
    """normals (t, 9) and uvs (t, 6) float32 and texture (t,) int32 of triangles; material (p,) int32
    of primitives, into materials (m, 12) float32; texels (any,) uint8, and in texture_table (k, 3)
    int64 where each texture starts, its width and height; lights (l, 3) and light_colors (l, 3);
    ambient and background (3,), float32."""

    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    texture: NDArray[np.int32]
    material: NDArray[np.int32]
    materials: NDArray[np.float32]
    texels: NDArray[np.uint8]
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
    sizes = [t.pixels.size for t in scene.textures]
    starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    table = [(starts[i], t.pixels.shape[1], t.pixels.shape[0]) for i, t in enumerate(scene.textures)]
    return Look(
        normals=normals,
        uvs=np.concatenate([t.uvs for t in triangles]).reshape(-1, 6),
        texture=np.concatenate([t.texture for t in triangles]),
        material=np.concatenate([t.material for t in triangles] + [o.quadrics.material for o in scene.objects]),
        materials=materials.reshape(-1, 12),
        texels=np.concatenate([t.pixels.reshape(-1) for t in scene.textures] or [np.empty(0, np.uint8)]),
        texture_table=np.array(table, np.int64).reshape(-1, 3),
        lights=np.array([light.position for light in scene.lights], np.float32).reshape(-1, 3),
        light_colors=np.array([light.color for light in scene.lights], np.float32).reshape(-1, 3),
        ambient=np.array(scene.ambient, np.float32),
        background=np.array(scene.background, np.float32),
    )


@inlined
def texture_color(look, texture, u, v):
    """Bilinear (r, g, b) of a repeating texture; v = 0 is the bottom of the picture."""
    start, width, height = look.texture_table[texture]
    x, y = (u - math.floor(u)) * width - 0.5, (1.0 - (v - math.floor(v))) * height - 0.5
    x0, y0 = math.floor(x), math.floor(y)
    fx, fy = np.float32(x - x0), np.float32(y - y0)
    left, right = x0 % width, (x0 + 1) % width
    upper, lower = start + (y0 % height) * width * 3, start + ((y0 + 1) % height) * width * 3
    a, b, c, d = upper + left * 3, upper + right * 3, lower + left * 3, lower + right * 3
    one = np.float32(1)
    wa, wb, wc, wd = (one - fx) * (one - fy), fx * (one - fy), (one - fx) * fy, fx * fy
    scale = np.float32(1 / 255)
    t = look.texels
    return (
        scale * (wa * t[a] + wb * t[b] + wc * t[c] + wd * t[d]),
        scale * (wa * t[a + 1] + wb * t[b + 1] + wc * t[c + 1] + wd * t[d + 1]),
        scale * (wa * t[a + 2] + wb * t[b + 2] + wc * t[c + 2] + wd * t[d + 2]),
    )

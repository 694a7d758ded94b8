"""Local light: Phong's diffuse and specular terms of each light that reaches a point."""

from __future__ import annotations

import numpy as np

from tracer.kernels import inlined, subkernel
from tracer.shading.points import DIFFUSE_ROW, EXPONENT_ROW, SHINE_ROW, SPECULAR_ROW
from tracer.shading.wave import row_of
from tracer.simd import (
    any_lane,
    f32x16,
    load_f32x16,
    load_three,
    mask16,
    maximum,
    power,
    select,
    square_root,
    store,
)

ZERO, ONE = np.float32(0), np.float32(1)


@inlined
def _row(points, row, v):
    return load_f32x16(row_of(points.memory, row) + 64 * v)


@subkernel
def add_light(points, look, number, lit, wave, light):
    """Add light `number` to light (3, n) where bits of lit (n / 16,) say so: diffuse N.L, and (R.V)^exponent
    (Phong 1975)."""
    place, strength = look.lights[number], look.light_colors[number]
    for v in range((wave.size + 15) // 16):
        if lit[v] == 0:
            continue
        px, py, pz = load_three(points.position, v)
        nx, ny, nz = load_three(points.normal, v)
        dx, dy, dz = load_three(wave.rays.direction, v)
        lx, ly, lz = place[0] - px, place[1] - py, place[2] - pz
        scale = ONE / square_root(lx * lx + ly * ly + lz * lz)
        cosine = (nx * lx + ny * ly + nz * lz) * scale
        reached = mask16(np.int64(lit[v])) & (cosine > ZERO)
        if not any_lane(reached):
            continue
        nv = nx * dx + ny * dy + nz * dz
        lv = (lx * dx + ly * dy + lz * dz) * scale
        rv = maximum(lv - np.float32(2) * cosine * nv, ZERO)  # the mirrored light's direction against the viewer's
        shines = reached & (_row(points, SHINE_ROW, v) > ZERO) & (rv > ZERO)
        highlight = f32x16(ZERO)
        if any_lane(shines):
            highlight = select(shines, power(rv, _row(points, EXPONENT_ROW, v)), ZERO)
        for c in range(3):
            local = _row(points, DIFFUSE_ROW + c, v) * cosine + _row(points, SPECULAR_ROW + c, v) * highlight
            at = row_of(light, c) + 64 * v
            store(at, load_f32x16(at) + select(reached, strength[c] * local, ZERO))

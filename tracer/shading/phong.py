"""Local light: ambient, and Phong's diffuse and specular terms of each light that reaches a point."""

from __future__ import annotations

import numpy as np

from tracer.kernels import inlined, subkernel
from tracer.shading.look import AMBIENT, DIFFUSE, EXPONENT, SPECULAR
from tracer.shading.points import SHINE
from tracer.simd import (
    address_of,
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
def _row(rows, row, v):
    return load_f32x16(address_of(rows) + 4 * rows.shape[1] * row + 64 * v)


@inlined
def _add(light, channel, v, amount):
    """Add to a channel of the v-th vector of points."""
    a = address_of(light) + 4 * light.shape[1] * channel + 64 * v
    store(a, load_f32x16(a) + amount)


@subkernel
def add_ambient(points, look, light):
    """Add what every point of the batch has without any light; a texture scales it.  light (3, n) float32."""
    for v in range(light.shape[1] // 16):
        for c in range(3):
            ambient = look.ambient[c] * _row(points.surface, AMBIENT + c, v) * _row(points.texture, c, v)
            _add(light, c, v, ambient)


@subkernel
def add_light(points, look, number, lit, rays, light):
    """Add light `number` where bits of lit (n / 16,) say so: diffuse N.L, and (R.V)^exponent (Phong 1975)."""
    place, strength = look.lights[number], look.light_colors[number]
    for v in range(len(lit)):
        if lit[v] == 0:
            continue
        px, py, pz = load_three(points.position, v)
        nx, ny, nz = load_three(points.normal, v)
        dx, dy, dz = load_three(rays.direction, v)
        lx, ly, lz = place[0] - px, place[1] - py, place[2] - pz
        scale = ONE / square_root(lx * lx + ly * ly + lz * lz)
        cosine = (nx * lx + ny * ly + nz * lz) * scale
        reached = mask16(np.int64(lit[v])) & (cosine > ZERO)
        if not any_lane(reached):
            continue
        nv = nx * dx + ny * dy + nz * dz
        lv = (lx * dx + ly * dy + lz * dz) * scale
        rv = maximum(lv - np.float32(2) * cosine * nv, ZERO)  # the mirrored light's direction against the viewer's
        shines = reached & (_row(points.surface, SHINE, v) > ZERO) & (rv > ZERO)
        highlight = f32x16(ZERO)
        if any_lane(shines):
            highlight = select(shines, power(rv, _row(points.surface, EXPONENT, v)), ZERO)
        for c in range(3):
            diffuse = _row(points.surface, DIFFUSE + c, v) * _row(points.texture, c, v) * cosine
            local = diffuse + _row(points.surface, SPECULAR + c, v) * highlight
            _add(light, c, v, select(reached, strength[c] * local, ZERO))

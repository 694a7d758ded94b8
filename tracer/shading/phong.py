"""Local light: Phong's diffuse and specular terms of each light that reaches a point."""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.scene.lights import FALLS_OFF
from tracer.shading.points import DIFFUSE_ROW, EXPONENT_ROW, SHINE_ROW, SPECULAR_ROW
from tracer.shading.wave import row_of
from tracer.simd import (
    any_lane,
    f32x16,
    lane_of,
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


@inlined
def toward(place, position, normal, direction, asked):
    """The cosine of a light at `place` against the normals of a vector of points, which of those that are asked it can
    reach, how near the viewer is to the direction in which it is mirrored, and 1 over its distance."""
    px, py, pz = position
    nx, ny, nz = normal
    dx, dy, dz = direction
    lx, ly, lz = place[0] - px, place[1] - py, place[2] - pz
    scale = ONE / square_root(lx * lx + ly * ly + lz * lz)
    cosine = (nx * lx + ny * ly + nz * lz) * scale
    nv = nx * dx + ny * dy + nz * dz
    lv = (lx * dx + ly * dy + lz * dz) * scale
    return cosine, asked & (cosine > ZERO), maximum(lv - np.float32(2) * cosine * nv, ZERO), scale


@inlined
def highlight(reached, shine, exponent, mirrored):
    """Phong's specular term, 0 where nothing shines."""
    shines = reached & (shine > ZERO) & (mirrored > ZERO)
    if not any_lane(shines):
        return f32x16(ZERO)
    return select(shines, power(mirrored, exponent), ZERO)


@inlined
def one_highlight(mirrored, exponent):
    """Phong's specular term of one point that shines."""
    return lane_of(power(f32x16(mirrored), f32x16(exponent)), 0)


@inlined
def fall_off(row, near, cosine, specular):
    """The diffuse and the specular part of a lamp's light, less with the square of the distance where it falls off."""
    if row[FALLS_OFF] == ZERO:
        return cosine, specular
    return cosine * (near * near), specular * (near * near)


@subkernel
def add_light(points, lamps, number, sample, lit, wave, light):
    """Add a sample of lamp `number` to light (3, n) where bits of lit (n / 16,) say so: diffuse N.L, and
    (R.V)^exponent (Phong 1975)."""
    place, row = lamps.samples[sample], lamps.rows[number]
    for v in range((wave.size + 15) // 16):
        if lit[v] == 0:
            continue
        position, normal = load_three(points.position, v), load_three(points.normal, v)
        direction = load_three(wave.direction, v)
        cosine, reached, mirrored, near = toward(place, position, normal, direction, mask16(np.int64(lit[v])))
        if not any_lane(reached):
            continue
        specular = highlight(reached, _row(points, SHINE_ROW, v), _row(points, EXPONENT_ROW, v), mirrored)
        cosine, specular = fall_off(row, near, cosine, specular)
        for c in range(3):
            local = _row(points, DIFFUSE_ROW + c, v) * cosine + _row(points, SPECULAR_ROW + c, v) * specular
            at = row_of(light, c) + 64 * v
            store(at, load_f32x16(at) + select(reached, row[c] * local, ZERO))

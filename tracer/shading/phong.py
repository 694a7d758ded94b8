"""Local light: ambient, and Phong's diffuse and specular terms of each light that reaches a point."""

from __future__ import annotations

import numpy as np

from tracer.culling.shadow import LIT
from tracer.kernels import subkernel
from tracer.shading.look import AMBIENT, DIFFUSE, EXPONENT, SPECULAR

ZERO = np.float32(0)


@subkernel
def add_ambient(points, look, wave, color):
    """Add what every point of the batch has without any light; a texture scales it."""
    for i in range(len(points.unit)):
        material = look.materials[points.material[i]]
        for c in range(3):
            light = look.ambient[c] * material[AMBIENT + c] * points.texture[c, i]
            color[wave.pixel[i], c] += wave.weight[c, i] * light


@subkernel
def add_light(points, look, number, answer, wave, color):
    """Add light `number` where it reaches the point: diffuse N.L, and (R.V)^exponent (Phong 1975)."""
    light = look.lights[number]
    p, n, d = points.position, points.normal, wave.rays.direction
    for i in range(len(points.unit)):
        if answer[i] != LIT:
            continue
        lx, ly, lz = light[0] - p[0, i], light[1] - p[1, i], light[2] - p[2, i]
        scale = np.float32(1) / np.sqrt(lx * lx + ly * ly + lz * lz)
        cosine = (n[0, i] * lx + n[1, i] * ly + n[2, i] * lz) * scale
        if not cosine > ZERO:
            continue
        nv = n[0, i] * d[0, i] + n[1, i] * d[1, i] + n[2, i] * d[2, i]
        lv = (lx * d[0, i] + ly * d[1, i] + lz * d[2, i]) * scale
        rv = lv - np.float32(2) * cosine * nv  # the mirrored light's direction against the viewer's
        material = look.materials[points.material[i]]
        highlight = rv ** material[EXPONENT] if rv > ZERO else ZERO
        for c in range(3):
            local = material[DIFFUSE + c] * points.texture[c, i] * cosine + material[SPECULAR + c] * highlight
            color[wave.pixel[i], c] += wave.weight[c, i] * look.light_colors[number, c] * local

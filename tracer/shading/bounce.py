"""From one wave to the next: rays reflected and refracted where the last one hit."""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.direction_sort import sorted_by_direction
from tracer.shading.points import IOR_ROW, OFFSET_ROW, SPECULAR_ROW, TRANSMISSION_ROW
from tracer.shading.wave import DIRECTION, HIT_T, ORIGIN, PATH_LENGTH, PIXEL, WEIGHT, room, row_of, wave_in
from tracer.simd import (
    any_lane,
    bits_of,
    lanes_below,
    load_f32x16,
    load_three,
    mask16,
    maximum,
    ones,
    pack,
    pack_three,
    select,
    square_root,
    store,
    store_three,
)

MIN_WEIGHT = np.float32(1 / 256)
SPLITS = 10
"""Bounces at which a ray may be reflected and refracted; at later ones only the stronger of the two rays goes on, so
that no pixel has more than 2 ** SPLITS rays under way, whatever mirrors and glass face each other."""
ZERO, ONE = np.float32(0), np.float32(1)


@inlined
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def reflected(d, n):
    """Directions d mirrored at surfaces of unit normals n."""
    s = np.float32(-2) * _dot(d, n)
    return d[0] + s * n[0], d[1] + s * n[1], d[2] + s * n[2]


@inlined
def refracted(d, n, eta):
    """(whether, direction) of Snell's law, n against d; not so under total internal reflection."""
    cosine = -_dot(d, n)
    k = ONE - eta * eta * (ONE - cosine * cosine)
    s = eta * cosine - square_root(maximum(k, ZERO))
    return k >= ZERO, (eta * d[0] + s * n[0], eta * d[1] + s * n[1], eta * d[2] + s * n[2])


@inlined
def _send(wave, v, out, n, going, origin, direction, scale):
    """Add rays from the v-th vector of a wave to the n of the next, but those that would count too little."""
    weight = load_three(wave.weight, v)
    weight = (weight[0] * scale[0], weight[1] * scale[1], weight[2] * scale[2])
    going = going & (maximum(weight[0], maximum(weight[1], weight[2])) >= MIN_WEIGHT)
    if not any_lane(going):
        return n
    length = square_root(_dot(direction, direction))
    path_length = load_f32x16(row_of(wave.memory, PATH_LENGTH) + 64 * v) + load_f32x16(
        row_of(wave.memory, HIT_T) + 64 * v
    )
    at, stride = row_of(out, 0) + 4 * n, 4 * out.shape[1]
    direction = (direction[0] / length, direction[1] / length, direction[2] / length)
    store_three(at + stride * ORIGIN, stride, pack_three(origin, going))
    store_three(at + stride * DIRECTION, stride, pack_three(direction, going))
    store_three(at + stride * WEIGHT, stride, pack_three(weight, going))
    store(at + stride * PATH_LENGTH, pack(path_length, going))
    store(at + stride * PIXEL, pack(load_f32x16(row_of(wave.memory, PIXEL) + 64 * v), going))
    return n + ones(bits_of(going))


@inlined
def _sunk(points, v):
    """Where refracted rays start: as far below the surface as others above it."""
    x, y, z = load_three(points.position, v)
    gx, gy, gz = load_three(points.geometric, v)
    offset = load_f32x16(row_of(points.memory, OFFSET_ROW) + 64 * v)
    return x - offset * gx, y - offset * gy, z - offset * gz


@subkernel
def _refract(points, wave, out, splits):
    """Refracted rays, scaled by the transmission, into the rows of `out`; how many.

    Where nothing passes, the transmission is added to the specular colour: it takes the refracted ray's share.  Unless
    a ray splits, only the stronger of two goes on: the specular colour becomes 0, or there is no refracted ray."""
    n = 0
    for v in range((wave.size + 15) // 16):
        through = load_f32x16(row_of(points.memory, TRANSMISSION_ROW) + 64 * v)
        transmits = (through > ZERO) & mask16(lanes_below(wave.size, v))
        if not any_lane(transmits):
            continue
        ior = load_f32x16(row_of(points.memory, IOR_ROW) + 64 * v)
        eta = select(mask16(np.int64(points.entering[v])), ONE / ior, ior)
        passes, direction = refracted(load_three(wave.direction, v), load_three(points.normal, v), eta)
        going, share = transmits & passes, select(transmits, select(passes, ZERO, through), ZERO)
        if not splits:
            red, green, blue = load_three(points.specular, v)
            going = going & (through >= maximum(red, maximum(green, blue)))
        n = _send(wave, v, out, n, going, _sunk(points, v), direction, (through, through, through))
        for c in range(3):
            a = row_of(points.memory, SPECULAR_ROW + c) + 64 * v
            specular = load_f32x16(a) + share
            store(a, specular if splits else select(going, ZERO, specular))
    return n


@subkernel
def _reflect(points, wave, out, n):
    """Reflected rays, scaled by the specular colour, after the n that there are; how many there are then."""
    for v in range((wave.size + 15) // 16):
        direction = reflected(load_three(wave.direction, v), load_three(points.normal, v))
        there = mask16(lanes_below(wave.size, v))
        n = _send(wave, v, out, n, there, load_three(points.lifted, v), direction, load_three(points.specular, v))
    return n


@inlined
def next_wave(points, wave, bounce, memory):
    """The rays sent on from here, refracted ones first, sorted by direction; and memory for the wave after them.

    They lie in this memory or in the wave's own, or in more where they are too many."""
    out = room(memory, 2 * wave.size)
    n = _reflect(points, wave, out, _refract(points, wave, out, bounce < SPLITS))
    spare = room(wave.memory, n)
    if sorted_by_direction(out, n, spare):
        out, spare = spare, out
    return wave_in(out, n), spare

"""Stochastic lightcuts: every point has representatives of its own, drawn by their intensities (C. Yuksel, "Stochastic
Lightcuts", HPG 2019; D. Lin and C. Yuksel, "Real-Time Stochastic Lightcuts", I3D 2020).

What clusters are wrong by then differs from pixel to pixel and from sample to sample: it is noise, which averages out,
where fixed representatives leave bands that do not.  Where a cluster is parted, the part that a point's representative
lies in keeps it, and one is drawn from the other part.  What is drawn depends on the pixel, the bounce, the frame, its
sample and the node alone, so that pictures repeat.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import CULLED, DUE, RAYS
from tracer.runtime.kernels import inlined, subkernel
from tracer.scene.lights import COLOR, FALLS_OFF
from tracer.shading.lightcuts.block import POINTS, count_asked, of_block, point_row, trace_rays
from tracer.shading.phong import highlight, toward
from tracer.shading.points import DIFFUSE_ROW, EXPONENT_ROW, SHINE_ROW, SPECULAR_ROW
from tracer.shading.wave import PIXEL, row_of
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    gather_f32x16,
    gather_i32x16,
    i32x16,
    lanes_below,
    load_f32x16,
    load_i32x16,
    load_spread_bytes16,
    load_three,
    mask16,
    ones,
    pack_three,
    select,
    store,
    store_three,
    to_f32,
)
from tracer.simd.records import F32, I32, F32x2D, I32x2D

ZERO = np.float32(0)
DRAWN_ROWS = 4  # of POINTS: red, green, blue, and the place of what was drawn in the order of lights
MIX, MIX_AGAIN, GOLDEN = np.int32(-2048144789), np.int32(-1028477387), np.int32(-1640531527)
NODES_APART = np.int32(-862048943)


class Draws(NamedTuple):
    """By what representatives are drawn: spans (n, 2) and order (l,) int32 of the tree, before (l + 1,) float32, the
    intensity of the lights before each in that order, shades (l,) float32, the intensity of each light, and a seed.
    fresh (DRAWN_ROWS, POINTS) float32 is memory.  Without rows where nothing is drawn."""

    spans: I32x2D
    order: I32
    before: F32
    shades: F32
    fresh: F32x2D
    seed: int


@inlined
def _mixed(h):
    """Bits of int32 well mixed (the finalizer of MurmurHash3, A. Appleby)."""
    h = h ^ ((h >> np.int32(16)) & np.int32(0xFFFF))
    h = h * MIX
    h = h ^ ((h >> np.int32(13)) & np.int32(0x7FFFF))
    h = h * MIX_AGAIN
    return h ^ ((h >> np.int32(16)) & np.int32(0xFFFF))


@inlined
def _chance(seed, pixel, node):
    """Numbers from 0 to 1 for pixels and nodes."""
    mixed = _mixed(_mixed(pixel * GOLDEN + np.int32(seed)) + node * NODES_APART)
    return to_f32((mixed >> np.int32(8)) & np.int32(0xFFFFFF)) * np.float32(1 / (1 << 24))


@inlined
def _place_of(before, first, last, low, high, chance):
    """Which lights of the spans from first to last - 1 the parts `chance` of their intensities fall on."""
    at, sought = address_of(before), low + chance * (high - low)
    last = last - np.int32(1)
    for _ in range(20):  # more lights than 2^20 lie in no cluster of a cut for long
        middle = (first + last + np.int32(1)) >> np.int32(1)
        right = (gather_f32x16(at, middle) <= sought) & (first < last)
        first, last = select(right, middle, first), select(right | ~(first < last), last, middle - np.int32(1))
    return first


@inlined
def _intensity(clusters, node):
    return clusters.colors[node, 0] + clusters.colors[node, 1] + clusters.colors[node, 2]


@inlined
def _kept_at(work, k, row, v, block):
    return address_of(work.kept) + 4 * (POINTS * (DRAWN_ROWS * k + row) + 16 * (v - block.first))


@subkernel
def ask_drawn(clusters, draws, points, wave, place, block, k, other, node, left, right, work, counts):
    """Draw representatives of a node's children for each point of a block whose own does not lie in them, and trace
    the rays from them: row k of `kept` becomes that of the child `left`, row `other` that of `right`.

    With left = right = node all are drawn, into row k, for the first time."""
    begins, first_time = address_of(draws.before), left == right
    stride, n, due = 4 * work.direction.shape[1], 0, np.int64(0)
    middle, lf, ll = draws.spans[left, 1], draws.spans[left, 0], draws.spans[left, 1]
    rf, rl = draws.spans[right, 0], draws.spans[right, 1]
    whole, power_left, power_right = (
        _intensity(clusters, node),
        _intensity(clusters, left),
        _intensity(clusters, right),
    )
    for v in range(block.first, block.last):
        there = lanes_below(block.size, v)
        pixel = select(mask16(there), load_i32x16(row_of(wave.memory, PIXEL) + 64 * v), i32x16(0))
        pixel = gather_i32x16(address_of(place), pixel)
        in_left = load_i32x16(_kept_at(work, k, 3, v, block)) < np.int32(middle)
        if first_time:
            in_left = pixel < np.int32(0)
        first, last = select(in_left, np.int32(rf), np.int32(lf)), select(in_left, np.int32(rl), np.int32(ll))
        low, high = gather_f32x16(begins, first), gather_f32x16(begins, last)
        chance = _chance(draws.seed, pixel, select(in_left, np.int32(right), np.int32(left)))
        rank = _place_of(draws.before, first, last, low, high, chance)
        light = gather_i32x16(address_of(draws.order), rank)
        at = address_of(clusters.samples)
        lights = light * np.int32(3)
        spot = gather_f32x16(at, lights), gather_f32x16(at + 4, lights), gather_f32x16(at + 8, lights)
        rows = gather_i32x16(address_of(clusters.owners), light) * np.int32(4)

        # The terms of a light, as for all others.
        px, py, pz = load_three(points.position, v)
        gx, gy, gz = load_three(points.geometric, v)
        facing = gx * (spot[0] - px) + gy * (spot[1] - py) + gz * (spot[2] - pz) > ZERO
        faced = bits_of(facing) & there
        due += ones(faced)
        normal, way = load_three(points.normal, v), load_three(wave.direction, v)
        cosine, reached, mirrored, near = toward(spot, (px, py, pz), normal, way, mask16(faced))
        shine, exponent = point_row(points, SHINE_ROW, v), point_row(points, EXPONENT_ROW, v)
        specular = highlight(reached, shine, exponent, mirrored)
        scale = select(in_left, power_right, power_left) / gather_f32x16(address_of(draws.shades), light)
        falls = gather_f32x16(address_of(clusters.rows) + 4 * FALLS_OFF, rows) > ZERO
        scale = select(falls, scale * (near * near), scale)
        for c in range(3):
            color = gather_f32x16(address_of(clusters.rows) + 4 * (COLOR + c), rows)
            diffuse, mirror = point_row(points, DIFFUSE_ROW + c, v), point_row(points, SPECULAR_ROW + c, v)
            local = color * (diffuse * cosine + mirror * specular) * scale
            store(of_block(draws.fresh[c], v, block), select(reached, local, ZERO))
        store(of_block(draws.fresh[3], v, block), rank)

        x, y, z = load_three(points.lifted, v)
        direction = pack_three((x - spot[0], y - spot[1], z - spot[2]), reached)
        store_three(address_of(work.direction) + 4 * n, stride, direction)
        store_three(address_of(work.origin) + 4 * n, stride, pack_three(spot, reached))
        work.reached[v - block.first] = np.int32(bits_of(reached))
        count_asked(work, block, v, reached)
        n += ones(bits_of(reached))
    counts[DUE] += due
    counts[RAYS] += n
    counts[CULLED] += due - n
    trace_rays(clusters, n, work, counts)

    n = 0
    for v in range(block.first, block.last):
        reached = np.int64(work.reached[v - block.first])
        blocked = load_spread_bytes16(address_of(work.blocked) + n, mask16(reached)) > 0
        lit = mask16(reached) & ~blocked
        n += ones(reached)
        drawn = load_i32x16(of_block(draws.fresh[3], v, block))
        ranks = load_i32x16(_kept_at(work, k, 3, v, block))
        in_left = ranks < np.int32(middle)
        estimate = load_f32x16(of_block(work.estimate, v, block))
        for c in range(3):
            value = select(lit, load_f32x16(of_block(draws.fresh[c], v, block)), ZERO)
            at = _kept_at(work, k, c, v, block)
            if first_time:
                store(at, value)
                estimate = estimate + value
            else:
                old = load_f32x16(at)
                a = select(in_left, old * (power_left / whole), value)
                b = select(in_left, value, old * (power_right / whole))
                store(at, a)
                store(_kept_at(work, other, c, v, block), b)
                estimate = estimate + (a + b - old)
        store(of_block(work.estimate, v, block), estimate)
        if first_time:
            store(_kept_at(work, k, 3, v, block), drawn)
        else:
            store(_kept_at(work, k, 3, v, block), select(in_left, ranks, drawn))
            store(_kept_at(work, other, 3, v, block), select(in_left, drawn, ranks))


@subkernel
def shade_drawn(points, block, count, work):
    """Add what the nodes of a cut send to the light of a block's points."""
    for v in range(block.first, block.last):
        for c in range(3):
            at, sent = row_of(points.light, c) + 64 * v, f32x16(ZERO)
            for k in range(count):
                sent = sent + load_f32x16(_kept_at(work, k, c, v, block))
            store(at, load_f32x16(at) + sent)

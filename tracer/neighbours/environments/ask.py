"""What the points of a wave look at, and what they ask."""

from __future__ import annotations

import numpy as np

from tracer.culling.counters import STEPS
from tracer.culling.stages import vectors
from tracer.neighbours.cells_of_space import answer_in_cells, want
from tracer.neighbours.environments.octree import HIDDEN, LIT, OUTSIDE, cells_at
from tracer.runtime.kernels import subkernel
from tracer.simd import (
    address_of,
    bits_of,
    gather_i32x16,
    i32_at,
    i32x16,
    lanes_below,
    load_i32x16,
    load_three,
    local_memory,
    lowest_bit,
    mask16,
    ones,
    select,
    store,
)
from tracer.visibility.ask_list import ASKED, KNOWN, ask_list


@subkernel
def find_cells(environments, points, count, cells):
    """Put the cells of a wave's points into `cells` (n,) int32, and want those of which more could be known."""
    numbers = address_of(cells)
    for v in range(vectors(count)):
        x, y, z = load_three(points.lifted, v)
        store(numbers + 64 * v, cells_at(environments, x, y, z))
        want(environments.wanted, environments.open, 1, numbers + 64 * v, lanes_below(count, v))


@subkernel
def select_lights(environments, count, cells):
    """Put the vectors of points that have to look at each light into environments.looks."""
    looks, held = environments.looks, environments.held
    lights, words = len(looks), (vectors(count) + 63) // 64
    for light in range(lights):
        for word in range(words):
            looks[light, word] = 0 if environments.known[light] else -1
    for v in range(vectors(count)):
        bit, word, before = np.int64(1) << (v & 63), v >> 6, -1
        rest = lanes_below(count, v)
        while rest != 0:
            cell = cells[16 * v + lowest_bit(rest)]
            rest &= rest - 1
            if cell == before:
                continue
            before = cell
            for light in range(held):
                if environments.codes[cell * held + light] != HIDDEN:
                    looks[light, word] |= bit
            which = environments.of[cell]
            if which == 0:
                for light in range(held, lights):
                    looks[light, word] |= bit
            else:
                for k in range(environments.starts[which - 1], environments.starts[which]):
                    looks[environments.lights[k], word] |= bit


@subkernel
def answer(environments, points, batch, light, place, count, cells, counts):
    """Answer the rays to a light at place (3,) of points of whose `cells` something is known."""
    held, by_ray = environments.held, environments.by_ray
    rows, codes = address_of(environments.light_space[light]), address_of(environments.codes)
    lists, seen, masks = local_memory(64), local_memory(KNOWN), local_memory(ASKED)
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live == 0:
            continue
        counts[STEPS] += ones(live) if by_ray else 1
        cell = select(mask16(live), load_i32x16(address_of(cells) + 64 * v), i32x16(np.int32(OUTSIDE)))
        code = gather_i32x16(codes, cell * np.int32(held) + np.int32(light))
        full, null = bits_of(code == np.int32(HIDDEN)) & live, bits_of(code == np.int32(LIT)) & live
        end = load_three(points.lifted, v)
        way = end[0] - place[0], end[1] - place[1], end[2] - place[2]
        rest, asked = bits_of(code > np.int32(LIT)) & live, np.int64(0)
        if rest != 0:
            store(lists, code)
            store(seen, i32x16(np.int32(-1)))
        while rest != 0:
            at = i32_at(lists)[lowest_bit(rest)]
            here = bits_of(code == np.int32(at)) & rest
            rest &= ~here
            names = address_of(environments.names) + 4 * (np.int64(at) + 1)
            many = np.int64(environments.names[at])
            blocked, unsure = ask_list(rows, names, many, place, end, way, here, seen, masks, by_ray, counts)
            full, null, asked = full | blocked, null | (here & ~(blocked | unsure)), asked | (here & ~unsure)
        answer_in_cells(batch, v, full, null, asked, environments.resting, place, end, counts)

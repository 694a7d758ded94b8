"""Rays between the planes of their cell: they are tested against its candidates, sixteen at a time.

A candidate's answer is taken where it is certain (`tracer.visibility.light_space.verdicts`).  One certain hit blocks
the ray; where all candidates are certain to be missed nothing static does.  All rays test one candidate, then those
that are still open, packed anew, the next.  Where sixteen of them ask the same candidate, as neighbours do, its row is
read once.  A ray of which a candidate is not certain is traced, and asks no more."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import TESTS
from tracer.culling.stages import vectors
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    gather_i32x16,
    i32_at,
    i32x16,
    lanes_below,
    load_columns,
    load_i32,
    load_i32x16,
    load_three,
    lowest_bit,
    mask16,
    ones,
    pack,
    pack_three,
    select,
    store,
    store_three,
)
from tracer.simd.records import IntRow, Memory, Row3, row_count, rows_of
from tracer.visibility.light_space import LIGHT_ROW, load_row, verdicts

# Answers, as bits.
OPEN_RAY, LIT_RAY, SHADOWED_RAY, SETTLED_RAY, BY_CANDIDATES = 0, 1, 2, 4, 8


class BufferRays(NamedTuple):
    """The live rays of a wave, packed, and those of them that test candidates, packed again.

    Attributes:
        end: where each ends, (3, n).
        code: the record of its cell; at last a byte for each answer.
        answer: what is known of it.
        ray, asked: the number of each that tests candidates among the former, and where it ends.
        next, left: where its next candidate stands in the lists, and how many are left to be tested.
        name: the row of that candidate.
    """

    memory: Memory
    end: Row3
    code: IntRow
    answer: IntRow
    ray: IntRow
    asked: Row3
    next: IntRow
    left: IntRow
    name: IntRow


buffer_rays_in = rows_of(BufferRays)
RAY_ROWS = row_count(BufferRays)


@inlined
def _note(rays, at, bits, answer):
    """Write an answer for those of sixteen rays, whose numbers are at an address, that bits name."""
    numbers = i32_at(at)
    while bits != 0:
        rays.answer[numbers[lowest_bit(bits)]] = answer
        bits &= bits - 1


@subkernel
def ask_candidates(cube, light, rays, count, single, counts):
    """Test the candidates of so many rays, and note what is certain of them."""
    ray, following, left = address_of(rays.ray), address_of(rays.next), address_of(rays.left)
    name, ends, stride = address_of(rays.name), address_of(rays.asked), 4 * rays.asked.shape[1]
    while count > 0:
        n = np.int64(0)
        for k in range(vectors(count)):
            there, a = lanes_below(count, k), 64 * k
            at, remaining = load_i32x16(following + a), load_i32x16(left + a)
            number = gather_i32x16(cube.lists, select(mask16(there), at, i32x16(0)))
            store(name, number)
            end = load_three(rays.asked, k)
            direction = end[0] - light[0], end[1] - light[1], end[2] - light[2]
            counts[TESTS] += ones(there) if single else 1
            first = load_i32(name)
            if bits_of(number == i32x16(first)) & there == there:
                hit, missed = verdicts(load_row(cube.rows + 4 * LIGHT_ROW * np.int64(first)), light, direction, end)
            else:
                hit, missed = verdicts(load_columns(cube.rows, name, LIGHT_ROW), light, direction, end)
            hit, missed = np.int64(hit) & there, np.int64(missed) & there
            last = np.int64(bits_of(remaining == np.int32(1)))
            _note(rays, ray + a, hit, SHADOWED_RAY | BY_CANDIDATES)
            _note(rays, ray + a, missed & ~hit & last, LIT_RAY | BY_CANDIDATES)
            more = missed & ~hit & ~last
            if more != 0:
                open_rays = mask16(more)
                store(ray + 4 * n, pack(load_i32x16(ray + a), open_rays))
                store(following + 4 * n, pack(at + np.int32(1), open_rays))
                store(left + 4 * n, pack(remaining - np.int32(1), open_rays))
                store_three(ends + 4 * n, stride, pack_three(end, open_rays))
                n += ones(more)
        count = n

"""The shadow rays of a wave's points to one light, and what is known about them."""

from __future__ import annotations

from typing import NamedTuple

from tracer.simd.records import IntRow, Memory, Row, Row3, row_count, rows_of


class ShadowBatch(NamedTuple):
    """The shadow rays of n points to one light: rows of `memory` (SHADOW_ROWS, n) float32.

    Sets of points are bits of int32, sixteen points a number, in the first n / 16 numbers of a row:

    - due: the light is on the viewer's side of the surface;
    - live: nothing is known yet, so that the trees are to be asked;
    - unblocked: due, and no static geometry is in the way;
    - settled: due, and dynamic objects need not be asked any more;
    - candidates: answered by a few static primitives, which were tested in the place of all;
    - cached: blocked by what blocked a light before;
    - lit: due, and nothing is in the way: the answer that shading uses;
    - truth: the same by tracing every due ray, where answers are verified.

    `active` are the numbers of those vectors of sixteen in which any ray is due, in the first numbers of the row.

    Rays that are traced are packed, one after the other: origin and direction (3, n), t_min and t_max (n,); `blocked`
    has a byte for each, and `occluders` (n,) what blocks it, where somebody wants to know.  `asked` are the bits of
    the points whose rays these are."""

    memory: Memory
    origin: Row3
    direction: Row3
    t_min: Row
    t_max: Row
    due: IntRow
    live: IntRow
    unblocked: IntRow
    settled: IntRow
    candidates: IntRow
    cached: IntRow
    lit: IntRow
    truth: IntRow
    active: IntRow
    asked: IntRow
    blocked: Row
    occluders: IntRow


shadow_batch_in = rows_of(ShadowBatch)
SHADOW_ROWS = row_count(ShadowBatch)

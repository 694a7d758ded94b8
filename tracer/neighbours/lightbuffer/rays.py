"""The memory in which rays are looked up."""

from __future__ import annotations

from typing import NamedTuple

from tracer.simd.records import IntRow, Memory, Row3, row_count, rows_of

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

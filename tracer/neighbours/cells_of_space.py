"""What is done alike with cells of all kinds: to show them, to want more of them known, and to answer rays by them."""

from __future__ import annotations

import numpy as np

from tracer.culling.counters import CANDIDATES_ONLY, CULLED, DYNAMIC_ONLY
from tracer.geometry.boxes import segments_miss_box
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, bits_of, i32_at, lowest_bit, mark, ones

STATES = "none", "full", "lit", "candidates"  # what is known of a light in a cell, by its bits in the cell's word


@inlined
def record_cells(cell, place, wave, found):
    """Write the cells `found` (n,) of primary hits into the picture, cell (pixels,) int32, unless that has no pixels;
    place (n,) says where in it each pixel of the tile is."""
    if len(cell) > 0:
        for i in range(wave.size):
            cell[place[wave.pixel[i]]] = found[i]


@inlined
def want(wanted, states, waiting, numbers, lanes):
    """Mark those cells as wanted (cells,) bool whose states (cells,) say that they are waiting to be known.

    The cells are those of some of sixteen lanes, by their bits, int32 at the address `numbers`."""
    before = -1
    while lanes != 0:
        cell = i32_at(numbers)[lowest_bit(lanes)]
        lanes &= lanes - 1
        if cell != before and states[cell] == waiting:
            mark(address_of(wanted) + cell)
        before = cell


@subkernel
def answer_in_cells(batch, v, full, null, tested, resting, light, end, counts):
    """Answer those rays from light (3,) to sixteen points `end` that are known to be blocked (`full`), and those that
    nothing blocks which never moves (`null`) and that pass by all boxes around what rests, resting (k, 6).

    What was `tested` to know that is counted apart; all are bits, batch is a `ShadowBatch`."""
    way = end[0] - light[0], end[1] - light[1], end[2] - light[2]
    for k in range(len(resting)):
        box = resting[k]
        if null != 0:
            null &= bits_of(segments_miss_box(light, way, (box[0], box[1], box[2]), (box[3], box[4], box[5])))
    known = full | null
    counts[CULLED] += ones(full & ~tested)
    counts[DYNAMIC_ONLY] += ones(null & ~tested)
    counts[CANDIDATES_ONLY] += ones(known & tested)
    batch.candidates[v] |= known & tested
    batch.live[v] = np.int64(batch.live[v]) & ~known
    batch.lit[v] |= null

"""What pictures and statistics tell of cuts."""

from __future__ import annotations

from typing import NamedTuple

from tracer.runtime.kernels import subkernel
from tracer.shading.lightcuts.block import DARK
from tracer.simd.records import F32, I32, I64

# Of a worker's tally: blocks, their points, nodes of their cuts, the same times their points, blocks whose cuts have as
# many nodes as may be, and the most nodes of any cut.
BLOCKS, POINTS, NODES, POINT_NODES, LIMITED, MOST_NODES = range(6)
TALLIES = 6


class Seen(NamedTuple):
    """What is told of the first sample's primary hits, (pixels,), or without rows: nodes int32, and the bound of their
    error as a part of what is estimated, float32.  Rays that were traced for pixels, and those that this saves,
    (pixels,) int32 or without rows.  And a worker's tally (TALLIES,) int64 of all waves."""

    nodes: I32
    bound: F32
    cost: I32
    saved: I32
    tally: I64


@subkernel
def tell(seen, wave, place, block, nodes, limited, work, bounce):
    """Tell of the cut of a block: its nodes, and whether it has as many as may be.

    place (n,) int32 are the pixels of the tile in the picture."""
    first, last = 16 * block.first, min(block.size, 16 * block.last)
    tally = seen.tally
    tally[BLOCKS] += 1
    tally[POINTS] += last - first
    tally[NODES] += nodes
    tally[POINT_NODES] += nodes * (last - first)
    tally[LIMITED] += limited
    tally[MOST_NODES] = max(tally[MOST_NODES], nodes)
    for i in range(first, last):
        pixel = place[wave.pixel[i]]
        if bounce == 0 and len(seen.nodes) > 0:
            seen.nodes[pixel] = nodes
            seen.bound[pixel] = work.bound[i - first] / max(work.estimate[i - first], DARK)
        if len(seen.cost) > 0:
            seen.cost[pixel] += work.asked[i - first]
            seen.saved[pixel] -= work.asked[i - first]

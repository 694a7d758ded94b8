"""What pictures and statistics tell of cuts."""

from __future__ import annotations

from typing import NamedTuple

from tracer.kernels import subkernel
from tracer.shading.lightcuts.block import DARK
from tracer.shading.lightcuts.block import POINTS as WIDTH
from tracer.shading.points import DIFFUSE_ROW, SPECULAR_ROW
from tracer.shading.wave import row_of
from tracer.simd import load_f32
from tracer.simd.records import F32, I32, I64, F32x2D

# Of a worker's tally: blocks, their points, nodes of their cuts, the same times their points, blocks whose cuts have as
# many nodes as may be, and the most nodes of any cut.
BLOCKS, POINTS, NODES, POINT_NODES, LIMITED, MOST_NODES = range(6)
TALLIES = 6
BOX, SENT, ERROR = 0, 6, 7  # columns of the nodes of the cut that is watched
NODE_ROWS = 8


class Seen(NamedTuple):
    """What is told of the first sample's primary hits, (pixels,), or without rows: nodes int32, and the bound of their
    error as a part of what is estimated, float32.  Rays that were traced for pixels, and those that this saves,
    (pixels,) int32 or without rows.  A worker's tally (TALLIES,) int64 of all waves.  And the cut of the `watched`
    pixel, by its number, -1 for none: watched_cut (m + 1,) int32, how many nodes it has, then their numbers;
    watched_nodes (m, NODE_ROWS) float32, of each its box, what it sends to the point, and by what part of all light
    there it may be wrong."""

    nodes: I32
    bound: F32
    cost: I32
    saved: I32
    tally: I64
    watched: int
    watched_cut: I32
    watched_nodes: F32x2D


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


@subkernel
def tell_watched(seen, clusters, drawn, points, wave, place, block, nodes, work, bounce):
    """Tell the nodes of a block's cut, where the pixel that is watched is in it and is seen directly.

    `drawn`: representatives were drawn, and what they send is kept as it is."""
    first, last = 16 * block.first, min(block.size, 16 * block.last)
    for i in range(first, last):
        if bounce == 0 and place[wave.pixel[i]] == seen.watched:
            seen.watched_cut[0] = nodes
            for k in range(nodes):
                node, at, told = work.nodes[k], i - first, seen.watched_nodes[k]
                seen.watched_cut[k + 1] = node
                for c in range(6):
                    told[c] = clusters.boxes[node, c]
                told[SENT] = 0.0
                for c in range(3):
                    if drawn:
                        told[SENT] += work.kept[k, WIDTH * c + at]
                    else:
                        diffuse = load_f32(row_of(points.memory, DIFFUSE_ROW + c) + 4 * i)
                        specular = load_f32(row_of(points.memory, SPECULAR_ROW + c) + 4 * i)
                        local = diffuse * work.kept[k, at] + specular * work.kept[k, WIDTH + at]
                        told[SENT] += clusters.colors[node, c] * local
                told[ERROR] = work.keys[k]

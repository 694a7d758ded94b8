"""What workers are given to shade by cuts, and the shading of one block."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import PASSED_OVER
from tracer.culling.stages import vectors
from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.lightcuts.block import BLOCK, Block, Clusters, CutWork
from tracer.shading.lightcuts.cut import refine, shade_block
from tracer.shading.lightcuts.drawn import Draws, shade_drawn
from tracer.shading.lightcuts.seen import Seen, tell


class Cuts(NamedTuple):
    """What a worker is given: the tree; how representatives are drawn; memory; what is told of cuts; the part of what
    arrives that a cluster may be wrong by; and the most nodes of a cut."""

    clusters: Clusters
    draws: Draws
    work: CutWork
    seen: Seen
    error: float
    limit: int


@inlined
def block_at(first, count):
    """The block that begins with a vector of `count` points."""
    return Block(first, min(first + BLOCK, vectors(count)), count)


@subkernel
def shade_by_cut(cuts, clusters, points, wave, given, block, counts):
    """Add the light of all lights to a block of points, by a cut of clusters."""
    error, place = np.float32(cuts.error), given.place
    nodes = refine(clusters, cuts.draws, points, wave, place, block, error, cuts.limit, cuts.work, counts)
    if len(cuts.draws.order) > 0:
        shade_drawn(points, block, nodes, cuts.work)
    else:
        shade_block(clusters, points, block, nodes, cuts.work)
    lights = len(clusters.samples)
    counts[PASSED_OVER] += (min(block.size, 16 * block.last) - 16 * block.first) * (lights - nodes)
    tell(cuts.seen, wave, place, block, nodes, nodes == cuts.limit and nodes < lights, cuts.work, given.bounce)

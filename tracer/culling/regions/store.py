"""The regions of a scene and the lights that each is left with, as far as rays have ended there.

What is proved rests on geometry that never moves and on where lights stand.  A light that has moved away from where
the tree of lights has it counts for every region, until many have: then all is proved anew.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.error_bounds import LONGEST
from tracer.culling.certified.scheduler import Budget, Counts
from tracer.culling.regions.blockers import Blockers, find_blockers
from tracer.culling.regions.certify import COUNTERS, STEPS, TESTS, hidden_from, leaves_left
from tracer.culling.regions.grid import Grid, blocks_around, boxes_of, make_grid, region_at
from tracer.culling.regions.light_tree import LightTree, build_light_tree
from tracer.runtime.parallel import for_each_chunk
from tracer.scene.lights import Lamps
from tracer.simd.records import I32, I64, Bytes, F32x2D

if TYPE_CHECKING:
    from tracer.geometry.world import World

COARSE = 8  # regions on a side of the blocks for which lights are left out first
CHUNK, BATCH, MOST = 16, 64, 4096  # regions that a thread takes at a time; of a frame's first batch, and of any
HARDLY = 0.8  # of a block's leaves: a region that keeps more is not worth a list of its own
MOVED = 8  # the part, one in so many, of lights that may have moved before all is proved anew


class RegionView(NamedTuple):
    """What kernels are given: the grid; `starts` (n + 1,) int64, where the lights of each list begin in `lights`;
    `boxes` (l, 6) float32, around each light's samples; `moved` (l,) bool, lights that count everywhere."""

    grid: Grid
    starts: I64
    lights: I32
    boxes: F32x2D
    moved: Bytes


class Block(NamedTuple):
    """The leaves (n,) of the tree of lights that a block of regions is left with; and, where its regions share their
    lights, what `Grid.certified` calls that list, else 0."""

    leaves: NDArray[np.int32]
    shared: int


class RegionStore:
    """What is known of a world's regions."""

    def __init__(self, world: World, lamps: Lamps, clock: Callable[[], float] = time.perf_counter) -> None:
        """For these lights."""
        self._world, self._clock = world, clock
        triangles = world.triangles_of(0).rows
        self._bounds = _bounds(triangles)
        self.blockers: Blockers = find_blockers(triangles)
        self.longest_sure = world.hit_padding / LONGEST * float(np.abs(self._bounds).max())
        self._begin(_boxes(lamps))

    def _begin(self, boxes: NDArray[np.float32]) -> None:
        """Begin with nothing known, of lights in these boxes (l, 6)."""
        self._proved, self._boxes = boxes, boxes
        self._moved = np.zeros(len(boxes), np.bool_)
        self.tree: LightTree = build_light_tree(boxes)
        self._forget()

    def _forget(self) -> None:
        self.grid: Grid = make_grid(self._bounds)
        self._blocks: dict[int, Block] = {}
        self._starts, self._lights = [np.zeros(1, np.int64)], [np.empty(0, np.int32)]
        self._lists = 0

    @property
    def bytes(self) -> int:
        """Memory that lists take, in bytes."""
        blocks = [block.leaves for block in self._blocks.values()]
        return sum(a.nbytes for arrays in (self._starts, self._lights, blocks) for a in arrays)

    def follow(self, lamps: Lamps) -> None:
        """Lights are where these lamps have them now."""
        boxes, before = _boxes(lamps), self._boxes
        if boxes.shape != before.shape:
            self._begin(boxes)
            return
        self._boxes, self._moved = boxes, (boxes != self._proved).any(1)
        if MOVED * self._moved.sum() > len(boxes) and (boxes == before).all():  # they stand again
            self._begin(boxes)

    def certify(self, budget: Budget, threads: int, cancel: Callable[[], bool] | None = None) -> Counts:
        """Find the lights of the regions that are wanted, as far as the budget allows.

        Raises Cancelled if `cancel` turns true meanwhile; what has been found by then is kept."""
        until, counts = self._clock() + budget.seconds, np.zeros((threads, COUNTERS), np.int64)
        wanted, made, batch = np.flatnonzero(self.grid.wanted), 0, BATCH
        while made < min(len(wanted), budget.certificates) and self._clock() < until:
            regions = wanted[made : made + int(min(batch, budget.certificates - made))]
            blocks = blocks_around(self.grid, regions, COARSE)
            self._certify_blocks(regions, blocks, threads, counts, cancel)
            known = [self._blocks[number] for number in blocks.tolist()]
            shared = np.array([block.shared for block in known])
            self.grid.certified[regions[shared > 0]] = shared[shared > 0]
            alone = np.flatnonzero(shared == 0)
            above = [known[k].leaves for k in alone]
            leaves = self._descend(boxes_of(self.grid, regions[alone]), above, threads, counts, cancel)
            self.grid.certified[regions[alone]] = self._add(leaves)
            self.grid.wanted[regions] = False
            made += len(regions)
            batch = min(MOST, 2 * batch)
        return Counts(int(counts[:, STEPS].sum()), int(counts[:, TESTS].sum()), made)

    def _certify_blocks(
        self,
        regions: NDArray[np.int64],
        blocks: NDArray[np.int64],
        threads: int,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> None:
        """Find the leaves of those blocks (n,) around regions (n,) that are not known yet.

        Where some of its regions are hardly left with fewer, all of them share what the block is left with."""
        new = np.array([number not in self._blocks for number in blocks.tolist()], np.bool_)
        order = np.argsort(blocks[new], kind="stable")
        numbers, first, count = np.unique(blocks[new][order], return_index=True, return_counts=True)
        some = np.stack([first, first + count // 2, first + count - 1], 1)
        examples = regions[new][order][some.reshape(-1)]
        root = [np.zeros(1, np.int32)] * len(numbers)
        of_blocks = self._descend(boxes_of(self.grid, examples[::3], COARSE), root, threads, counts, cancel)
        above = [leaves for leaves in of_blocks for _ in range(3)]
        left = self._descend(boxes_of(self.grid, examples), above, threads, counts, cancel)
        fewest = np.array([len(leaves) for leaves in left]).reshape(-1, 3).min(1)
        for number, leaves, least in zip(numbers.tolist(), of_blocks, fewest.tolist(), strict=True):
            shared = int(self._add([leaves])[0]) if least > HARDLY * len(leaves) else 0
            self._blocks[number] = Block(leaves, shared)

    def _descend(
        self,
        regions: NDArray[np.float64],
        above: list[NDArray[np.int32]],
        threads: int,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> list[NDArray[np.int32]]:
        """The leaves that each of regions (n, 6) is left with, of those below the nodes that are known to matter."""
        results: list[list[NDArray[np.int32]]] = [[] for _ in range(-(-len(regions) // CHUNK))]

        def work(chunk: int, worker: int) -> None:
            those = slice(chunk * CHUNK, (chunk + 1) * CHUNK)
            ends = np.cumsum([0, *(len(nodes) for nodes in above[those])])
            starts = np.stack([ends[:-1], ends[1:]], 1)
            known = self.tree, self.blockers, self.longest_sure, regions[those]
            ends, found = leaves_left(*known, starts, np.concatenate(above[those]), counts[worker])
            results[chunk] = np.split(found, ends[:-1])

        for_each_chunk(work, len(results), threads, cancel)
        return [leaves for chunk in results for leaves in chunk]

    def _add(self, leaves: list[NDArray[np.int32]]) -> NDArray[np.int64]:
        """Make lists of the lights of these leaves; what `Grid.certified` calls them."""
        tree, lists = self.tree, []
        for found in leaves:
            those = [tree.order[first:last] for first, last in tree.lights[found].tolist()]
            lists.append(np.sort(np.concatenate([np.empty(0, np.int32), *those])))
        if lists:
            self._starts.append(self._starts[-1][-1] + np.cumsum([len(lights) for lights in lists]))
            self._lights.append(np.concatenate(lists))
        self._lists += len(lists)
        return self._lists - len(lists) + 1 + np.arange(len(lists))

    def keep_within(self, most: float) -> None:
        """Forget all lists where they take more than `most` bytes."""
        if self.bytes > most:
            self._forget()

    def view(self) -> RegionView:
        """What kernels are given now."""
        self._starts, self._lights = [np.concatenate(self._starts)], [np.concatenate(self._lights)]
        return RegionView(self.grid, self._starts[0], self._lights[0], self._boxes, self._moved)

    def hidden_by(self, point: NDArray[np.float32], light: int) -> int:
        """The number of the triangle that hides a light from the region of a point (3,); -1 for none."""
        number = region_at(self.grid, point)
        if number < 0 or self._moved[light]:
            return -1
        region, lights = boxes_of(self.grid, np.array([number])), self._boxes[light : light + 1].astype(np.float64)
        blocker = hidden_from(self.blockers, self.longest_sure, region, lights)
        return int(self.blockers.numbers[blocker]) if blocker >= 0 else -1


def _bounds(triangles: NDArray[np.float32]) -> NDArray[np.float64]:
    """Lower and upper corner (2, 3) around triangles (t, 9), corner and two edges."""
    if not len(triangles):
        return np.zeros((2, 3))
    first = triangles[:, :3].astype(np.float64)
    every = np.concatenate([first, first + triangles[:, 3:6], first + triangles[:, 6:]])
    return np.stack([every.min(0), every.max(0)])


def _boxes(lamps: Lamps) -> NDArray[np.float32]:
    """Boxes (l, 6), lower and upper corner, around the samples of each of l > 0 lamps."""
    low, high = (around.reduceat(lamps.samples, lamps.first[:-1], axis=0) for around in (np.minimum, np.maximum))
    return np.concatenate([low, high], 1)

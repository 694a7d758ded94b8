"""The regions of a scene, cubes of which few are ever looked at, and the lights that each is left with, as far as rays
have ended there."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import OUTWARDS
from tracer.scene.lights import Lamps
from tracer.simd.records import I32, I64, Bytes, F32x2D
from tracer.visibility.budget import COUNTERS, STEPS, TESTS, Budget, Counts
from tracer.visibility.grid import SHIFT, Grid, boxes_of, cube_at, index_of
from tracer.visibility.hidden_lights import HiddenLights, LightLists, boxes_of_samples

if TYPE_CHECKING:
    from tracer.geometry.world import World

FINEST, MOST_REGIONS = 256, 1 << 24  # regions along the longest side, and in all, at most
ROOM = 1e-3  # of a region, by which each is taken to be larger: points are led to theirs in float32
COARSE = 8  # regions on a side of the blocks for which lights are left out first
BATCH, MOST = 64, 4096  # regions of a frame's first batch, and of any
HARDLY = 0.8  # of a block's leaves: a region that keeps more is not worth a list of its own


class RegionView(NamedTuple):
    """What kernels are given.

    Attributes:
        grid: the regions.
        certified: (regions,) int32, 1 more than the number of each region's list of lights; 0 while there is none.
        wanted: (regions,) bool, those in which rays have ended that had no list.
        starts, lights: (n + 1,) int64, where the lights of each list begin in the other, and (m,) int32.
        boxes: (l, 6) float32, around each light's samples.
        moved: (l,) bool, lights that count everywhere.
    """

    grid: Grid
    certified: I32
    wanted: Bytes
    starts: I64
    lights: I32
    boxes: F32x2D
    moved: Bytes


class Block(NamedTuple):
    """The leaves (n,) of the tree of lights that a block of regions is left with; and, where its regions share their
    lights, what `RegionView.certified` calls that list, else 0."""

    leaves: NDArray[np.int32]
    shared: int


class RegionStore:
    """What is known of a world's regions."""

    def __init__(self, world: World, lamps: Lamps, clock: Callable[[], float] = time.perf_counter) -> None:
        """For these lights."""
        self._clock = clock
        #: What hides lights.
        self.hidden = HiddenLights(world)
        self.update(lamps)

    def _forget(self) -> None:
        self.grid: Grid = make_grid(self.hidden.bounds)
        # Memory that nobody has touched is not taken.
        self.certified, self.wanted = np.zeros(self.grid.cubes, np.int32), np.zeros(self.grid.cubes, np.bool_)
        self._blocks: dict[int, Block] = {}
        self._lists = LightLists()

    @property
    def bytes(self) -> int:
        """Memory that lists take, in bytes."""
        return self._lists.bytes + sum(block.leaves.nbytes for block in self._blocks.values())

    def update(self, lamps: Lamps) -> None:
        """Lights are where these lamps have them now."""
        if self.hidden.update(boxes_of_samples(lamps)):
            self._forget()

    def certify(self, budget: Budget, threads: int, cancel: Callable[[], bool] | None = None) -> Counts:
        """Find the lights of the regions that are wanted, as far as the budget allows.

        Raises Cancelled if `cancel` turns true meanwhile; what has been found by then is kept."""
        until, counts = self._clock() + budget.seconds, np.zeros((threads, COUNTERS), np.int64)
        wanted, made, batch = np.flatnonzero(self.wanted), 0, BATCH
        while made < min(len(wanted), budget.certificates) and self._clock() < until:
            regions = wanted[made : made + int(min(batch, budget.certificates - made))]
            blocks = blocks_around(self.grid, regions, COARSE)
            self._certify_blocks(regions, blocks, threads, counts, cancel)
            known = [self._blocks[number] for number in blocks.tolist()]
            shared = np.array([block.shared for block in known])
            self.certified[regions[shared > 0]] = shared[shared > 0]
            alone = np.flatnonzero(shared == 0)
            above = [known[k].leaves for k in alone]
            leaves = self.hidden.descend(region_boxes(self.grid, regions[alone]), above, threads, counts, cancel)
            self.certified[regions[alone]] = self._lists.add([self.hidden.lights_below(found) for found in leaves])
            self.wanted[regions] = False
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
        of_blocks = self.hidden.descend(region_boxes(self.grid, examples[::3], COARSE), root, threads, counts, cancel)
        above = [leaves for leaves in of_blocks for _ in range(3)]
        left = self.hidden.descend(region_boxes(self.grid, examples), above, threads, counts, cancel)
        fewest = np.array([len(leaves) for leaves in left]).reshape(-1, 3).min(1)
        for number, leaves, least in zip(numbers.tolist(), of_blocks, fewest.tolist(), strict=True):
            shares = [self.hidden.lights_below(leaves)] if least > HARDLY * len(leaves) else []
            shared = int(self._lists.add(shares).sum())
            self._blocks[number] = Block(leaves, shared)

    def keep_within(self, most: float) -> None:
        """Forget all lists where they take more than `most` bytes."""
        if self.bytes > most:
            self._forget()

    def view(self) -> RegionView:
        """What kernels are given now."""
        lists = self._lists.arrays()
        return RegionView(self.grid, self.certified, self.wanted, *lists, self.hidden.boxes, self.hidden.moved)

    def describe(self, primitive: int, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]]:
        """Whether a triangle hides a light from the region of a point (3,): "full", and its number, or "none"."""
        number = cube_at(self.grid, point)
        if number >= 0 and not self.hidden.moved[light]:
            hider = self.hidden.hidden_by(region_boxes(self.grid, np.array([number]))[0], light)
            if hider >= 0:
                return "full", (hider,)
        return "none", ()


def make_grid(bounds: NDArray[np.float64]) -> Grid:
    """A grid around bounds (2, 3), lower and upper corner."""
    extent = np.maximum(bounds[1] - bounds[0], 1e-30)
    side = max(extent.max() / FINEST, (np.prod(np.maximum(extent, extent.max() / FINEST)) / MOST_REGIONS) ** (1 / 3))
    low = bounds[0] - SHIFT * side
    nx, ny, nz = (int(n) for n in np.floor((bounds[1] - low) / side) + 1)
    x, y, z = low.tolist()
    return Grid(x, y, z, 1.0 / side, nx, ny, nz)


def region_boxes(grid: Grid, numbers: NDArray[np.int64], times: int = 1) -> NDArray[np.float64]:
    """`boxes_of` regions (k,), or of blocks of them, with room for all points that are led to them."""
    boxes = boxes_of(grid, numbers, ROOM, times)
    return boxes + 1e-6 * np.abs(boxes).max(1, keepdims=True, initial=0.0) * OUTWARDS


def blocks_around(grid: Grid, numbers: NDArray[np.int64], times: int) -> NDArray[np.int64]:
    """A number (k,) for the block of so many regions on a side that each of regions (k,) lies in."""
    x, y, z = index_of(grid, numbers)
    return ((x // times) * grid.ny + y // times) * grid.nz + z // times

"""The lights that have no codes, lamps and those past the last one that has: which of them may shine into a cell at all
(`tracer.culling.regions`)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tracer.culling.environments.octree import OUTSIDE, boxes_of
from tracer.culling.environments.tree import CellTree, lengthened, room_for
from tracer.culling.regions import certify
from tracer.culling.regions.blockers import find_blockers
from tracer.culling.regions.certify import leaves_left
from tracer.culling.regions.light_tree import LightTree, build_light_tree
from tracer.culling.voxels.classify import CERTIFICATES, STEPS, TESTS
from tracer.runtime.parallel import for_each_chunk
from tracer.scene.lights import Lamps

CHUNK = 64  # cells that a thread takes at a time
SHARE = 8  # levels below the root down to which cells are divided for these lights
FEW_LIGHTS = 4  # of these: cells with no more are not divided for their sake
COARSE, HARDLY = 6, 0.8  # levels that are divided in any case; further ones where the last left this part of the lights
MOVED = 8  # the part, one in so many, of lights that may have moved before all is proved anew


class FurtherLights:
    """Lists of those of the lights with `numbers` (k,) that may shine into each cell of a tree: `lights` from `first`
    (cells,), -1 where nothing is known, to `last`; the first `used` numbers of `lights` are in use."""

    def __init__(self, numbers: NDArray[np.int64], triangles: NDArray[np.float32], longest_sure: float) -> None:
        self.numbers, self._longest_sure = numbers, longest_sure
        self._blockers = find_blockers(triangles) if len(numbers) else None
        self._tree: LightTree | None = None
        self._proved = np.empty((0, 6), np.float32)  # where the lights are of which anything is proved
        self.begin(0)

    def begin(self, cells: int) -> None:
        """Nothing is known of any cell; there is room for so many."""
        self.first, self.last = np.full(cells, -1, np.int32), np.full(cells, -1, np.int32)
        self._leaves: dict[int, NDArray[np.int32]] = {}
        self.lights, self.used = np.zeros(1024, np.int32), 0

    def grow(self, cells: int) -> None:
        """Let there be room for so many cells."""
        if cells > len(self.first):
            self.first, self.last = (lengthened(array, cells, -1) for array in (self.first, self.last))

    @property
    def bytes(self) -> int:
        """Memory that the lists take, in bytes."""
        return 4 * self.used + sum(leaves.nbytes for leaves in {id(a): a for a in self._leaves.values()}.values())

    def follow(self, lamps: Lamps, known: NDArray[np.bool_]) -> bool:
        """Lights are where these lamps have them now: say of which (lights,) anything is `known`.  One that has moved
        counts everywhere; where many have, all is to be proved anew, and this is true."""
        if not len(self.numbers):
            return False
        low, high = (a.reduceat(lamps.samples, lamps.first[:-1], axis=0) for a in (np.minimum, np.maximum))
        boxes = np.concatenate([low, high], 1)[self.numbers]
        anew = self._tree is None or MOVED * int((boxes != self._proved).any(1).sum()) > len(boxes)
        if anew:
            self._proved, self._tree = boxes, build_light_tree(boxes)
        known[self.numbers] = (boxes == self._proved).all(1)
        return anew

    def hides(self, cell: int, light: int) -> bool:
        """Whether one of these lights, which has not moved, is known to be hidden from a cell."""
        if cell <= OUTSIDE or self.first[cell] < 0:
            return False
        return light not in self.lights[self.first[cell] : self.last[cell]]

    def settle(
        self,
        tree: CellTree,
        cells: NDArray[np.int64],
        threads: int,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> NDArray[np.bool_]:
        """Find which of the lights may shine into cells (n,); which cells are worth dividing."""
        assert self._tree is not None and self._blockers is not None, "followed before"
        those = cells[self.first[cells] < 0]
        root = np.zeros(1, np.int32)
        above = [self._leaves.get(int(parent), root) for parent in tree.parent[those]]
        boxes = boxes_of(tree.frame, tree.cells[those])
        counted = np.zeros((threads, certify.COUNTERS), np.int64)
        results: list[list[NDArray[np.int32]]] = [[] for _ in range(-(-len(those) // CHUNK))]

        def work(chunk: int, worker: int) -> None:
            mine = slice(chunk * CHUNK, (chunk + 1) * CHUNK)
            ends = np.cumsum([0, *(len(leaves) for leaves in above[mine])])
            starts = np.stack([ends[:-1], ends[1:]], 1)
            known = self._tree, self._blockers, self._longest_sure, boxes[mine], starts, np.concatenate(above[mine])
            ends, found = leaves_left(*known, counted[worker])
            results[chunk] = np.split(found, ends[:-1])

        for_each_chunk(work, len(results), threads, cancel)
        counts[0, STEPS] += counted[:, certify.STEPS].sum()
        counts[0, TESTS] += counted[:, certify.TESTS].sum()
        counts[0, CERTIFICATES] += len(those)
        for cell, found in zip(those.tolist(), (leaves for chunk in results for leaves in chunk), strict=True):
            self._keep(cell, int(tree.parent[cell]), found)
        parents = tree.parent[cells]
        left, before = (self.last[of] - self.first[of] for of in (cells, parents))
        gains = (left < HARDLY * before) | (tree.cells[cells, 3] > tree.frame.levels - COARSE)
        return (left > FEW_LIGHTS) & gains & (tree.cells[cells, 3] > tree.frame.levels - SHARE)

    def _keep(self, cell: int, parent: int, found: NDArray[np.int32]) -> None:
        """Keep the lights in these leaves of the tree of lights as those of a cell."""
        assert self._tree is not None, "followed before"
        if parent in self._leaves and len(found) == len(self._leaves[parent]):  # they share all
            self.first[cell], self.last[cell] = self.first[parent], self.last[parent]
            self._leaves[cell] = self._leaves[parent]
            return
        spans = [self._tree.order[first:last] for first, last in self._tree.lights[found].tolist()]
        numbers = self.numbers[np.sort(np.concatenate([np.empty(0, np.int32), *spans]))].astype(np.int32)
        self.lights = room_for(self.lights, self.used + len(numbers))
        self.lights[self.used : self.used + len(numbers)] = numbers
        self.first[cell], self.used = self.used, self.used + len(numbers)
        self.last[cell], self._leaves[cell] = self.used, found

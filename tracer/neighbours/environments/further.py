"""The lights that have no codes, lamps and those past the last one that has: which of them may shine into a cell at all
(`tracer.visibility.hidden_lights`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.environments.octree import CellTree, boxes_of
from tracer.scene.lights import Lamps
from tracer.visibility.budget import CERTIFICATES
from tracer.visibility.hidden_lights import HiddenLights, LightLists, boxes_of_samples

if TYPE_CHECKING:
    from tracer.geometry.world import World

SHARE = 8  # levels below the root down to which cells are divided for these lights
FEW_LIGHTS = 4  # of these: cells with no more are not divided for their sake
COARSE, HARDLY = 6, 0.8  # levels that are divided in any case; further ones where the last left this part of the lights


class FurtherLights:
    """Lists of those of the lights with `numbers` (k,) that may shine into each cell of a tree: `of` (cells,) int32 are
    their numbers in `lists`, 0 where nothing is known."""

    def __init__(self, numbers: NDArray[np.int64], world: World) -> None:
        self.numbers = numbers
        self._hidden = HiddenLights(world) if len(numbers) else None
        self.begin(0)

    def begin(self, cells: int) -> None:
        """Nothing is known of any cell; there is room for so many."""
        self.of, self.lists = np.zeros(cells, np.int32), LightLists()
        self._leaves: dict[int, NDArray[np.int32]] = {}

    @property
    def bytes(self) -> int:
        """Memory that the lists take, in bytes."""
        leaves = {id(a): a.nbytes for a in self._leaves.values()}
        return self.lists.arrays()[1].nbytes + sum(leaves.values())

    def update(self, lamps: Lamps, known: NDArray[np.bool_]) -> bool:
        """Lights are where these lamps have them now: say of which (lights,) anything is `known`.  One that has moved
        counts everywhere; where many have, all is to be proved anew, and this is true."""
        if self._hidden is None:
            return False
        anew = self._hidden.update(boxes_of_samples(lamps)[self.numbers])
        known[self.numbers] = ~self._hidden.moved
        return anew

    def hides(self, cells: NDArray[np.int64], light: int) -> NDArray[np.bool_]:
        """From which cells (n,) one of these lights, which has not moved, is known to be hidden."""
        starts, lights = self.lists.arrays()
        hidden = np.ones(len(starts), np.bool_)
        hidden[0] = False
        hidden[np.searchsorted(starts, np.flatnonzero(lights == light), side="right")] = False
        return hidden[self.of[cells]]

    def counted(self, cells: NDArray[np.int64], which: NDArray[np.bool_]) -> NDArray[np.int64]:
        """How many of the lights `which` (lights,) are in the lists of cells (n,): none where nothing is known."""
        starts, lights = self.lists.arrays()
        before, of = np.concatenate([[0], np.cumsum(which[lights])])[starts], self.of[cells]
        return before[of] - before[np.maximum(of - 1, 0)]

    def settle(
        self,
        tree: CellTree,
        cells: NDArray[np.int64],
        threads: int,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> NDArray[np.bool_]:
        """Find which of the lights may shine into cells (n,); which cells are worth dividing."""
        assert self._hidden is not None, "some lights have no codes"
        those = cells[self.of[cells] == 0]
        root, new = np.zeros(1, np.int32), []
        above = [self._leaves.get(int(parent), root) for parent in tree.parent[those]]
        left_with = self._hidden.descend(boxes_of(tree.grid, tree.cells[those]), above, threads, counts, cancel)
        counts[0, CERTIFICATES] += len(those)
        for cell, found in zip(those.tolist(), left_with, strict=True):
            around = self._leaves.get(int(tree.parent[cell]))
            if around is not None and len(found) == len(around):  # they share all
                self.of[cell], self._leaves[cell] = self.of[tree.parent[cell]], around
            else:
                self._leaves[cell] = found
                new.append(cell)
        below = (self._hidden.lights_below(self._leaves[cell]) for cell in new)
        self.of[new] = self.lists.add([self.numbers[lights].astype(np.int32) for lights in below])
        sizes = np.diff(self.lists.arrays()[0], prepend=0)
        left, before = sizes[self.of[cells]], sizes[self.of[tree.parent[cells]]]
        gains = (left < HARDLY * before) | (tree.cells[cells, 3] > tree.levels - COARSE)
        return (left > FEW_LIGHTS) & gains & (tree.cells[cells, 3] > tree.levels - SHARE)

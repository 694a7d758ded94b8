"""The lights that have no codes, lamps and those past the last one that has: which of them may shine into a cell at all
(`tracer.visibility.hidden_lights`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.environments.octree import OUTSIDE, boxes_of
from tracer.neighbours.environments.tree import CellTree, lengthened, room_for
from tracer.scene.lights import Lamps
from tracer.visibility.budget import CERTIFICATES
from tracer.visibility.hidden_lights import HiddenLights, boxes_of_samples

if TYPE_CHECKING:
    from tracer.geometry.world import World

SHARE = 8  # levels below the root down to which cells are divided for these lights
FEW_LIGHTS = 4  # of these: cells with no more are not divided for their sake
COARSE, HARDLY = 6, 0.8  # levels that are divided in any case; further ones where the last left this part of the lights


class FurtherLights:
    """Lists of those of the lights with `numbers` (k,) that may shine into each cell of a tree: `lights` from `first`
    (cells,), -1 where nothing is known, to `last`; the first `used` numbers of `lights` are in use."""

    def __init__(self, numbers: NDArray[np.int64], world: World) -> None:
        self.numbers = numbers
        self._hidden = HiddenLights(world) if len(numbers) else None
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

    def update(self, lamps: Lamps, known: NDArray[np.bool_]) -> bool:
        """Lights are where these lamps have them now: say of which (lights,) anything is `known`.  One that has moved
        counts everywhere; where many have, all is to be proved anew, and this is true."""
        if self._hidden is None:
            return False
        anew = self._hidden.update(boxes_of_samples(lamps)[self.numbers])
        known[self.numbers] = ~self._hidden.moved
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
        assert self._hidden is not None, "some lights have no codes"
        those = cells[self.first[cells] < 0]
        root = np.zeros(1, np.int32)
        above = [self._leaves.get(int(parent), root) for parent in tree.parent[those]]
        left_with = self._hidden.descend(boxes_of(tree.frame, tree.cells[those]), above, threads, counts, cancel)
        counts[0, CERTIFICATES] += len(those)
        for cell, found in zip(those.tolist(), left_with, strict=True):
            self._keep(cell, int(tree.parent[cell]), found)
        parents = tree.parent[cells]
        left, before = (self.last[of] - self.first[of] for of in (cells, parents))
        gains = (left < HARDLY * before) | (tree.cells[cells, 3] > tree.frame.levels - COARSE)
        return (left > FEW_LIGHTS) & gains & (tree.cells[cells, 3] > tree.frame.levels - SHARE)

    def _keep(self, cell: int, parent: int, found: NDArray[np.int32]) -> None:
        """Keep the lights in these leaves of the tree of lights as those of a cell."""
        assert self._hidden is not None, "some lights have no codes"
        if parent in self._leaves and len(found) == len(self._leaves[parent]):  # they share all
            self.first[cell], self.last[cell] = self.first[parent], self.last[parent]
            self._leaves[cell] = self._leaves[parent]
            return
        numbers = self.numbers[self._hidden.lights_below(found)].astype(np.int32)
        self.lights = room_for(self.lights, self.used + len(numbers))
        self.lights[self.used : self.used + len(numbers)] = numbers
        self.first[cell], self.used = self.used, self.used + len(numbers)
        self.last[cell], self._leaves[cell] = self.used, found

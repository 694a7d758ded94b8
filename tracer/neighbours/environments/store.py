"""The cells of a scene, and what is known of them for its lights, as far as rays have ended there.

What is proved rests on geometry that never moves and on where a light stands: a light that has moved is looked into
anew.  Of the first point lights each cell knows the blockers, as far as there is memory; of all others, and of lamps,
which of them may shine into it at all (`tracer.neighbours.regions`).  Objects that rest are not looked into; a ray that
passes by their boxes has the answer that it has without them.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULL_SHADOW, FULLY_RENDERED, MAX_CULLED_LIGHTS, NON_SHADOW, word_type
from tracer.culling.rest import Resting, boxes_at_rest
from tracer.neighbours.environments.further import FurtherLights
from tracer.neighbours.environments.octree import (
    HIDDEN,
    LIT,
    OUTSIDE,
    ROOM,
    UNKNOWN,
    CellTree,
    EnvironmentView,
    boxes_of,
    lengthened,
    room_for,
)
from tracer.neighbours.environments.settle import settle
from tracer.runtime.parallel import for_each_chunk
from tracer.scene.lights import Lamps
from tracer.visibility.box_candidates import MOST, Light, light_to
from tracer.visibility.budget import COUNTERS, Counts
from tracer.visibility.error_bounds import LANES
from tracer.visibility.grid import DIGITS
from tracer.visibility.static_geometry import StaticGeometry

if TYPE_CHECKING:
    from tracer.geometry.world import World

BLOCKERS = 8  # of a light, at most, or a cell is divided
CHUNK, BATCH = 64, 4096  # cells that a thread takes at a time, and that are settled before the clock is looked at
CANDIDATES = 3  # in a word, instead of a shadow mode
FILLED = 0.7  # of the memory for cells: from there on none is divided
EACH = 80  # bytes of a light and primitive, about

# What finds the codes of cells for a light: (cells, light, codes of the cells around them) -> (codes, found (n, MOST)),
# as `settle` does.
Settle = Callable[[NDArray[np.int64], Light, NDArray[np.int32]], tuple[NDArray[np.int32], NDArray[np.int32]]]
By = Callable[["EnvironmentStore", NDArray[np.int64]], Settle]


class EnvironmentStore:
    """Cells, in no more than about `memory` bytes."""

    def __init__(
        self,
        world: World,
        lamps: Lamps,
        threads: int,
        memory: float,
        by_ray: bool,
        clock: Callable[[], float] = time.perf_counter,
        coarse: int = 0,
    ) -> None:
        """Cells are divided `coarse` times at most; 0 for as often as is worth it."""
        self._clock, self._memory, self._by_ray, self._threads = clock, memory, by_ray, threads
        single, count = np.diff(lamps.first) == 1, len(lamps.places)
        primitives = len(world.object_of)
        last = int(np.max(np.flatnonzero(single[:MAX_CULLED_LIGHTS]), initial=-1)) + 1  # lamps have no codes
        held = min(last, int(memory / 2) // max(1, EACH * primitives))
        self._wants = last
        #: How many lights, the first ones, have codes.
        self.held = held if len(world.triangles_of(0).rows) else 0
        self.geometry = StaticGeometry(world, self.held, threads, True)
        #: The cells.
        self.tree = CellTree(self.geometry.bounds)
        # The lights that are not held, or are lamps.
        further = np.arange(count) >= self.held
        further[: self.held] |= ~single[: self.held]
        #: What is known of the others.
        self.further = FurtherLights(np.flatnonzero(further), world)
        #: The level of the smallest cells, as the tree counts them.
        self.finest = max(0, self.tree.levels - coarse) if coarse else 0
        self.places = np.full((count, 3), np.nan, np.float32)  # for which anything is known
        self._resting = np.empty((0, 6), np.float32)
        self._known = np.zeros(count, np.bool_)
        self._usable = np.zeros(count, np.bool_)
        self._begin_cells()

    def _begin_cells(self) -> None:
        """Begin with a root, of which nothing is known, and the cell of what is outside."""
        self.tree.begin()
        self.further.begin(self.tree.room)
        self.codes = np.full((self.tree.room, self.held), UNKNOWN, np.int32)
        self.names, self._named = np.zeros(1024, np.int32), 1
        self._anew = True  # whether lights have moved, or all is new

    @property
    def bytes(self) -> int:
        """Memory that all of this takes, in bytes."""
        return self.geometry.bytes + self._cell_bytes

    @property
    def _cell_bytes(self) -> int:
        codes = 4 * self.held * self.tree.count
        return self.tree.bytes + codes + 4 * self._named + self.further.bytes

    # Following what moves.

    def update(self, lamps: Lamps, resting: Resting) -> None:
        """Lights are where these lamps have them now, and this rests.

        All cells are forgotten where they take more than half of the memory."""
        if self._cell_bytes > self._memory / 2:
            self._begin_cells()
        far = DIGITS * np.abs(lamps.places).max(1, initial=0.0) * self.tree.grid.per_unit > ROOM / 4
        moved = (lamps.places != self.places).any(1)
        held = moved[: self.held].copy()
        held[np.setdiff1d(self.further.numbers, np.arange(self.held, len(far)))] = False
        self._resting = boxes_at_rest(resting, self.geometry.largest)
        self._known = np.ones(len(moved), np.bool_)
        if held.any():
            numbers = np.flatnonzero(held)
            self.places[numbers] = lamps.places[numbers]
            self._usable[numbers] = ~far[numbers]
            self._forget(numbers)
            self.geometry.update_points(numbers.tolist(), lamps.places, self.tree.grid.around)
        if self.further.update(lamps, self._known):
            self._begin_cells()

    def _forget(self, lights: NDArray[np.int64]) -> None:
        """Nothing is known of these held lights any more."""
        self.codes[:, lights] = UNKNOWN
        self.tree.leaves_open(int(sum(1 << int(light) for light in lights)))
        self._anew = True

    def light(self, number: int) -> Light:
        """A held light as `settle` knows it."""
        return light_to(number, number, self.places[number].copy(), self.tree.grid.around, self.geometry.largest)

    # Settling cells.

    @property
    def waits(self) -> bool:
        """Whether it is worth looking for cells to settle: rays of the last frame have ended in some, or all is new."""
        return self._anew or len(self._wanted()) > 0

    def _wanted(self) -> NDArray[np.int64]:
        """The cells (n,) to settle next."""
        tree = self.tree
        return np.flatnonzero(tree.wanted[: tree.count] & tree.open[: tree.count])

    def work(
        self, want: Callable[[], None], seconds: float, cancel: Callable[[], bool] | None = None, by: By | None = None
    ) -> Counts:
        """Settle the cells that are wanted, and those within them that `want` wants then, until the time is up.

        `by` gives, for cells, what finds their codes, instead of proofs.  Raises Cancelled if `cancel` turns true."""
        until, counts = self._clock() + seconds, np.zeros((self._threads, COUNTERS), np.int64)
        self._anew = False
        while self._clock() < until:
            want()
            wanted = self._wanted()
            if not len(wanted):
                break
            self.tree.wanted[: self.tree.count] = False
            for first in range(0, len(wanted), BATCH):
                cells = wanted[first : first + BATCH]
                method = self._prove(counts, cancel) if by is None else by(self, cells)
                self._settle(cells, method, counts, cancel)
                if self._clock() >= until:
                    break
        return Counts(*counts.sum(0).tolist())

    def _prove(self, counts: NDArray[np.int64], cancel: Callable[[], bool] | None) -> Settle:
        def proved(
            cells: NDArray[np.int64], light: Light, above: NDArray[np.int32]
        ) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
            codes, found = np.empty(len(cells), np.int32), np.zeros((len(cells), MOST), np.int32)
            boxes = boxes_of(self.tree.grid, self.tree.cells[cells])

            def work(chunk: int, worker: int) -> None:
                those = slice(chunk * CHUNK, (chunk + 1) * CHUNK)
                given = boxes[those], above[those], self.names, codes[those], found[those]
                settle(self.geometry.occluders, light, *given, counts[worker])

            for_each_chunk(work, -(-len(cells) // CHUNK), self._threads, cancel)
            return codes, found

        return proved

    def _settle(
        self, cells: NDArray[np.int64], method: Settle, counts: NDArray[np.int64], cancel: Callable[[], bool] | None
    ) -> None:
        """Settle cells (n,), and divide those that are worth it."""
        tree, worth = self.tree, np.zeros(len(cells), np.bool_)
        for number in range(self.held):
            if not self._usable[number]:
                continue
            which = np.flatnonzero(tree.todo[cells] >> number & 1)
            those = cells[which]
            if len(those):
                codes, found = method(those, self.light(number), self.codes[tree.parent[those], number])
                self.codes[those, number] = self._keep(codes, found)
                tree.todo[those] &= ~(1 << number)
            mine = self.codes[cells, number]
            worth |= (mine == UNKNOWN) | ((mine > LIT) & (self.names[np.maximum(mine, 0)] > BLOCKERS))
        if len(self.further.numbers):
            worth |= self.further.settle(tree, cells, self._threads, counts, cancel)
        tree.open[cells] = False
        if self._cell_bytes < FILLED * self._memory / 2:
            tree.divide(cells[worth & (tree.cells[cells, 3] > self.finest)])
            if tree.room > len(self.codes):
                self.codes = lengthened(self.codes, tree.room, UNKNOWN)
                self.further.of = lengthened(self.further.of, tree.room, 0)

    def _keep(self, codes: NDArray[np.int32], found: NDArray[np.int32]) -> NDArray[np.int32]:
        """Add lists of blockers to the names; codes (n,) are how many of found (n, MOST) each has, then where its list
        begins."""
        some = np.flatnonzero(codes > LIT)
        sizes = codes[some].astype(np.int64) + 1
        starts = self._named + np.concatenate([[0], np.cumsum(sizes)])
        self.names = room_for(self.names, int(starts[-1]) + LANES)
        lists = np.concatenate([codes[some, None], found[some]], 1)
        self.names[self._named : starts[-1]] = lists[np.arange(MOST + 1) < sizes[:, None]]
        self._named = int(starts[-1])
        kept = codes.copy()
        kept[some] = starts[:-1]
        return kept

    # What is known.

    def view(self, looks: NDArray[np.int64], cell: NDArray[np.int32]) -> EnvironmentView:
        """What kernels are given now; `looks` has rows where lights are to be selected, and cell (pixels,) int32 gets
        the cells of primary hits, if it is not empty."""
        tree, further, space = self.tree, self.further, self.geometry.occluders.light_space
        return EnvironmentView(
            tree.grid, tree.levels, tree.child, tree.open, tree.wanted, self.codes.reshape(-1), self.held, self.names,
            further.of, *further.lists.arrays(), space, self._known.copy(), self._resting, self._by_ray, looks, cell,
        )  # fmt: skip

    def at_pixels(self, cell: NDArray[np.int32]) -> NDArray[np.unsignedinteger]:
        """What is known of cells, of any shape, as words like those of `tracer.neighbours.certified.cells`."""
        word, every = word_type(len(self.places)), np.arange(self.tree.count)
        words = np.full(len(every), FULLY_RENDERED, word)
        for light in range(min(len(self.places), MAX_CULLED_LIGHTS)):
            if light in self.further.numbers:
                state = np.where(self.further.hides(every, light) & self._known[light], FULL_SHADOW, 0)
            elif light < self.held:
                code = self.codes[every, light]
                state = np.select([code == HIDDEN, code == LIT, code > LIT], [FULL_SHADOW, NON_SHADOW, CANDIDATES], 0)
            else:
                continue
            words |= state.astype(word) << word(2 + 2 * light)
        words[OUTSIDE] = 0
        return words[np.maximum(cell, OUTSIDE)]

    def asked_in(self, cells: NDArray[np.int32]) -> NDArray[np.int32]:
        """How many lights points in cells, of any shape, must look at: those that are not known to be hidden from all
        of the cell; -1 for points in none."""
        one, which = np.unique(np.maximum(cells, OUTSIDE), return_inverse=True)
        known, held = self._known, self.held
        asked = ((self.codes[one] != HIDDEN) | ~known[:held]).sum(1)
        if len(known) > held:
            # Lights that are held are counted, and so are all that have moved.
            left = self.further.counted(one, known & (np.arange(len(known)) >= held)) + int((~known[held:]).sum())
            asked += np.where(self.further.of[one] == 0, len(known) - held, left)
        asked[one == OUTSIDE] = len(known)
        found = asked.astype(np.int32)[which].reshape(cells.shape)
        return np.where(cells < 0, np.int32(-1), found)

    @property
    def told(self) -> str:
        """What there is no memory for, in a sentence, or nothing."""
        lacking = self._wants - self.held
        if lacking <= 0 or not len(self.geometry.rows):
            return ""
        return (
            f"There is memory for the blockers of {self.held} lights; of {lacking} more only what hides them is known."
        )

    def describe(self, primitive: int, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]]:
        """What is known of a light in the cell of a point (3,), and its blockers there: "full", "lit", "candidates" or
        "none", the words that certificates have."""
        cell = self.tree.leaf_at(point)
        if light in self.further.numbers:
            return ("full" if self._known[light] and self.further.hides(np.array([cell]), light)[0] else "none"), ()
        code = int(self.codes[cell, light]) if light < self.held else UNKNOWN
        if code > LIT:
            return "candidates", tuple(self.names[code + 1 : code + 1 + self.names[code]].tolist())
        return {LIT: "lit", HIDDEN: "full", UNKNOWN: "none"}[code], ()

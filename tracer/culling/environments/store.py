"""The cells of a scene, and what is known of them for its lights, as far as rays have ended there.

What is proved rests on geometry that never moves and on where a light stands: a light that has moved is looked into
anew.  Of the first point lights each cell knows the blockers, as far as there is memory; of all others, and of lamps,
which of them may shine into it at all (`tracer.culling.regions`).  Objects that rest are not looked into; a ray that
passes by their boxes has the answer that it has without them.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.error_bounds import LANES, LONGEST
from tracer.culling.certified.scheduler import Counts
from tracer.culling.certified.static_geometry import StaticGeometry
from tracer.culling.environments.octree import (
    HIDDEN,
    LIT,
    OUTSIDE,
    ROOT,
    UNKNOWN,
    EnvironmentView,
    boxes_of,
    make_frame,
)
from tracer.culling.environments.settle import settle
from tracer.culling.modes import FULL_SHADOW, FULLY_RENDERED, MAX_CULLED_LIGHTS, NON_SHADOW, word_type
from tracer.culling.regions import certify
from tracer.culling.regions.blockers import find_blockers
from tracer.culling.regions.certify import leaves_left
from tracer.culling.regions.light_tree import LightTree, build_light_tree
from tracer.culling.rest import Resting
from tracer.culling.voxels.classify import CERTIFICATES, COUNTERS, MOST, STEPS, TESTS, Light
from tracer.culling.voxels.grid import DIGITS, ROOM
from tracer.culling.voxels.store import NEVER_HIT, boxes_at_rest, without_area
from tracer.parallel import for_each_chunk
from tracer.scene.lamps import Lamps

if TYPE_CHECKING:
    from tracer.geometry.world import World

BLOCKERS = 8  # of a light, at most, or a cell is divided
CHUNK, BATCH = 64, 4096  # cells that a thread takes at a time, and that are settled before the clock is looked at
SHARE = 8  # levels below the root down to which cells are divided for the lights that are not held
FEW_LIGHTS = 4  # of these: cells with no more are not divided for their sake
COARSE, HARDLY = 6, 0.8  # levels that are divided in any case; further ones where the last left this part of the lights
CANDIDATES = 3  # in a word, instead of a shadow mode
FILLED = 0.7  # of the memory for cells: from there on none is divided
MOVED = 8  # the part, one in so many, of lights that may have moved before all is proved anew
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
        self.frame = make_frame(self.geometry.bounds)
        self._flat = without_area(self.geometry)
        # The lights that are not held, or are lamps.
        further = np.arange(count) >= self.held
        further[: self.held] |= ~single[: self.held]
        self.further = np.flatnonzero(further)
        triangles = world.triangles_of(0).rows
        #: The level of the smallest cells, in what `frame` counts in.
        self.finest = max(0, self.frame.levels - coarse) if coarse else 0
        self._blockers = find_blockers(triangles) if len(self.further) else None
        self._longest_sure = world.hit_padding / LONGEST * float(np.abs(self.geometry.bounds).max())
        self.places = np.full((count, 3), np.nan, np.float32)  # for which anything is known
        self._resting = np.empty((0, 6), np.float32)
        self._tree: LightTree | None = None
        self._proved = np.empty((0, 6), np.float32)  # where the further lights are of which anything is proved
        self._known = np.zeros(count, np.bool_)
        self._usable = np.zeros(count, np.bool_)
        self._begin_cells()

    def _begin_cells(self) -> None:
        """Begin with a root, and the cell of what is outside."""
        n, self.count = 1024, 2
        self.child, self.open, self.wanted = np.zeros(n, np.int32), np.zeros(n, np.bool_), np.zeros(n, np.bool_)
        self.cells = np.zeros((n, 4), np.int32)  # where they begin, in the smallest cells, and their level
        self.parent = np.zeros(n, np.int32)
        self._todo = np.zeros(n, np.int64)  # bits of the held lights that are to be settled
        self.codes = np.full((n, self.held), UNKNOWN, np.int32)
        self.first, self.last = np.full(n, -1, np.int32), np.full(n, -1, np.int32)
        self._leaves: dict[int, NDArray[np.int32]] = {}
        self.names, self._named = np.zeros(1024, np.int32), 1
        self.lights, self._lit = np.zeros(1024, np.int32), 0
        self.cells[ROOT, 3] = self.frame.levels
        self.open[ROOT], self._todo[ROOT] = True, -1
        self._anew = True  # whether lights have moved, or all is new

    @property
    def bytes(self) -> int:
        """Memory that all of this takes, in bytes."""
        o = self.geometry.occluders
        fixed = (self.geometry.rows, o.boxes, o.blocks, o.error_radii, o.leaf_radii, o.light_space)
        return sum(a.nbytes for a in fixed) + self._cell_bytes

    @property
    def _cell_bytes(self) -> int:
        each = 4 * (self.held + 9) + 10
        leaves = sum(leaves.nbytes for leaves in {id(leaves): leaves for leaves in self._leaves.values()}.values())
        return self.count * each + 4 * (self._named + self._lit) + leaves

    def keep_within(self) -> None:
        """Forget all cells where they take more than half of the memory."""
        if self._cell_bytes > self._memory / 2:
            self._begin_cells()

    # Following what moves.

    def follow(self, lamps: Lamps, resting: Resting) -> None:
        """Lights are where these lamps have them now, and this rests."""
        far = DIGITS * np.abs(lamps.places).max(1, initial=0.0) * self.frame.per_unit > ROOM / 4
        moved = (lamps.places != self.places).any(1)
        held = moved[: self.held].copy()
        held[np.setdiff1d(self.further, np.arange(self.held, len(far)))] = False
        self._resting = boxes_at_rest(resting, self.geometry.largest)
        self._known = np.ones(len(moved), np.bool_)
        if held.any():
            numbers = np.flatnonzero(held)
            self.places[numbers] = lamps.places[numbers]
            self._usable[numbers] = ~far[numbers]
            self._forget(numbers)
            self.geometry.update_lights(
                numbers.tolist(), lamps.places, np.zeros(len(lamps.places), np.float32), self._beyond()
            )
            for light in numbers:
                self.geometry.occluders.light_space[light][self._flat] = NEVER_HIT
        if len(self.further):
            self._follow_further(lamps)

    def _follow_further(self, lamps: Lamps) -> None:
        """A light that is not held and has moved counts everywhere; where many have, all is proved anew."""
        low, high = (a.reduceat(lamps.samples, lamps.first[:-1], axis=0) for a in (np.minimum, np.maximum))
        boxes = np.concatenate([low, high], 1)[self.further]
        if self._tree is None or MOVED * int((boxes != self._proved).any(1).sum()) > len(boxes):
            self._proved = boxes
            self._tree = build_light_tree(boxes)
            self._begin_cells()
        self._known[self.further] = (boxes == self._proved).all(1)

    def _forget(self, lights: NDArray[np.int64]) -> None:
        """Nothing is known of these held lights any more."""
        self.codes[:, lights] = UNKNOWN
        self._todo[: self.count] |= int(sum(1 << int(light) for light in lights))
        self.open[: self.count] |= self.child[: self.count] == 0
        self.open[OUTSIDE] = False
        self._anew = True

    def _beyond(self) -> float:
        """How far the octree reaches beyond what is static, at most."""
        low = np.array([self.frame.x, self.frame.y, self.frame.z])
        high = low + 2.0**self.frame.levels * self.frame.side
        return float(np.linalg.norm(np.maximum(self.geometry.bounds[0] - low, high - self.geometry.bounds[1])))

    def light(self, number: int) -> Light:
        """A held light as `settle` knows it."""
        place = self.places[number].copy()
        low = np.array([self.frame.x, self.frame.y, self.frame.z])
        high = low + 2.0**self.frame.levels * self.frame.side
        longest = float(np.linalg.norm(np.maximum(np.abs(place - low), np.abs(place - high)))) * 1.001
        return Light(number, number, place, longest)

    # Settling cells.

    @property
    def waits(self) -> bool:
        """Whether it is worth looking for cells to settle: rays of the last frame have ended in some, or all is new."""
        return self._anew or bool((self.wanted[: self.count] & self.open[: self.count]).any())

    def work(
        self,
        want: Callable[[], None],
        seconds: float,
        cancel: Callable[[], bool] | None = None,
        by: By | None = None,
    ) -> Counts:
        """Settle the cells that are wanted, and those within them that `want` wants then, until the time is up.

        `by` gives, for cells, what finds their codes, instead of proofs.  Raises Cancelled if `cancel` turns true."""
        until, counts = self._clock() + seconds, np.zeros((self._threads, COUNTERS), np.int64)
        self._anew = False
        while self._clock() < until:
            want()
            wanted = np.flatnonzero(self.wanted[: self.count] & self.open[: self.count])
            if not len(wanted):
                break
            self.wanted[: self.count] = False
            for first in range(0, len(wanted), BATCH):
                cells = wanted[first : first + BATCH]
                method = self._prove(counts, cancel) if by is None else by(self, cells)
                self._settle(cells, method, counts, cancel)
                if self._clock() >= until:
                    break
        steps, tests, made = (int(counts[:, k].sum()) for k in (STEPS, TESTS, CERTIFICATES))
        return Counts(steps, tests, made)

    def _prove(self, counts: NDArray[np.int64], cancel: Callable[[], bool] | None) -> Settle:
        def proved(
            cells: NDArray[np.int64], light: Light, above: NDArray[np.int32]
        ) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
            codes, found = np.empty(len(cells), np.int32), np.zeros((len(cells), MOST), np.int32)
            boxes = boxes_of(self.frame, self.cells[cells])
            rounded = 2e-6 * max(self.geometry.largest, float(np.abs(light.place).max()))

            def work(chunk: int, worker: int) -> None:
                those = slice(chunk * CHUNK, (chunk + 1) * CHUNK)
                given = boxes[those], above[those], self.names, rounded, codes[those], found[those]
                settle(self.geometry.occluders, light, *given, counts[worker])

            for_each_chunk(work, -(-len(cells) // CHUNK), self._threads, cancel)
            return codes, found

        return proved

    def _settle(
        self,
        cells: NDArray[np.int64],
        method: Settle,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> None:
        """Settle cells (n,), and divide those that are worth it."""
        worth = np.zeros(len(cells), np.bool_)
        for number in range(self.held):
            if not self._usable[number]:
                continue
            which = np.flatnonzero(self._todo[cells] >> number & 1)
            those = cells[which]
            if len(those):
                codes, found = method(those, self.light(number), self.codes[self.parent[those], number])
                self.codes[those, number] = self._keep(codes, found)
                self._todo[those] &= ~(1 << number)
            mine = self.codes[cells, number]
            worth |= (mine == UNKNOWN) | ((mine > LIT) & (self.names[np.maximum(mine, 0)] > BLOCKERS))
        if len(self.further):
            worth |= self._settle_further(cells, counts, cancel)
        self.open[cells] = False
        if self._cell_bytes < FILLED * self._memory / 2:
            self._divide(cells[worth & (self.cells[cells, 3] > self.finest)])

    def _keep(self, codes: NDArray[np.int32], found: NDArray[np.int32]) -> NDArray[np.int32]:
        """Add lists of blockers to the names; codes (n,) are how many of found (n, MOST) each has, then where its list
        begins."""
        some = np.flatnonzero(codes > LIT)
        sizes = codes[some].astype(np.int64) + 1
        starts = self._named + np.concatenate([[0], np.cumsum(sizes)])
        self.names = _room_for(self.names, int(starts[-1]) + LANES)
        lists = np.concatenate([codes[some, None], found[some]], 1)
        self.names[self._named : starts[-1]] = lists[np.arange(MOST + 1) < sizes[:, None]]
        self._named = int(starts[-1])
        kept = codes.copy()
        kept[some] = starts[:-1]
        return kept

    def _settle_further(
        self, cells: NDArray[np.int64], counts: NDArray[np.int64], cancel: Callable[[], bool] | None
    ) -> NDArray[np.bool_]:
        """Find which of the lights that are not held may shine into cells (n,); which cells are worth dividing."""
        assert self._tree is not None and self._blockers is not None
        new = np.flatnonzero(self.first[cells] < 0)
        those = cells[new]
        root = np.zeros(1, np.int32)
        above = [self._leaves.get(int(parent), root) for parent in self.parent[those]]
        boxes = boxes_of(self.frame, self.cells[those])
        counted = np.zeros((self._threads, certify.COUNTERS), np.int64)
        results: list[list[NDArray[np.int32]]] = [[] for _ in range(-(-len(those) // CHUNK))]

        def work(chunk: int, worker: int) -> None:
            mine = slice(chunk * CHUNK, (chunk + 1) * CHUNK)
            ends = np.cumsum([0, *(len(leaves) for leaves in above[mine])])
            starts = np.stack([ends[:-1], ends[1:]], 1)
            known = self._tree, self._blockers, self._longest_sure, boxes[mine], starts, np.concatenate(above[mine])
            ends, found = leaves_left(*known, counted[worker])
            results[chunk] = np.split(found, ends[:-1])

        for_each_chunk(work, len(results), self._threads, cancel)
        counts[0, STEPS] += counted[:, certify.STEPS].sum()
        counts[0, TESTS] += counted[:, certify.TESTS].sum()
        counts[0, CERTIFICATES] += len(those)
        for cell, found in zip(those.tolist(), (leaves for chunk in results for leaves in chunk), strict=True):
            parent = int(self.parent[cell])
            if parent in self._leaves and len(found) == len(self._leaves[parent]):  # they share all
                self.first[cell], self.last[cell] = self.first[parent], self.last[parent]
                self._leaves[cell] = self._leaves[parent]
                continue
            spans = [self._tree.order[first:last] for first, last in self._tree.lights[found].tolist()]
            numbers = self.further[np.sort(np.concatenate([np.empty(0, np.int32), *spans]))].astype(np.int32)
            self.lights = _room_for(self.lights, self._lit + len(numbers))
            self.lights[self._lit : self._lit + len(numbers)] = numbers
            self.first[cell], self._lit = self._lit, self._lit + len(numbers)
            self.last[cell], self._leaves[cell] = self._lit, found
        parents = self.parent[cells]
        left, before = (self.last[of] - self.first[of] for of in (cells, parents))
        gains = (left < HARDLY * before) | (self.cells[cells, 3] > self.frame.levels - COARSE)
        return (left > FEW_LIGHTS) & gains & (self.cells[cells, 3] > self.frame.levels - SHARE)

    def _divide(self, cells: NDArray[np.int64]) -> None:
        """Divide leaves (n,) into eight children each, of which nothing is known yet."""
        first = self.count + 8 * np.arange(len(cells))
        self._grow(self.count + 8 * len(cells))
        self.child[cells] = first
        children = (first[:, None] + np.arange(8)).reshape(-1)
        level = np.repeat(self.cells[cells, 3] - 1, 8)
        octant = np.tile(np.arange(8), len(cells))
        bits = np.stack([octant >> 2, octant >> 1 & 1, octant & 1], 1)
        self.cells[children, :3] = np.repeat(self.cells[cells, :3], 8, axis=0) + (bits << level[:, None])
        self.cells[children, 3] = level
        self.parent[children] = np.repeat(cells, 8)
        self.open[children], self._todo[children] = True, -1
        self.count += len(children)

    def _grow(self, count: int) -> None:
        """Make room for so many cells."""
        if count <= len(self.child):
            return
        more = max(count, 2 * len(self.child)) - len(self.child)
        for name, fill in (("child", 0), ("open", 0), ("wanted", 0), ("cells", 0), ("parent", 0), ("_todo", 0),
                           ("codes", UNKNOWN), ("first", -1), ("last", -1)):  # fmt: skip
            old = getattr(self, name)
            setattr(self, name, np.concatenate([old, np.full((more, *old.shape[1:]), fill, old.dtype)]))

    # What is known.

    def view(self, looks: NDArray[np.int64], cell: NDArray[np.int32]) -> EnvironmentView:
        """What kernels are given now; `looks` has rows where lights are to be selected, and cell (pixels,) int32 gets
        the cells of primary hits, if it is not empty."""
        return EnvironmentView(
            self.frame,
            self.child,
            self.open,
            self.wanted,
            self.codes.reshape(-1),
            self.held,
            self.names,
            self.first,
            self.last,
            self.lights,
            self.geometry.occluders.light_space,
            self._known.copy(),
            self._resting,
            self._by_ray,
            looks,
            cell,
        )

    def at_pixels(self, cell: NDArray[np.int32]) -> NDArray[np.unsignedinteger]:
        """What is known of cells, of any shape, as words like those of `tracer.culling.certified.cells`."""
        word = word_type(len(self.places))
        words = np.full(self.count, FULLY_RENDERED, word)
        # Lists of the lights that are not held, some of them shared, and to which each number belongs.
        first, last = self.first[: self.count].astype(np.int64), self.last[: self.count]
        _, one, which = np.unique(2 * first + (last > first), return_index=True, return_inverse=True)
        owner = np.repeat(np.arange(len(one)), np.maximum(last[one] - first[one], 0))
        for light in range(min(len(self.places), MAX_CULLED_LIGHTS)):
            if light in self.further:
                full = (first[one] >= 0) & self._known[light]
                full[owner[self.lights[: len(owner)] == light]] = False
                state = np.where(full[which], FULL_SHADOW, 0)
            elif light < self.held:
                code = self.codes[: self.count, light]
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
            first, last = (np.maximum(ends[one], 0).astype(np.int64) for ends in (self.first, self.last))
            left = last - first
            if len(self.further) < len(known) - held or not known.all() or self.further[0] < held:
                # Lights that are held are counted, and so are all that have moved.
                lists = self.lights[: self._lit]
                before = np.concatenate([[0], np.cumsum((lists >= held) & known[lists])])
                left = before[last] - before[first] + int((~known[held:]).sum())
            asked += np.where(self.first[one] < 0, len(known) - held, left)
        asked[one == OUTSIDE] = len(known)
        found = asked.astype(np.int32)[which].reshape(cells.shape)
        return np.where(cells < 0, np.int32(-1), found)

    def _hides(self, cell: int, light: int) -> bool:
        """Whether a light that is not held is known to be hidden from a cell."""
        if cell <= OUTSIDE or self.first[cell] < 0 or not self._known[light]:
            return False
        return light not in self.lights[self.first[cell] : self.last[cell]]

    @property
    def told(self) -> str:
        """What there is no memory for, in a sentence, or nothing."""
        lacking = self._wants - self.held
        if lacking <= 0 or not len(self.geometry.rows):
            return ""
        return (
            f"There is memory for the blockers of {self.held} lights; of {lacking} more only what hides them is known."
        )

    def cell_at(self, point: NDArray[np.float32]) -> int:
        """The leaf in which a point (3,) lies; OUTSIDE for none."""
        frame = self.frame
        at = np.floor((point.astype(np.float64) - (frame.x, frame.y, frame.z)) * frame.per_unit)
        if not ((at >= 0) & (at < 2**frame.levels)).all():
            return OUTSIDE
        cell, (i, j, k) = ROOT, at.astype(np.int64).tolist()
        for level in range(frame.levels - 1, -1, -1):
            if self.child[cell] == 0:
                break
            cell = int(self.child[cell]) + 4 * (i >> level & 1) + 2 * (j >> level & 1) + (k >> level & 1)
        return cell

    def state_at(self, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]]:
        """What is known of a light in the cell of a point (3,), and its blockers there: "full", "lit", "candidates" or
        "none", the words that certificates have."""
        cell = self.cell_at(point)
        if light in self.further:
            return ("full" if self._hides(cell, light) else "none"), ()
        code = int(self.codes[cell, light]) if light < self.held else UNKNOWN
        if code > LIT:
            return "candidates", tuple(self.names[code + 1 : code + 1 + self.names[code]].tolist())
        return {LIT: "lit", HIDDEN: "full", UNKNOWN: "none"}[code], ()


def _room_for(array: NDArray[np.int32], count: int) -> NDArray[np.int32]:
    """The array, or a longer one that begins with it."""
    if count <= len(array):
        return array
    return np.concatenate([array, np.zeros(max(count, 2 * len(array)) - len(array), np.int32)])

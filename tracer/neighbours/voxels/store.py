"""The voxels of a scene, and what is known of them for its lights.

What is proved rests on geometry that never moves and on where a light stands: a light that has moved is classified
anew.  Objects that rest are not looked into; a ray that passes by their boxes has the answer that it has without them.
"""

from __future__ import annotations

import time
import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULLY_RENDERED, MAX_CULLED_LIGHTS, forget_lights, shadow_mode, word_type, words_at
from tracer.culling.rest import Resting, boxes_at_rest
from tracer.geometry.memory import aligned_rows
from tracer.neighbours.cells_of_space import STATES
from tracer.neighbours.voxels.classify import classify_blocks
from tracer.neighbours.voxels.contents import list_contents
from tracer.neighbours.voxels.grid import BLOCK, ROOM, make_grid, voxels_for
from tracer.neighbours.voxels.tell import VoxelStates, Walked, walked
from tracer.neighbours.voxels.walk import VoxelView
from tracer.runtime.parallel import for_each_chunk
from tracer.scene.lights import Lamps
from tracer.visibility.box_candidates import light_to
from tracer.visibility.budget import COUNTERS, Counts
from tracer.visibility.error_bounds import LANES, REPORTED
from tracer.visibility.grid import DIGITS, Grid, cube_at
from tracer.visibility.light_space import FARTHEST, LIGHT_ROW
from tracer.visibility.static_geometry import StaticGeometry

if TYPE_CHECKING:
    from tracer.geometry.world import World

CHUNK = 16  # blocks that a thread takes at a time
NAMED = 12  # bytes of lists for a voxel, about


class VoxelStore:
    """Voxels and their states, in no more than about `memory` bytes."""

    def __init__(
        self,
        world: World,
        lights: int,
        threads: int,
        memory: float,
        by_ray: bool,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self._geometry = StaticGeometry(world, 1, threads, True)
        self._by_ray, self._clock = by_ray, clock
        rows = self._geometry.rows
        # Half of the memory is for voxels, half for what is kept of each light and primitive.
        held = min(lights, MAX_CULLED_LIGHTS, int(memory / 2) // max(1, 4 * LIGHT_ROW * len(rows)))
        #: How many lights, the first ones, there is room for.
        self.held = held if len(rows) else 0
        word = word_type(self.held)
        each = np.dtype(word).itemsize + 4 + NAMED
        wanted = voxels_for(len(rows), each, memory / 2)
        self._coarser = wanted < voxels_for(len(rows), each, np.inf)
        self.grid: Grid = make_grid(self._geometry.bounds, wanted)
        self.words = np.zeros(self.grid.cubes + 1, word)
        self._light_space = aligned_rows(self.held * len(rows), LIGHT_ROW).reshape(self.held, len(rows), LIGHT_ROW)
        # How far from each primitive a hit may be reported: inf where its box alone tells, negative for none at all.
        self._reach, self._more = np.zeros(len(rows), np.float32), 0.0
        self._reach[self._geometry.first_quadric :] = np.inf
        self._flat = self._geometry.flat()
        self._reach[self._flat] = -1.0
        self._listed = False
        self._starts, self._names = np.zeros(self.grid.cubes + 1, np.int32), np.zeros(LANES, np.int32)
        #: (lights, 3) float32, where the lights stand for which voxels have states; NaN for those that have none.
        self.places = np.full((lights, 3), np.nan, np.float32)
        self._wanted = self.places.copy()
        self._resting = np.empty((0, 6), np.float32)
        self._shown: weakref.ref[VoxelStates] | None = None  # what pictures hold of `words` as they are

    @property
    def bytes(self) -> int:
        """Memory that all of this takes, in bytes."""
        kept = (self.words, self._light_space, self._starts, self._names)
        return sum(a.nbytes for a in kept) + self._geometry.bytes

    @property
    def told(self) -> str:
        """What there is no memory for, in a sentence, or nothing."""
        lights, grid = min(len(self.places), MAX_CULLED_LIGHTS), self.grid
        said = []
        if self._coarser:
            said.append(f"Memory lowers the grid to {grid.nx} x {grid.ny} x {grid.nz} voxels.")
        if self.held < lights and len(self._geometry.rows):
            said.append(f"There is memory for {self.held} of {lights} lights; rays to the others are traced.")
        return " ".join(said)

    def update(self, lamps: Lamps, resting: Resting) -> None:
        """Lights are where these lamps have them now, and this rests."""
        single = np.diff(lamps.first) == 1
        far = DIGITS * np.abs(lamps.places).max(1, initial=0.0) * self.grid.per_unit > ROOM / 4
        wanted = np.where((single & ~far)[:, None], lamps.places, np.float32(np.nan))
        wanted[self.held :] = np.nan
        moved = np.flatnonzero((wanted != self.places).any(1) & ~np.isnan(self.places[:, 0]))
        if len(moved):
            self._leave_words_to_pictures()
        forget_lights(self.words, moved.tolist())
        self.places[moved] = np.nan
        self._wanted = wanted
        self._resting = boxes_at_rest(resting, self._geometry.largest)

    def classify(self, seconds: float, threads: int, cancel: Callable[[], bool] | None = None) -> Counts:
        """Classify the voxels for one light after another that has none, until the time is up.

        Raises Cancelled if `cancel` turns true meanwhile."""
        until, counts = self._clock() + seconds, np.zeros((threads, COUNTERS), np.int64)
        for light in np.flatnonzero((self._wanted != self.places).any(1) & ~np.isnan(self._wanted[:, 0])):
            if self._clock() >= until:
                break
            self._classify(int(light), threads, counts, cancel)
        if not self._listed:
            self._list_contents()
        return Counts(*counts.sum(0).tolist())

    def _classify(self, light: int, threads: int, counts: NDArray[np.int64], cancel: Callable[[], bool] | None) -> None:
        geometry, grid, place = self._geometry, self.grid, self._wanted[light].copy()
        self._leave_words_to_pictures()
        forget_lights(self.words, [light])
        known = light_to(light, 0, place, grid.around, geometry.largest)
        geometry.update_points([0], place[None], grid.around)
        self._prepare(light, known.longest)
        many = grid.cubes // BLOCK**3
        shares = np.array_split(np.arange(many), max(1, many // CHUNK))

        def work(chunk: int, worker: int) -> None:
            words = words_at(self.words)
            classify_blocks(geometry.occluders, grid, words, known, shares[chunk], counts[worker])

        for_each_chunk(work, len(shares), threads, cancel)
        self.places[light] = place

    def _prepare(self, light: int, longest: float) -> None:
        """Keep all primitives as the light sees them, and note how far from them its rays may report hits."""
        rows, made = self._geometry.rows, self._geometry.occluders.light_space[0]
        self._light_space[light] = made
        infirm = made[:, FARTHEST] < 0.0
        reach = np.where(infirm, np.float32(np.inf), self._geometry.occluders.error_radii[0][: len(rows)])
        reach[self._flat] = -1.0
        further = reach > self._reach
        if further.any() or REPORTED * longest > self._more:
            # Somewhat further, so that a light that moves a little changes nothing.
            self._reach[further], self._listed = 1.5 * reach[further], False
            self._more = max(self._more, 1.5 * REPORTED * longest)

    def _list_contents(self) -> None:
        """List what lies in each voxel."""
        rows, self._listed = self._geometry.rows, True
        reach = np.where(self._reach > self.grid.side, np.float32(np.inf), self._reach)
        # Count what is in each, then put it there: starts[v + 1] goes from where v begins to where it ends.
        counts = np.zeros(self.grid.cubes + 1, np.int32)
        nobody = np.empty(0, np.int32)
        list_contents(rows, reach, self._more, self.grid, counts, nobody)
        starts = np.zeros_like(counts)
        starts[1:] = np.cumsum(counts)[:-1]
        names = np.zeros(int(counts.sum()) + LANES, np.int32)  # sixteen are read at a time
        list_contents(rows, reach, self._more, self.grid, starts, names)
        self._starts, self._names = starts, names
        self._leave_words_to_pictures()
        self.words &= ~self.words.dtype.type(3)
        self.words[:-1] |= (counts[1:] > 0).astype(self.words.dtype)

    def view(self, cell: NDArray[np.int32]) -> VoxelView:
        """What kernels are given now; cell (pixels,) int32 gets the voxels of primary hits, if it is not empty."""
        words, known = words_at(self.words), ~np.isnan(self.places[:, 0])
        return VoxelView(
            self.grid, words, self._starts, self._names, self._light_space, known, self._resting, self._by_ray, cell
        )

    def describe(self, primitive: int, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]]:
        """What is known of a light in the voxel of a point (3,): one of STATES.  It names no primitives."""
        number = cube_at(self.grid, point)
        if number < 0 or not 0 <= light < len(self.places) or np.isnan(self.places[light, 0]):
            return STATES[0], ()
        return STATES[int(shadow_mode(self.words[number], light))], ()

    def shown(self) -> VoxelStates:
        """The voxels and their states as they are now, for pictures to hold; the same until anything changes."""
        shown = None if self._shown is None else self._shown()
        if shown is None:
            shown = VoxelStates(self.grid, self.words, ~np.isnan(self.places[:, 0]))
            self._shown = weakref.ref(shown)
        return shown

    def _leave_words_to_pictures(self) -> None:
        """Go on with a copy of the words, which are about to change, if any picture holds them."""
        if self._shown is not None and self._shown() is not None:
            self.words = self.words.copy()
        self._shown = None

    def walked(self, point: NDArray[np.float32], light: int) -> Walked | None:
        """How a shadow ray that ends at a point (3,) goes from voxel to voxel to a light; None where it does not."""
        if not 0 <= light < len(self.places) or np.isnan(self.places[light, 0]):
            return None
        rows, lists = self._geometry.rows, (self._starts, self._names)
        return walked(self.shown(), light, self.places[light], point, rows[: self._geometry.first_quadric], lists)

    def at_pixels(self, cell: NDArray[np.int32]) -> NDArray[np.unsignedinteger]:
        """The words of voxels, of any shape, like those of `tracer.neighbours.certified.cells`."""
        word = self.words.dtype.type
        return np.where(
            (cell >= 0) & (cell < self.grid.cubes), self.words[cell] & ~word(3) | word(FULLY_RENDERED), word(0)
        )

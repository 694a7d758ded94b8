"""The store of certificates: all that is proved of a world's cells, kept up to date with what moves.

What is static has cells: geometry that never moves, and an object for as long as it rests.  In each frame the store
first follows what has moved (`update`), which drops the certificates that no longer hold and no others.  The scheduler
then adds to it (`gather`, `certify`), kernels look cells up in it (`view`), and in the end it is held within a memory
(`keep_within`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracer.culling.dependence import drop_dependent
from tracer.culling.modes import MAX_CULLED_LIGHTS, shadow_mode, words_at
from tracer.culling.modes import NON_SHADOW as LIT
from tracer.culling.rest import Changed, Resting, changes, nothing_rests
from tracer.geometry.boxes import OUTWARDS
from tracer.geometry.primitives import Outlines
from tracer.neighbours.cells_of_space import STATES
from tracer.neighbours.certified.cell_prism import SceneScale
from tracer.neighbours.certified.cells import (
    ALONG_U,
    ALONG_V,
    CORNER,
    FULL,
    NOBODY,
    NORMAL,
    ROOTS,
    SETTLED,
    TOO_MANY,
    Cells,
    bytes_of,
    make_cells,
    named_by,
    put_receivers,
    with_room,
)
from tracer.neighbours.certified.certify import Scratch, make_scratch
from tracer.neighbours.certified.cost_model import CostModel
from tracer.neighbours.certified.gather_requests import RequestPoints, gather_tasks
from tracer.neighbours.certified.invalidate import all_marked, copy_kept, invalidate_certificates
from tracer.neighbours.certified.journal import Journal
from tracer.neighbours.certified.lamp_geometry import LampGeometry
from tracer.neighbours.certified.quadtree import part_of
from tracer.neighbours.certified.requests import Requests
from tracer.neighbours.certified.tasks import KEPT, commit, make_tasks, run_tasks, tasks_in
from tracer.neighbours.certified.view import CertificateView, LampsView
from tracer.runtime.parallel import for_each_chunk
from tracer.scene.lights import Lamps
from tracer.visibility.occluders import FAR, Occluders
from tracer.visibility.static_geometry import StaticGeometry, max_height

if TYPE_CHECKING:
    from tracer.geometry.world import World

BATCH = 4096  # tasks of one call of `certify`, at most
SHARES, CHUNK = 4, (32, 256)  # of a batch that each thread takes, one at a time; least and most tasks of one
FEW_TILES = 4  # of a picture: with so many every vector of points makes requests, with twice as many every other
EMPTY_BOX = np.array([FAR, FAR, FAR, -FAR, -FAR, -FAR], np.float32)


class CertificateStore:
    """All certificates of a world.

    Attributes:
        cells: the cells in use; replaced when they need more room.
        count: lights that can be certified, the first ones.
        lights: (count, 3) float32, their places.
        radii: (count,) float32, of balls around these in which the samples of lamps lie; 0 for points.
        stationary: (count,) bool, those that have not moved for a frame.
        scale: what errors grow with.
        threads: how many work.
        cost_model: what certificates are worth.
        numbering: changes whenever cells get other numbers, so that requests of before mean nothing.
        restarts: how often everything was dropped, as the scene had outgrown it.
        journal: lets what is certified be undone, until something moves; None where that stays.
    """

    def __init__(self, world: World, lights: int, threads: int, cost_model: CostModel) -> None:
        """For so many lights, of which the first MAX_CULLED_LIGHTS can be certified."""
        self._world, self.threads, self.cost_model = world, threads, cost_model
        self._scratch: list[Scratch] = []
        self.count = min(lights, MAX_CULLED_LIGHTS)
        self._room = make_tasks(BATCH, self.count)
        self.numbering = self.restarts = 0
        self._start()

    def _start(self) -> None:
        """Begin with nothing known."""
        self._static = StaticGeometry(self._world, self.count, self.threads, self.cost_model.max_asked > 0)
        self._lamp_geometry: LampGeometry | None = None
        self._resting = nothing_rests(len(self._world.primitives.triangle_starts) - 1)
        self.lights = np.full((self.count, 3), np.nan, np.float32)
        self.radii = np.zeros(self.count, np.float32)
        self._samples = np.ones(self.count, np.int32)
        self.stationary = np.zeros(self.count, np.bool_)
        self._fitted = np.zeros(self.count, np.bool_)  # lights that boxes are fitted to, where they are now
        self.cells: Cells = make_cells(len(self._world.object_of), self.count)
        self._seen = np.zeros(len(self.cells.waiting), np.int32)  # the frame that last saw each root
        self._frame = 0
        self._slots = np.zeros(0, np.int32)  # in which requests are gathered
        self.journal: Journal | None = None
        self.numbering += 1
        self.restarts += 1
        self._rescale()

    def _rescale(self) -> None:
        """Let cells be as coarse as the coordinates of all that is static ask for."""
        largest = 1.5 * self._static.largest  # with room for what will come to rest
        self.scale = SceneScale(max_height(largest), largest)
        self._put_receivers(0)

    def _put_receivers(self, index: int, cells: bool = True) -> None:
        """Let an object's triangles have cells, none of which are there yet, or none ever."""
        rows = self._world.primitives.triangles_of(index)
        receivers = self.cells.receivers
        if cells:
            put_receivers(self._static.rows, rows.start, rows.stop, self.scale.max_coordinate, receivers)
        else:
            receivers[rows] = 0
        self.cells.rooted[rows] = 0
        self.cells.waiting[2 * rows.start : 2 * rows.stop] = 0

    @property
    def certified(self) -> NDArray[np.bool_]:
        """(count,) bool: lights that cells are certified for, points that have not moved for a frame."""
        return self.stationary & (self.radii == 0.0)

    @property
    def _are_lamps(self) -> NDArray[np.bool_]:
        """(count,) bool: lights whose rays beams answer."""
        return (self.radii > 0.0) & (self._samples >= self.cost_model.least_samples)

    @property
    def occluders(self) -> Occluders:
        """All that is static."""
        return self._static.occluders

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) the lower and the upper corner around it."""
        return self._static.bounds

    def occluders_in_ball(self, light: int, radius: float) -> Occluders:
        """The same, fitted to a ball around one of the lights."""
        return self._static.in_ball(light, self.lights, radius, self.scale.max_height)

    @property
    def bytes(self) -> int:
        """Memory that the cells take, in bytes."""
        return bytes_of(self.cells)

    # --- what moves -------------------------------------------------------------------------------------

    def update(self, lamps: Lamps, resting: Resting, threads: int) -> None:
        """Drop what no longer holds, with lights and objects where they are now, and nothing else.

        A point light is certified once it has not moved for a frame.  What is known of a lamp's rays serves one frame,
        so that lamps may move.  From now on work is done by so many threads."""
        self.threads, self.journal = threads, None
        self._scratch += [make_scratch() for _ in range(len(self._scratch), threads)]
        if self._world.extent > self._static.allowed:  # boxes may have grown beyond those that are known
            self._start()
        self._follow_rest(resting)
        lights, radii = lamps.places[: self.count], lamps.radii[: self.count]
        moved = ~(lights == self.lights).all(axis=1) | (radii != self.radii)
        words = self.cells.words[: self.cells.used[0]]
        for number in np.flatnonzero(moved):
            words &= ~words.dtype.type(3 << (2 + 2 * int(number)))
            self.cells.lists[: len(words), number] = NOBODY
        new = np.isnan(self.lights).any(axis=1)
        self.lights[:], self.radii[:] = lights, radii
        self._samples[:] = np.diff(lamps.first)[: self.count]
        self.stationary[:] = ~moved | new
        self._fitted &= ~moved
        if self._are_lamps.any():
            if self._lamp_geometry is None:
                self._lamp_geometry = LampGeometry(self._world, self.count, self.threads, self._static)
            self._lamp_geometry.update(self._are_lamps, lights, radii, moved, resting)
        fit = ~self._fitted & self.stationary & ~self._are_lamps
        self._static.update_lights(np.flatnonzero(fit).tolist(), lights, radii, self.scale.max_height)
        self._fitted |= fit

    def _follow_rest(self, resting: Resting) -> None:
        """Drop what depends on objects that have started or stopped."""
        started, stopped = changes(self._resting, resting)
        if not len(started.which) and not len(stopped.which):
            return
        outlines = self._world.outlines()
        self._static.update(started.which, stopped.which, outlines)
        if self._static.largest > self.scale.max_coordinate:  # rays may end higher than cells reach
            self._start()
            started, stopped = changes(self._resting, resting)
            self._static.update(started.which, stopped.which, outlines)
            self._rescale()
        else:
            self._invalidate(started, stopped, outlines)
        self._resting = resting
        for index in started.which:
            self._put_receivers(int(index), cells=False)
        for index in stopped.which:
            self._put_receivers(int(index))

    def _invalidate(self, started: Changed, stopped: Changed, outlines: Outlines) -> None:
        """Drop the certificates that name what has started, and those that what has stopped may come between."""
        gone = np.isin(self._world.object_of, started.which)
        near = all_marked(len(gone), self.cells.words.dtype.type)
        near[self.cells.rooted[: len(near)] == 0] = 0  # of what has no cells nothing need be known
        lights = np.nan_to_num(self.lights)
        known = np.flatnonzero(self._fitted).tolist()
        self._static.update_lights(known, lights, self.radii, self.scale.max_height)
        boxes = np.zeros((self.count, len(stopped.which), 6))  # by light, of which the others have no certificates
        for k, index in enumerate(stopped.which):
            boxes[known, k] = self._static.reported_within(int(index), known)
        around = np.concatenate(
            [boxes[known, :, :3].min(0, initial=np.inf), boxes[known, :, 3:].max(0, initial=-np.inf)], 1
        )
        around += 2.0 * self.scale.max_height * OUTWARDS  # rays end above what they are asked for
        drop_dependent(near, outlines, lights, around.astype(np.float32), LIT, self.threads)
        invalidate_certificates(self.cells, self.occluders, lights, self.scale, gone, boxes, near, self._scratch[0])

    # --- what is added ----------------------------------------------------------------------------------

    def undo(self) -> None:
        """Be as when the journal began."""
        if self.journal is not None:
            self.journal.undo(self.cells)
            self.journal = None

    def gather(
        self, key: NDArray[np.int32], u: NDArray[np.float32], v: NDArray[np.float32], patience: int
    ) -> tuple[NDArray[np.int32], RequestPoints]:
        """Tasks (k, 3) int32 for requests, arrays (n,) as in `Requests`, and these, sorted by task.

        A triangle's first cell is made once `patience` points have requested it."""
        points = RequestPoints(np.empty_like(u), np.empty_like(v), np.empty((2, len(u)), np.float32))
        self.cells = with_room(self.cells, min(len(key), 2 * len(self.cells.receivers)), 0)
        slots = len(self.cells.words) + len(self.cells.waiting)
        if len(self._slots) < slots:
            self._slots = np.zeros(slots, np.int32)
        if self.journal is not None:
            self.journal.note_owners(self.cells, (-1 - key[key < 0]).astype(np.int64))
        known = self.cells, self.occluders, self.lights, self.certified
        return gather_tasks(*known, key, u, v, patience, self._slots, points), points

    def certify(
        self,
        todo: NDArray[np.int32],
        points: RequestPoints,
        cost_model: CostModel,
        lights: int,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None = None,
    ) -> NDArray[np.int32]:
        """Certify up to BATCH tasks (n, 3) for so many lights each at most; the tasks (k, 3) that follow from them.

        counts (threads, COUNTERS) int64 are added to.  Raises Cancelled, with nothing certified, if `cancel` turns
        true meanwhile."""
        tasks = tasks_in(self._room, todo)
        size = min(max(CHUNK[0], -(-len(todo) // (SHARES * self.threads))), CHUNK[1])

        def work(chunk: int, worker: int) -> None:
            run_tasks(
                self.cells, self.occluders, self.lights, self.certified, self.scale,
                chunk * size, min(len(todo), (chunk + 1) * size), tasks, points,
                cost_model.split_requests, cost_model.settled_candidates, lights, self._scratch[worker], counts[worker],
            )  # fmt: skip

        for_each_chunk(work, -(-len(todo) // size), self.threads, cancel)
        named = 1 + tasks.amount[(tasks.state != KEPT) & (tasks.amount != TOO_MANY)].astype(np.int64) % SETTLED
        self.cells = with_room(self.cells, 4 * len(todo), int(named.sum()))
        if self.journal is not None:
            self.journal.note_cells(self.cells, tasks)
        following = np.empty((4 * len(todo), 3), np.int32)
        return following[: commit(self.cells, self.occluders, self.scale, tasks, following)]

    def keep_within(self, most: float, cell: NDArray[np.int32]) -> None:
        """Drop the cells of those triangles that were seen longest ago where all take more than `most` bytes.

        They are dropped down to three quarters of that.  cell (any,) int32 are those that primary rays see now."""
        self._frame += 1
        taken = bytes_of(self.cells)
        if taken > 0.5 * most:
            self._seen[self.cells.owner[cell]] = self._frame
        if taken <= most:
            return
        used = int(self.cells.used[0])
        sizes = np.bincount(self.cells.owner[1:used], minlength=len(self._seen)) * (taken / used)
        order = np.argsort(-self._seen, kind="stable")
        kept = np.zeros(len(self._seen), np.bool_)
        kept[order[np.cumsum(sizes[order]) <= 0.75 * most]] = True
        target = make_cells(len(self._world.object_of), self.count, len(self.cells.words))
        target = with_room(target, 0, int(self.cells.named[0]))
        target = target._replace(receivers=self.cells.receivers, rooted=self.cells.rooted)
        copy_kept(self.cells, kept, target)
        self.cells, self.journal = target, None
        self.numbering += 1

    # --- what is known ----------------------------------------------------------------------------------

    def view(self, tiles: int, requests: Requests, cell: NDArray[np.int32]) -> CertificateView:
        """What kernels are given that shade a picture of so many tiles.

        Their requests go to `requests`, a row for each tile, and the cells of primary hits to cell (pixels,) int32,
        empty where nobody wants to know.  In small pictures more of the points make requests: each stands for many of a
        large one."""
        model, cells = self.cost_model, self.cells
        stride = min(model.stride, max(1, tiles // FEW_TILES))
        return CertificateView(
            words=words_at(cells.words),
            child=cells.child,
            receivers=cells.receivers,
            rooted=cells.rooted,
            lists=cells.lists,
            names=cells.names,
            stationary=self.certified,
            occluders=self.occluders,
            lamps=self._lamps(),
            highest=self.scale.max_height,
            max_asked=model.max_asked,
            first_asking=model.first_asking,
            costly_rays=model.costly_rays,
            stride=stride,
            first_vector=self._frame % stride,
            requests=requests,
            cell=cell,
        )

    def _lamps(self) -> LampsView:
        geometry = self._lamp_geometry
        return LampsView(
            known=self._are_lamps,
            places=self.lights,
            radii=self.radii,
            samples=self._samples,
            within=EMPTY_BOX if geometry is None else geometry.within,
            unknown=EMPTY_BOX if geometry is None else geometry.unknown,
            ray_cost=self.cost_model.ray_cost,
            occluders=self.occluders if geometry is None else geometry.occluders,
            any_hit=self._world.placed.any_hit,
            data=self._world.placed.data,
        )

    def at_pixels(self, cell: NDArray[np.int32]) -> NDArray[np.unsignedinteger]:
        """The words of cells, of any shape."""
        return self.cells.words[cell]

    def describe(self, primitive: int, point: ArrayLike, light: int) -> tuple[str, tuple[int, ...]]:
        """What is certified for a light of the cell in which shadow rays end at a point (3,) above a primitive.

        One of STATES, and the numbers of the primitives that it names."""
        number = self.place_of(primitive, point)[3]
        state = int(shadow_mode(self.cells.words[number], light)) if light < self.count else 0
        names = named_by(self.cells, self.naming(number, light) if state == FULL else number, light)
        return STATES[state], tuple(int(name) for name in (() if names is None else names))

    def naming(self, cell: int, light: int) -> int:
        """The cell that a FULL one has its certificate from: itself, or one that it is a part of; 0 for none."""
        while cell and self.cells.lists[cell, light] == NOBODY:
            cell = int(self.cells.parent[cell])
        return cell

    def place_of(self, primitive: int, point: ArrayLike) -> tuple[int, float, float, int]:
        """The owner, -1 for none, of which shadow rays end at a point (3,) above a primitive; u and v there; and the
        leaf, 0 for none."""
        row = self.cells.receivers[primitive].astype(np.float64)
        to = np.asarray(point, np.float64) - row[CORNER : CORNER + 3]
        u, v, height = (float(row[at : at + 3] @ to) for at in (ALONG_U, ALONG_V, NORMAL))
        number = int(self.cells.receivers.view(np.int32)[primitive, ROOTS + (height < 0.0)])
        u, v = x, y = min(max(u, 0.0), 1.0), min(max(v, 0.0), 1.0)
        while self.cells.child[number] >= 0:
            part, x, y = part_of.py_func(x, y)
            number = int(self.cells.child[number]) + part
        return 2 * primitive + (height < 0.0) if row[NORMAL : NORMAL + 3].any() else -1, u, v, number

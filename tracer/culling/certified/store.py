"""All certificates of a scene: kept up to date with what moves, and made, most requested first, within a budget."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracer.culling.certified import certify
from tracer.culling.certified.cells import (
    ALONG_U,
    ALONG_V,
    CORNER,
    HIGHEST,
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
from tracer.culling.certified.cost_model import CostModel
from tracer.culling.certified.gather_requests import RequestPoints, gather_tasks
from tracer.culling.certified.invalidate import all_marked, copy_kept, invalidate_certificates
from tracer.culling.certified.occluders import Occluders
from tracer.culling.certified.requests import Requests
from tracer.culling.certified.static_geometry import StaticGeometry
from tracer.culling.certified.tasks import KEPT, commit, counters, make_tasks, run_tasks, tasks_in
from tracer.culling.certified.view import CertificateView, RequestRows
from tracer.culling.dependence import drop_dependent
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.culling.modes import NON_SHADOW as LIT
from tracer.culling.rest import Changed, Resting, changes, nothing_rests
from tracer.culling.shadow_modes import words_at
from tracer.geometry.boxes import OUTWARDS
from tracer.geometry.offsets import RAY_OFFSET
from tracer.geometry.primitives import Outlines
from tracer.geometry.world import World
from tracer.parallel import for_each_chunk

STATES = ("none", "full", "lit", "candidates")
BATCH = 4096  # tasks between two looks at the budget, at most
FIRST, FASTER = 8, 8  # tasks of a frame's first batch, where time counts, and how many times as many the next may have
FEW_TILES = 4  # of a picture: of so many every point may make requests, of twice as many every other
LEAST = 5e-4  # seconds: less time is not worth a batch
SORTING = 0.5  # of the time that is left, at most, is spent on sorting points by their cells
MANY = 1 << 14  # points, as which fewer are timed
SHARES, CHUNK = 4, (32, 256)  # of a batch that each thread takes, one at a time; least and most tasks of one


NOT_RECORDED = np.empty(0, np.int32)  # where nobody wants to know which cells primary hits see


@dataclass(frozen=True)
class Budget:
    """How much may be certified in a frame: so many cells and lights, and until when (`perf_counter`; inf for ever)."""

    certificates: float = np.inf
    until: float = np.inf


RARE = 1e-3  # certificates made for each shadow ray that was due, in the last frame: below that one can be EAGER
EAGER = 8  # times fewer requests needed


class CertificateStore:
    """The certified cells of what is static in a world: of what never moves and of objects that rest."""

    def __init__(self, world: World, lights: int, threads: int, usual: CostModel) -> None:
        """For so many lights, of which the first MAX_CULLED_LIGHTS are certified; `usual` is the effort that rays
        through this world are worth."""
        self._world, self._threads, self._cost_model = world, threads, usual
        self._scratch: list[certify.Scratch] = []
        self._count = min(lights, MAX_CULLED_LIGHTS)
        self._room = make_tasks(BATCH, self._count)
        self._start()

    def _start(self) -> None:
        """With nothing known."""
        self._static = StaticGeometry(self._world, self._count, self._threads, self._cost_model.max_asked > 0)
        self._resting = nothing_rests(len(self._world.primitives.triangle_starts) - 1)
        self._lights = np.full((self._count, 3), np.nan, np.float32)
        self.stationary = np.zeros(self._count, np.bool_)
        self.cells: Cells = make_cells(len(self._world.object_of), self._count)
        self._seen = np.zeros(len(self.cells.waiting), np.int32)  # the frame that last saw each root
        self._frame = 0
        self._pace = 5e-8  # seconds that a point took to be gathered, the slowest of late
        self._next_list = 0  # of the lists of requests, the first to be gathered where time is short
        self._rate = np.inf  # certificates that the last frame made, for each shadow ray due
        self.pending: list[Requests] = []  # what the last frame's rays requested and has not been looked into
        self.next_tile = 0  # of a picture, the first to be asked what it wants
        self._slots = np.zeros(0, np.int32)  # in which points are gathered
        self._scale()

    def _scale(self) -> None:
        """Let cells be as coarse as the coordinates of all that is static ask for."""
        self._largest = 1.5 * self._static.largest  # with room for what will come to rest
        self.highest = float(np.float32(HIGHEST * RAY_OFFSET * self._largest))
        self._receive(0)

    @property
    def occluders(self) -> Occluders:
        """All that is static."""
        return self._static.occluders

    def _receive(self, index: int, cells: bool = True) -> None:
        """Let an object's triangles have cells, or none."""
        rows = self._world.primitives.triangles_of(index)
        receivers = self.cells.receivers
        if cells:
            put_receivers(self._static.rows, rows.start, rows.stop, self._largest, receivers)
        else:
            receivers[rows] = 0
        self.cells.rooted[rows] = 0
        self.cells.waiting[2 * rows.start : 2 * rows.stop] = 0

    def follow(self, lights: NDArray[np.float32], resting: Resting, threads: int) -> None:
        """Drop what no longer holds, with lights (n, 3) and objects where they are now, and nothing else.

        A light is certified once it has stood still for a frame.  From now on work is done by so many threads."""
        self._threads = threads
        self._scratch += [certify.scratch() for _ in range(len(self._scratch), threads)]
        if self._world.extent > self._static.allowed:  # boxes may have grown beyond those that are known
            self._start()
        self._follow_rest(resting)
        lights = lights[: self._count]
        moved = ~(lights == self._lights).all(axis=1)
        words = self.cells.words[: self.cells.used[0]]
        for number in np.flatnonzero(moved):
            words &= ~words.dtype.type(3 << (2 + 2 * int(number)))
            self.cells.lists[: len(words), number] = NOBODY
        new = np.isnan(self._lights).any(axis=1)
        stationary = ~moved | new
        settled = stationary & ~self.stationary
        self._lights[:] = lights
        self.stationary[:] = stationary
        self._static.update_lights([int(number) for number in np.flatnonzero(settled)], self._lights, self.highest)

    def _follow_rest(self, resting: Resting) -> None:
        """Drop what depends on objects that have started or stopped."""
        started, stopped = changes(self._resting, resting)
        if not len(started.which) and not len(stopped.which):
            return
        outlines = self._world.outlines()
        self._static.follow(started.which, stopped.which, outlines)
        if self._static.largest > self._largest:  # what is known of rays' ends no longer holds
            self._start()
            started, stopped = changes(self._resting, resting)
            self._static.follow(started.which, stopped.which, outlines)
            self._scale()
        else:
            self._drop(started, stopped, outlines)
        self._resting = resting
        for index in started.which:
            self._receive(int(index), cells=False)
        for index in stopped.which:
            self._receive(int(index))

    def _drop(self, started: Changed, stopped: Changed, outlines: Outlines) -> None:
        """Drop the certificates that name what has started, and those that what has stopped may come between."""
        gone = np.isin(self._world.object_of, started.which)
        near = all_marked(len(gone), self.cells.words.dtype.type)
        near[self.cells.rooted[: len(near)] == 0] = 0  # of what has no cells nothing need be known
        lights = np.nan_to_num(self._lights)
        known = [int(number) for number in np.flatnonzero(self.stationary)]
        self._static.update_lights(known, self._lights, self.highest)
        boxes = np.zeros((self._count, len(stopped.which), 6))  # by light, of which the others have no certificates
        for k, index in enumerate(stopped.which):
            boxes[known, k] = self._static.reported_within(int(index), known)
        around = np.concatenate(
            [boxes[known, :, :3].min(0, initial=np.inf), boxes[known, :, 3:].max(0, initial=-np.inf)], 1
        )
        around += 2.0 * self.highest * OUTWARDS  # rays end above what they are asked for
        drop_dependent(near, outlines, lights, around.astype(np.float32), LIT, self._threads)
        reach = (self.highest, self._largest)
        invalidate_certificates(self.cells, self.occluders, lights, reach, gone, boxes, near, self._scratch[0])

    def keep_within(self, most: float, cell: NDArray[np.int32]) -> None:
        """Drop the cells of those triangles that were seen longest ago where all take more than `most` bytes, down to
        three quarters of that.  cell (any,) are those that primary rays see now."""
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
        empty = make_cells(len(self._world.object_of), self._count, len(self.cells.words))
        empty = with_room(empty, 0, int(self.cells.named[0]))
        empty = empty._replace(receivers=self.cells.receivers, rooted=self.cells.rooted)
        copy_kept(self.cells, kept, empty)
        self.cells, self.pending = empty, []  # which speaks of numbers that cells no longer have

    @property
    def cost_model(self) -> CostModel:
        """What certifying is worth now: more than usual where rays are costly and there is little to certify."""
        usual = self._cost_model
        if self._rate >= RARE or not usual.costly_rays:
            return usual
        return usual._replace(
            root_requests=-(-usual.root_requests // EAGER), split_requests=-(-usual.split_requests // EAGER)
        )

    def finish_frame(self, made: int, due: int) -> None:
        """A frame has made so many certificates, with so many shadow rays due."""
        self._rate = made / due if due else np.inf

    def view(self, tiles: int, requests: Requests, cell: NDArray[np.int32] = NOT_RECORDED) -> CertificateView:
        """What kernels are given that shade a picture of so many tiles: their requests go to `requests`, a row for each
        tile, and the cells of primary hits to cell (pixels,).  In small pictures more of the points request: each
        stands for many of a large one."""
        model, cells = self._cost_model, self.cells
        stride = min(model.stride, max(1, tiles // FEW_TILES))
        return CertificateView(
            words=words_at(cells.words),
            child=cells.child,
            receivers=cells.receivers,
            rooted=cells.rooted,
            lists=cells.lists,
            names=cells.names,
            light_space=self.occluders.light_space,
            stationary=self.stationary,
            highest=self.highest,
            max_asked=model.max_asked,
            costly_rays=model.costly_rays,
            stride=stride,
            first_vector=self._frame % stride,
            requests=RequestRows(*requests),
            cell=cell,
        )

    def certify(
        self, lists: list[Requests], budget: Budget, cost_model: CostModel, cancel: Callable[[], bool] | None
    ) -> NDArray:
        """Certify what rays requested, within a budget; counters (COUNTERS,) int64 of what that took."""
        counts = counters(self._threads)
        if not self._count:
            return counts.sum(0)
        todo, points = self._gather(lists, budget, cost_model)
        batch = FIRST if budget.until < np.inf else BATCH
        while len(todo):
            todo = todo[np.argsort(todo[:, 1] - todo[:, 2], kind="stable")]
            following, first = [], 0
            while first < len(todo):
                start = clock.perf_counter()
                left = budget.certificates - counts[:, certify.CERTIFICATES].sum()
                batch = int(min(batch, left / self._count))
                if batch <= 0 or start > budget.until - LEAST:
                    return counts.sum(0)
                those = todo[first : first + batch]
                following.append(self._certify(those, points, cost_model, counts, cancel))
                first += batch
                pace = max(1e-6, (clock.perf_counter() - start) / len(those))  # seconds a task takes
                batch = int(min(BATCH, FASTER * batch, 0.5 * (budget.until - clock.perf_counter()) / pace))
            todo = np.concatenate(following)
        return counts.sum(0)

    def _gather(
        self, lists: list[Requests], budget: Budget, cost_model: CostModel
    ) -> tuple[NDArray[np.int32], RequestPoints]:
        """Tasks (n, 3), and the points that request them: where time is short those of some tiles, and in the next
        frame those of others."""
        kept = [(requests, tile, n) for requests in lists for tile, n in enumerate(requests.of[:, 0].tolist()) if n]
        room = SORTING * max(LEAST, budget.until - clock.perf_counter()) / self._pace
        if sum(n for _, _, n in kept) > room:
            first = self._next_list % len(kept)
            kept = kept[first:] + kept[:first]
            kept = kept[: max(1, int(np.searchsorted(np.cumsum([n for _, _, n in kept]), room)))]
            self._next_list = first + len(kept)
        none = [np.empty(0, np.int32), np.empty(0, np.float32), np.empty(0, np.float32)]
        key, u, v = (
            np.concatenate([none[k], *(requests[k][tile, :n] for requests, tile, n in kept)]) for k in range(3)
        )
        points = RequestPoints(np.empty_like(u), np.empty_like(v), np.empty((2, len(u)), np.float32))
        self.cells = with_room(self.cells, min(len(key), 2 * len(self.cells.receivers)), 0)
        slots = len(self.cells.words) + len(self.cells.waiting)
        if len(self._slots) < slots:
            self._slots = np.zeros(slots, np.int32)
        known, start = (self.cells, self.occluders, self._lights, self.stationary), clock.perf_counter()
        todo = gather_tasks(*known, key, u, v, cost_model.root_requests, self._slots, points)
        self._pace = max(0.5 * self._pace, (clock.perf_counter() - start) / max(MANY, len(key)))
        return todo, points

    def _certify(
        self,
        todo: NDArray[np.int32],
        points: RequestPoints,
        cost_model: CostModel,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> NDArray[np.int32]:
        """Work on tasks (n, 3); those that follow."""
        tasks, reach = tasks_in(self._room, todo), (self.highest, self._largest)
        size = min(max(CHUNK[0], -(-len(todo) // (SHARES * self._threads))), CHUNK[1])

        def work(chunk: int, worker: int) -> None:
            run_tasks(
                self.cells, self.occluders, self._lights, self.stationary, reach,
                chunk * size, min(len(todo), (chunk + 1) * size),
                tasks, points, cost_model.split_requests, cost_model.settled_candidates,
                self._scratch[worker], counts[worker],
            )  # fmt: skip

        for_each_chunk(work, -(-len(todo) // size), self._threads, cancel)
        named = 1 + tasks.amount[(tasks.state != KEPT) & (tasks.amount != TOO_MANY)].astype(np.int64) % SETTLED
        self.cells = with_room(self.cells, 4 * len(todo), int(named.sum()))
        following = np.empty((4 * len(todo), 3), np.int32)
        return following[: commit(self.cells, self.occluders, reach, tasks, following)]

    def at_pixels(self, cell: NDArray[np.int32]) -> NDArray[np.unsignedinteger]:
        """The words of cells, of any shape."""
        return self.cells.words[cell]

    def describe(self, primitive: int, point: ArrayLike, light: int) -> tuple[str, tuple[int, ...]]:
        """What is certified for a light of the cell in which shadow rays end at a point (3,) above a primitive: "full",
        "lit", "candidates" or "none", and the numbers of the primitives that it names."""
        number = self._cell_at(primitive, np.asarray(point, np.float64))
        state = (int(self.cells.words[number]) >> (2 + 2 * light)) & 3 if light < self._count else 0
        while number and state == certify.FULL and self.cells.lists[number, light] == NOBODY:
            number = int(self.cells.parent[number])  # taken over from the cell that this one is a part of
        names = named_by(self.cells, number, light)
        return STATES[state], tuple(int(name) for name in (() if names is None else names))

    def _cell_at(self, primitive: int, point: NDArray[np.float64]) -> int:
        """The leaf in which a point above a primitive lies; 0 for none."""
        row = self.cells.receivers[primitive].astype(np.float64)
        to = point - row[CORNER : CORNER + 3]
        u, v, height = (float(row[at : at + 3] @ to) for at in (ALONG_U, ALONG_V, NORMAL))
        number = int(self.cells.receivers.view(np.int32)[primitive, ROOTS + (height < 0.0)])
        u, v = min(max(u, 0.0), 1.0), min(max(v, 0.0), 1.0)
        while self.cells.child[number] >= 0:
            number = int(self.cells.child[number])
            if u + v <= 0.5:
                u, v = 2 * u, 2 * v
            elif u >= 0.5:
                number, u, v = number + 1, 2 * u - 1, 2 * v
            elif v >= 0.5:
                number, u, v = number + 2, 2 * u, 2 * v - 1
            else:
                number, u, v = number + 3, 1 - 2 * u, 1 - 2 * v
        return number

    @property
    def bytes(self) -> int:
        """Memory that the cells take."""
        return bytes_of(self.cells)

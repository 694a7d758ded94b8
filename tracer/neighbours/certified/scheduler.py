"""The scheduler of certificates: what is certified in a frame, in which order, and when that ends.

A frame calls it after its primary rays and before it shades (`run`):

1. Primary hits request what they are about to need, tile by tile.  That ends with SEARCH of the time.
2. Requests of the last frame's other rays, those of reflections for the most part, are added.
3. All are gathered into tasks; of the time left, GATHER may be spent on that.
4. Tasks are run in rounds, those with most requests first: a round's tasks, then their parts.  That ends with the
   budget, of certificates or of time.

Where there is no time for all tiles, or for all lists of requests, the next frame begins with the others.  Batches of
tasks grow with what tasks have just taken, so that a frame ends in time.

With a budget of certificates alone everything repeats exactly, for any number of threads: so a cancelled frame leaves
no certificates and no requests behind.  With a budget of time it is up to chance how many there are, though never what
is seen.  Then a cancelled frame keeps what it has certified, and its requests: in motion frames are given up all the
time, and nothing would ever be certified otherwise.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.certified.cost_model import CostModel
from tracer.neighbours.certified.gather_requests import RequestPoints
from tracer.neighbours.certified.journal import Journal
from tracer.neighbours.certified.requests import Requests, make_requests
from tracer.neighbours.certified.store import BATCH, CertificateStore
from tracer.runtime.parallel import for_each_chunk
from tracer.visibility.budget import CERTIFICATES, COUNTERS, Budget, Counts

SEARCH = 0.5  # of a frame's time for certificates, at most, in which primary hits make requests
GATHER = 0.5  # of the time that is left then, at most, in which these are gathered
SHARES, SHARE = 8, 6  # of all tiles that each thread takes to look for requests; tiles of one, at least
FIRST, FASTER = 8, 8  # tasks of a frame's first batch, where time counts, and how many times as many the next may have
LEAST = 5e-4  # seconds: less time is not worth a batch
MANY = 1 << 14  # requests, as which fewer are timed
RARE = 1e-3  # certificates for each shadow ray due, in the last frame: with fewer there is time to be EAGER
EAGER = 8  # times fewer requests are asked for then, where rays are costly


# Let the primary hits of tiles with these numbers make requests, in their rows of these arrays.
RequestInTiles = Callable[[NDArray[np.int64], Requests], None]


class CertificateScheduler:
    """Decides what a store certifies.  `clock` tells seconds."""

    def __init__(self, store: CertificateStore, clock: Callable[[], float] = time.perf_counter) -> None:
        self._store, self._clock = store, clock
        self._begin()

    def _begin(self) -> None:
        """Begin with nothing known, as the store does."""
        self._restarts = self._store.restarts
        self._pending: list[Requests] = []  # what the last frame's rays requested, and cells have these numbers:
        self._numbering = self._store.numbering
        self._requests: Requests | None = None  # of the frame under way
        self._keeps = False  # what a frame certifies, even if it is cancelled
        self._first_tile = 0  # to be looked at in the next frame
        self._first_list = 0  # of requests, to be gathered in the next frame
        self._pace = 5e-8  # seconds that a request took to be gathered, the slowest of late
        self._rate = np.inf  # certificates that the last frame made, for each shadow ray due

    # --- a frame ----------------------------------------------------------------------------------------

    def begin(self, tiles: int, budget: Budget) -> Requests:
        """A frame of so many tiles begins: room for the requests of the rays that it shades.

        It ends with `keep` or `cancel`; one that does not has kept its certificates once the next begins."""
        if self._store.restarts != self._restarts:
            self._begin()
        self._keeps = budget.seconds < np.inf
        self._store.journal = None if self._keeps else Journal(self._store.cells)
        self._requests = make_requests(tiles)
        return self._requests

    def run(self, tiles: int, request: RequestInTiles, budget: Budget, cancel: Callable[[], bool] | None) -> Counts:
        """Certify what the primary hits of so many tiles, and rays of the last frame, request.

        Raises Cancelled if `cancel` turns true meanwhile."""
        start = self._clock()
        found = make_requests(tiles)
        self._search(tiles, request, found, start + SEARCH * budget.seconds, cancel)
        pending = self._pending if self._numbering == self._store.numbering else []
        return self._certify([found, *pending], budget, start + budget.seconds, cancel)

    def keep(self, requests: Requests) -> None:
        """The frame is whole: what it certified stays, and what its rays requested comes next.

        Call this before cells get other numbers (`CertificateStore.keep_within`)."""
        self._store.journal = None
        self._pending, self._numbering, self._requests = [requests], self._store.numbering, None

    def finish(self, made: int, due: int) -> None:
        """The frame made so many certificates, and so many shadow rays were due."""
        self._rate = made / due if due else np.inf

    def cancel(self, requests: Requests, shaded: bool) -> bool:
        """The frame is given up, after some of it was `shaded` or before: whether its certificates are kept.

        Nothing happens if another has begun since."""
        if requests is not self._requests:
            return False
        self._requests = None
        if not self._keeps:
            self._store.undo()
        elif shaded:
            self.keep(requests)
        return self._keeps

    # --- its parts --------------------------------------------------------------------------------------

    def _search(
        self, tiles: int, request: RequestInTiles, found: Requests, until: float, cancel: Callable[[], bool] | None
    ) -> None:
        """Let primary hits make requests, until there is no more time."""
        threads = self._store.threads
        order = (self._first_tile + np.arange(tiles)) % tiles
        shares = np.array_split(order, max(1, min(SHARES * threads, tiles // SHARE)))
        looked_at: list[int] = []

        def work(chunk: int, worker: int) -> None:
            if self._clock() < until:
                request(shares[chunk], found)
                looked_at.append(len(shares[chunk]))

        for_each_chunk(work, len(shares), threads, cancel)
        self._first_tile = (self._first_tile + sum(looked_at)) % tiles

    @property
    def cost_model(self) -> CostModel:
        """What certificates are worth now: more than usual where rays are costly and there is little to certify."""
        usual = self._store.cost_model
        if self._rate >= RARE or not usual.costly_rays:
            return usual
        return usual._replace(
            root_requests=-(-usual.root_requests // EAGER), split_requests=-(-usual.split_requests // EAGER)
        )

    def _certify(
        self, lists: list[Requests], budget: Budget, until: float, cancel: Callable[[], bool] | None
    ) -> Counts:
        """Gather requests, and certify what they ask for, within the budget."""
        store, model = self._store, self.cost_model
        counts = np.zeros((store.threads, COUNTERS), np.int64)
        if not store.count:
            return Counts()
        todo, points = self._gather(lists, model, until)
        # A cell is certified for all its lights, but light by light where the budget does not pay for all.
        lights = store.count if budget.certificates >= store.count else 1
        batch = FIRST if until < np.inf else BATCH
        while len(todo):
            todo = todo[np.argsort(todo[:, 1] - todo[:, 2], kind="stable")]  # most requests first
            following, first = [], 0
            while first < len(todo):
                start = self._clock()
                left = budget.certificates - counts[:, CERTIFICATES].sum()
                batch = int(min(batch, left / lights))
                if batch <= 0 or start > until - LEAST:
                    return Counts(*counts.sum(0).tolist())
                those = todo[first : first + batch]
                following.append(store.certify(those, points, model, lights, counts, cancel))
                first += batch
                # Plan half of the time that is left by what a task has just taken.
                pace = max(1e-6, (self._clock() - start) / len(those))
                batch = int(min(BATCH, FASTER * batch, 0.5 * (until - self._clock()) / pace))
            todo = np.concatenate(following)
        return Counts(*counts.sum(0).tolist())

    def _gather(self, lists: list[Requests], model: CostModel, until: float) -> tuple[NDArray[np.int32], RequestPoints]:
        """Tasks (n, 3) for requests: where time is short those of some lists, and in the next frame those of others."""
        kept = [(requests, tile, n) for requests in lists for tile, n in enumerate(requests.of[:, 0].tolist()) if n]
        room = GATHER * max(LEAST, until - self._clock()) / self._pace
        if sum(n for _, _, n in kept) > room:
            first = self._first_list % len(kept)
            kept = kept[first:] + kept[:first]
            kept = kept[: max(1, int(np.searchsorted(np.cumsum([n for _, _, n in kept]), room)))]
            self._first_list = first + len(kept)
        none = [np.empty(0, np.int32), np.empty(0, np.float32), np.empty(0, np.float32)]
        key, u, v = (
            np.concatenate([none[k], *(requests[k][tile, :n] for requests, tile, n in kept)]) for k in range(3)
        )
        start = self._clock()
        gathered = self._store.gather(key, u, v, model.root_requests)
        self._pace = max(0.5 * self._pace, (self._clock() - start) / max(MANY, len(key)))
        return gathered

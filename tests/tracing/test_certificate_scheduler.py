"""What is certified in a frame and what must wait, by a clock that passes as the test says."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import tracer
from tests.tracing.shades import floor, roof
from tests.tracing.worlds import scene
from tracer.culling.rest import nothing_rests
from tracer.neighbours.certified.cells import NOBODY, ROOTS
from tracer.neighbours.certified.cost_model import CostModel
from tracer.neighbours.certified.requests import Requests
from tracer.neighbours.certified.scheduler import LEAST, MANY, CertificateScheduler
from tracer.neighbours.certified.store import CertificateStore
from tracer.scene.lights import LampTable
from tracer.visibility.budget import Budget

LIGHTS = np.array([(0.0, 0.0, 11.0), (1.0, -1.0, 10.0)], np.float32)
SQUARES = scene(floor() + roof(6.0, 1.0), lights=LIGHTS)
FLOOR = 128  # triangles, the first ones
WHOLE = CostModel(1, 1_000_000, 0, 0, True, 1)  # a root for each triangle at once, which is never divided
NOTHING = Budget(seconds=0.0)


class Clock:
    """Seconds that pass by so many at each reading, and when somebody waits."""

    def __init__(self, step: float = 0.0) -> None:
        self.now, self.step = 0.0, step

    def __call__(self) -> float:
        self.now += self.step
        return self.now

    def wait(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture(scope="module")
def world() -> tracer.World:
    return tracer.World(SQUARES)


def _store(world: tracer.World, model: CostModel = WHOLE) -> CertificateStore:
    store = CertificateStore(world, len(LIGHTS), 1, model)
    store.update(LampTable(SQUARES.lights).at(LIGHTS), nothing_rests(1), 1)
    return store


def _ask(requests: Requests, tile: int, triangle: int, count: int = 1) -> None:
    """A tile requests the front of a triangle, so many times."""
    n = int(requests.of[tile, 0])
    requests.key[tile, n : n + count] = -1 - 2 * triangle
    requests.u[tile, n : n + count] = requests.v[tile, n : n + count] = 0.25
    requests.of[tile, 0] += count


def _triangle_of_tile(numbers: np.ndarray, requests: Requests) -> None:
    """Each tile sees the triangle of its number."""
    for tile in numbers.tolist():
        _ask(requests, tile, tile)


def _no_requests(numbers: np.ndarray, requests: Requests) -> None:
    """Nothing is seen."""


def _frame(
    scheduler: CertificateScheduler,
    tiles: int,
    request: Callable[[np.ndarray, Requests], None],
    budget: Budget,
    shaded: Callable[[Requests], None] = lambda requests: None,
) -> int:
    """A whole frame, of which shaded rays make requests as well; how many certificates it made."""
    requests = scheduler.begin(tiles, budget)
    made = scheduler.run(tiles, request, budget, None).certificates
    shaded(requests)
    scheduler.keep(requests)
    scheduler.finish(made, 1000)
    return made


def _rooted(store: CertificateStore) -> list[int]:
    """The triangles with cells."""
    return np.flatnonzero(store.cells.rooted).tolist()


def _certified(store: CertificateStore) -> list[int]:
    """The triangles whose cells have certificates for all lights."""
    roots = store.cells.receivers.view(np.int32)[:, ROOTS]
    states = store.cells.words[roots] >> 2
    return np.flatnonzero((roots > 0) & (states & 3 > 0) & (states >> 2 & 3 > 0)).tolist()


def test_a_budget_of_certificates_goes_to_what_is_requested_most(world: tracer.World) -> None:
    store = _store(world)
    scheduler = CertificateScheduler(store, Clock())

    def request(numbers: np.ndarray, requests: Requests) -> None:
        for tile in numbers.tolist():
            _ask(requests, tile, tile, 1 + 7 * tile % 10)

    assert _frame(scheduler, 10, request, Budget(6)) == 6
    assert _certified(store) == [1, 4, 7]  # with 8, 9 and 10 requests
    assert _frame(scheduler, 10, request, Budget(100)) == 2 * 7
    assert _certified(store) == list(range(10))


def test_a_budget_smaller_than_the_number_of_lights_is_spent_light_by_light(world: tracer.World) -> None:
    store = _store(world)
    scheduler = CertificateScheduler(store, Clock())
    made = [_frame(scheduler, 3, _triangle_of_tile, Budget(1)) for _ in range(8)]
    assert made == [1, 1, 1, 1, 1, 1, 0, 0] and _certified(store) == [0, 1, 2]
    assert _frame(CertificateScheduler(_store(world), Clock()), 3, _triangle_of_tile, Budget(0)) == 0


def test_time_ends_work_and_the_next_frame_goes_on(world: tracer.World) -> None:
    store, clock = _store(world), Clock(step=2e-3)
    scheduler, made = CertificateScheduler(store, clock), []

    def request(numbers: np.ndarray, requests: Requests) -> None:
        _triangle_of_tile(np.setdiff1d(numbers, _certified(store)), requests)

    while sum(made) < 2 * FLOOR and len(made) < 100:
        start = clock.now
        made.append(_frame(scheduler, FLOOR, request, Budget(seconds=0.04)))
        assert clock.now - start < 0.04 + 3 * clock.step
    assert _certified(store) == list(range(FLOOR)) and len(made) > 1
    other = CertificateScheduler(_store(world), Clock())
    assert _frame(other, FLOOR, _triangle_of_tile, Budget(seconds=LEAST / 2)) == 0


def test_tiles_without_time_come_first_in_the_next_frame(world: tracer.World) -> None:
    store, clock = _store(world), Clock()
    scheduler, tiles, frames = CertificateScheduler(store, clock), 50, []

    def request(numbers: np.ndarray, requests: Requests) -> None:
        frames[-1].update(numbers.tolist())
        clock.wait(len(numbers))
        _triangle_of_tile(numbers, requests)

    for _ in range(4):
        frames.append(set())
        _frame(scheduler, tiles, request, Budget(seconds=20.0))  # half of it to look for requests
    assert all(10 <= len(frame) < 20 for frame in frames)
    assert set().union(*frames) == set(range(tiles)) and not frames[0] & frames[1]
    assert _certified(store) == list(range(tiles))


def test_what_shaded_rays_request_comes_in_the_next_frame(world: tracer.World) -> None:
    store = _store(world)
    scheduler = CertificateScheduler(store, Clock())
    made = [
        _frame(scheduler, 2, _no_requests, Budget(), lambda requests: _ask(requests, 1, 40)),
        _frame(scheduler, 2, _no_requests, Budget()),
        _frame(scheduler, 2, _no_requests, Budget()),
    ]
    assert made == [0, 2, 0] and _certified(store) == [40]


def test_lists_of_requests_without_time_come_first_in_the_next_frame(world: tracer.World) -> None:
    """At the pace that the clock shows there is time for four lists in each frame."""
    store = _store(world)
    scheduler = CertificateScheduler(store, Clock(step=5e-8 * MANY))

    def shaded(requests: Requests) -> None:
        for tile in range(10):
            _ask(requests, tile, 10 + tile, 1100)

    _frame(scheduler, 10, _no_requests, NOTHING, shaded)
    assert _rooted(store) == []
    seen = []
    for _ in range(3):
        _frame(scheduler, 10, _no_requests, NOTHING, shaded)
        seen.append(len(_rooted(store)))
    assert seen == [4, 8, 10]


def test_requests_mean_nothing_once_cells_have_other_numbers(world: tracer.World) -> None:
    store = _store(world)
    scheduler = CertificateScheduler(store, Clock())
    _frame(scheduler, 4, _triangle_of_tile, Budget())
    cells = int(store.cells.used[0])

    def shaded(requests: Requests) -> None:
        requests.key[0, 0], requests.of[0, 0] = cells - 1, 1

    _frame(scheduler, 4, _no_requests, Budget(), shaded)
    store.keep_within(0.0, np.zeros(1, np.int32))
    assert int(store.cells.used[0]) == 1
    assert _frame(scheduler, 4, _no_requests, Budget()) == 0 and int(store.cells.used[0]) == 1


# --- frames that are given up -------------------------------------------------------------------------


def _contents(store: CertificateStore) -> dict[str, bytes]:
    """All that a store knows, but for what nobody reads."""
    cells, used, named = store.cells, int(store.cells.used[0]), int(store.cells.named[0])
    kept = {name: getattr(cells, name)[:used] for name in ("words", "child", "parent", "owner", "place", "requests")}
    kept |= {"lists": cells.lists[:used], "names": cells.names[:named], "waiting": cells.waiting}
    kept |= {"receivers": cells.receivers, "rooted": cells.rooted}
    return {name: value.tobytes() for name, value in kept.items()}


def test_what_a_cancelled_frame_certified_is_undone(world: tracer.World) -> None:
    """Also of cells that were there before: some lose their certificates first, and others are divided."""
    rng, model = np.random.default_rng(3), CostModel(2, 3, 2, 8, True, 1)
    store = _store(world, model)
    scheduler = CertificateScheduler(store, Clock())

    def request(numbers: np.ndarray, requests: Requests) -> None:
        for tile in numbers.tolist():
            _ask(requests, tile, int(rng.integers(FLOOR)), int(rng.integers(1, 40)))
            n = int(requests.of[tile, 0])
            requests.u[tile, :n], requests.v[tile, :n] = 0.5 * rng.random((2, n))

    undone = 0
    for _ in range(12):
        _frame(scheduler, 20, request, Budget(60), lambda requests: _ask(requests, 0, int(rng.integers(FLOOR)), 5))
        used = int(store.cells.used[0])
        for cell in rng.integers(1, used, used // 4).tolist():  # as if something had moved
            light = int(rng.integers(len(LIGHTS)))
            store.cells.words[cell] &= ~store.cells.words.dtype.type(3 << (2 + 2 * light))
            store.cells.lists[cell, light] = NOBODY
        before = _contents(store)
        requests = scheduler.begin(20, Budget())
        undone += scheduler.run(20, request, Budget(), None).certificates
        assert _contents(store) != before
        assert not scheduler.cancel(requests, shaded=True)
        assert _contents(store) == before
    assert undone > 500 and (store.cells.child[: int(store.cells.used[0])] > 0).any()


def test_with_a_budget_of_time_a_cancelled_frame_keeps_what_it_has(world: tracer.World) -> None:
    store = _store(world)
    scheduler, budget = CertificateScheduler(store, Clock()), Budget(seconds=1.0)
    requests = scheduler.begin(4, budget)
    assert scheduler.run(4, _triangle_of_tile, budget, None).certificates == 8
    _ask(requests, 0, 50)
    assert scheduler.cancel(requests, shaded=True)
    assert _certified(store) == [0, 1, 2, 3]
    assert _frame(scheduler, 4, _no_requests, budget) == 2 and 50 in _certified(store)


def test_a_frame_given_up_after_another_has_begun_changes_nothing(world: tracer.World) -> None:
    store = _store(world)
    scheduler = CertificateScheduler(store, Clock())
    late = scheduler.begin(4, Budget())
    scheduler.run(4, _triangle_of_tile, Budget(), None)
    _frame(scheduler, 8, _triangle_of_tile, Budget())
    assert not scheduler.cancel(late, shaded=True)
    assert _certified(store) == list(range(8))

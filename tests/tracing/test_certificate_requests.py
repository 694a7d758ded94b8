"""From requests to tasks: which cells are begun with, and what tasks leave to others."""

from __future__ import annotations

import numpy as np
import pytest

import tracer
from tests.tracing.shades import BEHIND, floor, roof
from tests.tracing.worlds import certificates_of, scene
from tracer.culling.modes import FULLY_RENDERED
from tracer.neighbours.certified.cells import ALONG_U, CANDIDATES, CORNER, FULL, LIT, NORMAL, ROOTS, TOO_MANY
from tracer.neighbours.certified.cost_model import CostModel
from tracer.neighbours.certified.gather_requests import RequestPoints, gather_tasks
from tracer.neighbours.certified.store import CertificateStore
from tracer.neighbours.certified.tasks import KEPT, commit, make_tasks, tasks_in

# The last light is below the floor: no cell there waits for it.
LIGHTS = [(0.0, 0.0, 11.0), (1.0, -1.0, 10.0), (0.0, 0.0, -4.0)]
SQUARES = scene(floor() + roof(6.0, 1.0), lights=LIGHTS, camera=BEHIND)
SETTINGS = tracer.Settings(96, 64, 2, "certified", threads=1)
EAGER = CostModel(2, 4, 2, 8, True, 1)  # small pictures are to have many certificates on either structure


@pytest.fixture
def certificates() -> CertificateStore:
    """Of squares, with a quadtree on each that rays have asked for."""
    renderer = tracer.Renderer(SQUARES, SETTINGS, cost_model=EAGER)
    for _ in range(4):
        renderer.render()
    store = certificates_of(renderer)
    assert store is not None
    return store


def _first_untried(c: CertificateStore, cell: int) -> int:
    """Naive twin: upwards from a cell, as long as the whole waits for a light that its part waits for."""

    def waits(number: int) -> set[int]:
        owner = int(c.cells.owner[number])
        row = c.cells.receivers[owner >> 1]
        above = (c.lights - row[CORNER : CORNER + 3]) @ row[NORMAL : NORMAL + 3] * (-1 if owner & 1 else 1)
        states = [(int(c.cells.words[number]) >> (2 + 2 * light)) & 3 for light in range(len(LIGHTS))]
        return {light for light in range(len(LIGHTS)) if above[light] > 0 and states[light] == 0}

    parent, waiting = int(c.cells.parent[cell]), waits(cell)
    while parent and waits(parent) & waiting:
        cell, parent = parent, int(c.cells.parent[parent])
    return cell


def test_points_are_gathered_by_the_cell_to_begin_with(certificates: CertificateStore) -> None:
    c, rng = certificates, np.random.default_rng(5)
    cells, used = c.cells, int(c.cells.used[0])
    assert used > 100 and (cells.parent[1:used] > 0).any()
    for number in range(1, used):  # forget some of what is certified: whole branches, and cells within others
        if rng.random() < 0.4:
            cells.words[number] &= ~cells.words.dtype.type(3 << (2 + 2 * int(rng.integers(len(LIGHTS)))))
    moved = int(cells.owner[used - 1]) >> 1  # as if it had begun to move, and stopped: what it had is nobody's
    cells.rooted[moved] = 0
    cells.receivers.view(np.int32)[moved, ROOTS : ROOTS + 2] = 0
    bare = [o for o in range(len(cells.waiting)) if cells.receivers.view(np.int32)[o >> 1, ROOTS + (o & 1)] == 0]
    requested_by_some, requested_by_few = 2 * moved, next(o for o in bare if o >> 1 != moved)
    cells.waiting[requested_by_some], cells.waiting[requested_by_few] = 4, 0
    key = rng.integers(1, used, 3000).astype(np.int32)
    key[rng.choice(len(key), 40, replace=False)] = -1 - requested_by_some
    key[np.flatnonzero(key > 0)[:3]] = -1 - requested_by_few
    u, v = rng.random((2, len(key)), np.float32)
    expected: dict[int, set[tuple[float, float]]] = {}
    for k, x, y in zip(key.tolist(), u.tolist(), v.tolist(), strict=True):
        if k > 0 and int(cells.owner[k]) >> 1 != moved:
            expected.setdefault(_first_untried(c, k), set()).add((x, y))
        elif k == -1 - requested_by_some:
            expected.setdefault(used, set()).add((x, y))  # the root that is made
    points = RequestPoints(np.empty_like(u), np.empty_like(v), np.empty((2, len(u)), np.float32))
    slots = np.zeros(len(cells.words) + len(cells.waiting), np.int32)
    tasks = gather_tasks(cells, c.occluders, c.lights, c.stationary, key, u, v, 20, slots, points)
    found = {int(cell): set(zip(points.u[a:b].tolist(), points.v[a:b].tolist(), strict=True)) for cell, a, b in tasks}
    assert len(found) == len(tasks) and found == expected
    assert any(_first_untried(c, k) != k for k in key[key > 0].tolist()), "some are part of a whole"
    assert not slots.any()
    assert int(cells.used[0]) == used + 1 and int(cells.owner[used]) == requested_by_some and cells.rooted[moved]
    assert cells.waiting[requested_by_few] == 3 and np.any(cells.receivers[moved, ALONG_U : ALONG_U + 3])


def test_a_task_within_another_leaves_what_that_has_found(certificates: CertificateStore) -> None:
    cells = certificates.cells
    whole = next(n for n in range(1, int(cells.used[0])) if cells.child[n] >= 0)
    part = int(cells.child[whole])
    word = cells.words.dtype.type(FULLY_RENDERED)
    cells.words[whole] = cells.words[part : part + 4] = word
    tasks = tasks_in(make_tasks(2, len(LIGHTS)), np.array([[whole, 0, 1], [part, 1, 2]], np.int32))
    tasks.state[:], tasks.amount[:], tasks.parts[:], tasks.doubt[:] = KEPT, 0, 0, False
    tasks.state[0, 0], tasks.amount[0, 0], tasks.names[0, 0, 0] = FULL, 1, 3
    tasks.state[1, 0], tasks.amount[1, 0] = CANDIDATES, TOO_MANY
    tasks.state[1, 1], tasks.amount[1, 1] = LIT, 0
    commit(cells, certificates.occluders, certificates.scale, tasks, np.empty((8, 3), np.int32))
    assert certificates.at_pixels(np.array([part])) == word | FULL << 2 | LIT << 4
    assert certificates.at_pixels(np.array([whole])) == word | FULL << 2

"""Slack is a true lower bound, and regret is what the smallest cells could have answered."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.sweeps import cases
from tests.tracing.shades import BEHIND, floor, roof
from tests.tracing.worlds import certificates_of, random_corners, scene
from tracer.culling.fate import FATE, Fate
from tracer.inspect.proofs_at_pixels import regret_at_pixels, slack_at_pixels
from tracer.neighbours.certified.cost_model import CostModel
from tracer.neighbours.certified.proofs import as_json, prism_of, proofs_of
from tracer.neighbours.certified.slack import SlackFinder, proved_cells, smallest_at
from viewer.output.proof_checker import Checker

SETTINGS = tracer.Settings(48, 36, 0, "certified", threads=2, record_fates=True)
EAGER = CostModel(2, 4, 2, 8, True, 1)
LIGHTS = [(0.4, -0.2, 11.0), (2.0, -3.0, 7.0)]


def _strewn(seed: int, nasty: bool = True) -> tracer.Scene:
    """A floor, a roof that two triangles make, and small triangles strewn between them, nasty ones among them."""
    rng = np.random.default_rng(seed)
    loose = random_corners(rng, 12, 0.2) if nasty else rng.random((8, 1, 3)) + rng.normal(size=(8, 3, 3)) * 0.2
    loose = loose * 4.0 + (-2.0, -2.0, 1.0)
    return scene([*floor(4), *roof(6.0, 1.0), *loose], lights=LIGHTS, camera=BEHIND)


def _traced(made: tracer.Scene, frames: int = 4, **more) -> tuple[tracer.Renderer, tracer.Frame]:
    renderer = tracer.Renderer(made, replace(SETTINGS, **more), cost_model=EAGER)
    for _ in range(frames):
        frame = renderer.render()
    return renderer, frame


@pytest.mark.parametrize("seed", range(cases(3, 60)))
def test_a_certificate_holds_exactly_while_its_light_moves_by_less_than_its_slack(seed: int) -> None:
    renderer, frame = _traced(_strewn(seed))
    store, rng = certificates_of(renderer), np.random.default_rng(seed)
    assert store is not None and frame.cells is not None
    seen, finder, tried, large = np.unique(frame.cells[frame.cells > 0]).tolist(), SlackFinder(store), 0, 0
    told, proofs = proofs_of(store, seen), as_json(store, seen, len(renderer.world.primitives.triangles))
    for k in rng.permutation(len(told))[:60]:
        proof = proofs["proofs"][k]
        slack = float(finder.of_cells(np.array([told[k].cell], np.int32), told[k].light)[0])
        large += slack > 0.05
        for way in rng.normal(size=(3, 3)):
            lights = np.array(proofs["lights"])
            lights[proof["light"]] += 0.99 * slack * way / np.linalg.norm(way)
            checker = Checker(proofs | {"lights": lights.tolist(), "proofs": [proof]})
            assert checker.check(checker.proofs[0]).holds, (proof, slack)
            tried += 1
    assert tried > 100 and large > 20, (tried, large)


def test_slack_is_how_far_the_light_is_from_planes_through_the_cell_and_an_edge_of_what_hides_it() -> None:
    """Of cells that one triangle hides: no further than from the nearest of these planes, and little less."""
    hood = [(-9.0, -8.0, 5.0), (9.0, -8.0, 5.0), (0.0, 9.0, 5.0)]
    renderer, frame = _traced(scene([*floor(1), hood], lights=[(0.5, 0.0, 10.0)], camera=BEHIND))
    store = certificates_of(renderer)
    assert store is not None and frame.cells is not None
    slack, light, tried = slack_at_pixels(renderer, frame, 0), store.lights[0].astype(np.float64), 0
    for y, x in np.argwhere((frame.primitive < 2) & (slack > 0.0)):
        cell = proved_cells(store.cells, frame.cells[y, x : x + 1], 0)[0]
        sides = [
            (np.subtract(hood[k], p), np.subtract(hood[k - 1], p), p) for k in range(3) for p in prism_of(store, cell)
        ]
        planes = [(np.cross(a, b), p) for a, b, p in sides]
        away = min(abs(n @ (light - p)) / np.linalg.norm(n) for n, p in planes)
        assert 0.95 * min(away, SlackFinder(store).most) < slack[y, x] < away
        tried += 1
    assert tried > 100


def test_slack_is_of_no_other_cell_after_cells_were_dropped() -> None:
    """Those that stay get other numbers, and the frame knows the old ones."""
    renderer, frame = _traced(_strewn(1, nasty=False), frames=3)
    store = certificates_of(renderer)
    assert store is not None and frame.cells is not None
    before = slack_at_pixels(renderer, frame, 0)
    number, numbering = store.cells.used[0], store.numbering
    store.keep_within(0.9 * store.bytes, frame.cells[:18].ravel())
    assert store.numbering > numbering and number // 2 < store.cells.used[0] < number
    after = slack_at_pixels(renderer, frame, 0)
    assert ((after == before) | (after == -1.0)).all() and (after != before).any()


def _crossed(triangles: np.ndarray, start: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(ends, triangles) which segments cross which triangles (t, 9), in double precision."""
    a, e1, e2 = triangles[:, :3], triangles[:, 3:6], triangles[:, 6:]
    d, s = ends[:, None] - start, start - a
    u, v = (d * np.cross(e2, s)).sum(-1), (d * np.cross(s, e1)).sum(-1)
    n = np.cross(e1, e2)
    along, t = -(d * n).sum(-1), (s * n).sum(-1)
    side = np.sign(along)
    inside = np.minimum(np.minimum(u * side, v * side), (along - u - v) * side) > 0
    return inside & (t * side > 0) & (t * side < along * side)


def test_regret_is_a_naive_count() -> None:
    """Of the few certificates that a frame may make, most rays are left to be traced: those are regretted of which one
    triangle hides all corners of the smallest prism, or none hides any."""
    renderer, frame = _traced(_strewn(1, nasty=False), frames=2, certificates=10)
    store, parts = certificates_of(renderer), list[float]()
    assert store is not None and frame.fates is not None
    regret, work = regret_at_pixels(renderer, frame, report=parts.append), renderer.work_on(frame)
    expected = np.zeros((36, 48), np.int32)
    assert len(parts) > 3 and min(parts) < 0.5 and max(parts) == 1.0
    triangles, highest = store.occluders.rows[:, :9].astype(np.float64), store.scale.max_height
    eye = np.asarray(work.rays.origin, np.float64)
    for y, x in np.argwhere(frame.primitive >= 0):
        k = int(frame.primitive[y, x])
        a, e1, e2 = triangles[k].reshape(3, 3)
        shortest, levels = min(np.linalg.norm(e1), np.linalg.norm(e2)), 0
        while levels < 12 and shortest * 0.5 ** (levels + 1) > 8.0 * highest:
            levels += 1
        ((u, v, size),) = smallest_at(work.buffers.u[y, x : x + 1], work.buffers.v[y, x : x + 1], [levels])
        normal = np.cross(e1, e2) / np.linalg.norm(np.cross(e1, e2))
        normal = normal if normal @ (eye - a) > 0 else -normal
        base = a + np.array([(u, v), (u + size, v), (u, v + size)]) @ np.stack([e1, e2])
        prism = np.concatenate([base + height * normal for height in (0.1 * highest, highest)])
        for light, place in enumerate(store.lights.astype(np.float64)):
            if frame.fates[y, x, light] & FATE != Fate.TRACED:
                continue
            crossed = _crossed(triangles, place, prism)
            expected[y, x] += crossed.all(axis=0).any() or not crossed.any()
        if np.abs(base).max() < 1.0:  # near the origin rays end too low to tell on which side of their own triangle
            expected[y, x] = regret[y, x]
    hit = frame.primitive >= 0
    assert (regret[~hit] == -1).all()
    assert expected.sum() > 200 and (regret[hit] != expected[hit]).sum() <= 3, "where a shadow's edge is in a prism"
    assert abs(int(regret[hit].sum()) - int(expected.sum())) <= 3


def test_nothing_is_regretted_where_all_is_proved() -> None:
    far = [(20.0, 20.0, 0.0), (21.0, 20.0, 0.0), (20.0, 21.0, 0.0)]  # where rays end high enough for cells
    made = scene([*floor(2), far], lights=LIGHTS, camera=BEHIND)
    renderer, frame = _traced(made, frames=6)
    assert frame.statistics.shadow.due > 300 and frame.statistics.shadow.traced == 0
    regret = regret_at_pixels(renderer, frame)
    assert regret.max() == 0 and (regret == 0).any()
    with pytest.raises(LookupError, match="no certificates"):
        slack_at_pixels(tracer.Renderer(made, SETTINGS), frame, 0)


def test_points_lie_in_the_smallest_cells_that_are_told() -> None:
    rng = np.random.default_rng(3)
    u, v = rng.dirichlet((1, 1, 1), 500)[:, :2].T
    u[:3], v[:3] = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    for levels in (0, 1, 5):
        place = smallest_at(u, v, np.full(len(u), levels)).astype(np.float64)
        x, y = (u - place[:, 0]) / place[:, 2], (v - place[:, 1]) / place[:, 2]
        assert np.all((x > -1e-6) & (y > -1e-6) & (x + y < 1 + 1e-6)) and np.all(np.abs(place[:, 2]) == 0.5**levels)

"""Certificates against what rays really meet: cells strewn densely with points, and a search near their edges."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import event, given
from hypothesis import strategies as st

import tracer
from tests.scenes import loaded
from tests.sweeps import ACCELERATORS, ALL, cases
from tests.tracing.certified_twin import NAMES, Twin
from tests.tracing.nasty_worlds import nasty_walk, static_part
from tests.tracing.random_worlds import quickly
from tests.tracing.worlds import certificates_of, quad, scene
from tracer.neighbours.certified.cells import CANDIDATES, FULL, LIT
from tracer.neighbours.certified.cost_model import CostModel
from tracer.scene.model import Camera

STATES = (FULL, LIT, CANDIDATES)
EAGER = CostModel(2, 4, 0, 8, True, 1)  # small pictures are to have many certificates on either structure


def _chosen(twin: Twin, rng: np.random.Generator, each: int) -> np.ndarray:
    """Some certificates of each kind, (n, 3)."""
    made = twin.certificates_made()
    return np.concatenate([rng.permutation(made[made[:, 2] == state])[:each] for state in STATES])


def _certified(made: tracer.Scene, size: int, frames: Sequence[tuple[float, Camera]], accelerator: str) -> Twin:
    """Certificates of a scene in which nothing moves, as some frames leave them."""
    settings = tracer.Settings(size, size, 2, "certified", accelerator=accelerator, threads=1)
    certified = tracer.Renderer(made, settings, cost_model=EAGER)
    for time, camera in frames:
        certified.render(time, camera)
    store = certificates_of(certified)
    assert store is not None
    return Twin(made, store, made.light_positions(frames[-1][0]))


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_cells_of_nasty_scenes_are_what_dense_sampling_says(accelerator: str):
    tried = np.zeros(4, int)
    for seed in range(cases(8, 20)):
        walk, rng = nasty_walk(seed), np.random.default_rng(seed)
        frames = [(0.0, camera) for _, camera in walk.frames]
        twin = _certified(static_part(walk.scene), 24, frames, accelerator)
        assert not twin.failures(_chosen(twin, rng, 8), rng, 200), f"seed {seed}"
        tried += twin.tried
    assert (tried[list(STATES)] > cases(1000, 5000)).all()


@pytest.mark.skipif(not ALL, reason="left to make test-all")
def test_cells_of_kitchen_are_what_dense_sampling_says(bart: Path):
    """Without what moves; every tenth certificate against every triangle in turn."""
    whole = loaded(bart / "kitchen" / "kitchen.aff")
    frames = [(whole.frame_time(0), whole.camera_at(whole.frame_time(number))) for number in (0, 60, 65, 300, 500)]
    twin, rng = _certified(static_part(whole), 64, frames, "kdtree"), np.random.default_rng(0)
    chosen = _chosen(twin, rng, 100)
    assert not twin.failures(chosen, rng, 200, brute=False)
    assert (twin.tried[list(STATES)] > 5000).all()
    assert not twin.failures(chosen[::30], rng, 40)


# --- near the edges of beams ------------------------------------------------------------------------

ULPS = st.integers(-40, 40)
FRACTIONS = st.sampled_from([1e-4, 0.1, 0.5, 0.9, 0.999, 0.9999]) | st.floats(0.01, 0.99)
GRID = st.integers(0, 8)  # eighths of the floor's edges, where cells begin and end


def _moved_by_ulps(x: np.ndarray, ulps: tuple[int, ...]) -> np.ndarray:
    """Numbers (3,), so many steps of float32 from where they were."""
    x = np.asarray(x, np.float32)
    return x + np.array(ulps, np.float32) * np.spacing(np.maximum(np.abs(x), np.float32(1e-3)))


@st.composite
def _occluders(draw: st.DrawFn, light: np.ndarray, lift: float) -> np.ndarray:
    """A triangle (3, 3) an edge or corner of which, seen from the light, all but touches the border of a cell of the
    floor: right above it, or as high as rays end there; or that hides all of it, and all but nothing else."""
    kind = draw(st.sampled_from(["edge", "edge", "corner", "cover", "sliver", "in line"]))
    t, up = draw(FRACTIONS), draw(st.sampled_from([0.0, 0.5, 1.0, 2.0])) * lift
    p, q = (np.array([draw(GRID) / 8, draw(GRID) / 8, up]) for _ in range(2))
    across = draw(st.sampled_from([-1.0, 1.0])) * np.array([q[1] - p[1], p[0] - q[0], 0.0])
    if kind == "edge":
        ends = [p, q, (p + q) / 2 + across]
    elif kind == "corner":
        far = [draw(st.floats(-1, 1)) for _ in range(4)]
        ends = [p, p + np.array([*far[:2], 0.0]), p + np.array([*far[2:], 0.0])]
    elif kind == "cover":
        size = draw(st.sampled_from([1.0, 0.5, 0.25, -0.25]))
        ends = [p, p + np.array([size, 0, 0]), p + np.array([0, size, 0])]
    elif kind == "sliver":
        ends = [p, q, p + draw(st.floats(0, 1)) * (q - p) + across * 10.0 ** draw(st.integers(-8, -3))]
    else:
        ends = [p, q, q]
    corners = [light + t * (end - light) for end in ends]
    if kind == "in line":
        corners[2] = light + draw(st.floats(-0.5, 0.99)) * (q - light)  # the light lies in its plane
    return np.stack([_moved_by_ulps(c, (draw(ULPS), draw(ULPS), draw(ULPS))) for c in corners])


@st.composite
def _searched(draw: st.DrawFn) -> tuple[tracer.Scene, Camera]:
    """A square floor, a light and up to five such occluders, of any size, anywhere."""
    scale, away = 10.0 ** draw(st.integers(-3, 4)), draw(st.sampled_from([0.0, 0.0, 1.0, 50.0]))
    light = np.array([draw(st.floats(-0.5, 1.5)), draw(st.floats(-0.5, 1.5)), draw(st.floats(0.05, 2.0))], np.float32)
    lift = 2e-5 * (1.0 + away)
    occluders = [draw(_occluders(light.astype(np.float64), lift)) for _ in range(draw(st.integers(1, 5)))]
    floor = quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    move = np.array([away, -away, away / 2])
    corners = (np.concatenate([np.array(floor, np.float64), occluders]) + move) * scale
    camera = Camera(tuple((move + np.array([0.5, 0.5, 0.04])) * scale), (0.0, 0.01, -1.0), (0.0, 1.0, 0.0), 170.0)
    return scene(corners, lights=[(light + move) * scale]), camera


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_no_occluder_near_the_edge_of_a_beam_makes_a_certificate_wrong(accelerator: str):
    seen: Counter[str] = Counter()

    @quickly(8)
    @given(_searched())
    def search(searched: tuple[tracer.Scene, Camera]) -> None:
        made, camera = searched
        rng = np.random.default_rng(0)
        twin = _certified(made, 24, [(0.0, camera)], accelerator)
        assert not twin.failures(_chosen(twin, rng, 12), rng, 200)
        for state in STATES:
            if twin.tried[state]:
                seen[NAMES[state]] += 1
                event(NAMES[state])

    search()
    assert set(seen) == set(NAMES.values()), "some kind of certificate was never there"

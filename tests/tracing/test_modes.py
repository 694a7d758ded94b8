"""The packed word, occlusion testing and mode setting, against their naive twins."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.tracing import naive, naive_cells
from tests.tracing.random_worlds import quickly
from tests.tracing.worlds import random_corners, scene
from tracer.culling import cells, modes
from tracer.culling.cells import primitives_are_units
from tracer.culling.mode_history import ModeHistory
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.culling.occlusion import occlusion_testing, set_occlusion_modes
from tracer.geometry.camera import pinhole
from tracer.geometry.rays import Hits
from tracer.scene.lights import LampTable, Light
from tracer.scene.model import Camera


@quickly(100, shrink=True)
@given(st.integers(1, 31), st.data())
def test_a_word_keeps_every_mode_apart(lights, data):
    word = modes.word_type(lights)
    words, gained = np.zeros(1, word), np.zeros((2, 1), word)
    expected = [0] * lights
    words[0] = occlusion = data.draw(st.integers(0, 3))
    for _ in range(data.draw(st.integers(0, 20))):
        light, bit, worker = (data.draw(st.integers(*r)) for r in ((0, lights - 1), (1, 2), (0, 1)))
        gained[worker, 0] |= word(bit << (2 + 2 * light))
        expected[light] |= bit
    modes.merge_words(words, gained)
    assert int(modes.occlusion_mode(words)[0]) == occlusion
    assert [int(modes.shadow_mode(words, light)[0]) for light in range(lights)] == expected


@pytest.mark.parametrize("lights, size", [(0, 4), (15, 4), (16, 8), (31, 8), (40, 8)])
def test_the_word_is_as_small_as_it_can_be(lights, size):
    assert np.dtype(modes.word_type(lights)).itemsize == size


def test_or_makes_partial_shadow():
    assert ShadowMode.FULL_SHADOW | ShadowMode.NON_SHADOW == ShadowMode.PARTIAL_SHADOW


def test_a_moved_light_is_forgotten_alone():
    word = np.uint32(OcclusionMode.FULLY_RENDERED | ShadowMode.FULL_SHADOW << 2 | ShadowMode.NON_SHADOW << 4)
    words = np.array([word, word & ~np.uint32(3) | np.uint32(OcclusionMode.DYNAMIC)])
    modes.forget_lights(words, [35])
    assert words[0] == word  # that light is not culled, and has nothing to be forgotten
    modes.forget_lights(words, [0, 35])
    assert modes.occlusion_mode(words).tolist() == [OcclusionMode.INIT, OcclusionMode.DYNAMIC]
    assert modes.shadow_mode(words, 0).tolist() == [0, 0]
    assert modes.shadow_mode(words, 1).tolist() == [2, 2]


@quickly(200, shrink=True)
@given(
    st.lists(
        st.tuples(
            st.integers(0, 3),
            st.booleans(),
            st.integers(0, 40),
            st.integers(0, 40),
            st.integers(0, 10),
            st.integers(0, 40),
        ),
        min_size=1,
        max_size=20,
    ),
    st.floats(1.0, 10.0),
    st.integers(0, 2**30 - 1),
)
def test_occlusion_modes_are_set_by_the_papers_rules(units, zoom, shadow_bits):
    words = np.array([mode | shadow_bits << 2 for mode, *_ in units], np.uint32)
    hidden = np.array([unit[1] for unit in units])
    counts, shaded, highest, taught = (np.array([unit[i] for unit in units], np.int32) for i in (2, 3, 4, 5))
    shaded = np.minimum(shaded, counts)
    expected = [
        naive.set_occlusion_mode(mode, covered, count, some, top, before, zoom)
        for (mode, covered, count, _, top, before), some in zip(units, shaded.tolist(), strict=True)
    ]
    set_occlusion_modes(words, hidden, counts, shaded, zoom, highest, taught)
    found = modes.occlusion_mode(words).tolist(), highest.tolist(), taught.tolist()
    assert list(zip(*found, strict=True)) == expected
    assert (words >> 2 == shadow_bits).all()


UNITS = 4


@quickly(20, shrink=True)
@given(st.sampled_from([1, 15, 16, 31, 40]), st.lists(st.booleans(), min_size=UNITS, max_size=UNITS), st.data())
def test_words_over_many_frames_are_what_the_naive_twin_says(lights, dynamic, data):
    """Lights move, units are hidden or not and cover more or fewer pixels, and workers learn side by side."""
    memory = ModeHistory(np.array(dynamic), lights, workers=3, first=primitives_are_units())
    twin = naive.Modes(dynamic, lights)
    positions = np.zeros((lights, 3), np.float32)
    light, unit = st.integers(0, lights - 1), st.integers(0, UNITS - 1)
    points = LampTable(tuple(Light(f"light {i}", (0.0, 0.0, 0.0)) for i in range(lights)))
    memory.follow_lights(positions, points)
    for _ in range(data.draw(st.integers(1, 8))):
        for moved in data.draw(st.sets(light, max_size=2)):
            positions[moved, 0] += 1.0
            twin.forget(moved)
        memory.follow_lights(positions, points)
        rays = data.draw(st.lists(st.tuples(unit, light, st.sampled_from([1, 2])), max_size=12))
        for worker, (u, number, mode) in enumerate(rays):
            if number < modes.MAX_CULLED_LIGHTS and not dynamic[u]:  # as the shadow test has it
                memory.gained[worker % 3, u] |= memory.words.dtype.type(mode << (2 + 2 * number))
        counts = data.draw(st.lists(st.integers(0, 30), min_size=UNITS, max_size=UNITS))
        whole = data.draw(st.booleans())
        shaded = counts if whole else [data.draw(st.integers(0, count)) for count in counts]
        hidden, zoom = data.draw(st.sets(unit)), data.draw(st.sampled_from([1.0, 2.5, 4.0]))
        memory.hidden[list(hidden)] = True
        memory.keep(memory.learnt(np.array(counts, np.int32), np.array(shaded, np.int32), zoom))
        twin.end_frame(hidden, counts, shaded, rays, zoom)
        assert memory.words.tolist() == twin.words()
        assert memory.highest_count.tolist() == twin.highest
        assert not memory.hidden.any() and not memory.gained.any()


@pytest.mark.parametrize("in_cells", [False, True])
@pytest.mark.parametrize("symmetric", [False, True])
def test_occlusion_testing_asks_what_the_naive_twin_asks(symmetric, in_cells, monkeypatch):
    """Of whole triangles, and of their cells."""
    monkeypatch.setattr(cells, "AIM", 150)
    rng = np.random.default_rng(2)
    corners = random_corners(rng, 25, 0.3)
    world = tracer.World(scene(corners), accelerator="kdtree")
    camera = pinhole(Camera((0.5, 0.5, 4.0), (0.0, 0.0, -1.0), angle=30.0), 24, 18)
    y, x = np.mgrid[:18, :24].reshape(2, -1)
    directions = camera.corner + x[:, None] * camera.column + y[:, None] * camera.row
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = np.broadcast_to(camera.origin, directions.shape)
    first = cells.first_units(world.placed.triangles, world.object_of) if in_cells else np.arange(len(corners) + 1)
    rays = tracer.RayBatch(origins, directions)

    def units_met(hits: Hits, triangle: int | None = None) -> np.ndarray:
        """(432,) the unit that each ray meets, of a world or of a triangle alone; -1 for none."""
        found = []
        for p, u, v in zip(hits.primitive.tolist(), hits.u, hits.v, strict=True):
            number = p if triangle is None else triangle
            count = int(first[number + 1] - first[number])
            found.append(-1 if p < 0 else int(first[number]) + naive_cells.cell_of(count, u, v))
        return np.array(found)

    hits = world.closest_hits(rays)
    ids, units = hits.primitive.reshape(18, 24), units_met(hits).reshape(18, 24).astype(np.int32)
    alone = [tracer.World(scene(c[None]), accelerator="kdtree") for c in corners]
    met = np.array([units_met(w.closest_hits(rays), p) for p, w in enumerate(alone)]).reshape(-1, 18, 24)
    expected, tests = naive.hidden_units(ids, units, lambda px, py, p, unit: met[p, py, px] == unit, symmetric)
    nothing = np.zeros(first[-1], np.uint32)
    for words in (
        nothing,
        np.where(np.arange(first[-1]) % 4 == 3, np.uint32(OcclusionMode.FULLY_RENDERED), nothing),
    ):
        hidden, numbers = np.zeros(first[-1], np.bool_), first.astype(np.int32) if in_cells else primitives_are_units()
        counted = [
            occlusion_testing(world.placed, camera, ids, numbers, units, symmetric, row, row + 6, words, hidden)
            for row in (0, 6, 12)
        ]
        assert sum(counted) == tests
        asked = words != OcclusionMode.FULLY_RENDERED
        assert set(np.flatnonzero(hidden & asked)) == expected & set(np.flatnonzero(asked))

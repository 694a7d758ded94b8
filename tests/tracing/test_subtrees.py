"""Large trees of subtrees: nobody can tell when a subtree was built, or by whom."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import cases
from tests.tracing.random_worlds import END, quickly, scenes
from tests.tracing.rays_and_movers import movers, random_rays
from tests.tracing.same import assert_same
from tests.tracing.worlds import random_corners, scene
from tracer.geometry.bvh8 import subtrees
from tracer.geometry.bvh8.subtrees import LargeTree
from tracer.geometry.primitives import triangle_rows
from tracer.geometry.rays import Rays
from tracer.geometry.structure import BuiltPart
from tracer.geometry.wide_tree.cells import cells_over
from tracer.method import Method, bases
from tracer.scene.model import Cancelled, Scene


@pytest.fixture(autouse=True)
def tiny_subtrees(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subtrees, "LARGE", 10)
    monkeypatch.setattr(subtrees, "SUBTREE_SIZE", 16)


def built(world: tracer.World) -> BuiltPart:
    told = world.built()
    assert told is not None
    return told


def assert_alike(lazy: tracer.World, whole: tracer.World, rays: Rays, threads: int = 1) -> None:
    """Answers to all queries, and steps and tests ray by ray."""
    for a, b in zip(lazy.closest_hits(rays, threads), whole.closest_hits(rays), strict=True):
        assert np.array_equal(a, b)
    assert np.array_equal(lazy.any_hits(rays, threads), whole.any_hits(rays))
    assert np.array_equal(lazy.occluders(rays, threads), whole.occluders(rays))
    assert np.array_equal(lazy.closest_hits_each(rays)[1], whole.closest_hits_each(rays)[1])
    for one, other in zip(lazy.occluders_each(rays), whole.occluders_each(rays), strict=True):
        assert np.array_equal(one, other)


def test_random_worlds_answer_alike_lazy_whole_and_not_in_subtrees(monkeypatch: pytest.MonkeyPatch) -> None:
    parts: list[BuiltPart] = []

    @quickly(6)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: Scene, time: float, seed: int) -> None:
        rng = np.random.default_rng(seed)
        rays = random_rays(rng, 64)
        lazy, whole = tracer.World(made, time, lazy=True), tracer.World(made, time)
        with monkeypatch.context() as patch:
            patch.setattr(subtrees, "LARGE", 1 << 40)
            plain = tracer.World(made, time)
        assert whole.built() is plain.built() is None
        for _ in range(2):
            assert_alike(lazy, whole, rays)
            for a, b in zip(whole.closest_hits(rays), plain.closest_hits(rays), strict=True):
                assert np.array_equal(a, b)
            assert np.array_equal(whole.any_hits(rays), plain.any_hits(rays))
            resting = rng.random(len(made.objects)) < 0.5
            for world in (lazy, whole, plain):
                world.place(time / 2, resting)
        parts.extend(part for part in (lazy.built(),) if part is not None)

    check()
    assert parts


def large(triangles: int = 3000) -> Scene:
    rng = np.random.default_rng(3)
    return scene(random_corners(rng, triangles, 0.02), dynamic=movers(rng, 4))


@pytest.mark.parametrize("threads", [1, 4])
def test_rays_that_build_meet_what_rays_meet_that_find_all_built(threads: int) -> None:
    made, rays = large(), random_rays(np.random.default_rng(1), 3000)
    lazy, whole = tracer.World(made, 0.0, lazy=True), tracer.World(made, 0.0)
    waiting = built(lazy)
    assert waiting.primitives == 48  # those of the objects that move
    lazy.closest_hits(Rays(*(np.ascontiguousarray(part[..., -2:]) for part in rays)))
    some = built(lazy)
    assert waiting.primitives < some.primitives < 0.7 * some.of  # what these two pass
    assert waiting.nodes < some.nodes and waiting.memory_bytes < some.memory_bytes
    assert_alike(lazy, whole, rays, threads)
    assert built(lazy).primitives == built(lazy).of == made.primitive_count


def test_who_asks_for_all_triangles_has_all_of_them() -> None:
    made = large()
    lazy, whole = tracer.World(made, 0.0, lazy=True), tracer.World(made, 0.0)
    for one, other in zip(lazy.triangles_of(0), whole.triangles_of(0), strict=True):
        assert np.array_equal(one, other)
    assert np.array_equal(lazy.triangles_of(0).rows, lazy.placed.triangles[:3000])
    assert built(lazy).primitives == made.primitive_count
    assert np.array_equal(lazy.bounds(), whole.bounds())


def test_what_is_measured_finds_all_built() -> None:
    world = tracer.World(large(), 0.0, lazy=True)
    assert built(world).primitives < built(world).of
    settings = tracer.Settings(width=16, height=12, depth=0)
    assert all(tracer.experiment.run(world.scene, settings, ["none"], [0.0], world=world))
    assert built(world).primitives == built(world).of


# By no measured time; in every run those that ask trees in ways of their own.
DECIDED = [kind.name for kind in bases(True) if not Method.parse(kind.name).adaptive]
ASKING = ["paper", "lightbuffer", "voxels", "lie-exact", "lightcuts-certified", "certified+cache+rest"]


@pytest.mark.parametrize("method", cases(ASKING, [*DECIDED, "certified+cache+rest"]))
def test_pictures_and_counters_are_those_of_a_tree_that_was_there(method: str) -> None:
    made = large(300)
    settings = tracer.Settings(width=32, height=24, depth=1, method=method, verify=True, threads=2)
    lazy = tracer.Renderer(made, settings, world=tracer.World(made, 0.0, lazy=True))
    whole = tracer.Renderer(made, replace(settings, threads=1), world=tracer.World(made, 0.0))
    for time in (0.0, 0.0, 0.5):
        one, other = lazy.render(time), whole.render(time)
        assert one.statistics.built is not None
        assert_same(one, other, f"at {time}")


def test_cells_hold_every_triangle_once_and_no_more_than_they_may() -> None:
    rng = np.random.default_rng(7)
    crowded = np.concatenate([random_corners(rng, 500, 0.1), random_corners(rng, 2000, 1e-6) * 1e-4])
    for corners, most in ((crowded, 40), (np.zeros((30, 3, 3)), 8), (crowded[:1], 8), (crowded[:0], 8)):
        rows = triangle_rows(corners.astype(np.float32))
        cells = cells_over(rows, most, np.zeros(2, np.int64), 2)
        assert np.array_equal(np.sort(cells.order), np.arange(len(rows)))
        counts = np.diff(cells.starts)
        assert (counts > 0).all() and cells.starts[-1] == len(rows)
        assert counts.max(initial=0) <= most or not corners.any()  # what is in one place stays together
        whole = np.stack([rows[:, :3], rows[:, :3] + rows[:, 3:6], rows[:, :3] + rows[:, 6:]], axis=1)
        for c, box in enumerate(cells.boxes):
            inside = whole[cells.order[cells.starts[c] : cells.starts[c + 1]]].reshape(-1, 3)
            assert np.array_equal(box, np.concatenate([inside.min(0), inside.max(0)]))


def test_what_goes_wrong_while_a_ray_waits_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    made, rays = large(), random_rays(np.random.default_rng(1), 300)
    fails: list[type[BaseException]] = [KeyboardInterrupt]
    build = subtrees.build_topology

    def failing(*arguments):
        if fails:
            raise fails.pop() if fails[0] is KeyboardInterrupt else fails[0]
        return build(*arguments)

    world, whole = tracer.World(made, 0.0, lazy=True), tracer.World(made, 0.0)
    monkeypatch.setattr(subtrees, "build_topology", failing)
    with pytest.raises(KeyboardInterrupt):
        world.closest_hits(rays)
    assert_alike(world, whole, rays)  # the subtree was built all the same
    fails.append(MemoryError)
    world = tracer.World(made, 0.0, lazy=True)
    for _ in range(2):  # a subtree is missing, which no picture may show
        with pytest.raises(MemoryError):
            world.closest_hits(rays)


def test_a_build_in_subtrees_can_be_stopped() -> None:
    rows = triangle_rows(random_corners(np.random.default_rng(2), 500, 0.1).astype(np.float32))
    nothing = np.empty((0, 6), np.float32)
    with pytest.raises(Cancelled):
        LargeTree(rows, nothing, np.array([1, 0]), 1)
    tree = LargeTree(rows, nothing, np.zeros(2, np.int64), 1)
    with pytest.raises(Cancelled):
        tree.build_all(np.array([1, 0]), 2)


def test_a_tree_with_few_addresses_is_the_same_in_less_room(monkeypatch: pytest.MonkeyPatch) -> None:
    made, rays = large(), random_rays(np.random.default_rng(1), 300)
    whole = tracer.World(made, 0.0)
    most = 4 * (whole.structure.static.nodes.size + whole.structure.static.blocks.size)
    monkeypatch.setattr(subtrees.memory_check, "of_limit", lambda: 1.9 * most)
    lazy, few = tracer.World(made, 0.0, lazy=True), tracer.World(made, 0.0)
    assert_alike(lazy, whole, rays)
    lazy.build()
    assert built(lazy).primitives == built(lazy).of  # all of it has found room
    for world in (lazy, few):
        tree = world.structure.static
        assert 4 * (tree.nodes.size + tree.blocks.size) < 0.7 * most
    monkeypatch.setattr(subtrees.memory_check, "of_limit", lambda: 2.1 * most)
    assert tracer.World(made, 0.0, lazy=True).structure.static.nodes.shape == whole.structure.static.nodes.shape


def test_no_room_at_all_is_an_error_of_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    def reserved(size: int) -> bytearray:
        raise OSError(12, "Cannot allocate memory")

    monkeypatch.setattr(subtrees, "_reserved", reserved)
    with pytest.raises(MemoryError, match=r"no room for a tree of 0\.\d GB"):
        tracer.World(large(), 0.0, lazy=True)


def test_subtrees_that_are_interrupted_again_and_again_never_leave_their_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subtrees.memory_check, "of_limit", lambda: 1000.0)
    world = tracer.World(large(), 0.0, lazy=True)
    write = subtrees.write_topology

    def interrupted(*arguments) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(subtrees, "write_topology", interrupted)
    for _ in range(50):
        with pytest.raises((KeyboardInterrupt, MemoryError)):
            world.build()
    monkeypatch.setattr(subtrees, "write_topology", write)
    with pytest.raises(MemoryError, match="no room for a subtree"):
        world.build()

"""Lightcuts: the tree of lights, bounds that bound, and pictures by cuts."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tracer
from tests.golden.pictures import FOLDER, Difference
from tests.sweeps import cases
from tests.tracing.nasty_worlds import nasty_walk, with_lamps
from tests.tracing.same import assert_same
from tests.tracing.shades import floor, going, kite, roof
from tests.tracing.worlds import quad, scene
from tracer.geometry.world import ACCELERATORS
from tracer.kernels import kernel
from tracer.methods.lightcuts import errors_of
from tracer.scene.animation import Animation
from tracer.scene.lamps import COLOR, FALLS_OFF, Lamps, LampTable
from tracer.scene.lights import Light
from tracer.scene.load import load_scene
from tracer.scene.model import Camera, Material
from tracer.shading.lightcuts.block import DARK
from tracer.shading.lightcuts.bounds import greatest_light, mirrored_direction
from tracer.shading.lightcuts.tree import CutTree, build_cut_tree
from tracer.shading.points import (
    DIFFUSE_ROW,
    EXPONENT_ROW,
    GEOMETRIC_ROW,
    NORMAL_ROW,
    POINT_ROWS,
    POSITION_ROW,
    SHINE_ROW,
    SPECULAR_ROW,
    points_in,
)
from tracer.simd import load_three, store
from viewer.output.pictures import picture
from viewer.state.views import View
from viewer.util.resources import embedded_scenes

METHODS = ("lightcuts", "lightcuts-stochastic", "lightcuts-certified")
SETTINGS = tracer.Settings(width=64, height=48, depth=2, method="lightcuts", threads=2)
ALL = {"lightcuts_error": 1e-30, "lightcuts_nodes": 65536}  # every cut is all lights
LIGHTS = 300
MATERIALS = (
    Material(diffuse=(0.6, 0.5, 0.4), specular=(0.3, 0.3, 0.3), exponent=20.0),
    Material(diffuse=(0.2, 0.3, 0.5), specular=(0.5, 0.4, 0.3), exponent=90.0),
)


def lights_of(seed: int, count: int, falloff: str | None = None, track: str | None = None) -> tuple[Light, ...]:
    """Coloured lights in clumps over a floor, some with samples, some of which fall off."""
    rng = np.random.default_rng(seed)
    middles = rng.uniform((-4, -4, 1.0), (4, 4, 5.0), (9, 3))
    made = []
    for i in range(count):
        place = tuple((middles[rng.integers(9)] + rng.normal(size=3) * 0.3).tolist())
        lamp = {"kind": "rectangle", "edges": ((0.2, 0.0, 0.0), (0.0, 0.2, 0.0)), "samples": 4} if i % 10 == 0 else {}
        falls = falloff or ("none" if i % 7 == 0 else "inverse square")
        color = tuple((rng.random(3) * (0.02 if falls == "none" else 0.1)).tolist())
        made.append(Light(f"light {i}", place, color, track if i % 3 == 0 else None, falloff=falls, **lamp))
    return tuple(made)


def hall(seed: int = 1, count: int = LIGHTS, **extra) -> tracer.Scene:
    """A floor with roofs over it and a wall, lit by many lights; a kite that comes and goes."""
    static = floor() + roof(1.2, 1.0) + quad((-3, 1, 0), (3, 1, 0), (3, 1, 3), (-3, 1, 3))
    made = scene(
        static,
        dynamic=(kite("goes", 0.8, 0.5),),
        materials=MATERIALS,
        camera=Camera((0.0, -9.0, 5.0), (0.0, 9.0, -4.5), (0.0, 0.0, 1.0), 45.0),
        animation=Animation({"goes": going([(0.0, -1.5), (2.0, 1.5)]), "swings": going([(0.0, 0.0), (2.0, 1.0)])}),
        ambient=(0.1, 0.1, 0.1),
    )
    made.objects[0].triangles.material[::3] = 1
    return replace(made, **({"lights": lights_of(seed, count)} | extra))


@cache
def still_hall() -> tracer.Scene:
    return hall()


@cache
def truth(accelerator: str = "bvh8", depth: int = 0) -> tracer.Frame:
    """The hall by all of its lights."""
    return frame_of(still_hall(), method="none", accelerator=accelerator, depth=depth)


def frame_of(made: tracer.Scene, time: float = 0.7, **settings) -> tracer.Frame:
    return tracer.Renderer(made, replace(SETTINGS, **settings)).render(time)


# --- the tree -------------------------------------------------------------------------------------


def twin(tree: CutTree, lamps: Lamps, node: int = 0) -> list[int]:
    """The lights below a node, by a naive walk that holds all that the tree says against them."""
    child = int(tree.children[node])
    below = [int(tree.reps[node])] if child == 0 else twin(tree, lamps, child) + twin(tree, lamps, child + 1)
    rows = lamps.rows[tree.owners[below]]
    assert tree.colors[node] == pytest.approx(rows[:, COLOR : COLOR + 3].astype(np.float64).sum(0), rel=1e-6)
    assert (tree.boxes[node, :3] == lamps.samples[below].min(0)).all()
    assert (tree.boxes[node, 3:] == lamps.samples[below].max(0)).all()
    assert sorted(tree.order[slice(*tree.spans[node])].tolist()) == sorted(below)
    if child:
        assert [tree.reps[node] == tree.reps[child], tree.reps[node] == tree.reps[child + 1]].count(True) == 1
    else:
        assert (tree.colors[node] == rows[0, COLOR : COLOR + 3]).all(), "a light's own colour, bit for bit"
    if node or len(set(rows[:, FALLS_OFF].tolist())) == 1:
        assert (rows[:, FALLS_OFF] == tree.falls[node]).all(), "clusters are of one kind"
    return below


@pytest.mark.parametrize("count", [1, 2, 3, 60])
def test_the_tree_holds_every_light_once_with_sums_boxes_and_representatives(count: int) -> None:
    lights = lights_of(count, count)
    lamps = LampTable(lights).at(np.array([light.position for light in lights]))
    tree = build_cut_tree(lamps)
    assert sorted(twin(tree, lamps)) == list(range(len(lamps.samples)))
    assert tree.owners.tolist() == np.repeat(np.arange(count), np.diff(lamps.first)).tolist()
    assert all(np.array_equal(a, b) for a, b in zip(tree, build_cut_tree(lamps), strict=True))


def test_lights_in_one_place_make_a_tree_as_well() -> None:
    lights = tuple(Light(f"light {i}", (1.0, 2.0, 3.0)) for i in range(50))
    lamps = LampTable(lights).at(np.array([light.position for light in lights]))
    assert len(twin(build_cut_tree(lamps), lamps)) == 50


# --- bounds ---------------------------------------------------------------------------------------


@kernel
def bounds_of(memory, directions, boxes, colors, falls):
    """Bounds (boxes, n) of clusters at points in rows of memory; directions (3, n) are those of the viewer's rays."""
    points, found = points_in(memory), np.empty((len(boxes), memory.shape[1]), np.float32)
    for k in range(len(boxes)):
        for v in range(memory.shape[1] // 16):
            mirror = mirrored_direction(load_three(points.normal, v), load_three(directions, v))
            color = colors[k, 0], colors[k, 1], colors[k, 2]
            bound = greatest_light(points, mirror, boxes[k], color, falls[k], v)
            store(found[k:].ctypes.data + 64 * v, bound)
    return found


def unit(a: np.ndarray) -> np.ndarray:
    return a / np.linalg.norm(a, axis=-1, keepdims=True)


def sent(points: np.ndarray, directions: np.ndarray, place: np.ndarray, falls: bool) -> np.ndarray:
    """What a light of colour 1 sends to each point, (n, 3): Phong, naively, in float64."""
    p = points.astype(np.float64).T
    position, normal = p[:, POSITION_ROW : POSITION_ROW + 3], p[:, NORMAL_ROW : NORMAL_ROW + 3]
    away = place.astype(np.float64) - position
    length = np.linalg.norm(away, axis=1)
    toward = away / length[:, None]
    cosine = (normal * toward).sum(1)
    view = directions.astype(np.float64).T
    mirrored = view - 2 * (view * normal).sum(1, keepdims=True) * normal
    along = np.maximum((mirrored * toward).sum(1), 0.0)
    shines = (p[:, SHINE_ROW] > 0) & (along > 0)
    specular = np.where(shines, along ** p[:, EXPONENT_ROW], 0.0)
    local = p[:, DIFFUSE_ROW : DIFFUSE_ROW + 3] * cosine[:, None]
    local += p[:, SPECULAR_ROW : SPECULAR_ROW + 3] * specular[:, None]
    faced = (cosine > 0) & ((p[:, GEOMETRIC_ROW : GEOMETRIC_ROW + 3] * away).sum(1) > 0)
    return np.where(faced[:, None], local / (length[:, None] ** 2 if falls else 1.0), 0.0)


@pytest.mark.parametrize("seed", range(cases(6, 60)))
def test_no_cluster_is_wrong_by_more_than_its_bound(seed: int) -> None:
    rng, n = np.random.default_rng(seed), 64
    points = np.zeros((POINT_ROWS, n), np.float32)
    points[POSITION_ROW : POSITION_ROW + 3] = rng.normal(size=(3, n)) * 10.0 ** rng.uniform(-2, 2)
    geometric = unit(rng.normal(size=(n, 3)))
    normal = unit(geometric + 0.3 * rng.normal(size=(n, 3)) * rng.integers(2))
    normal *= np.sign((normal * geometric).sum(1, keepdims=True))
    points[GEOMETRIC_ROW : GEOMETRIC_ROW + 3], points[NORMAL_ROW : NORMAL_ROW + 3] = geometric.T, normal.T
    points[DIFFUSE_ROW : DIFFUSE_ROW + 3] = rng.random((3, n))
    points[SPECULAR_ROW : SPECULAR_ROW + 3] = rng.random((3, n)) * (rng.random(n) < 0.6)
    points[SHINE_ROW] = points[SPECULAR_ROW : SPECULAR_ROW + 3].max(0)
    points[EXPONENT_ROW] = 10.0 ** rng.uniform(0, 2.5, n)
    directions = np.ascontiguousarray(unit(rng.normal(size=(n, 3))).T, np.float32)

    clusters = []
    for _ in range(40):
        spread, count = 10.0 ** rng.uniform(-3, 1), int(rng.integers(2, 7))
        middle = points[POSITION_ROW : POSITION_ROW + 3, rng.integers(n)] + rng.normal(size=3) * 10.0 ** rng.uniform(
            -2, 2
        )
        clusters.append(((middle + rng.normal(size=(count, 3)) * spread).astype(np.float32), rng.random((count, 3))))
    boxes = np.array([[*places.min(0), *places.max(0)] for places, _ in clusters], np.float32)
    colors = np.array([color.sum(0) for _, color in clusters], np.float32)
    falls = rng.random(len(clusters)) < 0.5
    found, tight = bounds_of(points, directions, boxes, colors, falls).astype(np.float64), []
    for (places, color), bound, total, fall in zip(clusters, found, colors, falls, strict=True):
        each = [sent(points, directions, place, bool(fall)) for place in places]
        lit = rng.random((len(places), n)) < 0.7
        light = sum((c * s).sum(1) * seen for c, s, seen in zip(color, each, lit, strict=True))
        for rep in range(len(places)):
            wrong = np.abs(light - (total * each[rep]).sum(1) * lit[rep])
            assert (wrong <= bound * (1 + 1e-6) + 1e-12).all()
        whole = sum((c * s).sum(1) for c, s in zip(color, each, strict=True))
        tight.append(bound[whole > 0] / whole[whole > 0])
    assert np.median(np.concatenate(tight)) < 4.0, "and bounds say something"


# --- pictures -------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_no_pixel_is_wrong_by_more_than_the_bounds_of_its_cut(method: str) -> None:
    frame, none = frame_of(still_hall(), method=method, depth=0, lightcuts_error=0.05), truth()
    bound = frame.layers["cut bound"] * np.maximum(frame.color.astype(np.float64).sum(2), DARK)
    wrong = np.abs(frame.color.astype(np.float64).sum(2) - none.color.astype(np.float64).sum(2))
    hit = frame.primitive >= 0
    # What is drawn for a pixel may by chance be more than the cluster can send.
    within = wrong[hit] <= bound[hit] * 1.001 + 1e-5
    assert within.all() if method != "lightcuts-stochastic" else within.mean() > 0.99
    cuts = frame.statistics.cuts
    assert cuts is not None and cuts.lights == 390 and cuts.limited == 0
    assert frame.layers["cut nodes"][hit].max() == cuts.most < 390 and cuts.nodes > cuts.blocks
    assert 0 < frame.statistics.shadow.rays < none.statistics.shadow.rays
    assert np.median(errors_of(frame.color[hit], none.color[hit])) < 0.02


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_cuts_of_all_lights_are_the_picture_of_none_bit_for_bit(accelerator: str) -> None:
    none = truth(accelerator, 2)
    for method in ("lightcuts", "lightcuts-certified"):
        frame = frame_of(still_hall(), method=method, accelerator=accelerator, **ALL)
        assert frame.color.tobytes() == none.color.tobytes(), method
        assert frame.statistics.cuts is not None and frame.statistics.cuts.nodes > 0
    for method in METHODS:
        frame = frame_of(still_hall(), method=method, accelerator=accelerator, lightcuts_error=0.0)
        assert frame.color.tobytes() == none.color.tobytes(), method
        assert frame.statistics.cuts is None and "every shadow ray is traced" in frame.statistics.decision


@pytest.mark.parametrize("seed", range(cases(3, 24)))
def test_nasty_worlds_are_those_of_none_where_cuts_are_all_lights(seed: int) -> None:
    walk = with_lamps(nasty_walk(seed, lights=12, frames=3))
    renderers = [
        tracer.Renderer(walk.scene, replace(SETTINGS, width=32, height=24, method=method, **ALL))
        for method in ("none", "lightcuts", "lightcuts-certified")
    ]
    for time, camera in walk.frames:
        none, *others = (renderer.render(time, camera) for renderer in renderers)
        for frame in others:
            assert frame.color.tobytes() == none.color.tobytes(), f"{frame.settings.method} {walk} {time}"


@pytest.mark.parametrize("method", METHODS)
def test_frames_repeat_for_any_number_of_threads_and_whatever_came_before(method: str) -> None:
    made = hall(lights=lights_of(2, 60, track="swings"))
    one = tracer.Renderer(made, replace(SETTINGS, width=160, height=96, method=method, threads=1, samples=2))
    three = tracer.Renderer(made, replace(SETTINGS, width=160, height=96, method=method, threads=3, samples=2))
    certified = method == "lightcuts-certified"
    first = one.render(0.4)
    assert_same(first, three.render(0.4), method)
    three.render(1.1)  # lights move
    again, fresh = three.render(0.4), one.render(0.4) if certified else first
    assert again.color.tobytes() == fresh.color.tobytes()
    moved = three.render(1.6)
    none = frame_of(made, 1.6, method="none", width=160, height=96)
    whole = replace(three.settings, samples=1)
    three.settings = whole
    moved = three.render(1.6)
    hit = moved.primitive >= 0
    assert np.median(errors_of(moved.color[hit], none.color[hit])) < 0.02, "of where the lights are now"


def test_errors_that_are_allowed_are_not_exceeded_by_much_and_limits_are_told() -> None:
    errors, sizes = [], []
    for allowed in (0.2, 0.02, 0.002):
        frame = frame_of(still_hall(), lightcuts_error=allowed, depth=0, verify=True)
        cuts = frame.statistics.cuts
        assert cuts is not None and cuts.errors is not None and frame.reference is not None and frame.wrong is not None
        assert frame.reference.tobytes() == truth().color.tobytes()
        hit = frame.primitive >= 0
        wrong = errors_of(frame.color[hit], truth().color[hit])
        assert (cuts.errors.median, cuts.errors.most) == pytest.approx((np.median(wrong), wrong.max()))
        assert frame.statistics.shadow.wrong == cuts.errors.beyond == frame.wrong.sum() == (wrong > allowed).sum()
        assert cuts.errors.median < allowed
        errors.append(cuts.errors.median)
        sizes.append(cuts.mean)
    assert errors == sorted(errors, reverse=True) and sizes == sorted(sizes)
    few = frame_of(still_hall(), lightcuts_error=0.002, lightcuts_nodes=7, depth=0)
    assert few.statistics.cuts is not None and few.statistics.cuts.most == 7
    assert few.statistics.cuts.limited > 0 and "as large as they may be" in few.statistics.decision
    assert frame_of(still_hall(), lightcuts_nodes=1, depth=0).layers["cut nodes"].max() == 1


def test_what_is_drawn_averages_out() -> None:
    """Sixteen frames at moments that look alike differ in what is drawn; their mean is nearer to the truth."""
    made = replace(still_hall(), animation=Animation.empty(), objects=still_hall().objects[:1])
    none = frame_of(made, method="none", depth=0)
    renderer = tracer.Renderer(made, replace(SETTINGS, method="lightcuts-stochastic", depth=0, lightcuts_error=0.2))
    pictures = [renderer.render(time).color.astype(np.float64) for time in np.linspace(0, 1, 16)]
    assert not np.array_equal(pictures[0], pictures[1])
    assert np.array_equal(pictures[0], renderer.render(0.0).color)
    hit = none.primitive >= 0
    one, mean = (errors_of(p[hit], none.color[hit]).mean() for p in (pictures[0], np.mean(pictures, axis=0)))
    assert mean < 0.5 * one
    bias = np.mean(pictures, axis=0)[hit].mean() / none.color[hit].mean()
    assert bias == pytest.approx(1.0, abs=0.01)


def test_clusters_that_are_proven_to_be_hidden_cost_nothing() -> None:
    """A closed lid over the floor, and half of the lights above it."""
    lid = quad((-9, -9, 2.0), (9, -9, 2.0), (9, 9, 2.0), (-9, 9, 2.0))
    made = hall(objects=scene(floor() + lid, materials=MATERIALS).objects, ambient=(0.0, 0.0, 0.0))
    made = replace(made, camera=Camera((0.0, -4.0, 1.6), (0.0, 9.0, -3.5), (0.0, 0.0, 1.0), 60.0))
    none, plain, certified = (
        frame_of(made, method=name, depth=0) for name in ("none", "lightcuts", "lightcuts-certified")
    )
    a, b = plain.statistics, certified.statistics
    assert a.cuts is not None and b.cuts is not None and b.certificates > 0
    assert b.cuts.nodes < 0.7 * a.cuts.nodes and b.shadow.rays < a.shadow.rays
    hit = none.primitive >= 0
    assert np.median(errors_of(certified.color[hit], none.color[hit])) < 0.02
    assert certified.layers["cut bound"][hit].mean() < plain.layers["cut bound"][hit].mean()


@pytest.mark.parametrize("method", METHODS)
def test_what_is_recorded_of_lights_and_modes_is_what_is_true(method: str) -> None:
    made = hall(count=20)
    recorded = {"record_lights": True, "record_work": True, "modes": True, "depth": 1}
    frame, none = (frame_of(made, method=name, **recorded) for name in (method, "none+rest"))
    assert np.array_equal(frame.asked, none.asked) and np.array_equal(frame.reached, none.reached)
    assert np.array_equal(frame.modes, none.modes)
    assert frame.statistics.by_modes == none.statistics.by_modes
    assert np.array_equal(frame.due_rays, none.due_rays)
    assert (frame.cost + frame.saved == none.cost + none.saved).all()
    unrecorded = frame_of(made, method=method, modes=True, depth=1)
    assert unrecorded.color.tobytes() == frame.color.tobytes()
    assert unrecorded.statistics.shadow == frame.statistics.shadow


@pytest.mark.parametrize("method", METHODS)
def test_few_lights_are_traced_and_said_to_be_few(method: str) -> None:
    for count in (0, 1, 2):
        made = hall(lights=tuple(Light(f"light {i}", (i - 0.5, 0.0, 4.0)) for i in range(count)))
        frame, none = (frame_of(made, method=name) for name in (method, "none"))
        assert frame.color.tobytes() == none.color.tobytes()
        assert "too few" in frame.statistics.decision and frame.statistics.cuts is None
    few = frame_of(hall(lights=tuple(Light(f"light {i}", (i - 1.5, 0.0, 4.0)) for i in range(4))), method=method)
    assert "too few lights to gain" in few.statistics.decision


def test_settings_of_cuts_are_checked() -> None:
    for wrong in ({"lightcuts_error": -0.1}, {"lightcuts_error": float("nan")}, {"lightcuts_nodes": 0}):
        with pytest.raises(ValueError, match="lightcuts_"):
            replace(SETTINGS, **wrong).validated()


def test_memory_is_told_and_forgotten() -> None:
    renderer = tracer.Renderer(still_hall(), replace(SETTINGS, lightcuts_nodes=100, threads=1))
    renderer.render()
    assert 100 * 1024 < renderer.memory_bytes < 400_000
    before = renderer.render(0.7).color
    renderer.reset_modes()
    assert renderer.render(0.7).color.tobytes() == before.tobytes()


def test_the_office_by_cuts_looks_as_it_did() -> None:
    """Cuts may come out otherwise on another processor: a few levels, where none of the lights would move by one."""
    made = load_scene(embedded_scenes()["office"])
    frame = tracer.Renderer(made, tracer.Settings(160, 120, 2, "lightcuts")).render(0.0)
    shown, path = picture(frame, View.COLOR), Path(FOLDER) / "lightcuts" / "office.png"
    found = Difference.between(np.asarray(Image.open(path).convert("RGB")), shown)
    assert found.most <= 8 and found.mean <= 0.5, str(found)

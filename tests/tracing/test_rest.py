"""Objects that rest count as static until they move: who rests, what queries answer, and what becomes of modes."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

import tracer
from tests.scenes import loaded, world_of
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.shades import BEHIND, GOING, MIDDLES, floor, going, kite, roof
from tests.tracing.worlds import random_corners, scene, triangles
from tracer.culling.modes import OcclusionMode, ShadowMode, occlusion_mode, shadow_mode
from tracer.culling.rest import Changed, Rest, changes
from tracer.neighbours.certified.cost_model import CostModel
from tracer.scene.animation import Animation, TrackSet
from tracer.scene.deformation import Deformation, deformed
from tracer.scene.model import SceneObject, empty_quadrics


@pytest.fixture(params=ACCELERATORS)
def accelerator(request) -> str:
    return request.param


# --- who rests ----------------------------------------------------------------------------------------


TRACKS = {
    "sails": going([(0, -1.5), (1, -1.5), (2, 1.5), (4, 1.5)]),
    "blinks": TrackSet(visibility=np.array([[1.5, 0.0], [2.5, 1.0]])),
}


def place_and_update(world: tracer.World, rest: Rest, time: float) -> tuple[Changed, Changed]:
    """Place the world at a time as a frame does; which objects have started to move since, and which stopped."""
    before, poses = rest.now, world.pose(time)
    world.place(poses, rest.update(poses, world.primitives, world.certain(poses)))
    return changes(before, rest.now)


def test_an_object_rests_from_the_second_frame_in_which_it_is_the_same():
    jelly = random_corners(np.random.default_rng(1), 5, 0.3)
    keys = np.stack([jelly, jelly, jelly + np.float32(0.1)], axis=1)
    deformation = Deformation(np.tile([0.0, 1.0, 2.0], (5, 1)), keys, np.zeros_like(keys) + np.float32([0, 0, 1]))
    deforming = SceneObject("jelly", triangles(jelly), empty_quadrics(), deformation=deformation)
    made = scene(floor(), dynamic=(kite("sails"), kite("blinks"), deforming), animation=Animation(TRACKS))
    world, rest = tracer.World(made), Rest(4)
    rested, changed = [], []
    for time in (0.0, 0.5, 1.25, 1.75, 1.75, 2.25, 2.75, 3.0, 3.5):
        started, stopped = place_and_update(world, rest, time)
        rested.append("".join(".SBJ"[i] for i in np.flatnonzero(rest.now.since)))
        changed.append(tuple("".join(".SBJ"[i] for i in c.which) for c in (started, stopped)))
        there = rest.now.since > 0
        assert np.array_equal(rest.now.boxes[there], world.object_boxes()[there])
        assert np.array_equal(stopped.boxes, world.object_boxes()[stopped.which])
    assert rested == ["SBJ", "SBJ", "B", "", "SJ", "", "SJ", "SBJ", "SBJ"]
    assert changed[:2] == [("", "SBJ"), ("", "")]
    assert changed[2:7] == [("SJ", ""), ("B", ""), ("", "SJ"), ("SJ", ""), ("", "SJ")]
    assert changed[7:] == [("", "B"), ("", "")]
    before = rest.now
    rest.forget()
    assert len(changes(before, rest.now)[0].which) == 3 and not rest.now.since.any()


def test_a_box_is_around_what_started_where_it_rested():
    world, rest = tracer.World(scene(floor(), dynamic=(kite("sails"),), animation=Animation(TRACKS))), Rest(2)
    for time in (0.5, 1.5):
        started, _ = place_and_update(world, rest, time)
    assert np.allclose(started.boxes, [[-2.1, -0.6, 5.0, -0.9, 0.6, 5.0]], atol=1e-4)
    assert np.allclose(world.object_boxes()[1], [-0.6, -0.6, 5.0, 0.6, 0.6, 5.0], atol=1e-4)


def test_what_deforms_does_not_rest(bart: Path):
    content = loaded(bart / "museum/museum5.aff")
    (index,) = (i for i, item in enumerate(content.objects) if item.deformation is not None)
    world, rest = tracer.World(content), Rest(len(content.objects))
    deforms, rests, shape = [], [], np.empty(0)
    for number in [*range(0, content.frames, 20), content.frames - 1, content.frames - 1]:
        time, before = content.frame_time(number), shape
        place_and_update(world, rest, time)
        shape, _ = deformed(content.objects[index].deformation, time)
        deforms.append(number > 0 and not np.array_equal(shape, before))
        rests.append(bool(rest.now.since[index]))
    assert rests == [not d for d in deforms] and sum(deforms) > 5 and not deforms[-1]


# --- modes --------------------------------------------------------------------------------------------

SETTINGS = tracer.Settings(width=64, height=64, depth=2, threads=1, method="paper+rest", verify=True)
SAILING = scene(
    floor() + roof(6.0, 0.7),
    dynamic=(kite("sails"),),
    lights=[(0.0, 0.0, 20.0), (0.0, -20.0, 1.0)],
    camera=BEHIND,
    animation=Animation(TRACKS),
)
SQUARES = slice(0, 128)  # the floor's triangles


def under(x: float) -> np.ndarray:
    """(128,) which of the floor's triangles the kite's shadow touches where it is at x, from above."""
    return (np.abs(MIDDLES[:, 0] - 4 / 3 * x) < 1.4) & (np.abs(MIDDLES[:, 1]) < 1.4)


def _words(renderer: tracer.Renderer) -> np.ndarray:
    return renderer.state.history(renderer.settings, np.empty(0, np.int32), 1).words


def test_what_depends_on_an_object_is_forgotten_and_nothing_else(accelerator):
    renderer = tracer.Renderer(SAILING, replace(SETTINGS, accelerator=accelerator))
    first = [renderer.render(t) for t in (0.0, 0.3, 0.6)][-1]
    kite_units = slice(len(first.modes) - 2, len(first.modes))
    assert (occlusion_mode(first.modes)[kite_units] != OcclusionMode.DYNAMIC).all()
    shadowed = (shadow_mode(first.modes, 0)[SQUARES] & ShadowMode.FULL_SHADOW) > 0
    assert (shadowed & under(-1.5)).sum() >= 8 and first.statistics.shadow.culled > 0
    renderer.begin(1.5).place_objects_and_lights()
    started = _words(renderer).copy()
    assert (started[kite_units] == OcclusionMode.DYNAMIC).all()
    kept = started[SQUARES] == first.modes[SQUARES]
    assert not kept[shadowed & under(-1.5)].any() and kept[~under(-1.5)].all()
    assert np.array_equal(shadow_mode(started, 1)[SQUARES], shadow_mode(first.modes, 1)[SQUARES])
    full = (shadow_mode(started, 0)[SQUARES] & ShadowMode.FULL_SHADOW) > 0
    assert full.any() and not full[under(-1.5)].any()

    moving = [renderer.render(t) for t in (1.6, 1.7, 2.2)][-1]  # where it is in the last of these it stays
    non = (shadow_mode(moving.modes, 0)[SQUARES] & ShadowMode.NON_SHADOW) > 0
    assert (non & under(1.5)).sum() >= 8
    renderer.begin(2.6).place_objects_and_lights()
    stopped = _words(renderer).copy()
    assert (stopped[kite_units] == 0).all()
    kept = stopped[SQUARES] == moving.modes[SQUARES]
    assert kept[~under(1.5)].all() and not kept[non & under(1.5)].all()
    gone = ~kept
    assert (occlusion_mode(stopped[SQUARES][gone]) != OcclusionMode.FULLY_RENDERED).all()
    assert not (shadow_mode(stopped, 0)[SQUARES][gone] & ShadowMode.NON_SHADOW).any()


def test_shadows_stay_right_while_objects_start_and_stop(accelerator):
    """And modes do better than where nothing that is animated may rest."""
    settings = replace(SETTINGS, accelerator=accelerator, record_lights=True)
    resting = tracer.Renderer(SAILING, settings)
    others = {m: tracer.Renderer(SAILING, replace(settings, method=m)) for m in ("none", "none+rest", "paper")}
    culled = Counter()
    for time in GOING:
        frame, none, same, paper = (renderer.render(time) for renderer in (resting, *others.values()))
        assert frame.statistics.shadow.wrong == 0
        for other in (frame, same):
            assert np.array_equal(other.color, none.color) and np.array_equal(other.lit, none.lit)
        culled.update(rest=frame.statistics.shadow.culled, paper=paper.statistics.shadow.culled)
        culled.update(asked=none.statistics.shadow.rays)
    assert culled["rest"] > culled["paper"] > 0


def test_what_rests_is_followed_through_other_methods_and_resolutions():
    renderer = tracer.Renderer(SAILING, SETTINGS)
    small, words = replace(SETTINGS, width=40, height=40), []
    for settings, times in (
        (SETTINGS, (0.0, 0.3, 0.6)),
        (replace(SETTINGS, method="paper"), (0.7, 1.5)),
        (SETTINGS, (2.2, 2.4)),
        (small, (2.5, 2.6)),
        (replace(SETTINGS, method="none"), (0.2,)),
        (SETTINGS, (0.5, 0.6)),
        (small, (0.7, 0.8)),
    ):
        renderer.settings = settings
        for time in times:
            frame = renderer.render(time)
            assert frame.statistics.shadow.wrong == 0
            assert np.array_equal(frame.color, frame.reference)
            words.append(int(occlusion_mode(frame.modes)[-1]))
    moving = np.array(words) == OcclusionMode.DYNAMIC
    assert moving.tolist() == [False] * 3 + [True] * 2 + [False] * 4 + [True] + [False] * 4


def test_pictures_are_those_without_culling_in_random_scenes():
    """But for what the paper's method gets wrong, which the reference picture shows right."""
    rested = 0

    @quickly(8)
    @given(walks())
    def check(walk: Walk) -> None:
        nonlocal rested
        world = tracer.World(walk.scene, accelerator="kdtree")
        settings = tracer.Settings(width=24, height=16, depth=2, verify=True, accelerator="kdtree")
        methods = ("none", "none+rest", "paper+rest")
        renderers = [tracer.Renderer(walk.scene, replace(settings, method=m), world=world) for m in methods]
        for time, camera in walk.frames:
            none, resting, paper = (renderer.render(time, camera) for renderer in renderers)
            assert np.array_equal(none.color, resting.color) and np.array_equal(none.color, paper.reference)
            assert renderers[2].state.rest.now.since.any() == renderers[1].state.rest.now.since.any()
            rested += int(renderers[1].state.rest.now.since.any())

    check()
    assert rested > 10


@pytest.mark.parametrize("accelerator", cases(["bvh8"], ACCELERATORS))
def test_kitchens_car_starts_and_stops_and_no_picture_differs(bart: Path, accelerator: str):
    """Where its poses say so, and, in view of the camera, where time stands still."""
    world = world_of(bart / "kitchen/kitchen.aff", accelerator)
    content = world.scene
    chain = content.objects[1].chain
    poses = [content.animation.matrix(chain, content.frame_time(i)).tobytes() for i in range(content.frames)]
    start = next(i for i in range(1, content.frames) if poses[i] != poses[i - 1])
    in_view = (700, 701, 702, 702, 702, 702, 703, 704, 704, 704, 704, 705, 706, 707, 708)
    numbers = [*range(start - 3, start + 3), *in_view]
    still = [True] + [poses[a] == poses[b] for a, b in pairwise(numbers)]
    rests = []
    width, height = cases((64, 48), (96, 64))
    settings = tracer.Settings(width, height, depth=2, record_lights=True, accelerator=accelerator)
    methods = ("none", "none+rest", "paper+rest", "certified")
    none, resting, paper, certified = (
        tracer.Renderer(content, replace(settings, method=m, verify="paper" in m), world=world) for m in methods
    )
    for number in numbers:
        time = content.frame_time(number)
        expected, frame, culled = none.render(time), resting.render(time), paper.render(time)
        assert np.array_equal(frame.color, expected.color) and np.array_equal(frame.lit, expected.lit)
        assert all(np.array_equal(c, expected.color) for c in (culled.reference, certified.render(time).color))
        rests.append(bool(paper.state.rest.now.since[1]))
    assert rests == still and 0 < sum(np.diff(np.int8(rests)) > 0) < sum(np.diff(np.int8(rests)) != 0)


def test_rays_to_dynamic_objects_only_are_counted_alike_by_modes_and_by_certificates_and_not_where_all_rest():
    """Nothing static is in any ray's way, so that all steps are those of the tree of what moves."""
    tracks = Animation({"sails": going([(0, -1.5), (8, 1.5)])})
    made = scene(floor(), dynamic=(kite("sails"),), animation=tracks, lights=[(0, 0, 20)])
    eager = CostModel(2, 4, 3, 48, True, 1)
    told = {}
    for method in ("none", "paper", "certified"):
        settings = tracer.Settings(width=64, height=64, method=method, accelerator="kdtree", threads=1)
        renderer = tracer.Renderer(made, settings, cost_model=eager)
        moving = [renderer.render(time) for time in range(1, 8)][-1].statistics.shadow
        still = [renderer.render(7.0) for _ in range(3)][-1].statistics.shadow
        told[method] = moving, still
    counted = {(moving.due, moving.rays, moving.traversal_steps) for moving, _ in told.values()}
    assert len(counted) == 1 and told["none"][0].rays == told["none"][0].due > 0
    assert told["none"][0].dynamic_only == 0 and min(told[m][0].dynamic_only for m in ("paper", "certified")) > 1000
    paper, certified = told["paper"][1], told["certified"][1]
    assert paper.rays == paper.due, "by the paper, a dynamic object is one also while it rests"
    assert certified.rays == certified.traced < certified.due, "what rests is static: nothing dynamic is left to ask"

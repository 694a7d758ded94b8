"""Edited scenes: what they hold, that exact methods stay exact in them, and which modes are carried over."""

from __future__ import annotations

import gc
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.tracing.random_worlds import Walk, quickly, scenes, walks
from tests.tracing.worlds import quad, scene
from tracer.culling import modes
from tracer.editing.carry_modes import carry_modes
from tracer.editing.edits import NO_EDITS, Edits, Origin, edited
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.animation import Animation, Keys, TrackSet
from tracer.scene.model import Camera, Light, Scene, SceneObject, empty_quadrics
from tracer.scene.things import thing_numbers, thing_of, things
from tracer.settings import Settings

SMALL = Settings(width=40, height=30, threads=1, depth=2)


def some_edits(made: Scene, rng: np.random.Generator) -> Edits:
    """Random ones of all kinds."""
    known = things(made)
    return Edits(
        lights_off=frozenset(np.flatnonzero(rng.random(len(made.lights)) < 0.3).tolist()),
        moved_lights=((int(rng.integers(len(made.lights))), tuple(rng.uniform(0.5, 2.5, 3).tolist())),),
        hidden=frozenset(t.name for t in known if rng.random() < 0.2),
        hidden_primitives=frozenset(rng.integers(made.primitive_count, size=2).tolist()),
        static=tuple((t.name, float(rng.uniform(0, 3))) for t in known if t.moves and rng.random() < 0.4),
        moving=frozenset(t.name for t in known if not t.moves and rng.random() < 0.4),
    )


def in_parts(made: Scene) -> Scene:
    """The scene with its static geometry as a floor, a roof, and the rest."""
    static = made.objects[0]
    count = len(static.triangles) + len(static.quadrics)
    part_of = np.minimum(np.arange(count) // 9, 2).astype(np.int32)
    static = replace(static, parts=("floor", "roof", "rest"), part_of=part_of)
    return replace(made, objects=(static, *made.objects[1:]))


@pytest.mark.parametrize("accelerator", ["bvh8", "kdtree"])
@quickly(4)
@given(walk=walks(), seed=st.integers(0, 2**32 - 1))
def test_certified_pictures_of_edited_scenes_are_those_of_none(accelerator: str, walk: Walk, seed: int):
    """Edits follow one another as in the window: renderers take turns, and scenes of some are exchanged."""
    rng, original = np.random.default_rng(seed), in_parts(walk.scene)
    settings = replace(SMALL, accelerator=accelerator, method="certified", modes=True)
    shown = edited(original, NO_EDITS)
    certified = Renderer(shown.scene, settings)
    for time, camera in walk.frames[:3]:
        edits = some_edits(original, rng)
        now = edited(original, edits)
        after = Renderer(now.scene, settings)
        carry_modes(certified, shown, after, now)
        certified, shown = after, now
        certified.render(time, camera)
        for place in rng.uniform(0.5, 2.5, (2, 3)):
            moved = edited(original, edits.with_light_at(int(rng.integers(3)), tuple(place.tolist())))
            hidden = next((t.name for t in things(original) if t.moves and t.name not in dict(edits.static)), None)
            if hidden is not None:
                moved = edited(original, moved.edits.with_thing(hidden, rng.random() < 0.5))
            certified.scene = certified.world.scene = moved.scene
            shown = moved
            fresh = Renderer(moved.scene, replace(settings, method="none")).render(time, camera)
            assert np.array_equal(certified.render(time, camera).color, fresh.color), (edits, moved.edits)


ROOM = quad((-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0))
"""A floor of two triangles."""
LID = quad((-0.4, -0.4, 1), (0.4, -0.4, 1), (0.4, 0.4, 1), (-0.4, 0.4, 1))
ABOVE = Camera((0.0, 0.0, 6.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 45.0)


def lidded() -> Scene:
    """A floor, and a lid above it that hides two lights from its middle."""
    lights = tuple(Light(f"light {n}", (x, 0.1, 3.0)) for n, x in enumerate((-0.5, 0.0, 0.5)))
    made = replace(scene(np.array(ROOM + LID, np.float32)), lights=lights)
    part_of = np.array([0, 0, 1, 1], np.int32)
    return replace(made, objects=(replace(made.objects[0], parts=("floor", "lid"), part_of=part_of),))


def learnt(original: Scene, method: str = "paper") -> Renderer:
    renderer = Renderer(original, replace(SMALL, method=method))
    for _ in range(3):
        renderer.render(0.0, ABOVE)
    return renderer


def after_edits(original: Scene, edits: Edits) -> tuple[Renderer, np.ndarray]:
    """A renderer of the edited scene, and the words that were carried over to it."""
    before, now = learnt(original), edited(original, edits)
    renderer = Renderer(now.scene, before.settings)
    carry_modes(before, edited(original, NO_EDITS), renderer, now)
    (history,) = renderer.state.histories.values()
    return renderer, history.words


def test_the_modes_of_other_lights_stay_when_one_is_switched_off():
    original = lidded()
    (known,) = learnt(original).state.histories.values()
    assert (modes.shadow_mode(known.words[:2], 1) == modes.ShadowMode.PARTIAL_SHADOW).all()
    _, words = after_edits(original, Edits(lights_off=frozenset({0})))
    for light in (0, 1):
        assert np.array_equal(modes.shadow_mode(words, light), modes.shadow_mode(known.words, light + 1))
    assert np.array_equal(modes.occlusion_mode(words), modes.occlusion_mode(known.words))


def test_what_something_may_have_blocked_is_learnt_anew_when_it_is_hidden():
    original = lidded()
    renderer, words = after_edits(original, Edits(hidden=frozenset({"lid"})))
    assert len(words) == 2 and (modes.shadow_mode(words, 1) == modes.ShadowMode.NON_SHADOW).all()
    assert not (modes.occlusion_mode(words) == modes.FULLY_RENDERED).any()
    for _ in range(3):
        frame = renderer.render(0.0, ABOVE)
    fresh = Renderer(renderer.scene, replace(renderer.settings, method="none")).render(0.0, ABOVE)
    assert np.array_equal(frame.color, fresh.color) and frame.statistics.shadow.dynamic_only > 0


def test_an_object_that_can_move_has_no_modes_and_casts_no_shadow_that_modes_speak_of():
    _, words = after_edits(lidded(), Edits(moving=frozenset({"lid"})))
    assert (modes.occlusion_mode(words[2:]) == modes.DYNAMIC).all()
    assert (modes.shadow_mode(words[:2], 1) == modes.ShadowMode.NON_SHADOW).all()


def test_a_light_that_is_switched_on_again_is_learnt_anew():
    original = lidded()
    off = edited(original, Edits(lights_off=frozenset({1})))
    before, now = learnt(off.scene), edited(original, NO_EDITS)
    renderer = Renderer(now.scene, before.settings)
    carry_modes(before, off, renderer, now)
    (history,) = renderer.state.histories.values()
    assert (modes.shadow_mode(history.words, 1) == modes.ShadowMode.INIT).all()
    assert (modes.shadow_mode(history.words[:2], 2) == modes.ShadowMode.PARTIAL_SHADOW).all()
    assert not (modes.occlusion_mode(history.words) == modes.FULLY_RENDERED).any()


def test_a_light_that_is_switched_on_again_leaves_those_before_it_their_modes():
    original = lidded()
    off = edited(original, Edits(lights_off=frozenset({1})))
    before, now = learnt(off.scene), edited(original, NO_EDITS)
    renderer = Renderer(now.scene, before.settings)
    carry_modes(before, off, renderer, now)
    (known,), (history,) = before.state.histories.values(), renderer.state.histories.values()
    full = modes.occlusion_mode(known.words) == modes.FULLY_RENDERED
    assert (modes.shadow_mode(known.words, 0)[full] == modes.ShadowMode.PARTIAL_SHADOW).any()
    for light, other in ((0, 0), (2, 1)):
        assert np.array_equal(modes.shadow_mode(history.words, light), modes.shadow_mode(known.words, other))


def test_what_gets_room_for_modes_of_one_light_more_is_seen_whole_anew():
    """A word holds modes of 31 lights: of those after them none are known, wherever they go."""
    lights = tuple(Light(f"light {n}", (-1.0 + 0.05 * n, 0.1, 3.0)) for n in range(33))
    _, words = after_edits(replace(lidded(), lights=lights), Edits(lights_off=frozenset({0})))
    assert (modes.shadow_mode(words, 29)[:2] == modes.ShadowMode.PARTIAL_SHADOW).all()
    assert (modes.shadow_mode(words, 30) == modes.ShadowMode.INIT).all()
    assert not (modes.occlusion_mode(words) == modes.FULLY_RENDERED).any()


def sliding() -> Scene:
    """A floor of many triangles below one light, and a lid that goes aside after a second."""
    steps = np.linspace(-2, 2, 17).tolist()
    floor = [
        row for x, right in pairwise(steps) for y, top in pairwise(steps)
        for row in quad((x, y, 0), (right, y, 0), (right, top, 0), (x, top, 0))
    ]  # fmt: skip
    lid = SceneObject("lid", scene(np.array(LID, np.float32)).objects[0].triangles, empty_quadrics(), ("slide",))
    places = np.zeros((5, 3))
    places[3:, 0] = 1.2
    keys = Keys(np.arange(-1.0, 4.0), places, np.zeros((5, 3)))
    made = scene(np.array(floor, np.float32), dynamic=(lid,))
    tracks = {**made.animation.tracks, "slide": TrackSet(translation=keys)}
    return replace(made, lights=(Light("lamp", (0.0, 0.1, 3.0)),), animation=Animation(tracks))


def test_what_is_static_elsewhere_leaves_no_modes_behind():
    original = sliding()
    first, then = (edited(original, Edits(static=(("lid", time),))) for time in (0.0, 2.0))
    before = Renderer(first.scene, replace(SMALL, width=96, height=96, method="paper", verify=True))
    for _ in range(3):
        before.render(0.0, ABOVE)
    renderer = Renderer(then.scene, before.settings)
    carry_modes(before, first, renderer, then)
    frames = [renderer.render(0.0, ABOVE) for _ in range(3)]
    assert frames[-1].statistics.shadow.wrong == 0
    fresh = Renderer(then.scene, replace(SMALL, width=96, height=96, method="none")).render(0.0, ABOVE)
    assert np.array_equal(frames[-1].color, fresh.color) and frames[-1].statistics.shadow.dynamic_only > 0


def test_a_renderer_beside_another_shows_the_same_edits():
    original = lidded()
    first = learnt(original, "certified")
    second = first.beside()
    second.settings = replace(first.settings, method="none")
    second.render(0.0, ABOVE)
    first.scene = first.world.scene = edited(original, Edits(moved_lights=((0, (1.0, 1.0, 2.5)),))).scene
    second.take_scene(first)
    assert np.array_equal(second.render(0.0, ABOVE).color, first.render(0.0, ABOVE).color)


@quickly(6)
@given(walk=walks(), seed=st.integers(0, 2**32 - 1))
def test_numbers_lead_back_to_the_scene_as_it_was_read(walk: Walk, seed: int):
    original = in_parts(walk.scene)
    now = edited(original, some_edits(original, np.random.default_rng(seed)))
    assert len(now.primitives) == now.scene.primitive_count and len(now.lights) == len(now.scene.lights)
    numbers, known = thing_numbers(original), things(original)
    for primitive, number in enumerate(now.primitives.tolist()):
        assert now.numbers[number] == primitive
        assert now.scene.material_of(primitive) == original.material_of(number)
        assert known[numbers[number]] == thing_of(original, number)
        assert number not in now.edits.hidden_primitives
        name, index = known[numbers[number]].name, now.scene.object_of(primitive)
        frozen, free = name in dict(now.edits.static), name in now.edits.moving
        assert (index > 0) == (free or (known[numbers[number]].moves and not frozen))
    assert edited(original, NO_EDITS).scene is original


@quickly(4)
@given(made=scenes(), time=st.floats(0.0, 3.0))
def test_objects_that_are_made_static_are_where_they_were(made: Scene, time: float):
    moving = [t for t in things(made) if t.moves]
    now = edited(made, Edits(static=tuple((t.name, time) for t in moving)))
    assert not any(len(one.triangles) + len(one.quadrics) for one in now.scene.objects[1:])
    world = World(made, time)
    rows, there = world.primitives.triangles.astype(np.float64), world.pose(time)
    for primitive, number in enumerate(now.primitives[: now.scene.triangle_count].tolist()):
        matrix = there.to_world[made.object_of(number)]
        corners = rows[number, :3] + [np.zeros(3), rows[number, 3:6], rows[number, 6:]]
        placed = corners @ matrix[:, :3].T + matrix[:, 3]
        assert np.abs(np.sort(placed, 0) - np.sort(now.scene.objects[0].triangles.corners[primitive], 0)).max() < 1e-5
    hidden = {t.index for t in moving if not there.present[t.index]}
    assert {made.object_of(n) for n in now.primitives.tolist()} == set(range(len(made.objects))) - hidden


def test_the_same_edits_made_again_are_the_same_scene():
    """What was measured of a scene is of it again once an edit was undone and redone; nothing holds on to scenes."""
    floor, light = quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), (0.5, 0.5, 2.0)
    made = scene(floor, lights=(light,))
    off, moved = (Edits(moved_lights=((0, place),)) for place in ((1.0, 2.0, 3.0), (1.0, 2.0, 4.0)))
    first = edited(made, off).scene
    whole, origin = Origin(made), Origin(first)
    assert whole.is_of(made) and whole.is_of(edited(made, NO_EDITS).scene) and not whole.is_of(first)
    again = edited(made, off).scene
    assert again is not first and origin.is_of(again) and origin.is_of(first) and Origin(again).is_of(first)
    del first, again
    assert origin.is_of(edited(made, off).scene) and not origin.is_of(edited(made, moved).scene)
    assert not origin.is_of(made) and not origin.is_of(None)
    assert origin.is_of(edited(replace(made), off).scene), "the same file was read again"
    del made
    gc.collect()
    assert whole.is_of(scene(floor, lights=(light,))) and not whole.is_of(scene(floor))

"""A session comes back to a state, goes through time, and shows its scene edited; edits in words and as options."""

from __future__ import annotations

import json
from argparse import ArgumentParser
from dataclasses import replace

import pytest

from tests.viewer.fakes import make_scene
from tracer.editing.edits import NO_EDITS, Edits, edited
from tracer.frame import Settings
from tracer.scene.lights import light_in_words, named_light, number_of
from tracer.scene.model import Camera
from viewer.cli.options import add_edits, edits_of, light_index
from viewer.state import codec
from viewer.state.session import Session
from viewer.state.view_state import ViewState, edits_in_words, one_by_one
from viewer.state.views import View

AWAY = Camera((1.0, 2.0, 3.0), (0.0, 0.6, -0.8), (0.0, 0.8, 0.6), 33.0)
ALL_KINDS = Edits(
    lights_off=frozenset({1}), moved_lights=((0, (0.1, -2.0, 1e-7)), (2, (1.0, 2.0, 3.0))),
    hidden=frozenset({"train"}), hidden_primitives=frozenset({3, 0}), static=(("train", 2.5),),
    moving=frozenset({"static"}),
)  # fmt: skip


def opened(**scene: object) -> Session:
    session = Session()
    session.open(make_scene(**scene))
    return session


def test_a_state_brings_everything_back_but_what_belongs_to_the_machine_and_what_the_scene_lacks() -> None:
    first, second = opened(), Session(state=ViewState(settings=Settings(width=99, threads=3)))
    first.set_settings(method="none", zoom_factor=7.5, symmetric=True, depth=3)
    first.change(time=4.0, camera=AWAY)
    first.set_draw(view=View.SHADOW, light=2, wipe=0.25)
    second.open(make_scene())
    second.playing = True
    second.restore(first.state)
    assert (second.camera, second.time, second.draw, second.playing) == (AWAY, 4.0, first.draw, False)
    assert second.settings == replace(first.settings, width=99, threads=3)
    second.restore(replace(first.state, camera=None))
    assert second.on_path and second.camera == second.scene.camera_at(4.0)
    other = opened(lights=2)
    edits = Edits(lights_off=frozenset({2}), hidden=frozenset({"train"}))
    other.restore(replace(first.state, scene="/gone.aff", time=1e9, edits=edits))
    assert other.time == 10.0 and other.draw.light == 1 and other.state.scene != "/gone.aff"
    assert other.edits == Edits(hidden=frozenset({"train"}))


def test_time_goes_round_or_stops_at_the_end():
    session = opened(frames=11)
    for loop, seconds in ((True, 0.5), (False, 10.0)):
        session.playing = True
        session.change(time=9.5)
        session.advance(1.0, loop)
        assert session.time == pytest.approx(seconds) and session.playing == loop
    session.go_to_frame(0)
    for expected in (1, 2, 3):
        session.advance_frame(loop=False)
        assert (session.frame, session.time) == (expected, pytest.approx(float(expected)))
    session.go_to_frame(99)
    session.advance_frame(loop=False)
    assert session.frame == 10 and not session.playing
    session.advance_frame(loop=True)
    assert session.frame == 0
    still = opened(frames=1)
    still.playing = True
    still.advance(1.0, loop=True)
    assert not still.playing and still.frame == 0 and Session().camera.angle > 0, "there is a camera without a scene"


def test_edits_come_back_from_json_and_each_has_words_and_can_go_by_itself():
    for edits in (ALL_KINDS, NO_EDITS, Edits(hidden_primitives=frozenset(range(100_001)))):
        state = codec.state_to_json(ViewState(edits=edits))
        assert codec.state_from_json(json.loads(json.dumps(state))).edits == edits
    listed = one_by_one(ALL_KINDS)
    words = [text for text, _ in listed]
    assert sorted(words) == sorted(edits_in_words(NO_EDITS, ALL_KINDS).values()) and "light 1 off" in words
    for text, without in listed:
        assert list(edits_in_words(without, ALL_KINDS).values()) == [text]


def test_the_chosen_light_stays_whatever_lights_are_off():
    session = opened(lights=3)
    session.set_draw(light=2)
    for off, light in (({0}, 1), ({2}, 1), (set(), 1)):  # the nearest that is on
        session.take(edited(session.original, Edits(lights_off=frozenset(off))))
        assert session.draw.light == light
    assert session.scene is session.original


def test_lights_keep_their_numbers_whichever_others_are_off():
    edits, scene = Edits(lights_off=frozenset({0, 3})), make_scene(lights=6)
    assert [edits.light_number(index) for index in range(4)] == [1, 2, 4, 5]
    assert [edits.light_index(number) for number in range(6)] == [None, 0, 1, None, 2, 3]
    lights = edited(scene, edits).scene.lights
    assert [number_of(lights, index) for index in range(4)] == [1, 2, 4, 5]
    assert [light.name for light in lights] == [scene.lights[number].name for number in (1, 2, 4, 5)]
    assert named_light(lights, 1) == light_in_words(2, scene.lights[2].name)
    session = Session(scene)
    session.take(edited(scene, edits))
    session.set_draw(light=2)
    assert session.light_number == 4
    parser = ArgumentParser()
    add_edits(parser)
    options = parser.parse_args(["--without-light=1"])
    dark = edited(scene, edits_of(options)).scene
    assert [light_index(options, "--light ", number, dark) for number in (0, 2)] == [0, 1]
    for number, said in ((1, "this light is switched off"), (9, "the scene's lights are 0 to 5")):
        with pytest.raises(ValueError, match=f"--light {number}: {said}"):
            light_index(options, "--light ", number, dark)

"""Edits in words, as JSON and as options; the session that is edited."""

from __future__ import annotations

import json
from argparse import ArgumentParser

import pytest

from tests.viewer.fakes import make_scene
from tracer.scene.edits import NO_EDITS, Edits, edited
from tracer.scene.lights import light_in_words, named_light, number_of
from viewer.cli.options import add_edits, edits_of, light_index
from viewer.state import codec
from viewer.state.session import Session
from viewer.state.view_state import ViewState, edits_in_words, one_by_one

ALL_KINDS = Edits(
    lights_off=frozenset({1}),
    moved_lights=((0, (0.1, -2.0, 1e-7)), (2, (1.0, 2.0, 3.0))),
    hidden=frozenset({"train"}),
    hidden_primitives=frozenset({3, 0}),
    static=(("train", 2.5),),
    moving=frozenset({"static"}),
)


def test_edits_come_back_from_json_however_many_they_are():
    for edits in (ALL_KINDS, NO_EDITS, Edits(hidden_primitives=frozenset(range(100_001)))):
        state = codec.state_to_json(ViewState(edits=edits))
        assert codec.state_from_json(json.loads(json.dumps(state))).edits == edits


def test_each_edit_has_words_and_can_go_by_itself():
    listed = one_by_one(ALL_KINDS)
    words = [text for text, _ in listed]
    assert sorted(words) == sorted(edits_in_words(NO_EDITS, ALL_KINDS).values()) and "light 1 off" in words
    for text, without in listed:
        assert list(edits_in_words(without, ALL_KINDS).values()) == [text]


def test_the_chosen_light_stays_whatever_lights_are_off():
    session = Session()
    session.open(make_scene(lights=3))
    session.set_draw(light=2)
    session.take(edited(session.original, Edits(lights_off=frozenset({0}))))
    assert session.draw.light == 1 and len(session.scene.lights) == 2
    session.take(edited(session.original, Edits(lights_off=frozenset({2}))))
    assert session.draw.light == 1, "the nearest that is on"
    session.take(edited(session.original, NO_EDITS))
    assert session.draw.light == 1 and session.scene is session.original


def test_a_snapshot_keeps_edits_and_gives_up_those_without_a_target():
    session = Session()
    session.open(make_scene(lights=3))
    session.change(edits=Edits(lights_off=frozenset({2}), hidden=frozenset({"train"})))
    kept = session.state
    assert kept.edits == session.edits
    other = Session()
    other.open(make_scene(lights=2))
    other.restore(kept)
    assert other.edits == Edits(hidden=frozenset({"train"}))


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


def test_options_name_lights_by_their_numbers_in_the_file():
    parser, scene = ArgumentParser(), make_scene(lights=3)
    add_edits(parser)
    options = parser.parse_args(["--without-light=1"])
    dark = edited(scene, edits_of(options)).scene
    assert [light_index(options, "--light ", number, dark) for number in (0, 2)] == [0, 1]
    with pytest.raises(ValueError, match="--light 1: this light is switched off"):
        light_index(options, "--light ", 1, dark)
    with pytest.raises(ValueError, match="--view shadow:3: the scene's lights are 0 to 2"):
        light_index(options, "--view shadow:", 3, dark)

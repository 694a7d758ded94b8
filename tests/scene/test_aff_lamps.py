"""`lamp`, the statement for lights of some size: what it puts into the scene, and what is wrong in one line."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tracer.scene.aff import load_aff
from tracer.scene.lights import DEFAULT_SAMPLES, MAX_SAMPLES, Light
from tracer.scene.model import SceneError

TRIANGLE = "p 3 0 0 0 1 0 0 0 1 0 "
VIEW = "v from 1 2 3 at 1 2 0 up 0 1 0 angle 40 hither 1 resolution 8 8 "
KEYS = "transl 4 " + " ".join(f"{t} 5 0 0 0 0 0" for t in range(4))
TURNS = "rot 4 " + " ".join(f"{t} 0 1 0 {9 * t} 0 0 0" for t in range(4))
GROWS = "scale 4 " + " ".join(f"{t} 2 2 2 0 0 0" for t in range(4))


def lamp(read, text: str, *, around: str = "") -> Light:
    """The only light of a scene, within some transforms."""
    (light,) = read(f"{VIEW}{around}{text}{' }' * around.count('{')} {TRIANGLE}").lights
    return light


def test_each_kind(read):
    point = lamp(read, "lamp point at 1 2 3 color .1 .2 .3 falloff inverse-square")
    assert point == Light("light 0", (1, 2, 3), (0.1, 0.2, 0.3), falloff="inverse square")
    sphere = lamp(read, "lamp sphere at 1 2 3 radius .25 samples 9 falloff none")
    assert sphere == Light("light 0", (1, 2, 3), kind="sphere", radius=0.25, samples=9)
    rectangle = lamp(read, "lamp rectangle at 1 2 3 edges 1 0 0  0 0 2 samples 4")
    assert rectangle == Light("light 0", (1, 2, 3), kind="rectangle", edges=((1, 0, 0), (0, 0, 2)), samples=4)
    dome = lamp(read, "lamp dome at 1 2 3 radius 50 up 0 0 1 samples 64")
    assert dome == Light("light 0", (1, 2, 3), kind="dome", radius=50, edges=((0, 0, 1),), samples=64)


def test_what_is_not_given(read):
    dome = lamp(read, "lamp dome radius 2 at 0 0 0")
    assert (dome.edges, dome.samples, dome.color, dome.falloff) == (((0, 1, 0),), DEFAULT_SAMPLES, (1, 1, 1), "none")


def test_words_come_in_any_order_and_statements_may_follow(read):
    text = "lamp sphere samples 4 color 1 0 0 radius 1 at 0 9 0 l 1 2 3 lamp point at 4 5 6 la a 7 8 9"
    scene = read(VIEW + text + " b .1 .2 .3 " + TRIANGLE)
    assert [light.kind for light in scene.lights] == ["sphere", "point", "point", "point"]
    assert [light.name for light in scene.lights] == ["light 0", "light 1", "light 2", "a"]
    assert scene.background == (0.1, 0.2, 0.3)
    assert scene.warnings == ()


def test_static_transforms_place_turn_and_scale(read):
    """Twice as large, a quarter turn about y, one further along x."""
    around = "xs 2 2 2 0 1 0 90 1 0 0 { "
    sphere = lamp(read, "lamp sphere at 1 0 0 radius 3", around=around)
    assert sphere.position == pytest.approx((1, 0, -2)) and sphere.radius == pytest.approx(6)
    rectangle = lamp(read, "lamp rectangle at 0 0 0 edges 1 0 0  0 1 0", around=around)
    assert np.allclose(rectangle.edges, [(0, 0, -2), (0, 2, 0)])
    dome = lamp(read, "lamp dome at 0 0 0 radius 1 up 1 0 0", around=around)
    assert np.allclose(dome.edges, [(0, 0, -2)]) and dome.radius == pytest.approx(2)
    nested = lamp(read, "lamp sphere at 0 0 0 radius 1", around=around + "xs 3 3 3 1 2 3 77 0 0 0 { ")
    assert nested.radius == pytest.approx(6)


def test_a_translation_track_moves_a_lamp_and_not_what_it_is_named_after_alone(read):
    text = "lamp rectangle at 1 0 0 edges 1 0 0  0 1 0 name swing lamp sphere at 0 0 0 radius 1 name still "
    scene = read(VIEW + text + TRIANGLE + f"k swing {{ {KEYS} }}")
    swing, still = scene.lights
    assert (swing.track, still.track) == ("swing", None) and still.name == "still"
    assert np.array_equal(scene.light_positions(1.5), [(6, 0, 0), (0, 0, 0)])
    assert scene.warnings == ()


RECTANGLE, SPHERE = "lamp rectangle at 0 0 0 edges 1 0 0  0 1 0", "lamp sphere at 0 0 0 radius 1"


@pytest.mark.parametrize(
    "text, said",
    [
        (
            f"x turn {{\n {RECTANGLE} }} k turn {{ {TURNS} }}",
            "a lamp neither moves nor turns with the transform around",
        ),
        (
            f"\n{RECTANGLE} name t k t {{ {KEYS} {TURNS} }}",
            "the track 't' moves the lamp, but neither turns nor scales",
        ),
        (f"\n{SPHERE} name t k t {{ {KEYS} {GROWS} }}", "the track 't' moves the lamp, but neither turns nor scales"),
        (f"xs 1 2 1 0 1 0 0 0 0 0 {{\n {SPHERE} }}", "a sphere lamp stays round under a transform that scales"),
    ],
)
def test_what_is_left_out_is_warned_of_once(read, text, said):
    (warning,) = read(VIEW + text + TRIANGLE).warnings
    assert f"scene.aff:2: {said}" in warning


def test_what_makes_no_difference_is_not_warned_of(read):
    text = f"{SPHERE} name t xs 1 2 1 0 1 0 0 0 0 0 {{ {RECTANGLE} }} x nothing {{ {SPHERE} }} k t {{ {KEYS} {TURNS} }}"
    assert read(VIEW + text + TRIANGLE).warnings == ()


ERRORS = {
    "lamp": r":1: the file ends where the kind of a lamp should follow; complete the file",
    "\nlamp 1 2 3": r":2: '1' is no kind of lamp; there are point, sphere, rectangle, dome",
    "lamp sun\xff at 1 2 3": r":1: 'sun.*' is no kind of lamp; there are point, sphere, rectangle, dome",
    "\nlamp sphere\n at 0 0 0\n b 0 0 0": r":2: the sphere lamp has no 'radius'; add it",
    "lamp rectangle edges 1 0 0 0 1 0": r":1: the rectangle lamp has no 'at'; add it",
    "lamp point at 0 0 0\n radius 1": r":2: a point lamp has no 'radius', it takes at, color, falloff, name; remove it",
    "lamp sphere radius 1 at 0 0 0 up 0 1 0": r":1: a sphere lamp has no 'up', it takes at, .*; remove it",
    "lamp sphere radius -1 at 0 0 0": r":1: a radius of -1; give 0 or more",
    "lamp sphere radius inf at 0 0 0": r":1: 'inf' in radius of the lamp is not finite; write a number",
    "lamp sphere at 0 0 radius 1": r":1: 'radius' in at of the lamp is not a number; correct it",
    "lamp dome at 0 0 0 radius 1 up 0 0 0": r":1: 'up' of a dome has no length; give the direction of its top",
    "lamp sphere samples 0": r":1: 0 samples; give at least 1",
    f"lamp sphere samples {MAX_SAMPLES + 1}": rf":1: {MAX_SAMPLES + 1} samples; give at most {MAX_SAMPLES}",
    "lamp sphere samples 2.5": r":1: '2\.5' in the number of samples is not a whole number; correct it",
    "lamp point at 0 0 0 falloff linear": r":1: 'linear' is no falloff; there are none, inverse-square",
    "lamp point at 0 0 0 name {": r":1: '\{' where the name of a lamp should stand; put it before the brace",
    "lamp point at 0 0 0 colour 1 1 1": r":1: unknown statement 'colour'; correct it, .*",
}


@pytest.mark.parametrize("text", ERRORS)
def test_errors_name_file_and_line(write, text):
    path = write(text.encode("latin-1"))
    with pytest.raises(SceneError) as caught:
        load_aff(path)
    assert re.fullmatch(re.escape(str(path)) + ERRORS[text], str(caught.value))

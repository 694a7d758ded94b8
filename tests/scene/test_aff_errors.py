"""Bad AFF: one clear line that names file and line, or a counted warning and the rest of the scene."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.platforms import permissions
from tracer.scene.aff import load_aff
from tracer.scene.model import Scene, SceneError

TRIANGLE = "p 3 0 0 0 1 0 0 0 1 0\n"
MESH = "m\nvertices 3\n0 0 0\n1 0 0\n0 1 0\n"
SETTING = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 8 8 l 0 9 0 fm 0 0 0 1 1 1 0 0 0 1 0 0 "

# What is wrong, and the whole message after the name of the file.
ERRORS = {
    "\n\nq 1 2": r":3: unknown statement 'q'; correct it, or check that this is an AFF file",
    "b 1 2 x": r":1: 'x' in the background is not a number; correct it",
    "b 1 2\n": r":1: the file ends within the background, 1 of 3 numbers are missing; complete the file",
    "b 1 2 nan": r":1: 'nan' in the background is not finite; write a number",
    "l 1 2 3 4": r":1: the file ends within the colour of a light, 2 of 3 numbers are missing; complete the file",
    "v from 1 2 3 up 0 1 0": r":1: the viewpoint has no 'at'; add it",
    "v from 1 2 3 at 1 2 3": r":1: the viewpoint looks at itself; make 'from' and 'at' differ",
    "v from 1 2 3 at 0 0 0 angle 180": r":1: an angle of 180 degrees; give one between 0 and 180",
    "a 0 1 0": r":1: 0 frames; give at least 1",
    "a 0 1 2.5": r":1: '2\.5' in the number of frames is not a whole number; correct it",
    "xs 1 1 1 0 1 0 0 0 0 0\n" + TRIANGLE: r":2: 'p' where '\{' of a transform should stand; insert it",
    "x {\n" + TRIANGLE + "}": r":1: '\{' where the name of a transform should stand; put it before the brace",
    "\nx a {\n x b { " + TRIANGLE + "}": r":2: '\{' that is never closed; add '\}'",
    TRIANGLE + "}": r":2: '\}' that closes nothing; remove it or open a brace before it",
    "p 2 0 0 0 1 0 0": r":1: 2 corners of a polygon; give at least 3",
    "p three": r":1: 'three' in the number of corners of a polygon is not a whole number; correct it",
    "m\ntriangles 1": r":2: 'triangles' where 'vertices' of a mesh should stand; insert it",
    MESH + "triangles 2\n0 1 2\n0 1 3": r":8: index 3 into vertices is out of range; there are 3, counted from 0",
    MESH + "triangles 1\n-1 1 2": r":7: index -1 into vertices is out of range; there are 3, counted from 0",
    MESH + "normals 1 0 0 1 triangles 1\n0 1 2\n0 0 1": r":8: index 1 into normals is out of range; there are 1, .*",
    MESH + "triangles 1\n0 1 1.5": r":7: '1\.5' in triangles is not a whole number; correct it",
    MESH + "triangles 1\n0 1 99999999999999999999": r":7: '99999999999999999999' in triangles is not a whole .*",
    MESH
    + "triangles 9999999999\n0 1 2\n": r":7: the file ends within triangles, 29999999994 of 29999999997 numbers .*",
    MESH: r":5: the file ends where 'triangles' of a mesh should follow; complete the file",
    "m\nvertices 2\n0 0 0\n1 zero 0\ntriangles 0": r":4: 'zero' in vertices is not a number; correct it",
    "m vertices -1": r":1: -1 vertices; give at least 0",
    "tpa 0": r":1: 0 keys of an animated triangle; give at least 1",
    "k a {\n transl 3": r":2: 3 keys of transl; give at least 4",
    "k a {\n turn 3": r":2: unknown track 'turn'; there are transl, rot, scale and visibility",
    "k a { visibility 1 0 1": r":1: the file ends where a track or '\}' should follow; complete the file",
    "i 0 nowhere.aff": r":1: the included file 'nowhere\.aff' cannot be read: no such file or directory; add it or .*",
    "\ni 0 .": r":2: the included file '\.' cannot be read: it is a folder, not a file; add it or correct the name",
    "i 0 no\0where": r":1: the included file 'no\\x00where' cannot be read: .*; add it or correct the name",
    "i 0 scene.aff": r":1: 'scene\.aff' includes itself; break the circle",
    "\ni": r":2: the file ends within the number of detail levels, 1 of 1 numbers are missing; complete the file",
    "": r":1: the file is empty; give a scene with at least one statement",
    "# nothing\n": r":1: the file is empty; give a scene with at least one statement",
}


@pytest.mark.parametrize("text", ERRORS)
def test_errors_name_file_and_line(write, text):
    path = write(text)
    with pytest.raises(SceneError) as caught:
        load_aff(path)
    assert re.fullmatch(re.escape(str(path)) + ERRORS[text], str(caught.value))


def test_errors_in_included_files_name_those(write):
    with pytest.raises(SceneError, match=r"part\.aff:2: unknown statement 'oops'"):
        load_aff(write("i 0 part.aff", part="\noops"))


def test_braces_close_in_the_file_that_opens_them(write):
    with pytest.raises(SceneError, match=r"part\.aff:1: '\}' that closes nothing"):
        load_aff(write("x a { i 0 part.aff", part="}"))


def test_circles_of_several_files(write):
    with pytest.raises(SceneError, match=r"b\.aff:1: 'scene\.aff' includes itself"):
        load_aff(write("i 0 a.aff", a="i 0 b.aff", b="i 0 scene.aff"))


def test_the_same_file_twice_is_no_circle(read):
    assert read("i 0 a.aff i 0 a.aff", a=TRIANGLE).triangle_count == 2


@permissions
def test_an_unreadable_include(write, tmp_path):
    path = write("i 0 secret.aff", secret=TRIANGLE)
    (tmp_path / "secret.aff").chmod(0)
    with pytest.raises(SceneError, match=r"scene\.aff:1: .*'secret\.aff' cannot be read: permission denied"):
        load_aff(path)


def test_binary_garbage(write):
    data = bytes(np.random.default_rng(5).integers(0, 256, 100_000, np.uint8))
    with pytest.raises(SceneError, match=r"^[^\n]*scene\.aff:\d+: unknown statement [ -~]{1,60}; correct it[^\n]*$"):
        load_aff(write(data))


def test_a_scene_cut_anywhere(write):
    whole = (
        SETTING + "x a {\n" + MESH + "triangles 1 0 1 2 }\ns 0 0 0 1 c 0 0 0 1 0 1 0 1 tpa 1 0"
        " 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 k a { visibility 1 0 1 }"
    )
    for length in range(0, len(whole), 3):
        try:
            load_aff(write(whole[:length]))
        except SceneError as error:
            assert re.match(r"[^\n]*scene\.aff:\d+: [^\n]+; [^\n]+$", str(error))


WORDS = st.sampled_from(b"v l la b am a f fm c s p pp tt ttp tpa m i d x xs k { } 0 1 -2.5 3 nan 1e999 w".split())


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(WORDS))
def test_any_words_give_a_scene_or_one_line(write, words):
    try:
        assert isinstance(load_aff(write(b" ".join(words))), Scene)
    except SceneError as error:
        assert "\n" not in str(error)


def test_triangles_that_are_not_finite_are_dropped_and_counted(read):
    bad = "nan 0 0 1 0 0 0 1 0\n"
    scene = read(
        SETTING + TRIANGLE + "p 3 " + bad + "p 3 " + bad + "p 3 1e39 0 0 1 0 0 0 1 0\n" + TRIANGLE + "i 0 part.aff",
        part="m vertices 4 0 0 0 1 0 0 0 1 0 inf 0 0 triangles 2\n0 1 2\n0 1 3",
    )
    assert scene.triangle_count == 3
    assert np.isfinite(scene.objects[0].triangles.corners).all()
    first, second, far = scene.warnings
    what = "a triangle with a corner that is not a finite number is dropped; correct it"
    assert first.endswith(f"scene.aff:2: {what} (the first of 2 in this file)")
    assert far.endswith("scene.aff:4: a triangle with a corner beyond 1e+09 is dropped; bring it nearer")
    assert second.endswith(f"part.aff:3: {what}")


def test_overflow_by_a_transform_is_dropped_too(read):
    scene = read(SETTING + "xs 1e9 1 1 0 1 0 0 0 0 0 { p 3 1e30 0 0 0 1 0 0 0 1 } " + TRIANGLE)
    assert scene.triangle_count == 1
    assert len(scene.warnings) == 1


def test_triangles_without_area_stay(read):
    scene = read(SETTING + "p 3 0 0 0 1 1 1 2 2 2\n" + TRIANGLE)
    assert scene.triangle_count == 2
    assert np.linalg.norm(scene.objects[0].triangles.normals, axis=2) == pytest.approx(np.ones((2, 3)))
    assert len(scene.warnings) == 1
    assert scene.warnings[0].endswith("scene.aff:1: a triangle without area is kept, but no ray can meet it")


def test_deforming_triangles_that_are_not_finite(read):
    good = "0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 "
    scene = read(SETTING + f"tpa 2 0 {good} 1 {good} \n tpa 2 0 {good} 1 nan {good[2:]}" + TRIANGLE)
    assert [len(o.triangles) for o in scene.objects] == [1, 1]
    assert "scene.aff:2: a triangle with a corner" in scene.warnings[0]


def test_quadrics_without_extent(read):
    scene = read(SETTING + "s 0 0 0 0 c 0 0 0 1 0 0 0 1 c 0 0 0 0 0 1 0 0 s nan 0 0 1 s 0 0 0 1 " + TRIANGLE)
    assert len(scene.objects[0].quadrics) == 1
    assert len(scene.warnings) == 3  # of spheres, of cones, of numbers


def test_a_scene_of_nothing(read):
    scene = read("b 1 0 0")
    assert scene.primitive_count == 0
    assert [w.split(": ", 1)[1].split(";")[0] for w in scene.warnings] == [
        "no viewpoint (v)",
        "no light (l)",
        "no triangle, sphere or cone",
    ]


def test_a_missing_viewpoint_is_made_up(read):
    camera = read("xs 1 1 1 0 1 0 0 100 0 0 { " + TRIANGLE + " }").camera
    assert np.dot(np.subtract((100.3, 0.3, 0), camera.position), camera.direction) > 0

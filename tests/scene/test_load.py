"""The one way in: kinds of files, files that are none, progress and cancelling."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest

from tests.platforms import permissions, posix_only
from tracer.scene.load import load_scene, load_visible_scene, scene_info
from tracer.scene.model import Cancelled, SceneError

TRIANGLE = "p 3 0 0 0 1 0 0 0 1 0\n"


def test_nff_is_aff(write):
    assert load_scene(write(TRIANGLE, "scene.NFF")).triangle_count == 1


@pytest.mark.parametrize("name, lights, colors", [
    ("a.nff", "l 1 2 3 l 4 5 6 l 7 8 9 l 1 1 1", [(0.5, 0.5, 0.5)] * 4),
    ("a.NFF", "l 1 2 3", [(1, 1, 1)]),
    ("a.aff", "l 1 2 3 l 4 5 6", [(1, 1, 1)] * 2),
    ("a.nff", "l 1 2 3 l 4 5 6 .2 .3 .4", [(1, 1, 1), (0.2, 0.3, 0.4)]),
    ("a.nff", "l 1 2 3 lamp sphere at 4 5 6 radius 1", [(1, 1, 1)] * 2),
    ("a.nff", "", []),
])  # fmt: skip
def test_lights_of_nff_without_colours_share_their_intensity(write, name, lights, colors):
    assert [light.color for light in load_scene(write(f"{lights} {TRIANGLE}", name)).lights] == colors


@pytest.mark.parametrize("name", ["nowhere.aff", "nowhere.obj"])
def test_a_missing_file(tmp_path, name):
    with pytest.raises(SceneError, match=r"nowhere\.\w+: no such file; check the path"):
        load_scene(tmp_path / name)


def test_a_folder(tmp_path):
    (tmp_path / "a.aff").mkdir()
    with pytest.raises(SceneError, match=r"a\.aff: it is a folder; give a file in it"):
        load_scene(str(tmp_path / "a.aff"))


def test_an_unknown_kind(tmp_path):
    (tmp_path / "a.txt").write_text("hello")
    with pytest.raises(SceneError, match=r"a\.txt: unknown kind of scene; give a file of one of these kinds: aff, nff"):
        load_scene(tmp_path / "a.txt")


@permissions
def test_an_unreadable_file(write):
    path = write(TRIANGLE)
    path.chmod(0)
    with pytest.raises(SceneError, match=r"scene\.aff: reading it is not permitted; change its permissions"):
        load_scene(path)


@posix_only
def test_no_regular_file(tmp_path):
    os.mkfifo(tmp_path / "pipe.aff")
    with pytest.raises(SceneError, match=r"pipe\.aff: cannot be read: it is not a regular file; check the path"):
        load_scene(tmp_path / "pipe.aff")


@pytest.mark.parametrize("name", ["a\0b.aff", "a" * 999 + ".aff"])
def test_impossible_names(name):
    with pytest.raises(SceneError, match=r"^[^\n]*: no (such )?file[^\n]*; check the path$"):
        load_scene(name)


def test_progress_rises_to_one(bart):
    seen = []
    load_scene(bart / "kitchen/kitchen.aff", lambda what, fraction: seen.append((what, fraction)))
    fractions = [f for _, f in seen]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0
    assert fractions[-1] == 1
    assert len(set(fractions)) > 3
    assert all(what.startswith("Read") for what, _ in seen)


@pytest.mark.parametrize("calls", [1, 2, 3])
def test_loading_can_be_cancelled(bart, calls):
    seen = []

    def stop(what, fraction):
        seen.append(what)
        if len(seen) == calls:
            raise Cancelled

    with pytest.raises(Cancelled):
        load_scene(bart / "kitchen/kitchen.aff", stop)
    assert len(seen) == calls


def test_putting_many_pieces_together_is_told_and_can_be_cancelled(write, monkeypatch):
    monkeypatch.setattr("tracer.scene.aff.SECONDS_BETWEEN_REPORTS", 0.0)
    monkeypatch.setattr("tracer.scene.assembly.PIECES_BETWEEN_REPORTS", 10)
    path, told = write("v from 0 0 9 at 0 0 0 l 0 9 0 " + TRIANGLE * 50), []

    def stop(what, fraction):
        told.append(what)
        if len([t for t in told if t.endswith("putting it together")]) == 3:
            raise Cancelled

    with pytest.raises(Cancelled):
        load_scene(path, stop)
    assert told[0].startswith("Reading") and len(told) > 50


def test_info(write):
    moving = "x a { p 3 0 0 0 1 0 0 0 0 1 s 0 0 0 1 } k a { transl 4 " + "0 5 0 0 0 0 0 " * 4 + "}"
    text = "a 0 2 60 l 0 9 0 v from 0 0 9 at 0 0 0 fm 0 0 0 1 1 1 0 0 0 1 0 0 c 0 0 0 1 0 2 0 .5 " + TRIANGLE + moving
    info = scene_info(load_scene(write(text)))
    bounds = info.pop("bounds")
    assert np.array(bounds) == pytest.approx(np.array([(-1, -1, -1), (6, 2, 1)]))
    assert info == {
        "triangles": 2,
        "static_triangles": 1,
        "dynamic_triangles": 1,
        "spheres": 1,
        "cones": 1,
        "lights": 1,
        "materials": 1,
        "textures": 0,
        "frames": 60,
        "time": [0.0, 2.0],
        "warnings": [],
        "light_kinds": [{"kind": "point", "samples": 1, "falloff": "none", "lights": 1}],
    }


def test_info_of_nothing(write):
    info = scene_info(load_scene(write("b 0 0 0")))
    assert info["bounds"] is None
    assert info["triangles"] == 0
    json.dumps(info)


def test_a_scene_of_what_is_too_large_says_so(write):
    with pytest.raises(SceneError, match=r"scene\.aff:1: a sphere beyond 1e\+09 is dropped; .*; nothing else is to be"):
        load_visible_scene(write("s 0 0 0 1e12\ns 0 0 0 2e12\n"))

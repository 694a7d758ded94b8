"""Transforms and tracks: what ends up in the static world, and what moves as one."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracer.scene.assembly import resolve
from tracer.scene.load import load_scene

TRIANGLE = "p 3 0 0 0 1 0 0 0 1 0 "


def moving(name: str, x: float = 5) -> str:
    keys = " ".join(f"{t} {x} 0 0 0 0 0" for t in range(4))
    return f"k {name} {{ transl 4 {keys} }} "


def test_static_transforms_nest(read):
    scene = read("xs 2 2 2 0 0 1 90 1 0 0 { xs 1 1 1 0 1 0 0 10 0 0 { " + TRIANGLE + "} }")
    # inner: (1, 0, 0) -> (11, 0, 0); outer: twice, a quarter turn, one on
    assert scene.objects[0].triangles.corners[0] == pytest.approx(
        np.array([(1, 20, 0), (1, 22, 0), (-1, 20, 0)]), abs=1e-5
    )
    assert len(scene.objects) == 1


def test_axes_of_any_length(read):
    one, ten, none = (read(f"xs 1 1 1 0 0 {z} 90 0 0 0 {{ {TRIANGLE} }}").objects[0].triangles for z in (1, 10, 0))
    assert one.corners == pytest.approx(ten.corners)
    assert none.corners[0, 1].tolist() == [1, 0, 0]


def test_normals_follow_the_inverse_transpose(read):
    scene = read("xs 1 4 1 0 1 0 0 0 0 0 { pp 3  0 0 0 1 1 0  0 0 1 1 1 0  -1 1 0 1 1 0 }")
    expected = np.array([1, 0.25, 0]) / np.hypot(1, 0.25)
    assert scene.objects[0].triangles.normals[0, 0] == pytest.approx(expected)


def test_a_mirroring_transform_keeps_the_winding(read):
    scene = read("xs -1 1 1 0 1 0 0 0 0 0 { pp 3  0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1 }")
    triangles = scene.objects[0].triangles
    a, b, c = triangles.corners[0]
    assert np.cross(b - a, c - a)[2] > 0
    assert np.array_equal(triangles.normals[0], [(0, 0, 1)] * 3)


def test_a_flattening_transform_keeps_normals(read):
    scene = read("xs 1 1 0 0 1 0 0 0 0 0 { pp 3  0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1 }")
    assert np.array_equal(scene.objects[0].triangles.normals[0], [(0, 0, 1)] * 3)


def test_normals_without_length_become_geometric(read):
    scene = read("pp 3  0 0 0 0 0 0  1 0 0 nan 0 0  0 1 0 1 0 0 ")
    assert np.array_equal(scene.objects[0].triangles.normals[0], [(0, 0, 1), (0, 0, 1), (1, 0, 0)])


def test_what_no_k_defines_is_static(read):
    scene = read("x ghost { x car { " + TRIANGLE + "} " + TRIANGLE + "}" + moving("car"))
    assert [(o.name, o.chain, len(o.triangles)) for o in scene.objects] == [("static", (), 1), ("car", ("car",), 1)]


def test_k_may_come_first(read):
    assert len(read(moving("car") + "x car { " + TRIANGLE + "}").objects) == 2


def test_the_last_k_of_a_name_wins(read):
    scene = read(moving("car", 1) + moving("car", 2) + "x car { " + TRIANGLE + "}")
    assert scene.animation.matrix(scene.objects[1].chain, 1.5)[0, 3] == 2


def test_chains_merge_and_the_end_is_baked(read):
    shift = "xs 1 1 1 0 1 0 0 {} 0 0 {{ "
    scene = read(
        shift.format(1)
        + shift.format(2)
        + "x a { "
        + shift.format(3)
        + "x b { "
        + shift.format(4)
        + TRIANGLE
        + "} } } } } }"
        + moving("a")
        + moving("b")
    )
    static, inner = scene.objects
    assert len(static.triangles) == 0
    assert inner.name == "a/b"
    first, a, second, b = inner.chain
    assert (a, b) == ("a", "b")
    assert (first[0, 3], second[0, 3]) == (3, 3)
    assert inner.triangles.corners[0, 0].tolist() == [4, 0, 0]
    assert scene.animation.matrix(inner.chain, 1.5)[:3, 3].tolist() == [16, 0, 0]


def test_equal_chains_are_one_object(read):
    car = "x car { xs 1 1 1 0 1 0 0 1 0 0 { x wheel { " + TRIANGLE + "} } } "
    scene = read(car + car + moving("car") + moving("wheel"))
    assert [len(o.triangles) for o in scene.objects] == [0, 2]


def test_quadrics_move_too(read):
    scene = read("x car { xs 2 2 2 0 1 0 0 0 0 0 { s 0 0 0 1 } }" + moving("car"))
    assert scene.objects[1].quadrics.to_object[0, 0, 0] == 2
    assert scene.quadric_offsets.tolist() == [0, 0, 1]


def test_animated_triangles_under_transforms(read):
    key = "0 0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1 "
    scene = read(
        f"xs 1 1 1 0 1 0 0 7 0 0 {{ tpa 1 {key} x car {{ tpa 1 {key} tpa 2 {key} 1 {key[2:]} }} }}" + moving("car")
    )
    assert [o.name for o in scene.objects] == ["static", "deforming", "car (deforming)", "car (deforming)"]
    baked, moved = scene.objects[1], scene.objects[2]
    assert baked.chain == ()
    assert baked.triangles.corners[0, 0].tolist() == [7, 0, 0]
    assert len(moved.chain) == 2
    assert moved.triangles.corners[0, 0].tolist() == [0, 0, 0]


def test_a_file_included_again_is_the_same_under_each_transform(read):
    mesh = "m vertices 3 0 0 0 1 0 0 0 1 0 triangles 1 0 1 2 "
    scene = read("".join(f"xs 1 1 1 0 1 0 0 {i} 0 0 {{ i 0 mesh.aff }} " for i in range(5)), mesh=mesh)
    assert scene.objects[0].triangles.corners[:, 0, 0].tolist() == [0, 1, 2, 3, 4]


names = st.sampled_from(["a", "b", "ghost"])
matrices = st.integers(0, 2**32).map(lambda seed: np.random.default_rng(seed).normal(size=(4, 4)))


@settings(deadline=None)
@given(st.lists(names | matrices, max_size=8))
def test_resolving_keeps_the_product(chain):
    values = {"a": np.diag([1.0, 2, 3, 1]), "b": np.eye(4)[[1, 2, 0, 3]]}

    def product(elements):
        result = np.eye(4)
        for e in elements:
            result = result @ (values.get(e, np.eye(4)) if isinstance(e, str) else e)
        return result

    rest, baked = resolve(tuple(chain), {"a", "b"})
    assert product(rest) @ baked == pytest.approx(product(chain), rel=1e-9, abs=1e-9)
    assert "ghost" not in [e for e in rest if isinstance(e, str)]
    assert not rest or isinstance(rest[-1], str)
    kinds = [isinstance(e, str) for e in rest]
    assert not any(not p and not q for p, q in itertools.pairwise(kinds))


def test_what_stands_still_is_called_by_its_transform_or_its_file(tmp_path: Path):
    (tmp_path / "lamp.aff").write_text("f 1 1 1 1 0 1 0 1\np 3 0 0 0 1 0 0 0 1 0\ns 0 0 0 1\n")
    path = tmp_path / "room.aff"
    path.write_text(
        "v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 8 8\na 0 1 10\n"
        "f 1 1 1 1 0 1 0 1\np 4 0 0 0 1 0 0 1 1 0 0 1 0\ni 0 lamp.aff\nx chair { p 3 0 0 1 1 0 1 0 1 1 }\n"
        "x flyer { p 3 0 0 0 1 0 0 0 1 0 }\n"
        "k flyer { transl 4 -1 0 0 0 0 0 0  0 0 0 0 0 0 0  1 1 0 0 0 0 0  2 1 0 0 0 0 0 }\n"
    )
    scene = load_scene(path)
    names = [scene.name_of(primitive) for primitive in range(scene.primitive_count)]
    assert names == ["room", "room", "lamp", "chair", "flyer", "lamp"]

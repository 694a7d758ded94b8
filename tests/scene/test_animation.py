"""Tracks against closed forms, a slow twin, and what must hold of any of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.scenes import loaded
from tests.sweeps import cases
from tests.tracing.random_worlds import quickly
from tracer.scene.animation import Animation, Chains, Keys, TrackSet
from tracer.scene.deformation import Deformation, deformed
from tracer.scene.model import Camera


def keys(times, values, shape=None):
    values = np.array(values, np.float64).reshape(len(times), -1)
    shape = np.zeros((len(times), 3)) if shape is None else np.array(shape, np.float64)
    return Keys(np.array(times, np.float64), values, shape)


def moving(times, values, shape=None):
    return Animation({"a": TrackSet(translation=keys(times, values, shape))})


def turning(times, values, shape=None):
    return Animation({"a": TrackSet(rotation=keys(times, values, shape))})


def x_at(animation, time):
    return animation.translation("a", time)[0]


def twin(track: Keys, time: float) -> np.ndarray:
    """Kochanek-Bartels by the book, one scalar at a time."""
    t, p = track.times, track.values
    n = len(t)
    time = min(max(time, t[1]), t[n - 2])
    i = next((i for i in range(1, n - 2) if t[i + 1] > time), n - 3)
    u = (time - t[i]) / (t[i + 1] - t[i]) if t[i + 1] > t[i] else 1.0
    u = max(u, 0.0)  # a last time before the first one would lead out of the segment
    (t1, c1, b1), (t2, c2, b2) = track.shape[i], track.shape[i + 1]

    def a(whole):
        return 2 * (t[i + 1] - t[i]) / whole if whole else 1.0

    back, here, on = p[i] - p[i - 1], p[i + 1] - p[i], p[i + 2] - p[i + 1]
    out = 0.5 * a(t[i + 1] - t[i - 1]) * (1 - t1) * ((1 + c1) * (1 + b1) * back + (1 - c1) * (1 - b1) * here)
    into = 0.5 * a(t[i + 2] - t[i]) * (1 - t2) * ((1 + c2) * (1 - b2) * on + (1 - c2) * (1 + b2) * here)
    return (
        (2 * u**3 - 3 * u**2 + 1) * p[i]
        + (3 * u**2 - 2 * u**3) * p[i + 1]
        + (u**3 - 2 * u**2 + u) * out
        + (u**3 - u**2) * into
    )


def test_even_keys_on_a_line_give_even_motion():
    animation = moving([0, 1, 2, 3, 4], [(i, 2 * i, 0) for i in range(5)])
    for t in np.linspace(1, 3, 21):
        assert animation.translation("a", t) == pytest.approx((t, 2 * t, 0))


def test_uneven_keys_on_a_line_give_even_motion():
    """The factor a is there for this: the speed does not change where keys are sparse."""
    times = [0, 1, 4, 4.5, 7]
    animation = moving(times, [(t, 0, 0) for t in times])
    for t in np.linspace(1, 4.5, 21):
        assert x_at(animation, t) == pytest.approx(t)


def test_full_tension_eases_in_and_out():
    animation = moving(range(4), [(0, 0, 0), (0, 0, 0), (1, 0, 0), (5, 0, 0)], [(1, 0, 0)] * 4)
    for u in np.linspace(0, 1, 11):
        assert x_at(animation, 1 + u) == pytest.approx(u * u * (3 - 2 * u))


def test_what_waits_between_two_keys_stands_still_to_the_last_bit():
    rng = np.random.default_rng(0)
    places, turns, sizes = rng.normal(size=(4, 3)), rng.normal(size=(4, 4)) * (1, 1, 1, 90), rng.uniform(0.5, 2, (4, 3))
    for values in (places, turns, sizes):
        values[2] = values[1]
    tracks = (keys(range(4), values, [(1, 0, 0)] * 4) for values in (places, turns, sizes))
    animation = Animation({"a": TrackSet(*tracks)})
    first = animation.matrix(("a",), 1.0)
    assert np.array_equal(first[:3, 3], places[1])
    for time in np.linspace(1, 2, 50):
        assert animation.matrix(("a",), time).tobytes() == first.tobytes()


def test_time_is_clamped_to_the_inner_keys():
    animation = moving(range(5), [(9, 0, 0), (1, 0, 0), (4, 0, 0), (2, 0, 0), (9, 0, 0)])
    assert x_at(animation, -100) == x_at(animation, 1) == 1
    assert x_at(animation, 100) == x_at(animation, 3) == 2


def test_duplicate_times_jump():
    animation = moving([0, 1, 2, 2, 3, 4], [(x, 0, 0) for x in (0, 0, 1, 5, 6, 6)], [(1, 0, 0)] * 6)
    assert x_at(animation, 2 - 1e-9) == pytest.approx(1)
    assert x_at(animation, 2) == 5


def test_times_that_run_backwards_take_the_first_segment_that_ends_later():
    animation = moving([0, 1, 3, 2, 5, 6], [(x, 0, 0) for x in (0, 0, 1, 2, 3, 3)], [(1, 0, 0)] * 6)
    assert x_at(animation, 2.5) == pytest.approx(0.75**2 * 1.5)  # still in the segment from 1 to 3
    u = (3.5 - 2) / (5 - 2)
    assert x_at(animation, 3.5) == pytest.approx(2 + u * u * (3 - 2 * u))


unit = st.floats(-1, 1)
track = st.integers(4, 9).flatmap(
    lambda n: st.builds(
        keys,
        st.lists(st.integers(-4, 8), min_size=n, max_size=n).map(lambda t: [x / 2 for x in t]),
        st.lists(st.tuples(*[st.floats(-9, 9)] * 3), min_size=n, max_size=n),
        st.lists(st.tuples(unit, unit, unit), min_size=n, max_size=n),
    )
)


@quickly(60)
@given(track, st.floats(-5, 10))
def test_any_track_agrees_with_its_slow_twin(track, time):
    result = Animation({"a": TrackSet(translation=track)}).translation("a", time)
    assert np.isfinite(result).all()
    assert result == pytest.approx(twin(track, time), rel=1e-9, abs=1e-9)


@quickly(30)
@given(track, track, st.floats(-5, 10))
def test_tracks_do_not_disturb_one_another(one, two, time):
    both = Animation({"a": TrackSet(translation=one), "b": TrackSet(scale=one), "c": TrackSet(translation=two)})
    for name, keys_ in (("a", one), ("c", two)):
        alone = Animation({name: TrackSet(translation=keys_)})
        assert np.array_equal(both.translation(name, time), alone.translation(name, time))
    assert np.diag(both.matrix(("b",), time))[:3] == pytest.approx(twin(one, time), abs=1e-9)


@quickly(40)
@given(track)
def test_tracks_pass_through_their_inner_keys(track):
    ordered = Keys(np.sort(track.times) + 0.1 * np.arange(len(track.times)), track.values, track.shape)
    animation = Animation({"a": TrackSet(translation=ordered)})
    for time, value in zip(ordered.times[1:-1], ordered.values[1:-1], strict=True):
        assert animation.translation("a", time) == pytest.approx(value, abs=1e-9)


def angle_about_y(matrix):
    assert matrix[1, :3] == pytest.approx((0, 1, 0), abs=1e-12)
    return math.degrees(math.atan2(matrix[0, 2], matrix[0, 0])) % 360


def test_even_turning_about_one_axis():
    animation = turning(range(5), [(0, 2, 0, 80 * i) for i in range(5)])  # an axis off unit length
    for t in np.linspace(1, 3, 21):
        assert angle_about_y(animation.matrix(("a",), t)) == pytest.approx(80 * t)


def test_turning_agrees_with_curves_about_one_axis():
    """About one axis with small steps squad is de Casteljau on angles; at its keys and middle it is the cubic."""
    values, shape = [0, 10, 40, 50, 20], [(0.1, 0.2, 0.3)] * 5
    rotation = turning(range(5), [(0, 1, 0, v) for v in values], shape)
    curve = moving(range(5), [(v, 0, 0) for v in values], shape)
    for t in (1, 1.5, 2, 2.5, 3):
        assert angle_about_y(rotation.matrix(("a",), t)) == pytest.approx(x_at(curve, t), abs=1e-9)


def test_opposite_quaternions_take_the_short_way():
    animation = turning(range(4), [(0, 1, 0, 350), (0, 1, 0, 350), (0, 1, 0, 370), (0, 1, 0, 370)], [(1, 0, 0)] * 4)
    flipped = turning(range(4), [(0, 1, 0, 350), (0, 1, 0, 350), (0, 1, 0, 10), (0, 1, 0, 10)], [(1, 0, 0)] * 4)
    for t in np.linspace(1, 2, 9):
        assert animation.matrix(("a",), t) == pytest.approx(flipped.matrix(("a",), t))


def test_an_axis_without_length_does_not_turn():
    assert np.array_equal(turning(range(4), [(0, 0, 0, 90)] * 4).matrix(("a",), 1.5), np.eye(4))


rotation_track = st.integers(4, 8).flatmap(
    lambda n: st.builds(
        keys,
        st.lists(st.integers(-4, 8), min_size=n, max_size=n),
        st.lists(st.tuples(unit, unit, unit, st.floats(-720, 720)), min_size=n, max_size=n),
        st.lists(st.tuples(unit, unit, unit), min_size=n, max_size=n),
    )
)


@quickly(40)
@given(rotation_track, st.floats(-5, 10))
def test_any_rotation_track_gives_rotations(track, time):
    matrix = Animation({"a": TrackSet(rotation=track)}).matrix(("a",), time)[:3, :3]
    assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(matrix) == pytest.approx(1)


def test_matrices_are_translation_rotation_scale():
    four = range(4)
    tracks = TrackSet(keys(four, [(1, 2, 3)] * 4), keys(four, [(0, 0, 1, 90)] * 4), keys(four, [(2, 3, 4)] * 4))
    assert Animation({"a": tracks}).matrix(("a",), 0) @ (1, 1, 1, 1) == pytest.approx((-2, 4, 7, 1))


def test_chains_multiply_outermost_first():
    animation = Animation(
        {
            "a": TrackSet(translation=keys(range(4), [(1, 0, 0)] * 4)),
            "b": TrackSet(scale=keys(range(4), [(2, 2, 2)] * 4)),
        }
    )
    shift = np.eye(4)
    shift[1, 3] = 5.0
    assert animation.matrix(("b", shift, "a"), 0) @ (0, 0, 0, 1) == pytest.approx((2, 10, 0, 1))
    assert np.array_equal(animation.matrix((), 0), np.eye(4))
    assert np.array_equal(animation.matrix(("nobody",), 0), np.eye(4))


def test_results_are_the_callers_own():
    animation = moving(range(4), [(1, 2, 3)] * 4)
    animation.matrix(("a",), 0)[:] = 7
    animation.translation("a", 0)[:] = 7
    assert animation.translation("a", 0).tolist() == [1, 2, 3]


def test_visibility():
    seen = TrackSet(visibility=np.array([(1.0, 0.0), (2.0, 1.0), (3.0, 0.0)]))
    animation = Animation({"a": seen, "b": TrackSet()})
    assert [animation.visible(("b", np.eye(4), "a"), t) for t in (0, 1, 1.5, 2, 3, 9)] == [1, 0, 0, 1, 0, 0]
    assert animation.visible(("b", "nobody"), 1)
    assert animation.visible((), 1)


def test_the_camera_takes_what_its_track_tells():
    base = Camera((9, 9, 9), (1, 0, 0), (0, 0, 1), 30)
    position, rotation = keys(range(4), [(1, 2, 3)] * 4), keys(range(4), [(0, 1, 0, 90)] * 4)
    both = Animation({"camera": TrackSet(position, rotation)}).camera(base, 1)
    assert both.position == (1, 2, 3)
    assert both.direction == pytest.approx((-1, 0, 0))
    assert both.up == pytest.approx((0, 1, 0))
    assert both.angle == 30
    only = Animation({"camera": TrackSet(translation=position)}).camera(base, 1)
    assert (only.position, only.direction, only.up) == ((1, 2, 3), base.direction, base.up)
    only = Animation({"camera": TrackSet(rotation=rotation)}).camera(base, 1)
    assert only.position == base.position
    assert only.direction == pytest.approx((-1, 0, 0))
    assert Animation.empty().camera(base, 1) == base


def test_lights_move_by_their_translation(read):
    scene = read("l 1 1 1 la lamp 4 5 6 k lamp { transl 4 0 0 0 0 0 0 0 1 0 0 0 0 0 0 2 2 0 0 0 0 0 3 2 0 0 0 0 0 }")
    assert scene.light_positions(2).tolist() == [[1, 1, 1], [6, 5, 6]]


def test_no_lights(read):
    assert read("b 0 0 0").light_positions(0).shape == (0, 3)


def test_deformation_is_linear_and_clamped():
    corners = np.zeros((2, 3, 3, 3), np.float32)
    corners[:, :, 1, 0] = corners[:, :, 2, 1] = 1
    corners[:, :, :, 2] = np.array([[0, 2, 3], [0, 4, 4]])[:, :, None]
    normals = np.zeros_like(corners)
    normals[0, :, :, 0] = [[3], [3], [0]]
    normals[0, :, :, 1] = [[0], [4], [0]]
    deformation = Deformation(np.array([(0.0, 1, 3), (1, 1, 2)]), corners, normals)

    def heights(time):
        return deformed(deformation, time)[0][:, 0, 2].tolist()

    assert [heights(t) for t in (-1, 0.5, 1, 2, 3, 9)] == [[0, 0], [1, 0], [2, 4], [2.5, 4], [3, 4], [3, 4]]
    _, n = deformed(deformation, 1)
    assert n[0, 0] == pytest.approx((0.6, 0.8, 0))
    assert n[1, 0] == pytest.approx((0, 0, 1))  # none given
    assert n.dtype == np.float32


def random_animation(rng: np.random.Generator) -> Animation:
    """Tracks a to e, of all that a track may tell; z is none."""
    times = np.arange(6.0)

    def keys(width: int) -> Keys:
        return Keys(times, rng.normal(size=(6, width)), rng.uniform(-0.5, 0.5, (6, 3)))

    def blink() -> np.ndarray:
        return np.array([[1.0, rng.integers(2)], [2.0, rng.integers(2)], [3.0, rng.integers(2)]])

    return Animation(
        {
            "a": TrackSet(keys(3), keys(4), keys(3), blink()),
            "b": TrackSet(rotation=keys(4)),
            "c": TrackSet(visibility=blink()),
            "d": TrackSet(translation=keys(3), visibility=blink()),
            "e": TrackSet(scale=keys(3)),
        }
    )


@pytest.mark.parametrize("seed", range(cases(5, 20)))
def test_together_is_as_alone(seed):
    rng = np.random.default_rng(seed)
    animation = random_animation(rng)
    pieces = [*"abcdez", *rng.normal(size=(3, 4, 4))]
    chains = [tuple(pieces[k] for k in rng.integers(len(pieces), size=rng.integers(0, 6))) for _ in range(40)]
    chains += [chain[:2] + chain for chain in chains]  # many begin alike
    together = Chains(animation, chains)
    for time in rng.uniform(-1, 6, 5):
        alone = np.stack([animation.matrix(chain, time) for chain in chains])
        assert np.allclose(together.matrices(time), alone, rtol=1e-12, atol=1e-12)
        assert together.visible(time).tolist() == [animation.visible(chain, time) for chain in chains]


@pytest.mark.parametrize("name", ["kitchen/kitchen.aff", "robot/Robot.aff"])
def test_of_a_whole_scene(bart, name):
    scene = loaded(bart / name)
    chains = [item.chain for item in scene.objects]
    together = Chains(scene.animation, chains)
    for time in np.linspace(*scene.time_range, 5):
        alone = np.stack([scene.animation.matrix(chain, time) for chain in chains])
        assert np.allclose(together.matrices(time), alone, rtol=1e-12, atol=1e-9)


def test_without_objects_or_tracks():
    assert Chains(Animation.empty(), []).matrices(0.0).shape == (0, 4, 4)
    assert np.array_equal(Chains(Animation.empty(), [(), ("gone",)]).matrices(0.0), [np.eye(4)] * 2)

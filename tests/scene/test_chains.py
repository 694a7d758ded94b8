"""Chains evaluated together are what each is alone."""

from __future__ import annotations

import numpy as np
import pytest

import tracer
from tracer.scene.animation import Animation, Chains, Keys, TrackSet


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


@pytest.mark.parametrize("seed", range(20))
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
    scene = tracer.load_scene(bart / name)
    chains = [item.chain for item in scene.objects]
    together = Chains(scene.animation, chains)
    for time in np.linspace(*scene.time_range, 5):
        alone = np.stack([scene.animation.matrix(chain, time) for chain in chains])
        assert np.allclose(together.matrices(time), alone, rtol=1e-12, atol=1e-9)


def test_without_objects_or_tracks():
    assert Chains(Animation.empty(), []).matrices(0.0).shape == (0, 4, 4)
    assert np.array_equal(Chains(Animation.empty(), [(), ("gone",)]).matrices(0.0), [np.eye(4)] * 2)

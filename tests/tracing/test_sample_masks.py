"""Bits of a lamp's samples: what a triangle is certain to hide from a point, and not to, against tracing every ray."""

from __future__ import annotations

import numpy as np
import pytest

import tracer
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.worlds import scene
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.rays import ray_batch
from tracer.runtime.kernels import kernel
from tracer.scene.lights import LampTable, Light
from tracer.simd import address_of, load_three, local_memory
from tracer.visibility.area_light_tests import (
    KEPT,
    MOST_SAMPLES,
    SAMPLES,
    ask_points,
    ask_samples,
    ask_triangles,
    put_samples,
)
from tracer.visibility.prepared_triangles import PREPARED, Lamp, prepare_in_tree
from tracer.visibility.static_geometry import StaticGeometry

LANES, MANY = 16, 40  # points, and samples: not a whole number of vectors


@kernel
def masks(o, samples, light, radius, ends, one_by_one, blocked, unsure, told):
    """What is known of rays from samples (n, 3) to ends (3, 16) and primitive 0: bits blocked and unsure (16, any)
    int32, sixteen samples a number, and told (3,), the points of which all, none, or some may be hidden.  The triangle
    is asked about all points at once, or the points about sixteen such triangles `one_by_one`."""
    room, numbers = local_memory(SAMPLES), np.zeros(LANES, np.int32)
    made, kept = local_memory(PREPARED), local_memory(KEPT)
    groups = put_samples(samples, 0, len(samples), light, room)
    lamp = Lamp(0, (light[0], light[1], light[2]), radius, groups)
    prepare_in_tree(o, lamp, address_of(numbers), made)
    if one_by_one:
        told[:] = 0
        for lane in range(LANES):
            place, k = (ends[0, lane], ends[1, lane], ends[2, lane]), lane % 3
            hidden, missed, able = ask_triangles(made, place, lamp.light, radius, kept)
            told[0] |= ((hidden >> k) & 1) << lane
            told[1] |= ((missed >> k) & 1) << lane
            at = address_of(blocked[lane]), address_of(unsure[lane])
            ask_samples(made + 4 * k, kept, k, (able >> k) & 1 != 0, room, groups, at[0], at[1])
        return numbers
    told[0], told[1], told[2] = ask_points(made, load_three(ends, 0), lamp.light, radius, kept)
    if told[1] == 0xFFFF:  # then nothing is kept
        return numbers
    for lane in range(LANES):
        can, rows = (told[2] >> lane) & 1 != 0, (address_of(blocked[lane]), address_of(unsure[lane]))
        ask_samples(made, kept, lane, can, room, groups, rows[0], rows[1])
    return numbers


def _bits(numbers: np.ndarray) -> np.ndarray:
    """(16, MANY) bool of the bits of numbers (16, any), sixteen each."""
    bits = (numbers[:, :, None] >> np.arange(16)) & 1
    return bits.reshape(LANES, -1)[:, :MANY].astype(np.bool_)


def _triangle(rng: np.random.Generator, lamp: np.ndarray, radius: float, ends: np.ndarray) -> np.ndarray:
    """Corners (3, 3) between a lamp and some points: of any size, and often seen edge-on."""
    middle = lamp + rng.uniform(0.05, 0.98) * (ends.mean(0) - lamp) + rng.normal(size=3) * radius
    size = 10.0 ** rng.uniform(-1.5, 0.7)
    corners = middle + size * rng.normal(size=(3, 3))
    if rng.random() < 0.4:  # its plane cuts the lamp, or passes close by
        corners[2] = corners[0] + rng.uniform(0.2, 2.0) * (lamp + rng.normal(size=3) * radius - corners[0])
    return corners


@pytest.mark.parametrize("one_by_one", [False, True])
@pytest.mark.parametrize("accelerator", ACCELERATORS)
@pytest.mark.parametrize("seed", range(cases(1, 32)))
def test_samples_that_are_known_are_as_tracing_finds_them(accelerator: str, seed: int, one_by_one: bool):
    rng, known, mixed = np.random.default_rng(seed), 0, 0
    for _ in range(12):
        radius = float(10.0 ** rng.uniform(-1.5, 0.0))
        light = Light("lamp", tuple(rng.normal(size=3).tolist()), kind="sphere", radius=radius, samples=MANY)
        lamps = LampTable((light,)).at(np.array([light.position]))
        center, samples = lamps.places[0], lamps.samples
        way = rng.normal(size=3)
        ends = center + 6.0 * way / np.linalg.norm(way) + 0.3 * rng.normal(size=(LANES, 3))
        ends = np.ascontiguousarray(ends, np.float32)
        made = scene([_triangle(rng, center, radius, ends).tolist()], lights=[light.position])
        world = tracer.World(made, accelerator=accelerator)
        static = StaticGeometry(world, 1, 1, False)
        static.update_lights([0], lamps.places, lamps.radii, 10.0)  # no ray is longer than that and the scene
        blocked, unsure = np.zeros((2, LANES, MOST_SAMPLES // LANES), np.int32)
        told = np.zeros(3, np.int64)
        points = np.ascontiguousarray(ends.T)
        masks(static.occluders, samples, center, lamps.radii[0], points, one_by_one, blocked, unsure, told)
        hidden, missed = ((told[:2, None] >> np.arange(LANES)) & 1).astype(np.bool_)

        rays = ray_batch(np.tile(samples, (LANES, 1)), (ends[:, None] - samples).reshape(-1, 3), LIGHT_MARGIN, 1.0)
        truth = world.any_hits(rays).reshape(LANES, MANY)
        assert truth[hidden].all() and not truth[missed].any()
        if missed.all():
            continue
        sure, doubt = _bits(blocked), _bits(unsure)
        assert not (sure & ~truth).any(), "bits say hidden, rays do not"
        assert not (truth & ~sure & ~doubt).any(), "bits say seen, rays do not"
        known += (sure | ~doubt).sum()
        mixed += (truth.any(1) & ~truth.all(1)).sum()
    assert known > 0.9 * 12 * LANES * MANY * 0.2 and mixed > 10, "too little is known: this shows nothing"

"""How much of a picture is traced before it is shown, by what frames have cost; and how many samples lamps have."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tracer.frame import Settings
from tracer.scene.lights import Light, as_lamps
from tracer.statistics import FrameStatistics
from viewer.services.frame_budget import PARTS, FrameBudget
from viewer.services.refinement import LampSamples, has_lamps

FIXED, RAY, PIXEL = 5e-3, 1e-7, 1e-6


def frame(pixels: int, part: float, beside: float = 0.0, slower: float = 1.0) -> FrameStatistics:
    """What a frame of a machine with these costs tells."""
    phases = {"place": beside, "primary": slower * (FIXED / 2 + RAY / 2 * pixels),
              "surfaces": slower * RAY / 2 * pixels,
              "shading": slower * (FIXED / 2 + PIXEL * pixels * part / 16)}  # fmt: skip
    return FrameStatistics(part=part / 16, phases=phases)


def taught(*seen: FrameStatistics, pixels: int = 400_000) -> FrameBudget:
    budget = FrameBudget()
    for statistics in seen:
        budget.observe(statistics, pixels)
    return budget


@pytest.mark.parametrize(
    ("seconds", "part", "divisor"),
    [
        (1.0, 16, 1), (0.32, 8, 1), (0.2, 4, 1), (0.13, 2, 1), (0.1, 1, 1), (0.055, 0.5, 1), (0.04, 0.5, 1),
        (0.02, 0.5, 2), (1e-4, 0.5, 8),
    ],
)  # fmt: skip
def test_the_most_that_fits_is_shaded_and_only_then_the_resolution_falls(seconds: float, part: float, divisor: int):
    budget = taught(*(frame(400_000, part) for part in (1, 4, 16, 2, 8) * 3))
    assert budget.seconds(400_000, 4) == pytest.approx(FIXED + RAY * 4e5 + PIXEL * 1e5, rel=0.1)
    plan = budget.plan(800, 500, seconds)
    assert (plan.parts[0], plan.divisor) == (part, divisor)
    assert plan.parts[-1] == 16 and list(plan.parts) == sorted(set(plan.parts))


def test_what_was_whole_at_once_teaches_what_its_primary_rays_cost():
    """Else a view that became dear would never be shaded in parts again."""
    budget, dear = taught(*(frame(300_000, part, slower=0.1) for part in (1, 16) * 3)), FrameStatistics(part=1.0)
    assert budget.plan(640, 480, 0.05).parts == (16,)
    dear.phases = {"primary": 0.15, "shading": 0.01}
    for _ in range(20):
        budget.observe(dear, 640 * 480)
    assert budget.plan(640, 480, 0.05).divisor > 1
    assert budget.plan(640, 480, 0.05, coarse=False, playing=False).parts == (16,), "0.16 s do not take long"
    slow = taught(*(frame(400_000, part) for part in (1, 4, 16) * 3))
    assert slow.plan(800, 500, 0.1, coarse=False, playing=False).parts[0] < 16, "something is seen soon"


def test_a_finer_step_needs_time_to_spare_and_a_coarser_one_none():
    budget = taught(*(frame(400_000, part) for part in (1, 4, 16, 2, 8) * 3))
    quarter = budget.seconds(400_000, 4)
    assert budget.plan(800, 500, 0.9 * quarter).parts[0] == 2
    assert budget.plan(800, 500, 1.05 * quarter).parts[0] == 2, "a quarter would fit, but with nothing to spare"
    assert budget.plan(800, 500, 1.4 * quarter).parts[0] == 4
    assert budget.plan(800, 500, 1.05 * quarter).parts[0] == 4


def test_what_else_is_in_a_frame_leaves_less_time():
    alone = taught(*(frame(400_000, part) for part in PARTS * 3))
    beside = taught(*(frame(400_000, part, beside=0.1) for part in PARTS * 3))
    assert beside.seconds(400_000, 1) == pytest.approx(alone.seconds(400_000, 1) + 0.1, rel=0.01)
    beside.forget()
    assert beside.seconds(400_000, 1) == FrameBudget().seconds(400_000, 1), "another scene"


def test_a_frame_that_was_slept_through_changes_nothing_but_slow_ones_do():
    def picture() -> FrameStatistics:
        return frame(400_000, 8)

    budget = taught(*[picture() for _ in range(20)])
    before = budget.plan(800, 500, 0.32)
    budget.observe(frame(400_000, 8, beside=3600.0), 400_000)
    assert budget.plan(800, 500, 0.32) == before
    for _ in range(10):
        budget.observe(frame(400_000, 8, slower=50.0), 400_000)
    assert budget.plan(800, 500, 0.32).divisor > before.divisor


@pytest.mark.parametrize("radius", [None, 0.0, 0.5])
@pytest.mark.parametrize("samples", [None, 9])
def test_samples_are_those_of_the_lamp_that_has_the_most(radius: float | None, samples: int | None):
    point, sphere = Light("a", (0, 0, 0)), Light("b", (0, 0, 0), kind="sphere", radius=1.0, samples=4)
    dome = Light("d", (0, 0, 0), kind="dome", radius=1.0, edges=((0, 1, 0),), samples=25)
    table, settings = LampSamples(), Settings(lamp_radius=radius, lamp_samples=samples)
    for lights in ((point,), (point, sphere), (sphere, dome), ()):
        lamps = as_lamps(lights, radius, samples)
        table.update(lights, settings)
        assert table.most(settings) == table.wanted == max((len(lamp.offsets()) for lamp in lamps), default=1)
        assert table.any == has_lamps(lights, settings) == any(lamp.kind != "point" for lamp in lamps)


def test_pixels_cost_by_the_samples_of_lamps():
    budget = FrameBudget()
    pixels, points = 400_000, FrameStatistics(phases={"primary": 1e-3, "shading": 0.1})
    for _ in range(5):
        budget.observe(points, pixels)
    costs = [budget.seconds(pixels, 16, samples) for samples in (1, 4, 16, 64)]
    assert costs[0] == pytest.approx(0.1, rel=0.1)
    assert 2.0 < costs[1] / costs[0] < 4.0 < costs[2] / costs[1] * costs[3] / costs[2]
    for _ in range(5):
        budget.observe(replace(points, phases={"primary": 1e-3, "shading": 0.15}), pixels, 4)
    assert budget.seconds(pixels, 16, 4) == pytest.approx(0.15, rel=0.1)
    assert budget.seconds(pixels, 16, 1) == pytest.approx(costs[0], rel=0.1), "each number for itself"
    assert budget.plan(800, 500, 0.05, lamp_samples=64).parts[0] < budget.plan(800, 500, 0.05).parts[0]

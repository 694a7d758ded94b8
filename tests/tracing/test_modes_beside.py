"""Modes kept beside any exact method: those that the paper's method would have, bit for bit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.nasty_worlds import nasty_walk
from tests.tracing.random_worlds import Walk, quickly, walks
from tracer.culling.modes import DYNAMIC, occlusion_mode
from tracer.geometry.accelerators import BVH8
from tracer.neighbours.certified.cost_model import CostModel
from tracer.scene.model import Camera

# Methods, and the paper's whose modes they keep beside them: that which counts what rests as static where they do.
PAPER, RESTING = "paper", "paper+rest"
BESIDE = {
    "none": PAPER,
    "none+cache": PAPER,
    "certified": RESTING,
    "certified+cache": RESTING,
    "none+cache+rest": RESTING,
    "auto": RESTING,
}
# Small pictures are to have many certificates on either structure, and to test candidates.
EAGER = CostModel(2, 4, 3, 48, True, 1)


def _differing(scene: tracer.Scene, frames: Iterable[tuple[float, Camera]], seen: Counter, **settings) -> list[str]:
    """What is not, frame by frame, as the paper's method has it; and pictures that are not those of "none"."""
    world = tracer.World(scene, scene.time_range[0], settings["accelerator"])

    def renderer_of(method: str, threads: int = 1, modes: bool = True) -> tracer.Renderer:
        chosen = tracer.Settings(method=method, threads=threads, modes=modes, **settings)
        return tracer.Renderer(scene, chosen, world=world, cost_model=EAGER)

    papers, none = {name: renderer_of(name) for name in (PAPER, RESTING)}, renderer_of("none", modes=False)
    beside = {method: renderer_of(method, 1 + number % 3) for number, method in enumerate(BESIDE)}
    result = []
    for number, (time, camera) in enumerate(frames):
        picture = none.render(time, camera)
        modes = {name: paper.render(time, camera) for name, paper in papers.items()}
        for culled in modes.values():
            said, shadow = culled.statistics.by_modes, culled.statistics.shadow
            assert sum(one.due for one in said) <= shadow.due
            assert sum(one.full_shadow for one in said) == shadow.culled
            assert sum(one.non_shadow for one in said) == shadow.dynamic_only
        seen["otherwise at rest"] += not np.array_equal(modes[PAPER].modes, modes[RESTING].modes)
        assert not picture.statistics.by_modes and picture.statistics.occlusion_tests == 0
        seen.update(full=shadow.culled, non=shadow.dynamic_only)
        for method, other in beside.items():
            frame, expected = other.render(time, camera), modes[BESIDE[method]]
            for name in ("modes", "pixel_count", "highest_count", "occlusion_mode", "shadow_mode"):
                if not np.array_equal(getattr(frame, name), getattr(expected, name)):
                    result.append(f"{name} of frame {number} with {method}")
            if frame.color.tobytes() != picture.color.tobytes():
                result.append(f"picture of frame {number} with {method}")
            assert frame.statistics.by_modes == expected.statistics.by_modes, (number, method)
            assert frame.statistics.occlusion_tests == 0, "of modes that are only looked at, nothing counts"
            other_shadow = frame.statistics.shadow
            seen.update({f"{method}: {name}": getattr(other_shadow, name) for name in ("culled", "candidates_only")})
            seen["cache hits"] += other_shadow.cache_hits
    return result


@pytest.mark.parametrize("accelerator", cases((BVH8,), ACCELERATORS))
def test_modes_beside_any_exact_method_are_the_papers(accelerator: str):
    """Moving cameras, lights and objects, which rest now and then."""
    seen: Counter[str] = Counter()
    settings = {"width": 26, "height": 20, "depth": 2, "accelerator": accelerator}

    @quickly(3)
    @given(walks(), st.booleans())
    def check(walk: Walk, symmetric: bool) -> None:
        assert not _differing(walk.scene, walk.frames, seen, symmetric=symmetric, **settings)

    check()
    for seed in range(cases(4, 8)):
        walk = nasty_walk(seed)
        assert not _differing(walk.scene, walk.frames, seen, **settings), f"seed {seed}"
    assert min(seen[f"certified: {name}"] for name in ("culled", "candidates_only")) > 500
    assert min(seen[name] for name in ("full", "non", "cache hits")) > 100
    assert seen["otherwise at rest"] > 5
    assert seen["none: culled"] == 0


def test_beyond_31_lights_there_are_no_modes_and_none_are_missed():
    walk, seen = nasty_walk(6, lights=33), Counter()
    assert not _differing(walk.scene, walk.frames, seen, width=24, height=16, depth=1, accelerator="bvh8")
    frame = tracer.Renderer(walk.scene, tracer.Settings(24, 16, 1, "none", modes=True)).render(0.0)
    assert len(frame.statistics.by_modes) == 31


def test_modes_go_on_where_the_method_changes_and_forget_nothing():
    """As in the window, where any method may follow another; and where nobody asks for modes, they stay as they are."""
    walk = nasty_walk(3, frames=8)
    settings = tracer.Settings(30, 24, 2, RESTING, threads=1)
    paper, changing = (tracer.Renderer(walk.scene, settings, cost_model=EAGER) for _ in range(2))
    methods = ["none+rest", RESTING, "certified", "none+cache+rest"]
    methods += ["certified+cache", RESTING, "certified", "none+rest"]
    for method, (time, camera) in zip(methods, walk.frames, strict=True):
        changing.settings = replace(settings, method=method, modes=True)
        expected, frame = paper.render(time, camera), changing.render(time, camera)
        assert np.array_equal(frame.modes, expected.modes)
        assert np.array_equal(frame.highest_count, expected.highest_count)
    time, camera = walk.frames[-1]
    changing.settings = replace(settings, method="none+rest")
    assert np.array_equal(changing.render(time, camera).modes, frame.modes)
    assert not changing.settings.keeps_modes and changing.render(time, camera).statistics.by_modes == []


def test_turning_culling_off_and_on_leaves_the_papers_modes_as_they_are():
    """Also those of objects that rest: what would be culled is what is culled again."""
    walk = nasty_walk(7, frames=8)
    settings = tracer.Settings(30, 24, 2, PAPER, threads=1)
    paper, toggled = (tracer.Renderer(walk.scene, settings) for _ in range(2))
    dynamic = saved = 0
    time = walk.frames[0][0]
    for number, (_, camera) in enumerate(walk.frames):
        toggled.settings = replace(settings, method=("none", PAPER)[number % 2], modes=True)
        expected, frame = paper.render(time, camera), toggled.render(time, camera)
        assert np.array_equal(frame.modes, expected.modes)
        dynamic += int((occlusion_mode(frame.modes) == DYNAMIC).sum())
        saved += frame.statistics.shadow.saved
    assert dynamic > 0 and saved > 500

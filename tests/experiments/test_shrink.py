"""What is left of a wrong pixel still shows it, and nothing more of that can be taken away."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tracer
from tests.marbles import LAST, STEP, write_marbles
from tracer.culling.cells import AIM
from tracer.experiments import hunt
from tracer.experiments.counterexample import Counterexample
from tracer.experiments.shrink import Shrink, WrongPixel, error, explained, static_area, with_area, with_primitives
from tracer.scene.aff_writer import aff_text
from tracer.scene.model import Scene

SETTINGS = tracer.Settings(width=96, height=96, depth=2, threads=1)
METHODS = ("paper", "cells")


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    return tracer.load_scene(write_marbles(tmp_path_factory.mktemp("marbles")))


def worst(scene: Scene, method: str) -> Counterexample:
    times = [scene.frame_time(number) for number in range(0, LAST + 1, STEP)]
    settings = replace(SETTINGS, method=method)
    *_, found = hunt.run(scene, hunt.Search(settings, times, None, around=0, radius=0.3, seed=1, keep=1))
    return found.finds[0]


def wrong_pixel(scene: Scene, method: str) -> WrongPixel:
    """The worst one, after more frames than it needs."""
    find = worst(scene, method)
    before = (*find.before, *find.before, *find.before)
    return WrongPixel(find.x, find.y, find.time, find.seen_camera, before, replace(SETTINGS, method=method))


def with_less(scene: Scene, wrong: WrongPixel) -> Iterator[tuple[Scene, WrongPixel]]:
    """Without any single primitive, light or frame before."""
    for number in range(scene.primitive_count):
        yield with_primitives(scene, np.delete(np.arange(scene.primitive_count), number)), wrong
    for number in range(len(scene.lights)):
        yield replace(scene, lights=scene.lights[:number] + scene.lights[number + 1 :]), wrong
    for number in range(len(wrong.before)):
        yield scene, replace(wrong, before=wrong.before[:number] + wrong.before[number + 1 :])


@pytest.mark.parametrize("method", METHODS)
def test_the_pixel_is_wrong_and_without_any_single_thing_it_is_not(scene: Scene, method: str, tmp_path: Path) -> None:
    """With `cells`, a far triangle makes the cells as large as the others; what stands for it stays."""
    if method == "cells":
        scene = with_area(scene, AIM * static_area(scene))
    wrong = wrong_pixel(scene, method)
    at_first = error(scene, wrong)
    run = Shrink(scene, wrong)
    *_, left = run.each()
    assert (
        run.whole and run.results == left and left.counts < left.first == (scene.primitive_count, 2, len(wrong.before))
    )
    assert left.counts.primitives == (3 if method == "cells" else 2)

    (tmp_path / "scene.aff").write_text(aff_text(left.scene))
    read = tracer.load_scene(tmp_path / "scene.aff")
    shown = error(read, left.wrong)
    assert np.sign(shown) == np.sign(at_first) != 0.0
    for fewer, pixel in with_less(read, left.wrong):
        assert np.sign(error(fewer, pixel)) != np.sign(shown)

    right = replace(left.wrong, settings=replace(left.wrong.settings, method="none"))
    assert error(read, right) == 0.0 and explained(read, right) is None
    find, rule = explained(read, left.wrong)
    assert find.taught >= 0 and find.verdict in rule and "failed" in rule
    assert "§2.4" in rule and ("the cell of triangle" in rule) == (method == "cells")


def test_what_is_there_by_then_is_kept(scene: Scene) -> None:
    """Stopped after any try, the results still show the pixel wrong."""
    wrong = wrong_pixel(scene, "paper")
    sizes = []
    for most in (1, 4, 8):
        run = Shrink(scene, wrong)
        for number, left in enumerate(run.each(), 1):  # noqa: B007
            if number == most:
                run.stop()
        assert run.done and not run.whole and run.results is left
        assert error(left.scene, left.wrong) != 0.0
        sizes.append(sum(left.counts))
    assert sizes == sorted(sizes, reverse=True) and sizes[0] > sizes[-1]


def test_what_is_not_wrong_is_refused(scene: Scene) -> None:
    wrong = wrong_pixel(scene, "paper")
    with pytest.raises(ValueError, match="pixel 0,0 is not wrong: by paper, after 3 frames, "):
        list(Shrink(scene, replace(wrong, x=0, y=0)).each())
    with pytest.raises(ValueError, match="--pixel 96,0: the picture is 96 x 96"):
        Shrink(scene, replace(wrong, x=96, y=0))

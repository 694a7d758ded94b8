"""Recorded pictures are those that were traced, with rings; memory is bounded; the figure draws those that tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import picture
from tests.viewer.fakes import make_frame
from tracer.experiments.zoom import Approach, Change, Results, Step
from tracer.frame import Frame, Settings
from tracer.scene.model import Camera
from viewer.output.filmstrip import Filmstrip
from viewer.output.run_figures import COLUMNS, chosen_steps, film_figure
from viewer.state.palette import WRONG
from viewer.views.difference import Mark, ringed, wrong_marks


@pytest.fixture
def frame() -> Frame:
    return make_frame(Settings(width=64, height=48, verify=True))


def step(number: int, wrong: int = 0, changes: tuple[Change, ...] = ()) -> Step:
    return Step(number, 1.0, Camera((0, 0, 0), (0, 0, 1)), 9, 9, "INIT", [], list(changes), wrong, wrong, 1, 0, 0)


def results(*approaches: Approach) -> Results:
    return Results("room.aff", (64, 48), 3, 0.0, (0.0, 0.0, 0.0), 0.9, approaches=list(approaches))


def test_a_shot_is_the_picture_with_rings_around_what_is_wrong(frame: Frame):
    film = Filmstrip()
    film.record(4.0, 0, frame)
    pixels, ring = film.of(4.0)[0].pixels(), wrong_marks(frame) == Mark.RING
    assert (pixels[ring] == np.round(255.0 * np.asarray(WRONG))).all() and ring.any()
    np.testing.assert_array_equal(pixels[~ring], picture(frame)[~ring])
    assert film.of(4.0)[0].thumbnail(24).shape == (24, 32, 3)
    with pytest.raises(ValueError, match="not verified"):
        ringed(replace(frame, wrong=None))


@pytest.mark.parametrize("limit", [{"most_shots": 20}, {"most_bytes": 4000}])
def test_however_long_the_way_memory_is_bounded(frame: Frame, limit: dict[str, int]):
    film = Filmstrip(**limit)
    for factor in (4.0, 16.0):
        for number in range(200):
            film.record(factor, number, frame)
            kept = [*film.of(4.0), *film.of(16.0)]
            assert len(kept) <= limit.get("most_shots", 1000)
            assert sum(len(shot.png) for shot in kept) <= limit.get("most_bytes", 10**9)
    numbers = [[shot.number for shot in film.of(factor)] for factor in (4.0, 16.0)]
    assert numbers[0] == numbers[1] and len(numbers[0]) > 3
    assert len(set(np.diff(numbers[0]))) == 1, "evenly thinned out"
    assert film.nearest(4.0, 199).number == numbers[0][-1] and film.nearest(5.0, 3) is None


def test_the_figure_draws_first_last_and_where_something_happens(frame: Frame):
    film = Filmstrip()
    for number in range(30):
        film.record(4.0, number, frame)
    approach = Approach(4.0, [step(n, wrong=int(11 <= n < 14)) for n in range(30)])
    chosen = chosen_steps(results(approach), list(range(30)))
    assert len(chosen) == COLUMNS and {0, 11, 14, 29} <= set(chosen) and chosen == sorted(chosen)
    figure = film_figure(film, results(approach))
    assert len(figure.axes) == COLUMNS
    np.testing.assert_array_equal(figure.axes[0].images[0].get_array(), film.of(4.0)[0].pixels())


def test_a_way_that_was_stopped_early_is_drawn_as_far_as_it_went(frame: Frame):
    film = Filmstrip()
    for factor, steps in ((4.0, 5), (16.0, 2)):
        for number in range(steps):
            film.record(factor, number, frame)
    approaches = [Approach(4.0, [step(n) for n in range(5)]), Approach(16.0, [step(0)]), Approach(64.0)]
    figure = film_figure(film, results(*approaches))
    assert [len(panel.images) for panel in figure.axes] == [1, 1, 1, 1, 1, 1, 0, 0, 0, 0]
    with pytest.raises(ValueError, match="no step"):
        film_figure(Filmstrip(), results(Approach(4.0)))

"""Figures: that they show the numbers, can be read, and are the same for everyone."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from PIL import Image

from tracer.experiments import experiment, figures
from tracer.experiments.figures import COLUMNS, chosen_steps, film_figure
from tracer.experiments.filmstrip import Filmstrip
from tracer.experiments.zoom import Approach, Change, Results, Step
from tracer.scene.model import Camera

FRAMES = [5, 6, 7, 8]
PAPER = {"steps": [1.0, 0.4, 0.75, 0.85], "tests": [1.0, 0.95, 0.9, 0.5]}  # what is left of the work of `none`


def results(verify: bool = False, wrong=(0, 0, 0, 0), **methods: dict[str, list[float]]) -> experiment.Results:
    """Of `none`, `paper` and more methods, given by the parts of the work that they leave."""
    made = experiment.Results(
        "scenes/hall.aff", (320, 200), frames=list(FRAMES), path_times=range(20), planned=4, settings={"verify": verify}
    )
    for method, left in {"none": {"steps": [1.0] * 4, "tests": [1.0] * 4}, "paper": PAPER, **methods}.items():
        made.methods[method] = {name: [0] * 4 for name in experiment.FIGURES} | {
            "shadow_rays_due": [1000] * 4,
            "shadow_traversal_steps": [10_000 * part for part in left["steps"]],
            "shadow_intersection_tests": [5_000 * part for part in left["tests"]],
            "wrong": list(wrong) if method != "none" else [0] * 4,
            "frame_seconds": [0.1] * 4,
        }
    return made


def named(panel) -> list[str]:
    return [text.get_text() for text in panel.get_legend().get_texts()]


def test_each_panel_shows_savings_their_average_and_their_maximum() -> None:
    figure = figures.savings_figure(results())
    for panel, work, told in zip(
        figure.axes,
        ("steps", "tests"),
        ("Paper, average 25.0%\nmost 60.0%, frame 6", "Paper, average 16.2%\nmost 50.0%, frame 8"),
        strict=True,
    ):
        saved = 1.0 - np.array(PAPER[work])
        curve, mean, mark = panel.lines
        np.testing.assert_array_equal(curve.get_xdata(), FRAMES)
        np.testing.assert_allclose(curve.get_ydata(), saved)
        np.testing.assert_allclose(mean.get_ydata(), saved.mean())
        assert (list(mark.get_xdata()), list(mark.get_ydata())) == ([FRAMES[saved.argmax()]], [saved.max()])
        assert named(panel) == [told]
        assert panel.get_ylim()[0] <= 0.0 and panel.get_ylim()[1] > saved.max()
        assert panel.yaxis.get_major_formatter()(0.25) == "25%"


@pytest.mark.parametrize(
    ("verify", "wrong", "said"), [(False, 0, ", answers not verified"), (True, 0, ", no wrong answer"), (True, 3, "")]
)
def test_wrong_answers_have_a_panel_where_there_are_any_and_the_title_says_what_it_is_of(verify, wrong, said) -> None:
    figure = figures.savings_figure(results(verify, (0, wrong, wrong // 3, 0)))
    assert figure.get_suptitle().endswith(f"\nhall.aff, 320 × 200, frames 5 to 8 of 20{said}")
    assert len(figure.axes) == (3 if wrong else 2)
    if wrong:
        np.testing.assert_array_equal(figure.axes[-1].lines[0].get_ydata(), [0, 3, 1, 0])
        assert named(figure.axes[-1]) == ["Paper, 4 (0.100%)"]


def test_methods_differ_in_colour_and_dashes_and_their_names_are_on_the_page() -> None:
    figure = figures.savings_figure(results(True, (1, 0, 0, 0), symmetric=PAPER, other=PAPER))
    figure.draw_without_rendering()
    for panel in figure.axes:
        curves = [line for line in panel.lines if len(line.get_xdata()) == len(FRAMES)]
        assert len({line.get_color() for line in curves}) == len({str(c._unscaled_dash_pattern) for c in curves}) == 3
        box = panel.get_legend().get_window_extent()
        assert box.x0 > panel.bbox.x1 - 1.0 and box.x1 <= figure.bbox.x1 and box.y0 >= 0.0


def test_one_frame_can_be_drawn_and_nothing_to_compare_is_said() -> None:
    one, alone = results(True), results()
    one.frames = [5]
    one.methods = {m: {key: values[:1] for key, values in of.items()} for m, of in one.methods.items()}
    for panel in figures.savings_figure(one).axes:
        assert named(panel) == ["Paper, average 0.0%\nmost 0.0%, frame 5"]
        assert panel.get_ylim()[0] <= 0.0 < panel.get_ylim()[1]
    del alone.methods["paper"]
    for nothing in (alone, experiment.Results("s", (1, 1), methods={"none": {}, "paper": {}})):
        with pytest.raises(ValueError, match="nothing to plot"):
            figures.savings_figure(nothing)


@pytest.mark.parametrize(("ending", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".PDF", b"%PDF")])
def test_files_are_the_same_each_time_and_for_any_settings_of_a_user(ending: str, start: bytes) -> None:
    first = figures.file_of(figures.savings_figure(results()), ending)
    with matplotlib.rc_context({"lines.linewidth": 9, "savefig.facecolor": "red", "pdf.fonttype": 3, "font.size": 30}):
        assert figures.file_of(figures.savings_figure(results()), ending) == first
        assert matplotlib.rcParams["font.size"] == 30
    assert first.startswith(start)
    if ending == ".png":
        with Image.open(io.BytesIO(first)) as image:
            assert image.size == (1920, 1080)


@pytest.mark.parametrize("name", ["plot", "plot.jpg", "plot.png.txt", ".png"])
def test_other_endings_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"give one of \.png \.svg \.pdf"):
        figures.check_ending(Path(name))


@pytest.fixture
def pixels() -> np.ndarray:
    return np.indices((48, 64, 3)).sum(axis=0).astype(np.uint8)


def step(number: int, wrong: int = 0, changes: tuple[Change, ...] = ()) -> Step:
    return Step(number, 1.0, Camera((0, 0, 0), (0, 0, 1)), 9, 9, "INIT", [], list(changes), wrong, wrong, 1, 0, 0)


def zoom_results(*approaches: Approach) -> Results:
    return Results("room.aff", (64, 48), 3, 0.0, (0.0, 0.0, 0.0), 0.9, approaches=list(approaches))


def test_a_zoom_test_is_drawn_with_counts_limits_marks_and_wrong_pixels() -> None:
    change = Change(None, "FULLY_RENDERED", "INIT")
    four = [step(0), step(1, wrong=2), step(2, wrong=3, changes=(change,)), step(3)]
    four = [replace(s, pixels=10 + s.number, highest=[5, 5, 12, 12][s.number]) for s in four]
    approaches = [Approach(4.0, four), Approach(64.0, four[:2])]
    figure = figures.zoom_figure(zoom_results(*approaches))
    counts, wrong = figure.axes
    drawn = {line.get_label(): list(zip(line.get_xdata(), line.get_ydata())) for line in counts.get_lines()}
    assert drawn["the primitive's pixels"] == [(0, 10), (1, 11), (2, 12), (3, 13)]
    assert drawn["4 × last examination"] == [(0, 20), (1, 20), (2, 48), (3, 48)]
    assert drawn["64 × last examination"] == [(0, 320), (1, 320)]
    assert drawn["modes change, factor 4"] == [(2, 12)]
    assert list(wrong.get_lines()[0].get_ydata()) == [0, 2, 3, 0] and counts.get_yscale() == "log"
    assert "Never fully rendered" not in figure.get_suptitle()
    never = [Approach(4.0, [replace(s, highest=0) for s in four])]
    assert "Never fully rendered, so it" in figures.zoom_figure(zoom_results(*never)).get_suptitle()
    with pytest.raises(ValueError, match="nothing to plot"):
        figures.zoom_figure(zoom_results(Approach(4.0)))


def test_a_shot_is_the_picture(pixels: np.ndarray):
    film = Filmstrip()
    film.record(4.0, 0, pixels)
    np.testing.assert_array_equal(film.of(4.0)[0].pixels(), pixels)
    assert film.of(4.0)[0].thumbnail(24).shape == (24, 32, 3)


def test_however_long_the_way_memory_is_bounded(pixels: np.ndarray):
    film = Filmstrip(4000)
    for factor in (4.0, 16.0):
        for number in range(200):
            film.record(factor, number, pixels)
            assert sum(len(shot.png) for shot in (*film.of(4.0), *film.of(16.0))) <= 4000
    numbers = [[shot.number for shot in film.of(factor)] for factor in (4.0, 16.0)]
    assert numbers[0] == numbers[1] and len(numbers[0]) > 3
    assert len(set(np.diff(numbers[0]))) == 1, "evenly thinned out"
    assert film.nearest(4.0, 199).number == numbers[0][-1] and film.nearest(5.0, 3) is None


def test_a_film_draws_first_last_and_where_something_happens_as_far_as_it_went(pixels: np.ndarray):
    film = Filmstrip()
    for factor, steps in ((4.0, 30), (16.0, 2)):
        for number in range(steps):
            film.record(factor, number, pixels)
    long = Approach(4.0, [step(n, wrong=int(11 <= n < 14)) for n in range(30)])
    chosen = chosen_steps(zoom_results(long), list(range(30)))
    assert len(chosen) == COLUMNS and {0, 11, 14, 29} <= set(chosen) and chosen == sorted(chosen)
    figure = film_figure(film, zoom_results(long, Approach(16.0, [step(0)]), Approach(64.0)))
    assert [len(panel.images) for panel in figure.axes] == [1] * COLUMNS + [1] + [0] * (COLUMNS - 1)
    np.testing.assert_array_equal(figure.axes[0].images[0].get_array(), film.of(4.0)[0].pixels())
    with pytest.raises(ValueError, match="no step"):
        film_figure(Filmstrip(), zoom_results(Approach(4.0)))

"""Figures: that they show the numbers, can be read, and are the same for everyone."""

from __future__ import annotations

from itertools import combinations, pairwise
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from tracer.experiments import experiment
from viewer.output import figures, run_figures
from viewer.output.reports import frames_in_words

FRAMES = [5, 6, 7, 8]
PAPER = {"steps": [1.0, 0.4, 0.75, 0.85], "tests": [1.0, 0.95, 0.9, 0.5]}  # what is left of the work of `none`


def results(wrong=(0, 0, 0, 0), **methods: dict[str, list[float]]) -> experiment.Results:
    """Of `none`, `paper` and more methods, given by the parts of the work that they leave."""
    made = experiment.Results("scenes/hall.aff", (320, 200), frames=list(FRAMES), path_times=range(20), planned=4)
    for method, left in {"none": {"steps": [1.0] * 4, "tests": [1.0] * 4}, "paper": PAPER, **methods}.items():
        made.methods[method] = {
            "shadow_rays_due": [1000] * 4,
            "shadow_rays_culled": [0] * 4,
            "shadow_rays_dynamic_only": [0] * 4,
            "shadow_traversal_steps": [10_000 * part for part in left["steps"]],
            "shadow_intersection_tests": [5_000 * part for part in left["tests"]],
            "occlusion_tests": [0] * 4,
            "certificate_steps": [0] * 4,
            "certificate_tests": [0] * 4,
            "wrong": list(wrong) if method != "none" else [0] * 4,
            "frame_seconds": [0.1] * 4,
        }
    return made


def texts(panel) -> list[str]:
    return [text.get_text() for text in panel.texts]


def test_each_panel_shows_savings_their_average_and_their_maximum() -> None:
    steps, tests = run_figures.savings_figure(results(), verified=False).axes
    for panel, work, average, most in (
        (steps, "steps", "average 25.0%", "most 60.0%, frame 6"),
        (tests, "tests", "average 16.2%", "most 50.0%, frame 8"),
    ):
        saved = 1.0 - np.array(PAPER[work])
        curve, mean, mark = panel.lines
        np.testing.assert_array_equal(curve.get_xdata(), FRAMES)
        np.testing.assert_allclose(curve.get_ydata(), saved)
        np.testing.assert_allclose(mean.get_ydata(), saved.mean())
        assert (list(mark.get_xdata()), list(mark.get_ydata())) == ([FRAMES[saved.argmax()]], [saved.max()])
        assert texts(panel) == [most, f"paper, {average}"]
        assert panel.get_ylim()[0] <= 0.0 and panel.get_ylim()[1] > saved.max()
        assert panel.yaxis.get_major_formatter()(0.25) == "25%"


def test_wrong_answers_have_a_panel_where_there_are_any() -> None:
    *_, wrong = run_figures.savings_figure(results(wrong=(0, 3, 1, 0)), verified=True).axes
    np.testing.assert_array_equal(wrong.lines[0].get_ydata(), [0, 3, 1, 0])
    assert texts(wrong) == ["paper, 4 (0.100%)"]
    assert len(run_figures.savings_figure(results(), verified=True).axes) == 2


@pytest.mark.parametrize(
    ("verified", "wrong", "said"),
    [
        (False, 0, "frames 5 to 8 of 20, answers not verified"),
        (True, 0, "frames 5 to 8 of 20, no wrong answer"),
        (True, 2, "frames 5 to 8 of 20"),
    ],
)
def test_the_title_tells_scene_size_frames_and_whether_it_was_verified(verified: bool, wrong: int, said: str) -> None:
    figure = run_figures.savings_figure(results(wrong=(wrong, 0, 0, 0)), verified)
    assert figure.get_suptitle().endswith(f"\nhall.aff, 320 × 200 pixels, {said}")


@pytest.mark.parametrize(
    ("frames", "path", "planned", "stopped", "said"),
    [
        ([0, 1, 2], 3, 3, False, "3 frames over the whole path"),
        ([0, 1, 2], 200, 3, False, "frames 0 to 2 of 200"),
        ([0, 1, 2], 200, 200, True, "3 of 200 frames, stopped"),
        ([0, 1, 2], 200, 200, False, "3 of 200 frames"),  # one has not stopped it, but looks meanwhile
        ([7, 8], 200, 20, True, "frames 7 to 8 of 200, stopped"),
        ([7], 200, 1, False, "frame 7 of 200"),
        ([0], 1, 1, False, "1 frame"),
    ],
)
def test_frames_are_told_by_their_path(frames, path: int, planned: int, stopped: bool, said: str) -> None:
    made = experiment.Results("s", (1, 1), frames, path_times=range(path), planned=planned, stopped=stopped)
    assert frames_in_words(made) == said


def test_methods_differ_in_colour_and_dashes_and_their_labels_do_not_meet() -> None:
    """Also where their values do: here the maxima are of one frame, and the averages within a percent."""
    near = {"steps": [1.0, 0.39, 0.75, 0.85], "tests": [1.0, 0.95, 0.9, 0.49]}
    nearer = {"steps": [1.0, 0.405, 0.75, 0.85], "tests": [1.0, 0.95, 0.9, 0.5]}
    figure = run_figures.savings_figure(results((1, 0, 0, 0), symmetric=near, other=nearer), verified=True)
    figure.draw_without_rendering()
    for panel in figure.axes:
        curves = [line for line in panel.lines if len(line.get_xdata()) == len(FRAMES)]
        assert len({line.get_color() for line in curves}) == 3
        assert len({str(line._unscaled_dash_pattern) for line in curves}) == 3
        boxes = [text.get_window_extent() for text in panel.texts]
        assert len(boxes) == 3
        assert panel is figure.axes[-1] or all("\nmost " in text and ", frame " in text for text in texts(panel))
        assert not [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]
        assert all(b.x0 >= 0.0 and b.x1 <= figure.bbox.x1 for b in boxes)
        assert all(b.y0 >= 0.0 and b.y1 <= figure.bbox.y1 for b in boxes)


def test_one_frame_that_saves_nothing_can_be_drawn() -> None:
    one = results()
    one.frames = [5]
    one.methods = {m: {key: values[:1] for key, values in of.items()} for m, of in one.methods.items()}
    for panel in run_figures.savings_figure(one, verified=True).axes:
        assert texts(panel) == ["most 0.0%, frame 5", "paper, average 0.0%"]
        low, high = panel.get_ylim()
        assert low <= 0.0 < high


def test_nothing_to_compare_is_said() -> None:
    alone = results()
    del alone.methods["paper"]
    for nothing in (alone, experiment.Results("s", (1, 1), methods={"none": {}, "paper": {}})):
        with pytest.raises(ValueError, match="nothing to plot"):
            run_figures.savings_figure(nothing, verified=False)


@pytest.mark.parametrize("ending", [".png", ".svg", ".PDF"])
def test_files_are_the_same_each_time_and_for_any_settings_of_a_user(tmp_path: Path, ending: str) -> None:
    paths = [tmp_path / f"{name}{ending}" for name in ("a", "b")]
    figures.save(run_figures.savings_figure(results(), verified=True), paths[0])
    with matplotlib.rc_context({"lines.linewidth": 9, "savefig.facecolor": "red", "pdf.fonttype": 3, "font.size": 30}):
        figures.save(run_figures.savings_figure(results(), verified=True), paths[1])
        assert matplotlib.rcParams["font.size"] == 30
    assert paths[0].read_bytes() == paths[1].read_bytes()
    start = {".png": b"\x89PNG", ".svg": b"<?xml", ".PDF": b"%PDF"}[ending]
    assert paths[0].read_bytes().startswith(start)
    assert sorted(tmp_path.iterdir()) == paths
    if ending == ".png":
        with Image.open(paths[0]) as image:
            assert image.size == (1920, 1080)


@pytest.mark.parametrize("name", ["plot", "plot.jpg", "plot.png.txt", ".png"])
def test_other_endings_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"give one of \.png \.svg \.pdf"):
        figures.check_ending(Path(name))


@given(st.lists(st.floats(-0.2, 1.2), max_size=12), st.floats(0.01, 0.3))
def test_labels_are_spread_in_their_order_as_little_as_need_be(heights: list[float], gap: float) -> None:
    placed = figures.spread(heights, gap, 0.0, 1.0)
    fitting = min(gap, 1.0 / max(len(heights), 1))
    in_order = [placed[i] for i in np.argsort(heights, kind="stable")]
    assert all(b - a >= fitting - 1e-9 for a, b in pairwise(in_order))
    assert all(fitting / 2 - 1e-9 <= height <= 1.0 - fitting / 2 + 1e-9 for height in placed)
    inside = all(gap / 2 <= height <= 1.0 - gap / 2 for height in heights)
    if inside and all(abs(a - b) >= gap for a, b in combinations(heights, 2)):
        assert placed == pytest.approx(heights)

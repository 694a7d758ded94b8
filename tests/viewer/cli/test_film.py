"""Films from the command line: each picture is what `render` makes, and the video shows them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.commands import Run, pixels, stop_at
from viewer.output import capture
from viewer.state.preferences import NamedState, Preferences, save_preferences

SIZE = ("--size", "47x33", "--threads", 1)


def test_pictures_and_video_show_the_same(run: Run) -> None:
    av = pytest.importorskip("av")
    modes = ("--method", "paper", "--view", "saved", "--caption", "{frame}")
    out = run.ok("film", "room.aff", "-o", "film.mp4", "--frames", "2-6", "--fps", 10, *SIZE, *modes)
    assert out.split() == ["film-frames", "film.mp4"]
    pictures = sorted(Path("film-frames").iterdir())
    assert [p.name for p in pictures] == [f"{n:04d}.png" for n in range(2, 7)], "they have the numbers of their frames"
    last = pixels(pictures[-1])
    run.ok("render", pictures[-1], "-o", "again.png")
    assert np.array_equal(pixels("again.png"), last), "its modes come from the frames of the film"
    run.ok("render", pictures[-1], "-o", "fresh.png", "--warmup", 0)
    assert not np.array_equal(pixels("fresh.png"), last)
    with av.open("film.mp4") as file:
        stream = file.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in file.decode(stream)]
        assert float(stream.average_rate) == 10.0 and len(frames) == 5
    height, width = last.shape[:2]
    assert width == 47 and frames[0].shape[:2] == (height + height % 2, 48), "odd sides are made even"
    for path, frame in zip(pictures, frames):
        assert np.abs(frame[:height, :width].astype(int) - pixels(path)).mean() < 6.0


def test_a_flight_goes_through_saved_pictures_or_bookmarks(run: Run, own_settings: Path) -> None:
    for number in (0, 4, 9):
        run.ok("render", "room.aff", "-o", f"at{number}.png", "--frame", number, *SIZE)
    seen = ["at0.png", "at4.png", "at9.png"]
    flight = ("--seconds", 1, "--fps", 5, *SIZE, "--method", "none")
    run.ok("film", "room.aff", "-o", "flight", "--through", *seen, *flight)
    assert len(list(Path("flight").iterdir())) == 5
    for name, original in (("0000", "at0"), ("0004", "at9")):
        assert np.array_equal(pixels(f"flight/{name}.png"), pixels(f"{original}.png"))
    path = str(Path("room.aff").absolute())
    state = [NamedState(name, capture.read_carried(Path(name)).state) for name in seen]
    save_preferences(Preferences(bookmarks={path: state}))
    run.ok("film", "room.aff", "-o", "marks", "--bookmarks", *flight)
    for picture in Path("flight").iterdir():
        assert np.array_equal(pixels(picture), pixels(Path("marks") / picture.name))


def test_why_there_is_no_legend_is_said_once(run: Run) -> None:
    view = ("--view", "depth", "--legend", "--method", "none")
    code, _, said = run("film", "room.aff", "-o", "small", "--frames", "2-4", *view, *SIZE)
    assert code == 0 and said.count("no legend: the picture is too small for it") == said.count("\n") == 1


def test_what_is_done_is_kept(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    av = pytest.importorskip("av")
    stop_at(monkeypatch, lambda label, done: done == 3)
    code, _, said = run("film", "room.aff", "-o", "film.mp4", *SIZE)
    assert code == 130 and "cancelled after 3 of 10 frames" in said
    assert len(list(Path("film-frames").iterdir())) == 3
    with av.open("film.mp4") as file:
        assert len(list(file.decode(video=0))) == 3
    assert sorted(p.name for p in Path().iterdir()) == ["film-frames", "film.mp4", "room.aff"]

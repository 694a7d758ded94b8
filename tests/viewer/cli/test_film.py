"""Films from the command line: each picture is what `render` makes, and the video shows them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.commands import ROOM, complaint, run
from viewer.cli.console import Work
from viewer.output import capture
from viewer.services import film as films
from viewer.state.preferences import NamedState, Preferences, save_preferences

SIZE = ("--size", "47x33", "--threads", 1)


@pytest.fixture(autouse=True)
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The room of `tests.commands` in a folder of its own, which is the current one."""
    monkeypatch.chdir(tmp_path)
    Path("room.aff").write_text(ROOM)


def pixels(path: str | Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def test_pictures_and_video_show_the_same(capfd: pytest.CaptureFixture[str]) -> None:
    av = pytest.importorskip("av")
    modes = ("--method", "paper", "--view", "saved", "--caption", "{frame}")
    code, out, _ = run(capfd, "film", "room.aff", "-o", "film.mp4", "--frames", "2-6", "--fps", 10, *SIZE, *modes)
    assert code == 0 and out.split() == ["film-frames", "film.mp4"]
    pictures = sorted(Path("film-frames").iterdir())
    assert [p.name for p in pictures] == [f"{n:04d}.png" for n in range(2, 7)], "they have the numbers of their frames"
    last = pixels(pictures[-1])
    assert run(capfd, "render", pictures[-1], "-o", "again.png")[0] == 0
    assert np.array_equal(pixels("again.png"), last), "its modes come from the frames of the film"
    assert run(capfd, "render", pictures[-1], "-o", "fresh.png", "--warmup", 0)[0] == 0
    assert not np.array_equal(pixels("fresh.png"), last)
    with av.open("film.mp4") as file:
        stream = file.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in file.decode(stream)]
        assert float(stream.average_rate) == 10.0 and len(frames) == 5
    height, width = last.shape[:2]
    assert width == 47 and frames[0].shape[:2] == (height + height % 2, 48), "odd sides are made even"
    for path, frame in zip(pictures, frames):
        assert np.abs(frame[:height, :width].astype(int) - pixels(path)).mean() < 6.0


def test_a_flight_goes_through_saved_pictures_or_bookmarks(
    capfd: pytest.CaptureFixture[str], own_settings: Path
) -> None:
    for number in (0, 4, 9):
        assert run(capfd, "render", "room.aff", "-o", f"at{number}.png", "--frame", number, *SIZE)[0] == 0
    seen = ["at0.png", "at4.png", "at9.png"]
    flight = ("--seconds", 1, "--fps", 5, *SIZE, "--method", "none")
    assert run(capfd, "film", "room.aff", "-o", "flight", "--through", *seen, *flight)[0] == 0
    assert len(list(Path("flight").iterdir())) == 5
    for name, original in (("0000", "at0"), ("0004", "at9")):
        assert np.array_equal(pixels(f"flight/{name}.png"), pixels(f"{original}.png"))
    path = str(Path("room.aff").absolute())
    state = [NamedState(name, capture.read_carried(Path(name)).state) for name in seen]
    save_preferences(Preferences(bookmarks={path: state}))
    assert run(capfd, "film", "room.aff", "-o", "marks", "--bookmarks", *flight)[0] == 0
    for picture in Path("flight").iterdir():
        assert np.array_equal(pixels(picture), pixels(Path("marks") / picture.name))


def test_why_there_is_no_legend_is_said_once(capfd: pytest.CaptureFixture[str]) -> None:
    view = ("--view", "depth", "--legend", "--method", "none")
    code, _, said = run(capfd, "film", "room.aff", "-o", "small", "--frames", "2-4", *view, *SIZE)
    assert code == 0 and said.count("no legend: the picture is too small for it") == said.count("\n") == 1


def test_what_is_done_is_kept(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    av = pytest.importorskip("av")
    count = Work.count

    def interrupted(work: Work, label: str, done: int, total: int) -> None:
        count(work, label, done, total)
        work.stopped = done == 3

    monkeypatch.setattr(Work, "count", interrupted)
    code, _, said = run(capfd, "film", "room.aff", "-o", "film.mp4", *SIZE)
    assert code == 130 and "cancelled after 3 of 10 frames" in said
    assert len(list(Path("film-frames").iterdir())) == 3
    with av.open("film.mp4") as file:
        assert len(list(file.decode(video=0))) == 3
    assert sorted(p.name for p in Path().iterdir()) == ["film-frames", "film.mp4", "room.aff"]


def test_mistakes_are_one_line(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    Path("taken").mkdir()
    Path("taken", "0110.png").write_bytes(b"")
    Path("file").write_text("")
    assert run(capfd, "render", "room.aff", "-o", "one.png", *SIZE)[0] == 0
    cases = [
        ((), "nothing to write"),
        (("-o", "d", "--frames", "4-20"), "frame numbers are 0 to 9"),
        (("-o", "d", "--frames", "9-3"), "argument --frames: '9-3' is not a range of frames"),
        (("-o", "d", "--through", "one.png"), "needs two bookmarks, or saved pictures, at least; there are 1"),
        (("-o", "d", "--bookmarks"), "at least; there are 0"),
        (("-o", "d", "--bookmarks", "--frames", "0-3"), "not allowed with"),
        (("-o", "taken"), "numbered pictures in it already; give another folder"),
        (("-o", "file"), "no folder for the pictures"),
        (("-o", "gone/d"), "gone/d: there is no folder gone"),
        (("-o", "d", "--caption", "{sceen}"), "the caption '{sceen}' is wrong: there is no field {sceen}, but scene"),
        (("-o", "d", "--view", "shadow:7"), "the scene's lights are 0 to 1"),
        (("-o", "d", "--view", "voxels", "--method", "paper"), "nothing for it; give --method voxels"),
        (("-o", "d", "--view", "tree"), "bvh8 builds all of its tree before rays come"),
    ]
    for options, said in cases:
        assert said in complaint(run(capfd, "film", "room.aff", *options, *SIZE))
    monkeypatch.setattr(films, "check_video", lambda: (_ for _ in ()).throw(ValueError(films.NEEDS_PYAV)))
    assert "shadowcull[video]" in complaint(run(capfd, "film", "room.aff", "-o", "d.mp4", *SIZE))
    assert not Path("d").exists() and not Path("d.mp4").exists()

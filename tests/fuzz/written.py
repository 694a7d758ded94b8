"""All that the program writes, each with how to tell that a file of it is whole."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from PIL import Image

from tests.fuzz.kills import Written
from tests.viewer.fakes import make_frame
from tracer.experiments import figures
from tracer.frame import Frame, Settings
from viewer.output import capture, exports, exr
from viewer.services.film import video
from viewer.state.preferences import SETTINGS_FILE, NamedState, Preferences, save_preferences
from viewer.util.files import write_bytes, write_new, write_text, write_whole

SIZE = (96, 128)


@cache
def _frame() -> Frame:
    return make_frame(Settings(width=SIZE[1], height=SIZE[0]))


def _pixels(number: int) -> np.ndarray:
    return np.random.default_rng(number).integers(0, 256, (*SIZE, 3), np.uint8)


def _visible(folder: Path, pattern: str) -> list[Path]:
    return [path for path in folder.glob(pattern) if not path.name.startswith(".")]


# --- what writes -------------------------------------------------------------------------------------


def _settings(folder: Path, number: int) -> None:
    marks = [NamedState(f"{number}", {"long": "x" * 20_000})]
    problem = save_preferences(Preferences(bookmarks={"/scene": marks}, recent=[str(number)]), folder)
    assert problem is None, problem


def _check_settings(folder: Path) -> None:
    data = json.loads((folder / SETTINGS_FILE).read_text())
    assert data["bookmarks"]["/scene"][-1]["name"].isdigit() and data["recent"]


def _capture(folder: Path, number: int) -> None:
    capture.save(_pixels(number), json.dumps({"number": number}), folder, "room.png")


def _check_images(folder: Path) -> None:
    for path in [found for kind in ("*.png", "*.jpg") for found in _visible(folder, kind)]:
        with Image.open(path) as image:
            image.load()
        path.unlink()  # each is looked at once


def _numbered(folder: Path, number: int) -> None:
    capture.write(folder / f"{number % 4:04}.png", _pixels(number), "{}")


def _jpeg(folder: Path, number: int) -> None:
    write_new(folder, "room", ".jpg", lambda path: capture.write(path, _pixels(number), "{}"))


def _table(folder: Path, number: int) -> None:
    exports.save(folder, "room", ".csv", lambda path: write_text(path, f"{number},1\n" * 4000 + "end\n"))


def _check_table(folder: Path) -> None:
    for path in _visible(folder, "*.csv"):
        assert path.read_text().endswith("end\n")
        path.unlink()


def _results(folder: Path, number: int) -> None:
    write_text(folder / "bench.json", json.dumps({"frames": list(range(5000)), "number": number}))


def _check_results(folder: Path) -> None:
    assert len(json.loads((folder / "bench.json").read_text())["frames"]) == 5000


def _buffers(folder: Path, number: int) -> None:
    arrays = {"depth": np.full((128, 128), number, np.float32), "primitive": np.zeros((128, 128), np.int32)}
    write_whole(folder / "buffers.npz", lambda file: np.savez(file, **arrays))


def _check_buffers(folder: Path) -> None:
    with np.load(io.BytesIO((folder / "buffers.npz").read_bytes())) as found:
        assert found["depth"].shape == found["primitive"].shape == (128, 128)


def _carried(number: int) -> str:
    return capture.Carried({"scene": "room.aff", "time": float(number)}).text()


def _exr(folder: Path, number: int) -> None:
    noise = _pixels(number).astype(np.float32)  # which nothing makes smaller
    exr.write(folder / "frame.exr", replace(_frame(), color=noise), _carried(number))


def _small_exr(folder: Path, number: int) -> None:
    exr.write(folder / "frame.exr", make_frame(), _carried(number))


def _check_exr(folder: Path) -> None:
    exr.read(folder / "frame.exr")


@cache
def _drawing():
    from matplotlib.figure import Figure

    drawn = Figure(figsize=(3, 2))
    drawn.add_subplot().plot(range(20))
    return drawn


def _figure(folder: Path, number: int) -> None:
    ending = ".pdf" if number % 2 else ".png"
    write_bytes(folder / f"plot{ending}", figures.file_of(_drawing(), ending))


def _check_figure(folder: Path) -> None:
    for path in _visible(folder, "*.pdf"):
        assert path.read_bytes().rstrip().endswith(b"%%EOF")
    for path in _visible(folder, "*.png"):
        with Image.open(path) as image:
            image.load()


def _video(folder: Path, number: int) -> None:
    with video(folder / "film.mp4", (64, 48), 25.0) as add:
        for frame in range(4):
            add(_pixels(number + frame)[:48, :64])


def _check_video(folder: Path) -> None:
    import av

    with av.open(str(folder / "film.mp4")) as film:
        assert sum(1 for _ in film.decode(video=0)) == 4


WRITTEN = (
    Written("settings, bookmarks, presets", _settings, _check_settings),
    Written("captures", _capture, _check_images),
    Written("pictures of a film", _numbered, _check_images),
    Written("pictures as JPEG", _jpeg, _check_images),
    Written("tables as CSV", _table, _check_table),
    Written("results as JSON", _results, _check_results),
    Written("buffers", _buffers, _check_buffers),
    Written("OpenEXR", _exr, _check_exr),
    Written("OpenEXR, small", _small_exr, _check_exr),
    Written("figures and plots", _figure, _check_figure),
    Written("videos", _video, _check_video),
)

"""Make the pictures of the README anew, from the real window: `make pictures`, or

    python tools/with_screen.py python tools/make_pictures.py [film] [still] [figure1] [methods]

`viewer.png` is the window with a clicked pixel and its shadow rays.  `loop.webp` is a short film that repeats: a
flight along the scene's own path, the occlusion modes and shadow modes that it has taught, and the wipe between the
culled picture and the right one.  ImGui's test engine presses the keys, as in the tests of the window.
`figure-1.svg` is the paper's Figure 1 with the numbers of a frame.  `methods` are those of the page of methods
(`tools/method_pictures.py`).
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import numpy as np
from PIL import Image

from tests.viewer import real_window
from tests.viewer.driver import Driver
from tools import method_pictures
from viewer.cli import main as command_line

ROOT = Path(__file__).resolve().parent.parent
SIZE = [1280, 800]  # of the window
FILM_SIZE = (880, 550)
FOLDER = ROOT / "assets" / "readme"
START, FLOWN = 40, 24  # the frame where the flight begins, and how many frames it is long
STILL, SAMPLES = 53, 16  # the frame of the still picture, and its samples per pixel
STEP, HOLD = 90, 1100  # milliseconds that a frame of the film is shown, in motion and when it rests
CLICKED = (0.832, 0.569)  # the pixel whose shadow rays are drawn, in parts of the picture's width and height
QUALITY = 72


class Film:
    """The frames of the loop with the time that each is shown; frames that look the same are one."""

    def __init__(self, driver: Driver) -> None:
        self._driver = driver
        self.frames: list[Image.Image] = []
        self.durations: list[int] = []

    def shoot(self, milliseconds: int = STEP) -> None:
        """Wait for the whole picture, then keep the window as it is drawn."""
        self._driver.settle()
        image = Image.fromarray(self._driver.window()).resize(FILM_SIZE, Image.Resampling.LANCZOS)
        self.frames.append(image)
        self.durations.append(milliseconds)

    def save(self, path: Path) -> None:
        first, *others = self.frames
        first.save(
            path, save_all=True, append_images=others, duration=self.durations, loop=0, quality=QUALITY, method=6
        )


def film(d: Driver) -> None:
    """The flight, the modes and the wipe."""
    _begin(d)
    d.press(*["RightArrow"] * START)
    film = Film(d)
    for _ in range(FLOWN):
        d.press("RightArrow")
        film.shoot()
    film.durations[-1] = HOLD
    for key in ("2", "3", "L"):
        d.press(key)
        film.shoot(HOLD)
    d.press("9")
    for wipe in 0.5 + 0.4 * np.sin(np.linspace(0.0, 2.0 * np.pi, 17)[:-1]):
        d.c.session.set_draw(wipe=float(wipe))
        film.shoot()
    film.save(FOLDER / "loop.webp")


def still(d: Driver) -> None:
    """The window with a clicked pixel, after some frames from which culling has learnt."""
    _begin(d)
    d.press(*["RightArrow"] * (STILL - 1)).settle()
    d.press("RightArrow").settle()
    d.c.settings.change(samples=SAMPLES)
    d.wait(lambda: d.c.frame.settings.samples == SAMPLES, "all samples")
    d.c.selection.select(CLICKED)
    d.wait(lambda: d.c.inspector.why is not None, "the pixel's shadow rays")
    d.wait(lambda: (known := d.c.baseline.measured) is not None and known.settled, "the speed beside none")
    d.settle()
    Image.fromarray(d.window()).save(FOLDER / "viewer.png", optimize=True)


def _begin(d: Driver) -> None:
    """Whole pictures only, from the first frame on, what culling saves above them, and the pointer out of the way, as
    it is drawn, too."""
    d.c.preferences.savings = True
    d.c.session.set_pace(progressive=False, fixed_size=False)
    d.context.mouse_move_to_pos((SIZE[0] - 1.0, SIZE[1] - 1.0))
    d.press("Backspace").settle()  # what pictures in parts have taught is forgotten
    d.press("Home")


def main(names: list[str]) -> int:
    made = {"film": film, "still": still, "figure1": None, "methods": None}
    if not set(names) <= set(made):
        print(f"make_pictures: give any of {', '.join(made)}", file=sys.stderr)
        return 2
    for name in names or made:
        if name == "methods":
            if code := method_pictures.main([]):
                return code
            continue
        if name == "figure1":
            words = ["render", "default", "--frame", "19", "--warmup", "19", "--size", "640x480"]
            if code := command_line.main([*words, "--figure1", str(FOLDER / "figure-1.svg")], lambda *_: 2):
                return code
            continue
        real_window.SCENARIOS[name] = made[name]
        with tempfile.TemporaryDirectory() as folder:
            os.environ["SHADOWCULL_CONFIG_DIR"] = folder
            if code := real_window.run(name, SIZE, str(ROOT / "assets" / "scenes" / "default.aff"), folder):
                return code
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

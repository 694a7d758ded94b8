"""A wrong pixel being shrunk, and its folder: the scene that is left, the frames, a figure, and a test that fails.

The command `shrink` and the window make a `ShrinkRun`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from tracer.experiments import counterexample
from tracer.experiments.hunt import SETTINGS, Results
from tracer.experiments.shrink import Shrink, Shrunk, WrongPixel, explained
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.geometry.world import World
from tracer.method import title_of
from tracer.scene.aff_writer import aff_text
from tracer.scene.load import load_scene
from tracer.scene.mesh_options import AS_IN_FILE
from tracer.scene.model import Cancelled, Scene
from viewer.output.findings import comparison_of, save_json
from viewer.services import stills
from viewer.services.history import FrameHistory
from viewer.services.inspector import Selection
from viewer.services.render_request import Traced
from viewer.services.runs import Runs
from viewer.state.picking import wrong_at
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.util.files import take_folder, write_text

SCENE, FRAMES, FIGURE, TEST = "scene.aff", "wrong.json", "wrong.png", "test_wrong.py"
_TEST = '''\
"""{words}

{rule}

Run it by pytest: it fails as long as the pixel is wrong.
"""

import json
from pathlib import Path

import tracer
from tracer.experiments import warmup_frames
from tracer.scene.model import Camera

FOLDER = Path(__file__).parent
WRONG = json.loads((FOLDER / "{frames}").read_text())


def color_by(method: str) -> list[float]:
    """The pixel's colour by a method, after the frames that lead there."""
    width, height = WRONG["size"]
    settings = tracer.Settings(width=width, height=height, method=method, threads=1, **WRONG["settings"])
    renderer = tracer.Renderer(tracer.load_scene(FOLDER / "{scene}"), settings)
    for frame in warmup_frames.from_json(WRONG):
        renderer.render(*frame)
    x, y = WRONG["pixel"]
    return renderer.render(WRONG["time"], Camera.from_json(WRONG["camera"])).color[y, x].tolist()


def test_the_pixel_is_that_of_none() -> None:
    assert color_by(WRONG["method"]) == color_by("none")
'''


class ShrinkRun(Shrink):
    """Shrinks a wrong pixel, and writes what is left into a folder, also where that was ended early."""

    def __init__(self, scene: Scene, wrong: WrongPixel, folder: Path) -> None:
        """Raises ValueError and OSError, in one line, for a pixel that is not there and for a folder in use."""
        super().__init__(scene, wrong)
        self.folder, self.rule = folder, ""
        take_folder(folder, lambda path: True)

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Shrunk]:
        try:
            yield from super().steps(scene, world, cancel)
        except Cancelled:
            if self.results is None:
                raise
        assert self.results is not None
        self.rule, self.output = write(self.results, self.folder), self.folder


def write(shrunk: Shrunk, folder: Path) -> str:
    """Write the files of a wrong pixel, and return the sentence that says which rule failed.

    Raises OSError in one line, and ValueError where the scene as it is read again does not show it."""
    write_text(folder / SCENE, aff_text(shrunk.scene))
    scene, wrong = load_scene(folder / SCENE), shrunk.wrong
    found = explained(scene, wrong)
    if found is None:
        raise ValueError(f"{folder / SCENE}: the pixel is right in the scene as it is read")
    find, rule = found
    size = wrong.settings.width, wrong.settings.height
    told = {name: getattr(wrong.settings, name) for name in SETTINGS}
    results = Results(str(scene.path), wrong.settings.method, size, told, finds=[find])
    state, figure = comparison_of(find, results, scene, wrong.settings, AS_IN_FILE)
    save_json(find, results, scene, state, folder / FRAMES)
    figure = replace(figure, methods=figure.methods[::-1], words=f"{figure.words} {rule}")
    world = World(scene, wrong.time, wrong.settings.accelerator)
    stills.save_methods(stills.trace_methods(scene, state, figure, world), folder / FIGURE)
    words = f"By {title_of(wrong.settings.method)}: {' '.join(counterexample.in_words(find, scene))}"
    write_text(folder / TEST, _TEST.format(words=words, rule=rule, frames=FRAMES, scene=SCENE))
    return rule


class Shrinking:
    """Shrinks wrong pixels of the window: that which is selected, or a finding of the hunt."""

    def __init__(
        self, session: Session, preferences: Preferences, runs: Runs, history: FrameHistory, selection: Selection,
        newest: Callable[[], Traced | None],
    ) -> None:  # fmt: skip
        """`newest` returns the newest picture, None while it is that of a run."""
        self._session, self._preferences, self._runs = session, preferences, runs
        self._history, self._selection, self._newest = history, selection, newest

    @property
    def offers(self) -> bool:
        """Whether a wrong pixel is selected."""
        traced, pixel = self._newest(), self._selection.pixel
        return traced is not None and pixel is not None and bool(wrong_at(traced.frame, *pixel))

    def start(self) -> None:
        """Begin to shrink the pixel that is selected, after the frames that were traced before it in this size."""

        def make(scene: Scene) -> ShrinkRun:
            traced, pixel = self._newest(), self._selection.pixel
            if traced is None or pixel is None or not self.offers:
                raise ValueError("click a wrong pixel first; Verify finds them")
            frame, asked, (x, y) = traced.frame, traced.request.warmup, pixel
            before = self._history.before(frame) if asked is None else tuple(WarmupFrame(*one) for one in asked)
            return self._run(scene, WrongPixel(x, y, frame.time, frame.camera, before, frame.settings))

        self._runs.start(make)

    def start_find(self, number: int) -> None:
        """Begin to shrink a finding of the hunt."""
        hunt = self._runs.hunt
        if hunt is None or hunt.results is None or not self._runs.allows(hunt):
            return
        find, settings = hunt.results.finds[number], hunt.settings
        wrong = WrongPixel(find.x, find.y, find.time, find.seen_camera, find.before, settings)
        self._runs.start(lambda scene: self._run(scene, wrong))

    def _run(self, scene: Scene, wrong: WrongPixel) -> ShrinkRun:
        name = f"{scene.path.stem}-shrunk-{datetime.now():%Y-%m-%d-%H-%M-%S}"
        return ShrinkRun(scene, wrong, self._preferences.picture_folder / name)

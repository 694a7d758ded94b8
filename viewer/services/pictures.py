"""Pictures that leave the window otherwise than as they are shown: larger, with a caption, as EXR, to the clipboard, or
to tev."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from viewer.output import clipboard, exr, png, tev
from viewer.output.commands import cannot_come_back, needs_history
from viewer.output.legend_picture import with_legend
from viewer.services import stills
from viewer.services.jobs import Job
from viewer.services.recipes import Recipes
from viewer.services.runs import FileRun, Runs
from viewer.state.notices import Notices
from viewer.state.plans import MOST_MULTIPLE, PicturePlan
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState, Warmup
from viewer.util.files import write_new
from viewer.views.legend import Legend

MOST_PIXELS = 1 << 26
JPEG = ".jpg"


def write_picture(path: Path, pixels: NDArray[np.uint8], text: str) -> None:
    """Write (h, w, 3) pixels as the ending says, whole or not at all; a PNG carries the text.  Raises OSError in one
    line."""
    if path.suffix == JPEG:
        png.write_image(path, Image.fromarray(pixels), "JPEG", quality=95)
    else:
        png.write(path, pixels, text)


class PictureRun(FileRun):
    """One picture being traced beside what the window shows; its results are its file."""

    name = "picture"

    def __init__(self, scene: Scene, recipe: ViewState, folder: Path, ending: str) -> None:
        self.recipe, self.folder, self.ending = recipe, folder, ending
        super().__init__(scene, 1 + recipe.warmup.repeats)

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Path]:
        (width, height), as_exr = self.recipe.size, self.ending == exr.ENDING
        renderer = Renderer(scene, self.recipe.settings, world=world)

        def tell(done: int, total: int) -> None:
            self.traced, self.label = done, f"{width} x {height}"

        frame = stills.trace(renderer, self.recipe, as_exr, tell, cancel)
        pixels, _ = (frame.pixels, "") if as_exr else stills.draw(frame, scene, self.recipe)
        text = stills.text(pixels, frame, scene, self.recipe)

        def write(path: Path) -> None:
            if as_exr:
                exr.write(path, frame, text)
            else:
                write_picture(path, pixels, text)

        stem = f"{Path(scene.path).stem}-{self.recipe.draw.view.value}-{width}x{height}"
        self.output = write_new(self.folder, stem, self.ending, write)
        self.traced = self.frames
        yield self.output


class Pictures:
    """`plan` is what the dialog says."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        runs: Runs,
        recipes: Recipes,
        notices: Notices,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._preferences, self._runs, self._recipes = session, preferences, runs, recipes
        self._notices, self._wake = notices, wake
        self.plan = PicturePlan()
        self.jobs: list[tuple[Job[str], str]] = []

    @property
    def size(self) -> tuple[int, int]:
        """Of the picture that is planned; 0, 0 before there is one to take it of."""
        recipe = self._recipes.now()
        return (0, 0) if recipe is None else (recipe.size[0] * self.plan.multiple, recipe.size[1] * self.plan.multiple)

    def save(self) -> bool:
        """Begin to trace and write what is planned; returns whether it has begun, and else has said why not."""

        def make(scene: Scene) -> PictureRun:
            recipe = self._recipes.now()
            if recipe is None:
                raise ValueError("there is no picture to save yet")
            return PictureRun(scene, self._planned(recipe, scene), self._preferences.picture_folder, self.plan.ending)

        return self._runs.start(make)

    def _planned(self, recipe: ViewState, scene: Scene) -> ViewState:
        plan = self.plan
        width, height = self.size
        if not 1 <= plan.multiple <= MOST_MULTIPLE or width * height > MOST_PIXELS:
            raise ValueError(f"{width} x {height} are more than {MOST_PIXELS:,} pixels; choose a smaller multiple")
        if plan.ending == exr.ENDING:
            exr.check()
        settings = replace(recipe.settings, width=width, height=height, samples=plan.samples).validated()
        # Modes are those of a resolution, and begin anew in another; once more, and they show what they are.
        repeats, unknown = 1 if needs_history(recipe) else 0, cannot_come_back(settings, recipe.draw)
        wanted = replace(recipe, settings=settings, warmup=Warmup(repeats=repeats, unknown=unknown))
        wanted = wanted.with_draw(magnified=1, legend=plan.legend, caption=plan.caption)
        stills.check_light(wanted, scene)
        if not stills.lights_fit(wanted, scene, plan.ending == exr.ENDING):
            raise ValueError("there are too many lights for all buffers of a picture of this size")
        return stills.with_caption_filled(wanted, scene)

    # --- what is shown, elsewhere ------------------------------------------------------------------

    def copy(
        self,
        pixels: NDArray[np.uint8] | None,
        frame: Frame | None,
        legend: Legend | None = None,
        recipe: ViewState | None = None,
    ) -> None:
        """Put what is shown, (h, w, 3), on the clipboard, with its legend.

        With the recipe that makes it again; without one, as for two pictures, it says nothing."""
        scene, place = self._session.scene, self._session.draw.legend_at
        if pixels is None or frame is None or scene is None:
            self._notices.say("there is no picture to copy yet", error=True)
            return
        if clipboard.program() is None:
            self._notices.say(clipboard.NONE, error=True)
            return

        def work() -> str:
            file = BytesIO()
            if recipe is not None:
                drawn, _ = stills.dressed(pixels, frame, scene, recipe)
                Image.fromarray(drawn).save(
                    file, "PNG", pnginfo=png.notes(stills.text(drawn, frame, scene, recipe, by_gpu=True))
                )
            else:
                described = with_legend(pixels, legend, place) if legend is not None else None
                drawn = pixels if described is None else described
                Image.fromarray(drawn).save(file, "PNG")
            clipboard.copy(file.getvalue())
            return f"the picture, {drawn.shape[1]} x {drawn.shape[0]}, is on the clipboard"

        self._begin("Copying", work)

    def to_tev(self, frame: Frame | None) -> None:
        """Send the frame and its buffers to where the preferences say."""
        scene = self._session.scene
        if frame is None or scene is None:
            self._notices.say("there is no picture to send yet", error=True)
            return
        try:
            to = tev.address(self._preferences.tev)
        except ValueError as error:
            self._notices.say(str(error), error=True)
            return
        name = f"{scene.path.stem} frame {self._session.frame_at(frame.time)} {frame.settings.method}"

        def work() -> str:
            tev.send(to, name, frame)
            return f"sent to {to[0]}:{to[1]} as {name!r}"

        self._begin("Sending", work)

    def _begin(self, title: str, work: Callable[[], str]) -> None:
        self.jobs.append((Job(title, lambda _: work(), self._wake), title))

    def report_done(self) -> None:
        """Report what has been done, or could not be."""
        for entry in [entry for entry in self.jobs if entry[0].done]:
            self.jobs.remove(entry)
            job = entry[0]
            if job.failure is not None:
                self._notices.report(job.failure)
            elif job.result is not None:
                self._notices.say(job.result)

"""Films in the window: what is planned, and the run that traces and writes it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from viewer.output import movie
from viewer.output.movie import VIDEO
from viewer.output.recipe import Recipe, cannot_come_back
from viewer.services import filming
from viewer.services.bookmarks import Bookmarks
from viewer.services.filming import Script
from viewer.services.recipes import Recipes
from viewer.services.run_controller import RunController
from viewer.services.runs import LONGEST_SIDE, Run
from viewer.state import codec, flight
from viewer.state.flight import Stop, Take
from viewer.state.notices import Notices
from viewer.state.plans import FilmPlan, frames_within
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.views import View


class FilmRun(Run[int]):
    """A film being traced; `results` is how many of its pictures are written."""

    name = "film"
    endings = ()

    def __init__(self, scene: Scene, script: Script, wake: Callable[[], None] = lambda: None) -> None:
        self.script = script
        super().__init__(scene, len(script.takes), wake)

    @property
    def verifies(self) -> bool:
        return self.script.recipe.settings.verify or self.script.recipe.view.needs_verify

    def lacks(self, view: View) -> str:
        return "" if view is self.script.recipe.view else super().lacks(view)

    @property
    def where(self) -> str:
        return f", in {self.script.video or self.script.folder}"

    def _steps(self, scene: Scene, renderer: Renderer, cancelled: Callable[[], bool]) -> Iterator[int]:
        filming.check_folder(self.script.folder)
        own = Renderer(scene, self.script.recipe.settings, world=renderer.world)

        def on_frame(number: int, frame: Frame) -> None:
            self._count(f"frame {number + 1} of {self.frames}")
            self._show(frame, wait=False)

        for _ in filming.shoot(own, self.script, cancelled, on_frame):
            yield self.traced

    def write(self, results: int, path: Path) -> None:
        raise ValueError("a film is written as it is traced")


class FilmController:
    """`plan` is what to film next, `film` the last one: under way, done or stopped."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        runs: RunController,
        recipes: Recipes,
        bookmarks: Bookmarks,
        notices: Notices,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._preferences, self._runs, self._recipes = session, preferences, runs, recipes
        self._bookmarks, self._notices, self._wake = bookmarks, notices, wake
        self.plan = FilmPlan()
        self.film: FilmRun | None = None

    @property
    def frames(self) -> tuple[int, int]:
        """The first and the last frame of the path that are to be filmed, of those that there are."""
        scene = self._session.scene
        return frames_within(self.plan.first, self.plan.last, scene.frames if scene is not None else 1)

    @property
    def count(self) -> int:
        """How many frames the film has; 0 where it cannot be made."""
        plan, (first, last) = self.plan, self.frames
        if plan.through_bookmarks:
            legs = len(self._bookmarks.all) - 1
            return max(2, round((plan.seconds or flight.LEG * legs) * plan.fps)) if legs > 0 else 0
        return max(2, round(plan.seconds * plan.fps)) if plan.seconds else last - first + 1

    def start(self) -> None:
        """Begin to film what is planned, with the view, the method and the settings that are chosen now."""
        scene, recipe = self._session.scene, self._recipes.now()
        if self._runs.refuses_start():
            return
        if scene is None or recipe is None:
            self._notices.say("there is nothing to film yet")
            return
        try:
            script = self._script(scene, recipe)
        except (ValueError, OSError) as error:
            self._notices.say(str(error), error=True)
            return
        self.film = FilmRun(scene, script, self._wake)
        self._runs.begin(self.film)

    def _script(self, scene: Scene, recipe: Recipe) -> Script:
        plan = self.plan
        if max(plan.size) > LONGEST_SIDE:
            raise ValueError(f"{plan.size[0]} x {plan.size[1]} is too large; {LONGEST_SIDE} pixels a side at most")
        if plan.video:
            movie.check_video()
        takes = self._takes(scene)
        settings = replace(
            recipe.settings,
            width=plan.size[0],
            height=plan.size[1],
            samples=plan.samples,
            certificate_seconds=math.inf,  # a count of certificates is what repeats exactly
        ).validated()
        p, place = self._preferences, self._session.draw.legend_at
        style = replace(recipe.style, magnified=1, caption=plan.caption, legend=place if plan.legend else None)
        history = cannot_come_back(settings, recipe.view, recipe.tells_counters)
        recipe = replace(recipe, settings=settings, style=style, repeats=0, history=history, by_gpu=False)
        name = f"{scene.path.stem}-film-{datetime.now():%Y-%m-%d-%H-%M-%S}"
        folder = p.picture_folder / name
        video = p.picture_folder / (name + VIDEO) if plan.video else None
        return Script(takes, recipe, folder, video, plan.fps)

    def _takes(self, scene: Scene) -> list[Take]:
        plan = self.plan
        if plan.through_bookmarks:
            places = [codec.state_from_json(bookmark.state) for bookmark in self._bookmarks.all]
            if len(places) < 2:
                raise ValueError("a flight needs two bookmarks at least; the menu Camera adds one")
            return flight.through(
                [Stop(place.time, place.camera or scene.camera_at(place.time)) for place in places], self.count
            )
        first, last = self.frames
        camera = self._session.camera if plan.from_here else None
        return flight.along_path(scene, first, last, self.count if plan.seconds else None, camera)

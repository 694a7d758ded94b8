"""Hunts for counterexamples in the window: what is planned, the run that searches, and the way to what it has found."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from tracer.experiments import hunt
from tracer.experiments.counterexample import Counterexample
from tracer.experiments.hunt import Search
from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Scene
from viewer.output import exports
from viewer.services import counterexamples
from viewer.services.frame_history import FrameNavigator, JumpTarget
from viewer.services.recipes import Recipes
from viewer.services.run_controller import RunController
from viewer.services.runs import LONGEST_SIDE, Run
from viewer.state import flight, zooming
from viewer.state.edits import as_options
from viewer.state.notices import Notices
from viewer.state.plans import HuntPlan, frames_within
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.views import View


class HuntRun(Run[hunt.Results]):
    """A hunt under way; its pictures are the window's.  Raises ValueError for a size that is none."""

    name = "hunt"
    endings = (".json",)

    def __init__(self, scene: Scene, search: Search, wake: Callable[[], None] = lambda: None) -> None:
        size = search.settings.width, search.settings.height
        if max(size) > LONGEST_SIDE:
            raise ValueError(f"{size[0]} x {size[1]} is too large for a hunt; {LONGEST_SIDE} pixels a side at most")
        self.search = search
        super().__init__(scene, search.frames, wake)

    def _steps(self, scene: Scene, renderer: Renderer, cancelled: Callable[[], bool]) -> Iterator[hunt.Results]:
        def on_frame(label: str, frame: Frame) -> None:
            self._count(label)
            self._show(frame, wait=False)

        return hunt.run(scene, self.search, cancelled, renderer.world, on_frame)

    def _copy(self, results: hunt.Results) -> hunt.Results:
        return replace(results, finds=list(results.finds))

    def write(self, results: hunt.Results, path: Path) -> None:
        raise ValueError("each find is saved by itself")


class FigureRun(Run[Path]):
    """The figure of a find being traced and drawn; `results` is its file."""

    name = "figure"
    endings = ()

    def __init__(
        self, scene: Scene, found: hunt.Results, find: Counterexample, search: Search, folder: Path,
        folders: tuple[Path, ...], meshes: MeshOptions, edits: Edits, wake: Callable[[], None],
    ) -> None:  # fmt: skip
        self._found, self._find, self._folder, self._edits = found, find, folder, edits
        self._comparison = counterexamples.comparison_of(find, found, scene, search.settings, folders, meshes, edits)
        super().__init__(scene, len(find.before) + 2, wake)

    def lacks(self, view: View) -> str:
        return "is traced beside it"

    @property
    def where(self) -> str:
        return f": {self.results}" if self.results is not None else ""

    def _steps(self, scene: Scene, renderer: Renderer, cancelled: Callable[[], bool]) -> Iterator[Path]:
        def tell(method: str, done: int, total: int) -> None:
            self.label = f"{method}, frame {done + 1} of {total}"
            self.traced = min(self.traced + 1, self.frames - 1)

        def write(path: Path) -> None:
            counterexamples.save_figure(self._comparison, scene, renderer.world, path, tell, cancelled)

        name = f"{scene.path.stem}-find-{self._find.primitive}-{self._find.light}"
        path = exports.save(self._folder, name, ".png", write)
        options = as_options(self._edits)
        counterexamples.save_json(self._find, self._found, scene, path.with_suffix(".json"), options)
        self.traced = self.frames
        yield path

    def write(self, results: Path, path: Path) -> None:
        raise ValueError("a figure is written when it is traced")


class HuntController:
    """`plan` is what to search next, `hunt` the last hunt: under way, done or stopped; `chosen` is the find that is
    looked at, by its place in the list."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        runs: RunController,
        navigator: FrameNavigator,
        recipes: Recipes,
        notices: Notices,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._preferences, self._runs, self._navigator = session, preferences, runs, navigator
        self._recipes, self._notices, self._wake = recipes, notices, wake
        self.plan = HuntPlan()
        self.hunt: HuntRun | None = None
        self.chosen: int | None = None

    @property
    def frames(self) -> tuple[int, int]:
        """The first and the last frame of the path that are to be searched, of those that there are."""
        scene = self._session.scene
        return frames_within(self.plan.first, self.plan.last, scene.frames if scene is not None else 1)

    @property
    def found(self) -> hunt.Results | None:
        """What the last hunt has found so far."""
        return self.hunt.results if self.hunt is not None else None

    def start(self) -> None:
        """Begin to search what is planned, with the settings that are chosen now."""
        scene = self._session.scene
        if self._runs.refuses_start() or scene is None:
            return
        try:
            self.hunt = HuntRun(scene, self._search(scene), self._wake)
        except ValueError as error:
            self._notices.say(str(error), error=True)
            return
        self.chosen = None
        self._runs.begin(self.hunt)

    def _search(self, scene: Scene) -> Search:
        plan, (first, last) = self.plan, self.frames
        times = [take.time for take in flight.along_path(scene, first, last)][:: plan.step]
        width, height = plan.size
        settings = replace(self._session.settings, method=plan.method, width=width, height=height, samples=1)
        settings = replace(settings, certificate_seconds=float("inf"), verify=True).validated()
        return Search(settings, times, None, plan.around, plan.radius, plan.seed, plan.keep)

    def find(self, number: int) -> Counterexample | None:
        """A find by its place in the list, if the scene that it was found in is still open; else one line."""
        hunt, found = self.hunt, self.found
        if hunt is None or found is None or not 0 <= number < len(found.finds) or self._runs.refuses():
            return None
        if not hunt.is_of(self._session.scene):
            self._notices.say(f"this was found {hunt.made_in(self._session.scene)}")
            return None
        return found.finds[number]

    def go(self, number: int) -> None:
        """Fly to a find: forget all modes, trace the earlier frames that made it, and select its pixel, enlarged.
        The picture stays as it was found, with one sample a pixel, until something moves."""
        find, hunt, scene = self.find(number), self.hunt, self._session.scene
        if find is None or hunt is None or scene is None:
            return
        self.chosen = number
        settings, size = hunt.search.settings, (hunt.search.settings.width, hunt.search.settings.height)
        wanted = replace(settings, samples=self._session.settings.samples)
        state = replace(
            self._session.state, time=find.time, camera=None if find.own_camera else find.camera, settings=wanted
        ).with_draw(light=find.light)
        point = (find.x + 0.5) / size[0], (find.y + 0.5) / size[1]
        warmup = tuple((one.time, one.camera or scene.camera_at(one.time)) for one in find.before)
        zoom = zooming.around(*point, size[0] / counterexamples.crop_of(find, size).width)
        self._navigator.go_to(JumpTarget(state, f"find {number + 1}", size, point, zoom, warmup))

    def save_figure(self, number: int) -> None:
        """Trace and draw the figure of a find, into the folder of the pictures."""
        find, hunt, found, scene = self.find(number), self.hunt, self.found, self._session.scene
        if find is None or hunt is None or found is None or scene is None:
            return
        folder, folders = self._preferences.picture_folder, self._recipes.folders
        meshes, edited = self._session.meshes, self._session.edited
        edits = edited.edits if edited is not None else NO_EDITS
        self._runs.begin(FigureRun(scene, found, find, hunt.search, folder, folders, meshes, edits, self._wake))

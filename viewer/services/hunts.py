"""Hunts for counterexamples in the window: what to search next, and the way to what was found."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from tracer.experiments import hunt
from tracer.experiments.counterexample import Counterexample
from tracer.experiments.hunt import Hunt, Search
from tracer.frame import Settings
from tracer.geometry.world import World
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Scene
from viewer.output import exports
from viewer.services import comparison, counterexamples
from viewer.services.frame_history import FrameNavigator, JumpTarget
from viewer.services.runs import FileRun, Runs, check_size
from viewer.state import navigation
from viewer.state.changes import as_options
from viewer.state.notices import Notices
from viewer.state.pixels import around
from viewer.state.plans import HuntPlan, frames_within
from viewer.state.preferences import Preferences
from viewer.state.session import Session


class FigureRun(FileRun):
    """The figure of a counterexample being traced and drawn; its results are its file."""

    name = "figure"

    def __init__(
        self, scene: Scene, found: hunt.Results, find: Counterexample, settings: Settings, folder: Path,
        meshes: MeshOptions, edits: Edits,
    ) -> None:  # fmt: skip
        self._found, self._find, self._folder = found, find, folder
        self._figure = counterexamples.comparison_of(find, found, scene, settings, meshes, edits)
        super().__init__(scene, len(find.before) + 2)

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Path]:
        assert world is not None

        def tell(method: str, done: int, total: int) -> None:
            if self.traced < self.frames - 1:
                self.progressed(f"{method}, frame {done + 1} of {total}")

        def write(path: Path) -> None:
            comparison.save(comparison.trace(scene, *self._figure, world, tell, cancel), path)

        name = f"{Path(scene.path).stem}-find-{self._find.primitive}-{self._find.light}"
        self.output = exports.save(self._folder, name, ".png", write)
        options = as_options(self._figure[0].edits)
        counterexamples.save_json(self._find, self._found, scene, self.output.with_suffix(".json"), options)
        self.traced = self.frames
        yield self.output


class Hunts:
    """`plan` is what to search next, `hunt` the last hunt: under way, done or stopped; `chosen` is the counterexample
    that is looked at, by its place in the list."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        runs: Runs,
        navigator: FrameNavigator,
        notices: Notices,
    ) -> None:
        self._session, self._preferences, self._runs, self._navigator = session, preferences, runs, navigator
        self._notices = notices
        self.plan = HuntPlan()
        self.hunt: Hunt | None = None
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

        def make(scene: Scene) -> Hunt:
            self.hunt, self.chosen = Hunt(scene, self._search(scene)), None
            return self.hunt

        self._runs.start(make)

    def _search(self, scene: Scene) -> Search:
        plan, (first, last) = self.plan, self.frames
        check_size(plan.size)
        times = [take.time for take in navigation.along_path(scene, first, last)][:: plan.step]
        settings = replace(
            self._session.settings, method=plan.method, width=plan.size[0], height=plan.size[1], samples=1,
            certificate_seconds=float("inf"), verify=True,
        ).validated()  # fmt: skip
        return Search(settings, times, None, plan.around, plan.radius, plan.seed, plan.keep)

    def find(self, number: int) -> Counterexample | None:
        """A counterexample by its place in the list, if its scene is still open; else one line."""
        hunt, found = self.hunt, self.found
        if hunt is None or found is None or not 0 <= number < len(found.finds) or self._runs.refuses():
            return None
        if not hunt.is_of(self._session.scene):
            self._notices.say(f"this was found {hunt.made_in(self._session.scene)}")
            return None
        return found.finds[number]

    def go(self, number: int) -> None:
        """Fly to a counterexample: forget all modes, trace the frames that taught it, and select its pixel, enlarged.
        The picture stays as it was found, with one sample a pixel, until something moves."""
        find, hunt, scene = self.find(number), self.hunt, self._session.scene
        if find is None or hunt is None or scene is None:
            return
        self.chosen = number
        settings, size = hunt.settings, (hunt.settings.width, hunt.settings.height)
        wanted = replace(settings, samples=self._session.settings.samples)
        state = replace(
            self._session.state, time=find.time, camera=None if find.own_camera else find.camera, settings=wanted
        ).with_draw(light=find.light)
        point = (find.x + 0.5) / size[0], (find.y + 0.5) / size[1]
        warmup = tuple((one.time, one.camera or scene.camera_at(one.time)) for one in find.before)
        zoom = around(*point, size[0] / counterexamples.crop_of(find, size).width)
        self._navigator.go_to(JumpTarget(state, f"counterexample {number + 1}", size, point, zoom, warmup))

    def save_figure(self, number: int) -> None:
        """Trace and draw the figure of a counterexample, into the folder of the pictures."""
        find, hunt, found = self.find(number), self.hunt, self.found
        if find is None or hunt is None or found is None:
            return
        folder, meshes, edited = self._preferences.picture_folder, self._session.meshes, self._session.edited
        edits = edited.edits if edited is not None else NO_EDITS
        self._runs.start(lambda scene: FigureRun(scene, found, find, hunt.search.settings, folder, meshes, edits))

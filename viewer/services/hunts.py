"""Hunts for counterexamples: what to search next in the window, the way to what was found, and what is kept of it."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path

from tracer.experiments import counterexample, hunt
from tracer.experiments.camera_path import along_path
from tracer.experiments.counterexample import Counterexample
from tracer.experiments.hunt import Hunt, Search
from tracer.frame import Settings
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.scene.model import Scene
from viewer.output import commands, exports
from viewer.output.comparison import Comparison, Crop
from viewer.services.history import FrameNavigator
from viewer.services.runs import Runs
from viewer.state.methods import NO_CULLING
from viewer.state.notices import Notices
from viewer.state.pixels import around
from viewer.state.plans import HuntPlan
from viewer.state.session import Session
from viewer.state.view_state import ViewState, Warmup

# --- what is kept: a figure and a JSON for each counterexample, and one JSON with all --------------------

ALL = "hunt.json"


def check_folder(folder: Path) -> None:
    """Make the folder; raises OSError, in one line, where that cannot be, or where a hunt has written to it already."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        taken = next((path.name for path in folder.iterdir() if path.name == ALL or path.match("find-*.*")), None)
    except OSError as error:
        raise OSError(f"{folder}: cannot write counterexamples there: {error.strerror or error}") from None
    if taken is not None:
        raise OSError(f"{folder}: has counterexamples already ({taken}); give another folder")


def crop_of(find: Counterexample, size: tuple[int, int]) -> Crop:
    """Return the surroundings of the pixel, inside the picture."""
    width, height = (min(max(least, side // 8), side) for least, side in zip((24, 18), size, strict=True))
    x = min(max(find.x - width // 2, 0), size[0] - width)
    y = min(max(find.y - height // 2, 0), size[1] - height)
    return Crop(x, y, width, height)


def comparison_of(
    find: Counterexample,
    found: hunt.Results,
    scene: Scene,
    settings: Settings,
    meshes: MeshOptions = AS_IN_FILE,
) -> tuple[ViewState, Comparison]:
    """Return the figure of a counterexample: the right picture and the method's, with the pixel's surroundings
    enlarged."""
    state = ViewState(
        scene=str(Path(scene.path).absolute()),
        time=find.time,
        camera=find.seen_camera,
        settings=replace(settings, method=found.method, verify=False, samples=1, modes=False),
        warmup=Warmup(find.before),
        meshes=meshes,
    )
    methods, words = (NO_CULLING, found.method), " ".join(counterexample.in_words(find, scene))
    shown = Comparison(methods, (crop_of(find, found.size),), ((find.x, find.y),), words)
    return state, shown.checked(state.size)


def save_json(find: Counterexample, found: hunt.Results, scene: Scene, state: ViewState, path: Path) -> None:
    """Write all about a counterexample, whose picture has this state, with the command that explains it.

    Raises OSError in one line."""
    words = ["shadowcull", "explain", commands.scene_word(Path(state.scene))]
    words += commands.options(replace(state, warmup=Warmup()))
    words += ["--pixel", f"{find.x},{find.y}", "--before", path.name, "--only", "wrong"]
    told = counterexample.to_json(find, scene) | {"size": found.size, "method": found.method}
    told |= {"scene": found.scene, "settings": found.settings}
    told |= {"words": counterexample.in_words(find, scene), "explain": shlex.join(words)}
    exports.write_json(path, told, indent=1)


# --- in the window ------------------------------------------------------------------------------------


class Hunts:
    """`plan` is what to search next, `hunt` the last hunt: under way, done or stopped; `chosen` is the counterexample
    that is looked at, by its place in the list."""

    def __init__(self, session: Session, runs: Runs, navigator: FrameNavigator, notices: Notices) -> None:
        self._session, self._runs, self._navigator, self._notices = session, runs, navigator, notices
        self.plan = HuntPlan()
        self.hunt: Hunt | None = None
        self.chosen: int | None = None

    @property
    def found(self) -> hunt.Results | None:
        """What the last hunt has found so far."""
        return self.hunt.results if self.hunt is not None else None

    def start(self) -> None:
        """Begin to search what is planned, with the settings that are chosen now."""

        def make(scene: Scene) -> Hunt:
            plan = self.plan
            times = [take.time for take in along_path(scene, *plan.frames(scene))][:: plan.step]
            settings = replace(
                self._session.settings, method=plan.method, width=plan.size[0], height=plan.size[1], samples=1,
                certificate_seconds=float("inf"), verify=True,
            ).validated()  # fmt: skip
            search = Search(settings, times, None, plan.around, plan.radius, plan.seed, plan.keep)
            self.hunt, self.chosen = Hunt(scene, search), None
            return self.hunt

        self._runs.start(make)

    def find(self, number: int) -> Counterexample | None:
        """Return a counterexample by its place in the list, if its scene is still open; else one line is said."""
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
            self._session.state, time=find.time, camera=find.seen_camera, settings=wanted
        ).with_draw(light=find.light)  # fmt: skip
        point = (find.x + 0.5) / size[0], (find.y + 0.5) / size[1]
        warmup = tuple((one.time, one.camera or scene.camera_at(one.time)) for one in find.before)
        zoom = around(*point, size[0] / crop_of(find, size).width)
        self._navigator.go_to(state, f"counterexample {number + 1}", size, point, zoom, warmup)

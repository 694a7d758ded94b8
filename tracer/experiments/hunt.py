"""A hunt for counterexamples: the worst wrong pixels of a method, along a path of frames and near it.

Along the path the method learns from frame to frame, as in `bench`; every culled answer is verified.  What a wrong
pixel shows, and to which light its answer is wrong, is read off the tree of its rays.  Then the shortest history is
looked for that gives the same pixel the same colour, bit for bit: mostly the one frame that taught the mode.  The extra
views near the path are random; each comes after the history of one of the worst counterexamples.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.experiments import counterexample
from tracer.experiments.counterexample import AROUND, PATH, Counterexample, counterexample_in, difference_of
from tracer.experiments.runner import Run
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame, Settings
from tracer.geometry.rays import ray_batch
from tracer.geometry.world import World
from tracer.inspect.mode_origins import NEVER, ModeOrigins
from tracer.inspect.projection import seen_at
from tracer.inspect.ray_tree import ray_tree
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.arrays import vector
from tracer.scene.model import Camera, Cancelled, Scene

OnFrame = Callable[[str, Frame], None]
VISIBLE = 0.5 / 255.0
"""Differences below this are not seen on a screen of 8 bits."""
MOST_LOOKED_INTO = 12
"""Wrong pixels of one frame whose rays are looked into, at most."""
_SUFFIXES = (1, 2, 4, 8, 16)  # last frames of a history that are tried alone
_DRAWS = 12  # places that are tried for one random view, until nothing is in the way there
SETTINGS = ("depth", "symmetric", "zoom_factor", "lamp_radius", "lamp_samples", "accelerator")
"""What findings tell of how they were traced."""


@dataclass(frozen=True)
class Search:
    """What to search: the frames at `times`, in their order, from `camera` or else along the scene's path; then
    `around` random views near the worst counterexamples, drawn with `seed`, at most `radius` times as far from where
    the camera was as that is from what is wrong there.  The worst `keep` counterexamples are kept."""

    settings: Settings
    times: Sequence[float]
    camera: Camera | None
    around: int
    radius: float
    seed: int
    keep: int

    @property
    def frames(self) -> int:
        """How many pictures are searched."""
        return len(self.times) + self.around


@dataclass
class Results:
    """What a hunt has found: `finds`, the worst counterexamples first, and in how many frames and pixels.

    `wrong_pixels` and `wrong_frames` count those with a wrong answer or colour.  `settings` are by name."""

    scene: str
    method: str
    size: tuple[int, int]
    settings: dict[str, Any]
    frames: int = 0
    pixels: int = 0
    wrong_pixels: int = 0
    wrong_frames: int = 0
    finds: list[Counterexample] = field(default_factory=list)

    @property
    def summary(self) -> str:
        """How much was compared, and how much of it was wrong, in one line."""
        compared = f"{self.pixels:,} pixels of {self.frames:,} frame{'s' * (self.frames != 1)} compared"
        if not self.wrong_pixels:
            return f"{compared}: none is wrong"
        frames = f"{self.wrong_frames:,} frame{'s' * (self.wrong_frames != 1)}"
        wrong = f"{self.wrong_pixels:,} wrong pixel{'s' * (self.wrong_pixels != 1)}"
        return f"{compared}: {wrong}, in {frames}"

    def to_dict(self, scene: Scene) -> dict[str, Any]:
        """Plain lists and numbers, for JSON."""
        finds = [counterexample.to_json(find, scene) for find in self.finds]
        return vars(self) | {"size": list(self.size), "finds": finds}


def run(
    scene: Scene,
    search: Search,
    cancel: Callable[[], bool] = lambda: False,
    world: World | None = None,
    on_frame: OnFrame = lambda label, frame: None,
) -> Iterator[Results]:
    """Search, and yield the results after each picture: always the same growing object.

    `on_frame` is called with each picture, and where it is in words.  Once `cancel` returns true, the hunt ends with
    what it has.  Raises ValueError where a setting is out of range."""
    settings = repeatable(replace(search.settings, verify=True))
    world = world or World(scene, search.times[0], settings.accelerator)
    settings = replace(settings, accelerator=world.accelerator)
    names = {name: getattr(settings, name) for name in SETTINGS}
    results = Results(str(scene.path), settings.method, (settings.width, settings.height), names)
    hunter = _Hunter(scene, search, settings, world, cancel, results)
    try:
        for number, time in enumerate(search.times):
            on_frame(f"frame {number + 1} of {len(search.times)}", hunter.frame_of_path(time))
            yield results
        hunter.shorten_histories()
        yield results
        lots = np.random.default_rng(search.seed)
        for number in range(search.around):
            on_frame(f"random view {number + 1} of {search.around}", hunter.random_view(lots))
            yield results
        hunter.shorten_histories()
    except Cancelled:
        return
    yield results


def repeatable(settings: Settings) -> Settings:
    """Return settings by which the same picture comes again, bit for bit, after the same frames.

    Raises ValueError, in one line, where one is out of range."""
    settings = replace(settings, samples=1, modes=False).validated()
    if Method.parse(settings.method).has_certificates:
        settings = replace(settings, threads=1)  # which certificates are made depends on the turns of threads
    return settings


class Hunt(Run[Results]):
    """A hunt as a run."""

    name = "hunt"

    def __init__(self, scene: Scene, search: Search) -> None:
        self.search, self.settings = search, search.settings.validated()
        super().__init__(scene, search.frames)

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Results]:
        self.make_ready([self.settings.method], scene, self.settings.accelerator, cancel)
        yield from run(scene, self.search, cancel, world, self.progressed)

    def copy(self, results: Results) -> Results:
        return replace(results, finds=list(results.finds))


class History:
    """Frames that were traced one after another, and which of them taught what."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.frames: list[WarmupFrame] = []
        self.origins = ModeOrigins(len(scene.lights))
        self._lights: np.ndarray | None = None

    def add(self, frame: Frame, traced: WarmupFrame) -> None:
        """Take up a frame and the modes that it leaves."""
        lights = self._scene.light_positions(frame.time)
        moved = None if self._lights is None else (lights != self._lights).any(axis=1)
        if frame.settings.keeps_modes:
            self.origins.add(len(self.frames), frame.modes, moved)
        self._lights = lights
        self.frames.append(traced)

    def with_teacher(self, find: Counterexample, unit: int) -> Counterexample:
        """Add the frame that taught the mode of the unit, the primitive or a cell of it."""
        taught = self.origins.of(unit)
        if taught is None or find.light >= len(taught.lights):
            return find
        origin = taught.lights[find.light]
        number = origin.lit if find.lit else origin.blocked
        return find if number == NEVER else replace(find, taught=number, taught_time=self.frames[number].time)


def trace_before(renderer: Renderer, before: Sequence[WarmupFrame], cancel: Callable[[], bool]) -> History:
    """Trace frames one after another, without verifying them, and return them as a history."""
    history, renderer.settings = History(renderer.scene), replace(renderer.settings, verify=False)
    for one in before:
        history.add(renderer.render(one.time, one.camera, cancel), one)
    return history


def wrong_in(frame: Frame) -> tuple[NDArray[np.bool_], dict[str, Any]]:
    """Return which pixels (h, w) of a verified frame have a wrong answer or another colour, and how many there are of
    either, as a `Counterexample` has it."""
    assert frame.wrong is not None and frame.reference is not None
    differing = (frame.color != frame.reference).any(axis=-1)
    wrong = (frame.wrong > 0) | differing
    pixels, answers = int(np.count_nonzero(wrong)), int(frame.wrong.sum())
    return wrong, {"pixels": pixels, "answers": answers, "differing": int(np.count_nonzero(differing))}


def find_at(
    renderer: Renderer, frame: Frame, x: int, y: int, history: History, cancel: Callable[[], bool]
) -> Counterexample | None:
    """Return what is wrong at a pixel of a verified frame that comes after a history; None where no answer is."""
    find = counterexample_in(ray_tree(renderer, frame, x, y, cancel), renderer.scene)
    if find is None:
        return None
    if frame.cells is None or frame.certificates is not None:  # else cells of it have the modes
        find = history.with_teacher(find, find.primitive)
    return replace(find, before=tuple(history.frames), learnt_from=len(history.frames))


class _Hunter:
    """Judges pictures, and keeps the worst of what is wrong in them."""

    def __init__(
        self,
        scene: Scene,
        search: Search,
        settings: Settings,
        world: World,
        cancel: Callable[[], bool],
        results: Results,
    ) -> None:
        self._scene, self._search, self._settings, self._world = scene, search, settings, world
        self._cancel, self._results = cancel, results
        self._renderer = Renderer(scene, settings, world=world)
        self._path = History(scene)
        self._shortened: set[Counterexample] = set()

    def frame_of_path(self, time: float) -> Frame:
        """Trace and judge the next frame of the path."""
        frame = self._renderer.render(time, self._search.camera, self._cancel)
        self._judge(self._renderer, frame, PATH, self._path, self._search.camera is None)
        self._path.add(frame, WarmupFrame(time, self._search.camera))
        return frame

    def random_view(self, lots: np.random.Generator) -> Frame:
        """Trace and judge a view near one of the worst counterexamples, after its history, or else near the path."""
        finds = self._results.finds
        find = finds[int(lots.integers(len(finds)))] if finds else None
        if find is not None:
            time, camera, before = find.time, find.camera, find.before
            target = seen_at(self._primary_rays(time, find.seen_camera), find.x, find.y)
        else:
            time = float(lots.choice(np.asarray(self._search.times)))
            camera = self._search.camera or self._scene.camera_at(time)
            before, target = (WarmupFrame(time, self._search.camera),), None
        self._renderer.reset_modes()
        history = trace_before(self._renderer, before, self._cancel)
        if target is None:
            target = self._ahead(time, camera)
        moved = self._another(camera, target, time, lots)
        self._renderer.settings = self._settings
        frame = self._renderer.render(time, moved, self._cancel)
        self._judge(self._renderer, frame, AROUND, history, False)
        return frame

    # --- judging ----------------------------------------------------------------------------------

    def _judge(self, renderer: Renderer, frame: Frame, place: str, history: History, own_camera: bool) -> None:
        """Count what is wrong in a picture that comes after a history, and keep it where it is among the worst."""
        results, (wrong, counts) = self._results, wrong_in(frame)
        results.frames += 1
        results.pixels += wrong.size
        results.wrong_pixels += counts["pixels"]
        results.wrong_frames += counts["pixels"] > 0
        for x, y in self._candidates(frame, wrong):
            find = find_at(renderer, frame, x, y, history, self._cancel)
            if find is not None:
                self._keep(replace(find, place=place, own_camera=own_camera, **counts))

    def _candidates(self, frame: Frame, wrong: NDArray[np.bool_]) -> list[tuple[int, int]]:
        """The worst wrong pixel (x, y) of each primitive, worst first, where it may be among the worst of all."""
        rows, columns = np.nonzero(wrong)
        assert frame.reference is not None
        differences = difference_of(frame.color[rows, columns], frame.reference[rows, columns])
        order = np.lexsort((columns, rows, -differences))
        _, first = np.unique(frame.primitive[rows, columns][order], return_index=True)
        finds = self._results.finds
        least = finds[-1].difference if len(finds) >= self._search.keep else VISIBLE
        worst = order[np.sort(first)][:MOST_LOOKED_INTO]
        return [(int(columns[i]), int(rows[i])) for i in worst if differences[i] > least]

    def _keep(self, find: Counterexample) -> None:
        """Put a counterexample among the others, the worst first, the worst only of a primitive and a light."""
        finds = self._results.finds
        same = next((other for other in finds if other.key == find.key), None)
        if same is not None:
            if same.difference >= find.difference:
                return
            finds.remove(same)
        finds.append(find)
        finds.sort(key=lambda one: (-one.difference, -one.pixels))
        del finds[self._search.keep :]

    # --- histories --------------------------------------------------------------------------------

    def shorten_histories(self) -> None:
        """Look, once for each counterexample, for the shortest history that still makes it."""
        finds = self._results.finds
        for number, find in enumerate(finds):
            if find not in self._shortened:
                finds[number] = self._shortest(find)
                self._shortened.add(finds[number])

    def _shortest(self, find: Counterexample) -> Counterexample:
        for before in self._fewer(find):
            if self._makes(before, find):
                return replace(find, before=before)
        return find

    def _fewer(self, find: Counterexample) -> list[tuple[WarmupFrame, ...]]:
        """Return shorter histories to try: the frame that taught the mode, the one since which the primitive is fully
        rendered, the last ones."""
        every = find.before
        tries: list[tuple[WarmupFrame, ...]] = []
        if find.place == PATH and find.taught >= 0:
            taught = self._path.origins.of(find.primitive)
            whole = taught.whole if taught is not None else NEVER
            numbers = [{find.taught}, {whole}, {find.taught, whole}, {find.taught, len(every) - 1}]
            chosen = [sorted(n for n in some if 0 <= n < len(every)) for some in numbers]
            tries += [tuple(every[n] for n in some) for some in chosen if some]
        tries += [every[-count:] for count in _SUFFIXES]
        return sorted({one for one in tries if len(one) < len(every)}, key=lambda one: (len(one), tries.index(one)))

    def _makes(self, before: tuple[WarmupFrame, ...], find: Counterexample) -> bool:
        """Whether this history gives the pixel of a counterexample the same colour, bit for bit."""
        renderer = Renderer(self._scene, self._settings, world=self._world)
        trace_before(renderer, before, self._cancel)
        frame = renderer.render(find.time, find.seen_camera, self._cancel)
        return vector(frame.color[find.y, find.x]) == find.color

    # --- random views -----------------------------------------------------------------------------

    def _ahead(self, time: float, camera: Camera) -> np.ndarray:
        """Return a point ahead of the camera, at the median depth of what it sees."""
        depth = self._primary_rays(time, camera).depth
        seen = depth[np.isfinite(depth)]
        return np.asarray(camera.position) + (float(np.median(seen)) if len(seen) else 1.0) * camera.basis()[2]

    def _primary_rays(self, time: float, camera: Camera | None) -> Frame:
        settings = replace(self._settings, method="none", depth=0, verify=False)
        return Renderer(self._scene, settings, world=self._world).render(time, camera, self._cancel)

    def _another(self, camera: Camera, target: np.ndarray, time: float, lots: np.random.Generator) -> Camera:
        """Return a random camera nearby that has the target at the same place of its picture; nothing is in between."""
        eye = np.asarray(camera.position, np.float64)
        way = eye - target
        distance = float(np.linalg.norm(way))
        aside = np.asarray(camera.basis()[2]) + way / max(distance, 1e-300)
        nearest = 1.0 / math.sqrt(self._settings.zoom_factor)  # nearer, it would be examined anew
        self._world.place(time)
        for _ in range(_DRAWS):
            scale = math.exp(lots.uniform(math.log(nearest), math.log(1.25)))
            step = lots.normal(size=3)
            step *= lots.uniform() * self._search.radius / max(float(np.linalg.norm(step)), 1e-300)
            place = target + scale * way + scale * distance * step
            blocked = self._world.any_hits(ray_batch(eye[None], (place - eye)[None], 0.0, 1.0), threads=1)[0]
            ahead = target - place
            direction = ahead / max(float(np.linalg.norm(ahead)), 1e-300) + aside
            if not blocked and np.linalg.norm(direction) > 1e-6 and np.linalg.norm(ahead) > 1e-3 * distance:
                return replace(camera, position=vector(place), direction=vector(direction))
        return camera

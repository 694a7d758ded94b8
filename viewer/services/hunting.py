"""A hunt for counterexamples: the frames of a path, and pictures beside it, searched for a method's worst wrong pixels.

Along the path the method learns from frame to frame, as in `bench`; every culled answer is verified.  What a wrong
pixel shows, and to which light its answer is wrong, is read off the tree of its rays.  Then the fewest frames before it
are looked for that make the same colour of the same pixel, bit for bit: mostly the one that taught the mode.  Pictures
beside the path are drawn by lot near the worst finds, and come after just these frames."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tracer.frame import Frame, Settings
from tracer.geometry.rays import ray_batch
from tracer.geometry.world import World
from tracer.method import Method
from tracer.ray_tree import ray_tree
from tracer.renderer import Renderer
from tracer.scene.model import Camera, Cancelled, Scene
from viewer.output.finds import AROUND, PATH, VISIBLE, Find, Findings
from viewer.services.counterexample import Lessons, find_in, triple
from viewer.state.earlier import Earlier
from viewer.state.picking import point_at, typical_depth
from viewer.state.readings import has_modes_of_cells
from viewer.state.teaching import NEVER

OnFrame = Callable[[str, int, int, Frame], None]
MOST_LOOKED_INTO = 12
"""Wrong pixels of one frame whose rays are looked into, at most."""
_SUFFIXES = (1, 2, 4, 8, 16)  # last frames before a find that are tried alone
_DRAWS = 12  # places that are tried for one picture beside the path, until nothing is in the way there
_NAMES = ("depth", "symmetric", "zoom_factor", "lamp_radius", "lamp_samples", "accelerator")


@dataclass(frozen=True)
class Search:
    """What to search: the frames at `times`, in their order, from `camera` or else along the scene's path; then
    `around` pictures near the worst finds, at most `radius` times as far from where the camera was as that is from what
    is wrong there, drawn with `seed`.  The worst `keep` finds are kept."""

    settings: Settings
    times: Sequence[float]
    camera: Camera | None = None
    around: int = 0
    radius: float = 0.3
    seed: int = 1
    keep: int = 8

    @property
    def frames(self) -> int:
        """How many pictures are judged."""
        return len(self.times) + self.around


def hunt(
    scene: Scene,
    search: Search,
    world: World | None = None,
    cancelled: Callable[[], bool] = lambda: False,
    on_frame: OnFrame = lambda label, done, total, frame: None,
) -> Iterator[Findings]:
    """Search, and yield what was found so far after each picture: always the same growing object.

    `on_frame` gets in words where a picture is, how many are done, of how many, and the picture.  Once `cancelled()`,
    it ends with what it has; no exception tells.  Raises ValueError where a setting is out of range."""
    settings = replace(search.settings, samples=1, verify=True, modes=False).validated()
    if Method.parse(settings.method).has_certificates:
        settings = replace(settings, threads=1)  # which certificates are made depends on the turns of threads
    world = world or World(scene, search.times[0], settings.accelerator)
    settings = replace(settings, accelerator=world.accelerator)
    names = {name: getattr(settings, name) for name in _NAMES}
    found = Findings(str(scene.path), settings.method, (settings.width, settings.height), names)
    hunter = _Hunter(scene, search, settings, world, cancelled, found)
    try:
        for number, time in enumerate(search.times):
            frame = hunter.along_path(time)
            on_frame(f"frame {number + 1} of {len(search.times)}", number + 1, search.frames, frame)
            yield found
        hunter.shorten()
        yield found
        lots = np.random.default_rng(search.seed)
        for number in range(search.around):
            frame = hunter.beside(lots)
            done = len(search.times) + number + 1
            on_frame(f"picture {number + 1} of {search.around} beside the path", done, search.frames, frame)
            yield found
        hunter.shorten()
    except Cancelled:
        return
    yield found


class _Hunter:
    """Judges pictures, and keeps the worst of what is wrong in them."""

    def __init__(
        self,
        scene: Scene,
        search: Search,
        settings: Settings,
        world: World,
        cancelled: Callable[[], bool],
        found: Findings,
    ) -> None:
        self._scene, self._search, self._settings, self._world = scene, search, settings, world
        self._cancelled, self._found = cancelled, found
        self._renderer = Renderer(scene, settings, world=world)
        self._path = Lessons(scene)
        self._short: set[Find] = set()  # whose frames before cannot be fewer

    def along_path(self, time: float) -> Frame:
        """The next frame of the path, judged."""
        frame = self._renderer.render(time, self._search.camera, self._cancelled)
        self._judge(self._renderer, frame, PATH, self._path, self._search.camera is None)
        self._path.add(frame, Earlier(time, self._search.camera))
        return frame

    def beside(self, lots: np.random.Generator) -> Frame:
        """A picture near one of the worst finds, or near the path while there is none, judged after the same frames."""
        finds = self._found.finds
        find = finds[int(lots.integers(len(finds)))] if finds else None
        if find is not None:
            time, camera, before = find.time, find.camera, find.before
            target = self._target(find)
        else:
            time = float(lots.choice(np.asarray(self._search.times)))
            camera = self._search.camera or self._scene.camera_at(time)
            before, target = (Earlier(time, self._search.camera),), None
        self._renderer.reset_modes()
        lessons = self._trace_before(self._renderer, before)
        if target is None:
            target = self._ahead(time, camera)
        moved = self._another(camera, target, time, lots)
        self._renderer.settings = self._settings
        frame = self._renderer.render(time, moved, self._cancelled)
        self._judge(self._renderer, frame, AROUND, lessons, False)
        return frame

    # --- judging ----------------------------------------------------------------------------------

    def _judge(self, renderer: Renderer, frame: Frame, place: str, lessons: Lessons, own_camera: bool) -> None:
        """Count what is wrong in a picture that comes after others, and keep it where it is among the worst."""
        found = self._found
        assert frame.wrong is not None and frame.reference is not None
        wrong = (frame.wrong > 0) | (frame.color != frame.reference).any(axis=-1)
        pixels = int(np.count_nonzero(wrong))
        found.frames += 1
        found.pixels += wrong.size
        found.wrong_pixels += pixels
        found.wrong_frames += pixels > 0
        for x, y, difference in self._candidates(frame, wrong):
            find = find_in(ray_tree(renderer, frame, x, y, self._cancelled), self._scene)
            if find is not None:
                color, right = frame.color[y, x], frame.reference[y, x]
                self._keep(
                    replace(
                        find if has_modes_of_cells(frame) else lessons.with_teacher(find),
                        place=place,
                        own_camera=own_camera,
                        difference=difference,
                        color=triple(color),
                        reference=triple(right),
                        pixels=pixels,
                        before=tuple(lessons.frames),
                        learnt_from=len(lessons.frames),
                    )
                )

    def _candidates(self, frame: Frame, wrong: np.ndarray) -> list[tuple[int, int, float]]:
        """The worst wrong pixel of each primitive that a picture shows, the worst first, as x, y and difference, as far
        as they may be among the worst of all."""
        rows, columns = np.nonzero(wrong)
        if not len(rows):
            return []
        assert frame.reference is not None
        color, right = (np.clip(picture[rows, columns], 0.0, 1.0) for picture in (frame.color, frame.reference))
        differences = np.abs(color - right).max(axis=-1)
        order = np.lexsort((columns, rows, -differences))
        _, first = np.unique(frame.primitive[rows, columns][order], return_index=True)
        finds = self._found.finds
        least = finds[-1].difference if len(finds) >= self._search.keep else VISIBLE
        worst = order[np.sort(first)][:MOST_LOOKED_INTO]
        return [(int(columns[i]), int(rows[i]), float(differences[i])) for i in worst if differences[i] > least]

    def _keep(self, find: Find) -> None:
        """Put a find among the others, the worst first, the worst only of a primitive and a light."""
        finds = self._found.finds
        same = next((other for other in finds if other.key == find.key), None)
        if same is not None:
            if same.difference >= find.difference:
                return
            finds.remove(same)
        finds.append(find)
        finds.sort(key=lambda one: (-one.difference, -one.pixels))
        del finds[self._search.keep :]

    # --- fewer frames before it -------------------------------------------------------------------

    def shorten(self) -> None:
        """Look for the fewest frames before each find that still make it, once for each: the numbers of frames in a
        find are those of all that came before it."""
        finds = self._found.finds
        for number, find in enumerate(finds):
            if find not in self._short:
                finds[number] = self._shortened(find)
                self._short.add(finds[number])

    def _shortened(self, find: Find) -> Find:
        for before in self._fewer(find):
            if self._makes(before, find):
                return replace(find, before=before)
        return find

    def _fewer(self, find: Find) -> list[tuple[Earlier, ...]]:
        """Some of the frames before a find: that which taught it, with that since which it is seen whole, the last."""
        every = find.before
        tries: list[tuple[Earlier, ...]] = []
        if find.place == PATH and find.taught >= 0:
            taught = self._path.ledger.of(find.primitive)
            whole = taught.whole if taught is not None else NEVER
            numbers = [{find.taught}, {whole}, {find.taught, whole}, {find.taught, len(every) - 1}]
            chosen = [sorted(n for n in some if 0 <= n < len(every)) for some in numbers]
            tries += [tuple(every[n] for n in some) for some in chosen if some]
        tries += [every[-count:] for count in _SUFFIXES]
        return sorted({one for one in tries if len(one) < len(every)}, key=lambda one: (len(one), tries.index(one)))

    def _makes(self, before: tuple[Earlier, ...], find: Find) -> bool:
        """Whether these frames before it give the pixel of a find the same colour, bit for bit."""
        renderer = Renderer(self._scene, self._settings, world=self._world)
        self._trace_before(renderer, before)
        frame = renderer.render(find.time, find.seen_camera, self._cancelled)
        return triple(frame.color[find.y, find.x]) == find.color

    def _trace_before(self, renderer: Renderer, before: tuple[Earlier, ...]) -> Lessons:
        renderer.settings, lessons = replace(self._settings, verify=False), Lessons(self._scene)
        for earlier in before:
            lessons.add(renderer.render(earlier.time, earlier.camera, self._cancelled), earlier)
        return lessons

    # --- places beside the path -------------------------------------------------------------------

    def _target(self, find: Find) -> np.ndarray:
        """The point that the pixel of a find shows."""
        settings = replace(self._settings, method="none", depth=0, verify=False)
        frame = Renderer(self._scene, settings, world=self._world).render(find.time, find.seen_camera, self._cancelled)
        point = point_at(frame, (find.x + 0.5) / frame.width, (find.y + 0.5) / frame.height)
        assert point is not None, "a wrong pixel shows something"
        return np.asarray(point)

    def _ahead(self, time: float, camera: Camera) -> np.ndarray:
        """A point before the camera, as far as it sees as a rule."""
        settings = replace(self._settings, method="none", depth=0, verify=False)
        depth = typical_depth(Renderer(self._scene, settings, world=self._world).render(time, camera, self._cancelled))
        return np.asarray(camera.position) + (depth if math.isfinite(depth) else 1.0) * camera.basis()[2]

    def _another(self, camera: Camera, target: np.ndarray, time: float, lots: np.random.Generator) -> Camera:
        """A camera nearby that has the target where this one has it, nearer or farther; nothing is in between."""
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
                return replace(camera, position=triple(place), direction=triple(direction))
        return camera

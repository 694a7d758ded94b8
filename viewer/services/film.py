"""Films: each frame traced whole, at any size, as a numbered picture that says how it was made, and a video of them.

In turn, modes are learnt from frame to frame, as the camera flies.  Where no earlier frame shows in a picture, several
processes may share the film; pictures that are there already then stay, so that a film that was stopped goes on.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from tracer import fingerprint
from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.settings import Settings
from tracer.version import program_version
from viewer.output import capture, movie, png
from viewer.output.commands import cannot_come_back, needs_history
from viewer.output.movie import VIDEO, Video, frame_name, video
from viewer.services import stills
from viewer.services.named_states import Bookmarks
from viewer.services.pictures import Pictures
from viewer.services.runs import FileRun, Runs, check_size
from viewer.state import codec, navigation
from viewer.state.navigation import Stop, Take
from viewer.state.plans import FilmPlan, frames_within
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState, Warmup
from viewer.util.files import write_bytes

if TYPE_CHECKING:
    from tracer.experiments.cluster import Cluster

FILMED = "its modes were learnt from the frames of its film before it"
FRAMES = "-frames"
"""What the folder of the pictures of a video is called after it."""
Drawn = Iterator[tuple[int, bytes, str]]
"""The number of a take, its picture's file, and a remark or nothing."""


@dataclass(frozen=True)
class Script:
    """What to film: the takes, how each is traced and drawn (`state`, whose caption has fields), the folder that the
    pictures go to, the video if one is wanted, and its frames a second."""

    takes: Sequence[Take]
    state: ViewState
    folder: Path
    video: Path | None = None
    fps: float = 25.0

    @property
    def paths(self) -> list[Path]:
        """The picture of each take: by the number of its frame, or else they are counted from 0."""
        of_path = [take.number for take in self.takes if take.number is not None]
        numbers = of_path if len(of_path) == len(self.takes) else list(range(len(self.takes)))
        return [self.folder / frame_name(number, max(numbers)) for number in numbers]

    def state_of(self, take: Take, scene: Scene) -> ViewState:
        """How to make a take again, alone: after as many frames of the scene's path, where these were before it."""
        state = replace(self.state, time=take.time, camera=take.camera)
        if needs_history(state) and not state.warmup.unknown:  # where chance has a part in it, nothing brings it back
            unknown = take.warmup is None
            state = state.with_warmup(unknown=FILMED) if unknown else state.with_warmup(of_path=take.warmup or 0)
        return stills.with_caption_filled(state, scene)

    def states_alone(self, scene: Scene) -> list[ViewState]:
        """How each picture is made by a process of one thread that may work in another folder."""
        state = self.state.with_settings(threads=1)
        return [replace(self, state=state).state_of(take, scene) for take in self.takes]


def places(output: Path) -> tuple[Path, Path | None]:
    """The folder of the pictures and the video that a name asks for: a folder, or an mp4."""
    if output.suffix.lower() == VIDEO:
        return output.with_name(output.stem + FRAMES), output
    return output, None


def _pictures_in(folder: Path) -> list[Path]:
    """The numbered pictures in a folder, which is made; raises OSError, in one line, where that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        found = [path for path in folder.iterdir() if re.fullmatch(r"\d{4,}\.png", path.name)]
    except OSError as error:
        raise OSError(f"{folder}: no folder for the pictures: {error.strerror or error}") from None
    return sorted(found, key=lambda path: int(path.stem))


def check_folder(folder: Path) -> None:
    """Make the folder; raise OSError, in one line, where that cannot be, or where it holds another film's pictures."""
    taken = _pictures_in(folder)
    if taken:
        which = taken[0].name if len(taken) == 1 else f"{taken[0].name} to {taken[-1].name}"
        raise OSError(f"{folder}: there are numbered pictures in it already, {which}; give another folder")


def kept_pictures(script: Script, scene: Scene) -> set[int]:
    """Which pictures of the film are in its folder already.

    Raises OSError, in one line, where a numbered picture in it is none of this film."""
    there, paths, states = _pictures_in(script.folder), script.paths, script.states_alone(scene)
    found = {number for number, path in enumerate(paths) if path in there}
    for number in sorted(found):
        other = _difference(paths[number], states[number], scene)
        if other:
            raise OSError(f"{paths[number]}: a picture of another film ({other}); give another folder")
    for path in there:
        if path not in paths:
            raise OSError(f"{path}: a picture of another film; give another folder")
    return found


def _difference(path: Path, state: ViewState, scene: Scene) -> str:
    """In what a picture differs from what the state makes, in words; empty where it is the same."""
    try:
        data = capture.read_data(path)
    except capture.CaptureError as error:
        return str(error)
    made = data.get("made", {})
    expected: dict[str, tuple[Any, Any]] = {
        "version": (made.get("version"), program_version()),
        "scene": (made.get("scene"), fingerprint.of_scene(scene)),
        "size": (data.get("size"), list(state.size)),
        "settings": (data.get("state"), _as_json(codec.state_to_json(stills.as_kept(state), of_picture=True))),
    }
    return ", ".join(f"another {name}" for name, (old, new) in expected.items() if old != new)


def _as_json(data: Any) -> Any:
    return json.loads(json.dumps(data, default=str))


# --- tracing ------------------------------------------------------------------------------------------


def drawn(
    renderer: Renderer,
    state: ViewState,
    cancelled: Callable[[], bool],
    on_frame: Callable[[Frame], None] = lambda frame: None,
) -> tuple[bytes, str]:
    """A picture's file, and why it has no legend where one was wanted; `on_frame` gets its frame."""
    frame = stills.trace(renderer, state.with_warmup(of_path=0), cancelled=cancelled)
    pixels, missing = stills.draw(frame, renderer.scene, state)
    on_frame(frame)
    return png.encoded(pixels, stills.text(pixels, frame, renderer.scene, state)), missing


def in_turn(
    renderer: Renderer,
    script: Script,
    cancelled: Callable[[], bool],
    on_frame: Callable[[Frame], None] = lambda frame: None,
) -> Drawn:
    """The pictures one after another; raises Cancelled."""
    for number, take in enumerate(script.takes):
        yield number, *drawn(renderer, script.state_of(take, renderer.scene), cancelled, on_frame)


def by_processes(
    cluster: Cluster,
    scene: Scene,
    script: Script,
    kept: Collection[int],
    cancelled: Callable[[], bool],
    on_wait: Callable[[], None],
) -> Drawn:
    """The pictures but those `kept`, as they come; raises Cancelled, and RuntimeError in one line."""
    from tracer.experiments import distributed_film  # needs Dask

    missing = [number for number in range(len(script.takes)) if number not in kept]
    states = script.states_alone(scene)
    wanted = [(states[number].settings, states[number]) for number in missing]
    for place, data, remark in distributed_film.pictures(cluster, scene, drawn, wanted, cancelled, on_wait):
        yield missing[place], data, remark


def write(
    script: Script,
    pictures: Drawn,
    kept: Collection[int] = (),
    note: Callable[[str], object] = lambda line: None,
) -> Iterator[int]:
    """Write each picture as it comes, and add it to the video once those before it are there; yields how many are.

    `note` is told a remark once.  What `pictures` raises leaves what is done, with the video as long as its beginning;
    raises OSError, in one line, as where the disk is full."""
    paths, there, told = script.paths, set(kept), set[str]()
    with ExitStack() as stack:
        reel: Video | None = None
        added = 0
        for number, data, remark in pictures:
            if remark and remark not in told:
                told.add(remark)
                note(remark)
            write_bytes(paths[number], data)
            there.add(number)
            while script.video is not None and added in there:
                with Image.open(paths[added], formats=("PNG",)) as image:
                    pixels = np.asarray(image.convert("RGB"))
                if reel is None:
                    reel = stack.enter_context(video(script.video, (pixels.shape[1], pixels.shape[0]), script.fps))
                reel.add(pixels)
                added += 1
            yield len(there)


# --- in the window ------------------------------------------------------------------------------------


class FilmRun(FileRun):
    """A film being traced and written, in the view in which it is drawn."""

    name = "film"

    def __init__(self, scene: Scene, script: Script) -> None:
        self.script, self.view = script, script.state.draw.view
        self.verifies = script.state.settings.verify or self.view.needs_verify
        super().__init__(scene, len(script.takes))
        self.output = script.video or script.folder

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Path]:
        check_folder(self.script.folder)
        renderer = Renderer(scene, self.script.state.settings, world=world)

        def on_frame(frame: Frame) -> None:
            self.progressed(f"frame {self.traced + 1} of {self.frames}", frame)

        for _ in write(self.script, in_turn(renderer, self.script, cancel, on_frame)):
            yield self.script.folder


class Films:
    """`plan` is what to film next, `film` the last one: under way, done or stopped."""

    def __init__(
        self, session: Session, preferences: Preferences, runs: Runs, pictures: Pictures, bookmarks: Bookmarks
    ) -> None:
        self._session, self._preferences, self._runs = session, preferences, runs
        self._pictures, self._bookmarks = pictures, bookmarks
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
            return max(2, round((plan.seconds or navigation.LEG * legs) * plan.fps)) if legs > 0 else 0
        return max(2, round(plan.seconds * plan.fps)) if plan.seconds else last - first + 1

    def start(self) -> None:
        """Begin to film what is planned, with the view, the method and the settings that are chosen now."""

        def make(scene: Scene) -> FilmRun:
            self.film = FilmRun(scene, self._script(scene))
            return self.film

        self._runs.start(make)

    def _script(self, scene: Scene) -> Script:
        plan, p, state = self.plan, self._preferences, self._pictures.now()
        if state is None:
            raise ValueError("there is nothing to film yet")
        check_size(plan.size)
        if plan.video:
            movie.check_video()
        takes = self._takes(scene)
        settings: Settings = replace(
            state.settings, width=plan.size[0], height=plan.size[1], samples=plan.samples,
            certificate_seconds=math.inf,  # a count of certificates is what repeats exactly
        ).validated()  # fmt: skip
        state = replace(state, settings=settings, warmup=Warmup(unknown=cannot_come_back(settings, state.draw)))
        state = state.with_draw(magnified=1, caption=plan.caption, legend=plan.legend)
        name = f"{scene.path.stem}-film-{datetime.now():%Y-%m-%d-%H-%M-%S}"
        mp4 = p.picture_folder / (name + VIDEO) if plan.video else None
        return Script(takes, state, p.picture_folder / name, mp4, plan.fps)

    def _takes(self, scene: Scene) -> list[Take]:
        plan = self.plan
        if plan.through_bookmarks:
            states = [codec.state_from_json(bookmark.state) for bookmark in self._bookmarks.all]
            stops = [Stop(state.time, state.camera or scene.camera_at(state.time)) for state in states]
            if len(stops) < 2:
                raise ValueError("a flight needs two bookmarks at least; the menu Camera adds one")
            return navigation.through(stops, self.count)
        first, last = self.frames
        camera = self._session.camera if plan.from_here else None
        return navigation.along_path(scene, first, last, self.count if plan.seconds else None, camera)

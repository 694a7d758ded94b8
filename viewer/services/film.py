"""Films: each frame traced whole, at any size, as a numbered picture that says how it was made, and a video of them.

Modes are learnt from frame to frame, as the camera flies.  The command `film` and the window's panel make a `FilmRun`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from datetime import datetime
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.experiments.camera_path import Stop, Take, along_path, through
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.model import Camera, Cancelled, Scene
from tracer.settings import Settings
from viewer.output import capture
from viewer.output.commands import chance, needs_history
from viewer.services import stills
from viewer.services.named_states import Bookmarks
from viewer.services.pictures import Pictures
from viewer.services.runs import FileRun, Runs
from viewer.state import codec
from viewer.state.plans import FilmPlan
from viewer.state.preferences import NamedState, Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import Record
from viewer.util.files import check_writable, whole_file

VIDEO = ".mp4"
SECONDS_BETWEEN_STOPS = 2.0  # where no length is given
QUALITY = "16"  # of x264: what the eye can hardly tell from the pictures
FILMED = "its modes were learnt from the frames of its film before it"
NEEDS_PYAV = "a video needs PyAV; install shadowcull[video] (pip install av), or give a folder for the pictures alone"


def places(output: Path) -> tuple[Path, Path | None]:
    """The folder of the pictures and the video that a name asks for: a folder, or an mp4."""
    if output.suffix.lower() == VIDEO:
        return output.with_name(f"{output.stem}-frames"), output
    return output, None


def prepare(folder: Path, video: Path | None) -> None:
    """Make the folder of the pictures, in one that is there.

    Raises ValueError or OSError, in one line, where that or the video cannot be, or where another film is in it."""
    if video is not None:
        check_video()
        check_writable(video)
    try:
        folder.mkdir(exist_ok=True)
        taken = any(re.fullmatch(r"\d{4,}\.png", path.name) for path in folder.iterdir())
    except FileNotFoundError:
        raise OSError(f"{folder}: there is no folder {folder.parent}") from None
    except OSError as error:
        raise OSError(f"{folder}: no folder for the pictures: {error.strerror or error}") from None
    if taken:
        raise OSError(f"{folder}: there are numbered pictures in it already; give another folder")


def frame_count(frames: tuple[int, int], stops: int | None, seconds: float, fps: float) -> int:
    """How many frames a film has: of the path from the first to the last, or of a flight through so many stops.

    With 0 seconds each frame of the path comes once, and a flight takes 2 seconds from stop to stop.  0 without a way
    from one stop to another."""
    if stops is None:
        return max(2, round(seconds * fps)) if seconds else frames[1] - frames[0] + 1
    return max(2, round((seconds or SECONDS_BETWEEN_STOPS * (stops - 1)) * fps)) if stops > 1 else 0


def takes(
    scene: Scene, frames: tuple[int, int], stops: Sequence[Stop] | None, seconds: float, fps: float,
    camera: Camera | None,
) -> list[Take]:  # fmt: skip
    """The takes of a film, as `frame_count` counts them; raises ValueError, in one line, where there can be none."""
    count = frame_count(frames, None if stops is None else len(stops), seconds, fps)
    if stops is None:
        return along_path(scene, *frames, count if seconds else None, camera)
    if not count:
        raise ValueError(f"a flight needs two bookmarks, or saved pictures, at least; there are {len(stops)}")
    start, end = scene.time_range
    for stop in stops:
        if not start <= stop.time <= end:
            raise ValueError(f"a stop's time, {stop.time:g} s, is not within the scene's, {start:g} to {end:g} s")
    return through(stops, count)


def stops_of(bookmarks: Sequence[NamedState], scene: Scene) -> list[Stop]:
    """Where bookmarks are; raises ValueError, in one line, for one that is damaged."""
    states = [codec.state_from_json(bookmark.state) for bookmark in bookmarks]
    return [Stop(state.time, state.camera or scene.camera_at(state.time)) for state in states]


class FilmRun(FileRun):
    """A film being traced and written, in the view in which it is drawn.

    `state` says how each take is traced and drawn, and its caption has fields; the pictures go to `folder`, and to
    `video` with so many frames a second.  `remark` says why there is no legend where one was wanted."""

    name = "film"

    def __init__(
        self, scene: Scene, takes: Sequence[Take], state: ViewState, folder: Path, video: Path | None, fps: float
    ) -> None:
        self.takes, self.state, self.folder, self.video, self.fps = takes, state, folder, video, fps
        self.view, self.remark = state.draw.view, ""
        self.verifies = state.settings.verify or self.view.records is Record.VERIFY
        super().__init__(scene, len(takes))
        self.output = video or folder

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Path]:
        renderer, add = Renderer(scene, self.state.settings, world=world), None
        with ExitStack() as stack:
            for number, path in enumerate(self._paths()):
                state = self._state_of(number, scene)
                try:
                    frame = stills.trace(renderer, state.with_warmup(of_path=0), cancelled=cancel)
                except Cancelled:
                    return  # the video ends with the last whole picture
                pixels, self.remark = stills.draw(frame, scene, state)
                capture.write(path, pixels, stills.text(pixels, frame, scene, state))
                if self.video is not None:
                    size = pixels.shape[1], pixels.shape[0]
                    add = add or stack.enter_context(video(self.video, size, self.fps))
                    add(pixels)
                self.progressed(f"frame {self.traced + 1} of {self.frames}", frame)
                yield self.folder

    def _paths(self) -> list[Path]:
        """The picture of each take: by the number of its frame, or else they are counted from 0."""
        numbers = [at if take.number is None else take.number for at, take in enumerate(self.takes)]
        digits = max(4, len(str(max(numbers))))
        return [self.folder / f"{number:0{digits}d}.png" for number in numbers]

    def _state_of(self, number: int, scene: Scene) -> ViewState:
        """How to make a take again, alone: after as many frames of the scene's path, where these were before it."""
        take = self.takes[number]
        state = replace(self.state, time=take.time, camera=take.camera)
        if needs_history(state) and not state.warmup.unknown:  # where chance has a part in it, nothing brings it back
            state = state.with_warmup(unknown=FILMED) if take.number is None else state.with_warmup(of_path=number)
        return stills.with_caption_filled(state, scene)


class Films:
    """`plan` is what the window films next, `film` the last one: under way, done or stopped."""

    def __init__(
        self, session: Session, preferences: Preferences, runs: Runs, pictures: Pictures, bookmarks: Bookmarks
    ) -> None:
        self._session, self._preferences, self._runs = session, preferences, runs
        self._pictures, self._bookmarks = pictures, bookmarks
        self.plan = FilmPlan()
        self.film: FilmRun | None = None

    @property
    def count(self) -> int:
        """How many frames the film has; 0 where it cannot be made."""
        plan = self.plan
        stops = len(self._bookmarks.all) if plan.through_bookmarks else None
        return frame_count(plan.frames(self._session.scene), stops, plan.seconds, plan.fps)

    def start(self) -> None:
        """Begin to film what is planned, with the view, the method and the settings that are chosen now."""

        def make(scene: Scene) -> FilmRun:
            self.film = self._planned(scene)
            return self.film

        self._runs.start(make)

    def _planned(self, scene: Scene) -> FilmRun:
        plan, state = self.plan, self._pictures.now()
        if state is None:
            raise ValueError("there is nothing to film yet")
        stops = stops_of(self._bookmarks.all, scene) if plan.through_bookmarks else None
        camera = self._session.camera if plan.from_here else None
        filmed = takes(scene, plan.frames(scene), stops, plan.seconds, plan.fps, camera)
        settings: Settings = replace(
            state.settings, width=plan.size[0], height=plan.size[1], samples=plan.samples,
            certificate_seconds=math.inf,  # a count of certificates is what repeats exactly
        ).validated()  # fmt: skip
        state = replace(state, settings=settings)
        state = replace(state, warmup=Warmup(unknown=chance(state)))
        state = state.with_draw(magnified=1, caption=plan.caption, legend=plan.legend)
        folder = self._preferences.picture_folder
        folder.mkdir(parents=True, exist_ok=True)
        folder = folder / f"{scene.path.stem}-film-{datetime.now():%Y-%m-%d-%H-%M-%S}"
        mp4 = folder.with_name(folder.name + VIDEO) if plan.video else None
        prepare(folder, mp4)
        return FilmRun(scene, filmed, state, folder, mp4, plan.fps)


# --- videos ------------------------------------------------------------------------------------------


def check_video() -> None:
    """Raise ValueError, in one line, where no video can be written."""
    try:
        import av
    except ImportError as error:
        raise ValueError(f"{NEEDS_PYAV} ({error})") from None
    if "libx264" not in av.codecs_available:
        raise ValueError("PyAV was built without x264; give a folder for the pictures alone")


@contextmanager
def video(path: Path, size: tuple[int, int], fps: float) -> Iterator[Callable[[NDArray[np.uint8]], None]]:
    """An mp4 of pictures of this size, which takes its name at the end of the block; after an error, none is left.

    Gives what adds a picture, (h, w, 3) uint8.  x264 takes even sides only: an odd one is made even by its last row or
    column once more.  Raises OSError in one line."""
    import av

    width, height = (side + side % 2 for side in size)
    options = {"movflags": "+faststart"}
    with whole_file(path) as (part, _), av.open(str(part), "w", format="mp4", options=options) as file:
        rate = Fraction(fps).limit_denominator(1001)
        stream: Any = file.add_stream("libx264", rate=rate, options={"crf": QUALITY, "preset": "medium"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        context = stream.codec_context
        context.colorspace = context.color_primaries = context.color_trc = 1  # BT.709, as players take it to be
        context.color_range = 1  # of studios

        def add(pixels: NDArray[np.uint8]) -> None:
            room = ((0, height - pixels.shape[0]), (0, width - pixels.shape[1]), (0, 0))
            frame: Any = av.VideoFrame.from_ndarray(np.ascontiguousarray(np.pad(pixels, room, "edge")), format="rgb24")
            colors = {"dst_colorspace": "itu709", "dst_color_range": "MPEG", "src_color_range": "JPEG"}
            file.mux(stream.encode(frame.reformat(format="yuv420p", **colors)))

        yield add
        file.mux(stream.encode(None))

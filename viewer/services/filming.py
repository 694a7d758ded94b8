"""Films, offline: each frame traced whole, at any size, as a numbered picture that says how it was made, and a video.

Modes are learnt from frame to frame, as the camera flies.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from tracer.frame import Frame
from tracer.renderer import Renderer
from viewer.output import png
from viewer.output.commands import needs_history
from viewer.output.movie import VIDEO, Video, frame_name, video
from viewer.services import stills
from viewer.state.flight import Take
from viewer.state.view_state import ViewState

FILMED = "its modes were learnt from the frames of its film before it"
_NUMBERED = re.compile(r"\d{4,}\.png")
FRAMES = "-frames"
"""What the folder of the pictures of a video is called after it."""


@dataclass(frozen=True)
class Script:
    """What to film: the takes, how each is traced and drawn (`recipe`, whose caption has fields), the folder that the
    pictures go to, the video if one is wanted, and its frames a second."""

    takes: Sequence[Take]
    recipe: ViewState
    folder: Path
    video: Path | None = None
    fps: float = 25.0


def places(output: Path) -> tuple[Path, Path | None]:
    """The folder of the pictures and the video that a name asks for: a folder, or an mp4."""
    if output.suffix.lower() == VIDEO:
        return output.with_name(output.stem + FRAMES), output
    return output, None


def check_folder(folder: Path) -> None:
    """Make the folder; raise OSError, in one line, where that cannot be, or where it holds another film's pictures."""
    make_folder(folder)
    try:
        taken = sorted((path.name for path in folder.iterdir() if is_numbered(path.name)), key=_by_number)
    except OSError as error:
        raise OSError(f"{folder}: no folder for the pictures: {error.strerror or error}") from None
    if taken:
        which = taken[0] if len(taken) == 1 else f"{taken[0]} to {taken[-1]}"
        raise OSError(f"{folder}: there are numbered pictures in it already, {which}; give another folder")


def make_folder(folder: Path) -> None:
    """Make the folder; raise OSError, in one line, where that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OSError(f"{folder}: no folder for the pictures: {error.strerror or error}") from None


def is_numbered(name: str) -> bool:
    """Whether a file's name is that of a picture of a film."""
    return _NUMBERED.fullmatch(name) is not None


def _by_number(name: str) -> int:
    return int(Path(name).stem)


def shoot(
    renderer: Renderer,
    script: Script,
    cancelled: Callable[[], bool] = lambda: False,
    on_frame: Callable[[int, Frame], None] = lambda number, frame: None,
    note: Callable[[str], object] = lambda line: None,
) -> Iterator[Path]:
    """Trace and write frame after frame; yields each picture's path.

    `on_frame` gets a frame's number, from 0, and the frame; `note` is told, once, why a picture has no legend where one
    was wanted.  Raises Cancelled, with the pictures so far written and the video as long as these, and OSError, in one
    line, as when the disk is full."""
    scene, numbers = renderer.scene, picture_numbers(script.takes)
    with ExitStack() as stack:
        film: Video | None = None
        told = ""
        for number, take in enumerate(script.takes):
            recipe = stills.with_caption_filled(recipe_of(script.recipe, take), scene)
            frame = stills.trace(renderer, recipe.with_warmup(of_path=0), cancelled=cancelled)
            pixels, missing = stills.draw(frame, scene, recipe)
            if missing and not told:
                note(told := missing)
            if film is None and script.video is not None:
                height, width = pixels.shape[:2]  # with a caption, these are more than the frame's
                film = stack.enter_context(video(script.video, (width, height), script.fps))
            path = script.folder / frame_name(numbers[number], max(numbers))
            png.write(path, pixels, stills.text(pixels, frame, scene, recipe))
            if film is not None:
                film.add(pixels)
            on_frame(number, frame)
            yield path


def picture_numbers(takes: Sequence[Take]) -> list[int]:
    """What numbers the pictures have: those of their frames, or else they are counted from 0."""
    of_path = [take.number for take in takes if take.number is not None]
    return of_path if len(of_path) == len(takes) else list(range(len(takes)))


def recipe_of(recipe: ViewState, take: Take) -> ViewState:
    """How to make a take again, alone: after as many frames of the scene's path, where these were before it."""
    taken = replace(recipe, time=take.time, camera=take.camera)
    if not needs_history(taken) or taken.warmup.unknown:  # where chance has a part in it, nothing brings it back
        return taken
    return taken.with_warmup(unknown=FILMED) if take.warmup is None else taken.with_warmup(of_path=take.warmup)

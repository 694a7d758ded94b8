"""Films by several processes: each picture is traced alone, in any order, and is the one that it would be in its turn.

That holds where no earlier frame shows in a picture (`filmed_alone`).  Each is kept as soon as it is there, so that a
film that was stopped goes on."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer import fingerprint
from tracer.experiments.cluster import Cluster
from tracer.experiments.remote_jobs import Emit, Job, do, prepare, world_of
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.version import program_version
from viewer.output import capture, png
from viewer.output.movie import Video, frame_name, video
from viewer.output.recipe import Recipe
from viewer.services import filming, stills
from viewer.services.filming import Script
from viewer.state import codec
from viewer.util.files import write_bytes

_SCENE = "film"


def filmed_alone(recipe: Recipe) -> bool:
    """Whether a picture is the same without the frames before it."""
    return not recipe.needs_history


def shoot(
    cluster: Cluster,
    scene: Scene,
    script: Script,
    kept: set[int],
    cancelled: Callable[[], bool] = lambda: False,
    on_progress: Callable[[int], None] = lambda done: None,
    note: Callable[[str], object] = lambda line: None,
) -> Iterator[Path]:
    """Trace all pictures but those `kept`, and write each as soon as it comes; yields their paths.

    The video gets them in their order.  `on_progress` is told how many pictures there are, and `note`, once, why one
    has no legend where one was wanted.  Raises Cancelled, with what is done written and the video as long as its
    beginning, OSError, in one line, and RuntimeError where a picture could not be traced."""
    paths, recipes = _paths(script), _recipes(script, scene)
    wanted = [number for number in range(len(paths)) if number not in kept]
    there, code = set(kept), fingerprint.code_of(scene)
    with ExitStack() as stack:
        reel = _Reel(script, paths, stack)
        reel.wind(there)
        jobs = [Job(_SCENE, (recipes[number], code)) for number in wanted]
        outcomes = do(cluster, picture, {_SCENE: scene}, jobs, cancelled, lambda: on_progress(len(there)))
        told = ""
        for outcome in outcomes:
            if outcome.parts and not told:
                told = outcome.parts[0][1]
                note(told)
            for job, data in outcome.results:
                number = wanted[job]
                write_bytes(paths[number], data)
                there.add(number)
                yield paths[number]
            reel.wind(there)
            on_progress(len(there))
            for job, why in outcome.failures:
                raise RuntimeError(f"{paths[wanted[job]].name}: {why}")


def kept_pictures(script: Script, scene: Scene) -> set[int]:
    """Which pictures of the film are in its folder already.

    Raises OSError, in one line, where a numbered picture in it is none of this film."""
    paths, recipes = _paths(script), _recipes(script, scene)
    found = set()
    for number, path in enumerate(paths):
        if path.exists():
            other = _otherwise(path, recipes[number], scene)
            if other:
                raise OSError(f"{path}: a picture of another film ({other}); give another folder")
            found.add(number)
    if script.folder.is_dir():
        own = {path.name for path in paths}
        others = [path for path in script.folder.iterdir() if filming.is_numbered(path.name) and path.name not in own]
        if others:
            raise OSError(f"{min(others)}: a picture of another film; give another folder")
    return found


def _otherwise(path: Path, recipe: Recipe, scene: Scene) -> str:
    """In what a picture differs from what the recipe makes, in words; empty where it is the same."""
    try:
        data = capture.read_data(path)
    except capture.CaptureError as error:
        return str(error)
    made = data.get("made", {})
    expected: dict[str, tuple[Any, Any]] = {
        "version": (made.get("version"), program_version()),
        "scene": (made.get("scene"), fingerprint.of_scene(scene)),
        "size": (data.get("size"), list(recipe.size)),
        "settings": (data.get("state"), _as_json(codec.state_to_json(recipe.state(), of_picture=True))),
    }
    return ", ".join(f"another {name}" for name, (old, new) in expected.items() if old != new)


def _as_json(data: Any) -> Any:
    return json.loads(json.dumps(data, default=str))


def _paths(script: Script) -> list[Path]:
    numbers = filming.picture_numbers(script.takes)
    return [script.folder / frame_name(number, max(numbers)) for number in numbers]


def _recipes(script: Script, scene: Scene) -> list[Recipe]:
    """How each picture is made, alone, by a process of one thread that may work in another folder."""
    recipe = script.recipe
    recipe = replace(recipe, scene=recipe.scene.absolute(), settings=replace(recipe.settings, threads=1))
    return [stills.with_caption_filled(filming.recipe_of(recipe, take), scene) for take in script.takes]


class _Reel:
    """The video, which takes pictures in their order: each waits for those before it."""

    def __init__(self, script: Script, paths: list[Path], stack: ExitStack) -> None:
        self._script, self._paths, self._stack = script, paths, stack
        self._video: Video | None = None
        self._next = 0

    def wind(self, there: set[int]) -> None:
        """Add what can be added."""
        if self._script.video is None:
            return
        while self._next in there:
            pixels = _pixels(self._paths[self._next])
            if self._video is None:
                size = pixels.shape[1], pixels.shape[0]
                self._video = self._stack.enter_context(video(self._script.video, size, self._script.fps))
            self._video.add(pixels)
            self._next += 1


def _pixels(path: Path) -> NDArray[np.uint8]:
    with Image.open(path, formats=("PNG",)) as image:
        return np.asarray(image.convert("RGB"))


def picture(given: tuple[Recipe, str], scene: Scene, emit: Emit, cancelled: Callable[[], bool]) -> bytes:
    """In a process of the cluster: one picture as the bytes of a PNG."""
    recipe, code = given
    settings = recipe.settings
    prepare(len(scene.lights), settings.accelerator, settings.method)
    renderer = Renderer(scene, settings, world=world_of(scene, code, settings.accelerator, scene.time_range[0]))
    frame = stills.trace(renderer, replace(recipe, warmup=0), cancelled=cancelled)
    pixels, missing = stills.draw(frame, scene, recipe)
    if missing:
        emit(missing)
    return png.encoded(pixels, stills.text(pixels, frame, scene, recipe))

"""What a path that is opened or dropped is: a scene, a saved picture to restore, or one clear line."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tracer.compilation import can_draw, compiled_before, warm_up
from tracer.renderer import Renderer, Settings
from tracer.scene.files import Stamp, noting
from tracer.scene.load import load_visible_scene, scene_info
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Progress, Scene
from tracer.scene.studio import model_bounds
from viewer.util import resources

SCENE_SUFFIXES = (".aff", ".nff", ".obj", ".ply", ".stl", ".gltf", ".glb")
CAPTURE_SUFFIXES = (".png",)


@dataclass(frozen=True)
class Opened:
    """A scene, the renderer that holds its trees, and what `scene_info` says of it."""

    scene: Scene
    renderer: Renderer
    info: dict[str, Any]
    seconds: float


def is_scene(path: Path) -> bool:
    return path.suffix.lower() in SCENE_SUFFIXES


def is_capture(path: Path) -> bool:
    return path.suffix.lower() in CAPTURE_SUFFIXES


def refusal(path: Path) -> str | None:
    """Why a path cannot be opened, in one line; None if it is worth trying."""
    if path.is_dir():
        return f"{path}: a folder; open a scene ({' '.join(SCENE_SUFFIXES)}) or a saved picture (.png)"
    if not (is_scene(path) or is_capture(path)):
        return f"{path.name}: not a scene ({' '.join(SCENE_SUFFIXES)}) nor a saved picture (.png)"
    return None if path.exists() else f"{path}: no such file"


def find_scene(stored: str, picture: Path) -> Path | None:
    """Where a saved picture's scene is now: at its old path, beside the picture, or among our own scenes."""
    path = Path(stored)
    candidates = [path, picture.parent / path.name]
    embedded = resources.embedded_scenes().get(path.stem)
    if embedded is not None and (stored == path.stem or path.parent.name == embedded.parent.name):
        candidates.append(embedded)
    return next((c for c in candidates if c.is_file()), None)


def read_scene(
    path: Path, progress: Progress, folders: Sequence[Path], meshes: MeshOptions, files: dict[Path, Stamp]
) -> Scene:
    """Read a scene's file; what was read gets into `files`, also where it cannot be shown.  Raises SceneError or
    Cancelled."""
    with noting(files), _no_collecting():
        return load_visible_scene(path, progress, folders, meshes)


@contextmanager
def _no_collecting() -> Iterator[None]:
    """Without Python's search for circles of objects: a scene of a million pieces has none, and the search stops the
    window for up to a second each time."""
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def open_scene(
    read: Callable[[], Scene],
    settings: Settings,
    ready: Callable[[], bool],
    progress: Progress,
    seen: Callable[[Scene], None] = lambda scene: None,
) -> Opened:
    """Build the trees of a scene once it is `read` and the tracer is `ready`.  A scene whose kernels are yet to be
    compiled is `seen` before that.

    Raises SceneError or Cancelled; runs on a thread of its own."""
    started, scene = time.perf_counter(), read()
    lights, accelerator = len(scene.lights), settings.accelerator
    if not can_draw(lights, accelerator) and not compiled_before(lights, accelerator, certificates=False):
        seen(scene)
    while not ready():
        progress(f"{scene.path.name} is read; waiting for the tracer", 1.0)
        time.sleep(0.02)
    if not can_draw(lights, accelerator):  # many lights need wider words, and kernels for them
        warm_up(progress, lights, accelerator)
    renderer, info, model = Renderer(scene, settings, progress), scene_info(scene), model_bounds(scene)
    if model is not None:  # what the camera goes around is the model, not the floor
        info["bounds"] = model.tolist()
    return Opened(scene, renderer, info, time.perf_counter() - started)

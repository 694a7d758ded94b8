"""A saved picture in the place of a scene or of a camera on the command line: what it carries, as options."""

from __future__ import annotations

import json
from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any

from tracer.scene.files import read_regular
from tracer.scene.model import Camera
from viewer.cli import edit_options
from viewer.cli.argument_types import ChosenView
from viewer.output import capture, recipe
from viewer.output.recipe import Recipe
from viewer.services.scene_files import find_scene, is_capture
from viewer.state.tone import Curve

_A_CAMERA = '{"position": [0, 1, 3], "direction": [0, 0, -1], "angle": 40}'
_LARGEST_CAMERA = 1 << 20  # bytes
_SETTINGS = (
    "method", "samples", "depth", "symmetric", "zoom_factor", "verify", "lamp_radius", "lamp_samples", "accelerator",
    "lightcuts_error", "lightcuts_nodes",
)  # fmt: skip
_STYLE = ("magnified", "shading", "beneath", "outlines", "savings")
_TONE = ("exposure", "white", "tone")


def defaults(path: Path) -> tuple[Path, dict[str, Any]]:
    """The scene of a saved picture, and what it carries, by the names of the options of `render`.

    Raises CaptureError, in one line, for any other picture, and where the scene is gone."""
    saved, size = read(path)
    kept: dict[str, Any] = {name: getattr(saved.settings, name) for name in _SETTINGS}
    kept |= {name: getattr(saved.style, name) for name in _STYLE}
    kept |= {"before": saved.before, "warmup": saved.warmup, "repeat": saved.repeats}
    kept |= {"no_marks": not saved.style.marked}
    kept |= {"legend": saved.style.legend is not None, "legend_at": saved.style.legend}
    kept |= {"exposure": saved.style.tone.exposure, "white": saved.style.tone.white, "tone": saved.style.tone.curve}
    kept |= {"mark_clipped": saved.style.clipping, "range": saved.style.span, "slice": saved.style.cut}
    kept["caption"] = saved.style.caption.replace("{", "{{").replace("}", "}}")
    if size is not None:
        kept["size"] = size
    if saved.camera is not None:
        kept["camera"] = saved.camera
    kept["view"] = ChosenView(saved.view, saved.edits.light_number(saved.light), saved.wipe, saved.style.shares)
    kept["moment"] = saved.time
    kept |= {"no_studio": not saved.meshes.studio, "up": saved.meshes.up, "crease": saved.meshes.crease}
    kept |= edit_options.defaults(saved.edits)
    return saved.scene, kept


def read(path: Path) -> tuple[Recipe, tuple[int, int] | None]:
    """The recipe of a saved picture with its scene where that is now, and its size if that is known.

    Raises CaptureError, in one line, for any other picture, and where the scene is gone."""
    snapshot, size = capture.read_with_size(path)
    try:
        saved = recipe.from_json(snapshot, size, capture.read_data(path).get("picture"))
    except ValueError as error:
        raise capture.CaptureError(f"{path}: cannot be restored: {error}") from None
    scene = find_scene(snapshot.scene, path)
    if scene is None:
        raise capture.CaptureError(f"{path}: its scene is gone: {snapshot.scene}")
    return replace(saved, scene=scene), size


def settle(options: Namespace, kept: dict[str, Any]) -> None:
    """What options mean together: a frame or a time that was given wins over the picture's, and in a view that has no
    use for its tone, its stripes or its range, these go."""
    view = options.view.view
    if not view.shows_picture and all(getattr(options, name) == kept[name] for name in _TONE):
        options.exposure, options.white, options.tone = 0.0, 1.0, Curve.NONE
    if kept["mark_clipped"] and not view.shows_clipped:
        options.mark_clipped = False
    if options.range == kept["range"] and (view is not kept["view"].view or options.view.shares):
        options.range = None
    if options.frame is None and options.time is None:
        options.time = kept["moment"]


def name_output(options: Namespace, picture: Path) -> None:
    """A file's name that was given wins over one after the saved picture's."""
    given = (options.output, options.buffers, options.to_tev)
    if not any(given) and not options.print_command:
        options.output = _free_name(f"{picture.stem}-rendered")


def camera(given: str | Camera | None) -> Camera | None:
    """`--camera`: a camera, JSON, a file that holds it, or a saved picture; raises ValueError in one line."""
    if given is None or isinstance(given, Camera):
        return given
    if is_capture(Path(given)):
        try:
            return capture.read(Path(given)).camera
        except capture.CaptureError as error:
            raise ValueError(f"--camera: {error}") from None
    return _camera_from(given)


def _camera_from(text: str) -> Camera:
    """`--camera`: JSON, or a file that holds it; raises ValueError in one line."""
    name = text[:60]
    try:
        if not text.lstrip().startswith("{"):
            text = read_regular(Path(text), _LARGEST_CAMERA).decode("utf-8")
        data = json.loads(text)
    except OSError as error:
        raise ValueError(f"--camera: neither JSON nor a file that can be read: {name}: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise ValueError(f"--camera: {name} is not JSON; give a camera like {_A_CAMERA}") from None
    try:
        return Camera.from_json(data)
    except ValueError as error:
        raise ValueError(f"--camera: {error}") from None


def _free_name(stem: str) -> Path:
    """A name of a PNG in this folder that is not taken."""
    path, number = Path(f"{stem}.png"), 2
    while path.exists():
        path, number = Path(f"{stem}-{number}.png"), number + 1
    return path

"""What is kept of a hunt's counterexamples: for each a figure and a JSON, and one JSON with all."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from tracer.experiments import counterexample, hunt
from tracer.experiments.counterexample import Counterexample
from tracer.frame import Settings
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.scene.model import Scene
from tracer.setting import settings_of
from tracer.version import program_version
from viewer.output.commands import scene_word
from viewer.output.comparison import Comparison, Crop
from viewer.state.methods import NO_CULLING
from viewer.state.view_state import ViewState, Warmup
from viewer.util.files import write_text

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
    """The surroundings of the pixel, inside the picture."""
    width, height = min(max(24, size[0] // 8), size[0]), min(max(18, size[1] // 8), size[1])
    x = min(max(find.x - width // 2, 0), size[0] - width)
    y = min(max(find.y - height // 2, 0), size[1] - height)
    return Crop(x, y, width, height)


def comparison_of(
    find: Counterexample,
    found: hunt.Results,
    scene: Scene,
    settings: Settings,
    meshes: MeshOptions = AS_IN_FILE,
    edits: Edits = NO_EDITS,
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
        edits=edits,
    )
    words = " ".join(counterexample.in_words(find, scene))
    return state, Comparison(
        (NO_CULLING, found.method), (crop_of(find, found.size),), ((find.x, find.y),), words
    ).checked(state.size)


def save_json(
    find: Counterexample, found: hunt.Results, scene: Scene, path: Path, of_scene: Sequence[str] = ()
) -> None:
    """All about a counterexample, with the command that explains it; `of_scene` are that command's options on how the
    scene is read.  Raises OSError in one line."""
    told = counterexample.to_json(find, scene) | {"size": list(found.size), "method": found.method}
    told |= {"scene": found.scene, "settings": found.settings, "version": program_version()}
    told["words"] = counterexample.in_words(find, scene)
    told["explain"] = shlex.join([*explaining(find, found, path.name), *of_scene])
    write_text(path, json.dumps(told, indent=1))


def save_all(found: hunt.Results, scene: Scene, folder: Path) -> None:
    """One JSON with all counterexamples; raises OSError in one line."""
    write_text(folder / ALL, json.dumps(found.to_dict(scene) | {"version": program_version()}))


def explaining(find: Counterexample, found: hunt.Results, before: Path | str) -> list[str]:
    """The words of the command that explains a counterexample; `before` is the file of the frames before it."""
    width, height = found.size
    words = ["shadowcull", "explain", scene_word(Path(found.scene)), f"--time={find.time!r}"]
    words += ["--size", f"{width}x{height}", "--method", found.method, "--pixel", f"{find.x},{find.y}"]
    if not find.own_camera:
        words += ["--camera", json.dumps(find.camera.to_json())]
    for one in settings_of(Settings):
        if one.name in ("depth", "zoom_factor", "lamp_radius", "lamp_samples", "symmetric"):
            words += one.words(found.settings.get(one.name, one.default))
    return [*words, "--before", str(before), "--only", "wrong"]

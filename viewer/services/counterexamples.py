"""What is kept of a hunt's counterexamples: for each a figure and a JSON, and one JSON with all."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from tracer.experiments import counterexample, hunt
from tracer.experiments.counterexample import Counterexample
from tracer.frame import Settings
from tracer.geometry.world import World
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.scene.model import Scene
from tracer.version import program_version
from viewer.output import comparison_figure
from viewer.output.commands import scene_word
from viewer.output.comparison_figure import Crop
from viewer.services import comparison
from viewer.services.comparison import Comparison
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
    folders: tuple[Path, ...] = (),
    meshes: MeshOptions = AS_IN_FILE,
    edits: Edits = NO_EDITS,
) -> Comparison:
    """The figure of a counterexample: the right picture and the method's, with the pixel's surroundings enlarged."""
    common = ViewState(
        scene=str(Path(scene.path).absolute()),
        time=find.time,
        camera=find.seen_camera,
        settings=replace(settings, method=found.method, verify=False, samples=1, modes=False),
        warmup=Warmup(find.before),
        meshes=meshes,
        edits=edits,
    )
    words = " ".join(counterexample.in_words(find, scene))
    return Comparison(
        common, (NO_CULLING, found.method), (crop_of(find, found.size),), ((find.x, find.y),), words
    ).checked()


def save_figure(
    wanted: Comparison,
    scene: Scene,
    world: World,
    path: Path,
    on_frame: Callable[[str, int, int], None] = lambda method, done, total: None,
    cancelled: Callable[[], bool] = lambda: False,
) -> None:
    """Trace and draw; raises OSError in one line, or Cancelled."""
    shown = comparison.trace(scene, wanted, world, on_frame, cancelled)
    comparison_figure.save(shown, path, comparison.text(shown, wanted))


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
    for option, default in (("depth", 10), ("zoom_factor", 4.0), ("lamp_radius", None), ("lamp_samples", None)):
        value = found.settings.get(option, default)
        if value != default:
            words += [f"--{option.replace('_', '-')}", str(value)]
    words += ["--symmetric"] if found.settings.get("symmetric") else []
    return [*words, "--before", str(before), "--only", "wrong"]

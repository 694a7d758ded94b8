"""What is kept of the finds of a hunt: for each a figure beside the right picture, and a JSON; and one with all."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from tracer.frame import Settings
from tracer.geometry.world import World
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.scene.model import Scene
from viewer.output import comparison_figure, finds
from viewer.output.finds import Find, Findings
from viewer.output.recipe import Recipe
from viewer.services import comparison
from viewer.services.comparison import Comparison
from viewer.state.methods import NO_CULLING
from viewer.util.files import write_text
from viewer.util.version import program_version

ALL = "hunt.json"


def check_folder(folder: Path) -> None:
    """Make the folder; raises OSError, in one line, where that cannot be, or where finds are in it already."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        taken = next((path.name for path in folder.iterdir() if path.name == ALL or path.match("find-*.*")), None)
    except OSError as error:
        raise OSError(f"{folder}: no folder for the finds: {error.strerror or error}") from None
    if taken is not None:
        raise OSError(f"{folder}: there are finds in it already, as {taken}; give another folder")


def name_of(number: int) -> str:
    """What the files of a find are called, counted from 1."""
    return f"find-{number}"


def comparison_of(
    find: Find,
    findings: Findings,
    scene: Scene,
    settings: Settings,
    folders: tuple[Path, ...] = (),
    meshes: MeshOptions = AS_IN_FILE,
    edits: Edits = NO_EDITS,
) -> Comparison:
    """The figure of a find: the right picture and the method's, with the surroundings of the pixel enlarged."""
    common = Recipe(
        scene=Path(scene.path),
        time=find.time,
        camera=find.seen_camera,
        settings=replace(settings, method=findings.method, verify=False, samples=1, modes=False),
        folders=folders,
        before=find.before,
        meshes=meshes,
        edits=edits,
    )
    words = " ".join(finds.in_words(find, scene))
    crop = finds.crop_of(find, findings.size)
    return Comparison(common, (NO_CULLING, findings.method), (crop,), ((find.x, find.y),), words).checked()


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


def save_json(find: Find, findings: Findings, scene: Scene, path: Path, of_scene: Sequence[str] = ()) -> None:
    """All about a find, with the command that explains it, and options of that about how the scene is read; raises
    OSError in one line."""
    told = finds.to_json(find, scene) | {"size": list(findings.size), "method": findings.method}
    told |= {"scene": findings.scene, "settings": findings.settings, "version": program_version()}
    told["words"] = finds.in_words(find, scene)
    told["explain"] = shlex.join([*finds.explaining(find, findings, path.name), *of_scene])
    write_text(path, json.dumps(told, indent=1))


def save_all(findings: Findings, scene: Scene, folder: Path) -> None:
    """One JSON with all finds; raises OSError in one line."""
    write_text(folder / ALL, json.dumps(finds.all_to_json(findings, scene) | {"version": program_version()}))

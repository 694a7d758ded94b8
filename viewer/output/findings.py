"""Wrong pixels as files: a figure beside the right picture, and a JSON with all about it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tracer.experiments import counterexample, hunt
from tracer.experiments.counterexample import Counterexample
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Scene
from tracer.settings import Settings
from tracer.util.text import shell_line
from viewer.output import commands, exports
from viewer.output.comparison import Comparison, Crop
from viewer.state.methods import NO_CULLING
from viewer.state.view_state import ViewState, Warmup


def comparison_of(
    find: Counterexample, found: hunt.Results, scene: Scene, settings: Settings, meshes: MeshOptions,
) -> tuple[ViewState, Comparison]:  # fmt: skip
    """Return the figure of a counterexample: the right picture and the method's, with what is around the pixel."""
    settings = replace(settings, method=found.method, verify=False, samples=1, modes=False)
    state = ViewState(
        str(Path(scene.path).absolute()), time=find.time, camera=find.seen_camera, settings=settings,
        warmup=Warmup(find.before), meshes=meshes,
    )  # fmt: skip
    methods, words = (NO_CULLING, found.method), " ".join(counterexample.in_words(find, scene))
    shown = Comparison(methods, (Crop.around((find.x, find.y), found.size),), ((find.x, find.y),), words)
    return state, shown.checked(state.size)


def save_json(find: Counterexample, found: hunt.Results, scene: Scene, state: ViewState, path: Path) -> None:
    """Write all about a counterexample, whose picture has this state, and the commands that explain and shrink it."""
    words = [commands.scene_word(Path(state.scene)), *commands.options(replace(state, warmup=Warmup()))]
    words += ["--pixel", f"{find.x},{find.y}", "--before", path.name]
    told = {
        "size": found.size, "method": found.method, "scene": found.scene, "settings": found.settings,
        "words": counterexample.in_words(find, scene),
        "explain": shell_line(["shadowcull", "explain", *words, "--only", "wrong"]),
        "shrink": shell_line(["shadowcull", "shrink", *words, "-o", f"{path.stem}-shrunk"]),
    }  # fmt: skip
    exports.write_json(path, counterexample.to_json(find, scene) | told, indent=1)

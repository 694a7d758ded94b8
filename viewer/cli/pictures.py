"""What a picture is to be like: the options of `render`, `film` and `figure`, beside what a saved picture carries."""

from __future__ import annotations

import json
from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any

from tracer.geometry.accelerators import BVH8, LAZY
from tracer.geometry.world import LARGE
from tracer.method import DEFAULT_METHOD, Method
from tracer.scene.files import read_regular
from tracer.scene.model import Scene
from tracer.setting import settings_of
from tracer.settings import Settings
from viewer.cli import arguments, options
from viewer.cli.arguments import ChosenView, Parser
from viewer.output import capture, commands
from viewer.services import stills
from viewer.services.scene_files import find_scene, is_capture
from viewer.state import codec
from viewer.state.draw_options import MIDDLE, DrawOptions
from viewer.state.methods import BY_MODES, CERTIFIED, SHOWN_BY, default_for
from viewer.state.tone import NEUTRAL, Tone
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import View

LOWER_LEFT = 0.0, 1.0
_SPECIAL = {"view", "spans", "savings", "caption"}  # whose options are no plain values
_DRAWN = [one for one in settings_of(DrawOptions) if one.option and one.path not in _SPECIAL]
OR_PICTURE = ", or a saved picture or a state as .json, for its scene, settings and view"
_LARGEST_STATE = 1 << 26  # bytes


def add_picture(parser: Parser) -> None:
    """Add what one picture is to be like."""
    add = parser.add_argument
    options.add_size(parser)
    options.add_settings(parser, Settings, "samples")
    help_ = (
        f"how shadow rays are culled: {options.method_names()} (default: {DEFAULT_METHOD}, or the method that a view "
        "belongs to: certified, lightcuts, voxels or lie-exact)"
    )
    add("--method", type=arguments.method, metavar="M", help=help_)
    help_ = (
        "what to draw: color, occlusion, shadow:LIGHT, primitive, depth, normal, pixel-count, difference, wipe:PART, "
        "certificate:LIGHT, penumbra:LIGHT, lights, cuts, voxels:LIGHT, cell-lights, tree, fate:LIGHT, "
        "moving-shadow:LIGHT, saved or cost, as counts of rays or as shares like saved:share (default: color)"
    )
    add("--view", type=arguments.view, default="color", metavar="V", help=help_)
    options.add_settings(parser, DrawOptions, *(one.name for one in _DRAWN))
    help_ = "what has the first and the last colour in the views depth, saved, cost and lights (default: as they come)"
    add("--range", type=arguments.value_range, metavar="LOW:HIGH", help=help_)
    help_ = "where the legend is: 0,0 is the upper left (default: 0,1)"
    add("--legend-at", type=arguments.place, metavar="X,Y", help=help_)
    help_ = "above the picture, what culling saves: a sentence, with TEXT about steps and time, and a bar"
    add("--savings", nargs="?", const="", metavar="TEXT", help=help_)
    help_ = "a line below the picture, like '{scene}, frame {frame}'"
    add("--caption", default="", metavar="TEXT", help=help_)
    add("--camera", type=arguments.camera, metavar="JSON", help=f"another camera: {options.CAMERA}")
    options.add_edits(parser)


def picture_settings(given: Namespace) -> Settings:
    """Return how the picture is traced; raises ValueError, in one line, where the options do not fit its view."""
    settings = options.tracing_settings(given, method=given.method or default_for(given.view.view))
    check_view(settings, given.view.view)
    check_display(given)
    return settings


def wanted_state(scene: Scene, settings: Settings, given: Namespace) -> ViewState:
    """Return what the options ask for, with a caption that may have fields.

    Raises ValueError, in one line, for a moment or a light that the scene does not have."""
    view, light, wipe, shares = given.view
    edits = options.edits_of(given)
    if view.of_light:
        light = options.light_index(given, f"--view {view.value}:", light, scene)
    draw = DrawOptions(
        view=view, light=light if view.of_light else edits.light_index(light) or 0, wipe=wipe, shares=shares,
        legend_at=given.legend_at or LOWER_LEFT, savings=given.savings, caption=given.caption,
    )  # fmt: skip
    for one in _DRAWN:
        draw = one.put(draw, getattr(given, one.name))
    draw = draw.with_span(given.range)
    unknown = ""
    if commands.by_chance(settings, draw):
        unknown = f"what the method {settings.method} makes depends on time and threads"
    warmup = Warmup(given.before, given.warmup, given.repeat, unknown=unknown)
    meshes = options.mesh_options(given).of_file(given.path)
    path, time = str(given.path.absolute()), options.moment(scene, given)
    return ViewState(path, meshes, edits, time, given.camera, settings, draw, warmup=warmup)


def _tone(given: Namespace) -> Tone:
    return Tone(given.exposure, given.white, given.curve)


def check_display(given: Namespace) -> None:
    """Raise ValueError, in one line, for options that the view has no use for."""
    view, shares = given.view.view, given.view.shares
    if not view.shows_picture and not _tone(given).neutral:
        raise ValueError(f"--exposure, --white and --tone are for pictures: --view {view.value} shows none")
    if given.clipping and not view.shows_clipped:
        raise ValueError(f"--mark-clipped is for the views color and wipe, not {view.value}")
    if given.slice != MIDDLE and not view.has_slice:
        raise ValueError(f"--slice is for the views voxels and tree, not {view.value}")
    if given.range is not None and (not view.has_range or shares):
        names = ", ".join(one.value for one in View if one.has_range)
        raise ValueError(f"--range is for views of numbers: {names}{' as counts' if shares else ''}")


def check_view(settings: Settings, view: View, option: str = "--method") -> None:
    """Raise ValueError, in one line, where the method has nothing for a view of what single methods have; `option` is
    the one that names methods."""
    method = Method.parse(settings.method)
    shows = {View.VOXELS: ("voxels",), View.CELL_LIGHTS: ("lie-exact", "lie")}.get(view)
    why, instead = "", SHOWN_BY.get(view, BY_MODES)
    if view is View.CERTIFICATE and (method.adaptive or not method.has_certificates):
        may = "may make" if method.adaptive else "makes"
        why, instead = f"the method {settings.method} {may} none", CERTIFIED
    elif view is View.CUTS and not method.clusters:
        why = f"the method {settings.method} makes no clusters of lights"
    elif view.needs_fates and method.clusters:
        why, instead = (
            f"the method {settings.method} shades by clusters of lights: single lights have no rays",
            BY_MODES,
        )
    elif shows is not None and not any(name == method.base or method.has(name) for name in shows):
        why = f"not with the method {settings.method}"
    if why:
        raise ValueError(f"--view {view.value}: {why}; give {option} {instead}")


def check_tree(settings: Settings, view: View, scene: Scene) -> None:
    """Raise ValueError, in one line, where a view of what rays have had built meets a tree that is built before."""
    static = len(scene.objects[0].triangles) + len(scene.objects[0].quadrics)
    waits = settings.accelerator == LAZY or (settings.accelerator == BVH8 and static > LARGE)
    if view is View.TREE and not waits:
        why = f"{settings.accelerator} builds all of its tree before rays come; give --accelerator {LAZY}"
        raise ValueError(f"--view {view.value}: {why}")


def check_lights(wanted: ViewState, scene: Scene) -> None:
    """Raise ValueError, in one line, where memory has no room for what all lights send to each pixel."""
    if not stills.lights_fit(wanted, scene):
        raise ValueError(f"--view {wanted.draw.view.value}: too many lights for pictures of this size")


# --- saved pictures and states ----------------------------------------------------------------------


def carries_state(path: Path) -> bool:
    """Whether a file stands for the state that it carries: a saved picture, or a JSON of a state."""
    return is_capture(path) or path.suffix.lower() == ".json"


def state_of(path: Path) -> ViewState:
    """Return the state that a file carries, with the path that its scene has now.

    Raises CaptureError, in one line, where it carries none, and where the scene is gone."""
    if is_capture(path):
        state = capture.read(path)
    else:
        try:
            data = json.loads(read_regular(path, _LARGEST_STATE))
            state = codec.picture_from_json(data) if "state" in data else codec.state_from_file(data)
        except FileNotFoundError:
            raise capture.CaptureError(f"{path}: no such file") from None
        except (OSError, ValueError, TypeError, RecursionError) as error:
            raise capture.CaptureError(f"{path}: holds no state of the viewer: {error}") from None
    scene = find_scene(state.scene, path)
    if scene is None:
        raise capture.CaptureError(f"{path}: its scene is gone: {state.scene}")
    return replace(state, scene=str(scene))


def scene_of(path: Path) -> Path:
    """Return the file of a scene, or that of the scene of a saved picture or state; raises CaptureError."""
    return Path(state_of(path).scene) if carries_state(path) else path


def filled_in(parser: Parser, given: Namespace, words: list[str]) -> Namespace:
    """Return the options beside a state that stands for the scene: what is given wins over what that says.

    Raises CaptureError, in one line."""
    if not carries_state(given.path):
        return given
    state, saved = state_of(given.path), given.path
    parser.set_defaults(**_as_options(state))
    given = parser.parse_args(words)
    given.path = Path(state.scene)
    view, draw = given.view.view, state.draw  # a view that has no use for something takes none of the state's
    if not view.shows_picture and _tone(given) == draw.tone:
        given.exposure, given.white, given.curve = NEUTRAL.exposure, NEUTRAL.white, NEUTRAL.curve
    given.clipping &= view.shows_clipped or not draw.clipping
    given.slice = given.slice if view.has_slice or given.slice != draw.slice else MIDDLE
    if given.range == draw.span and (view is not draw.view or given.view.shares):
        given.range = None
    if given.frame is None and given.time is None:
        given.time = state.time
    if "buffers" in given and not (given.output or given.buffers or given.to_tev or given.print_command):
        given.output = _free_name(f"{saved.stem}-rendered")
    return given


def _as_options(state: ViewState) -> dict[str, Any]:
    """Return a state by the names that options have in the namespace."""
    draw, warmup, meshes = state.draw, state.warmup, state.meshes
    kept = {one.name: one.get(state) for one in settings_of(ViewState) if one.option}
    kept |= {"view": ChosenView(draw.view, state.edits.light_number(draw.light), draw.wipe, draw.shares)}
    kept |= {"legend_at": draw.legend_at, "range": draw.span}
    kept |= {"caption": draw.caption.replace("{", "{{").replace("}", "}}")}
    kept |= {"size": (state.settings.width, state.settings.height)}
    kept |= {"before": warmup.frames, "warmup": warmup.of_path, "repeat": warmup.repeats}
    kept |= {"no_studio": not meshes.studio, "up": meshes.up, "crease": meshes.crease}
    kept |= {"camera": state.camera} if state.camera is not None else {}
    return kept | options.edits_as_options(state.edits)


def _free_name(stem: str) -> Path:
    """Return a name of a PNG in this folder that is not taken."""
    path, count = Path(f"{stem}.png"), 2
    while path.exists():
        path, count = Path(f"{stem}-{count}.png"), count + 1
    return path

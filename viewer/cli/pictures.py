"""What a picture is to be like: the options of `render`, `film` and `figure`, as a state, and a state as these."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from tracer.method import DEFAULT_METHOD, Method
from tracer.scene.files import read_regular
from tracer.scene.model import Scene
from tracer.settings import Settings
from tracer.util.setting import settings_of
from viewer.cli import arguments, options
from viewer.cli.arguments import Parser, view_form
from viewer.output import capture, commands
from viewer.services import stills
from viewer.services.scene_files import find_scene, is_capture
from viewer.state import codec
from viewer.state.draw_options import DrawOptions
from viewer.state.methods import BY_MODES, CERTIFIED, SHOWN_BY, default_for
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import Record, View

DRAWN = [one for one in settings_of(DrawOptions) if one.option and f"draw.{one.path}" not in commands.NOT_PLAIN]
OR_PICTURE = ", or a saved picture or a state as .json, for its scene, settings and view"
_LARGEST_STATE = 1 << 26  # bytes


def add_picture(parser: Parser) -> None:
    """Add what one picture is to be like."""
    options.add_size(parser)
    options.add_settings(parser, Settings, "samples")
    help_ = (
        f"how shadow rays are culled: {options.METHODS} (default: {DEFAULT_METHOD}, or the method that a view belongs "
        f"to: {', '.join(dict.fromkeys(SHOWN_BY.values()))})"
    )
    parser.add_argument("--method", type=arguments.method, metavar="METHOD", help=help_)
    group = parser.add_argument_group("what is drawn")
    add = group.add_argument
    help_ = (
        f"what to show: {', '.join(map(view_form, View))}. LIGHT is the number of a light, 0 if left out; wipe shows "
        "the traced picture left of a line at this PART of the width, 0 to 1, and the right one on its other side; "
        ":share shows shares of rays, not counts (default: color)"
    )
    add("--view", type=arguments.view, default=DrawOptions(), metavar="VIEW", help=help_)
    options.add_settings(group, DrawOptions, *(one.name for one in DRAWN))
    with_range = ", ".join(view.value for view in View if view.has_range)
    help_ = f"what the first and the last colour stand for in the views {with_range} (default: as they come)"
    add("--range", type=arguments.value_range, metavar="LOW:HIGH", help=help_)
    help_ = "where the legend is: 0,0 is the upper left, 1,1 the lower right (default: 0,1)"
    add("--legend-at", type=arguments.place, default=DrawOptions().legend_at, metavar="X,Y", help=help_)
    help_ = "above the picture, what culling saves: a sentence, with TEXT about steps and time, and a bar"
    add("--savings", nargs="?", const="", metavar="TEXT", help=help_)
    fields = ", ".join(f"{{{name}}}" for name in capture.FIELDS)
    help_ = f"a line below the picture; it may have the fields {fields}"
    add("--caption", default="", metavar="TEXT", help=help_)
    add("--camera", type=arguments.camera, metavar="JSON", help=f"another camera: {options.CAMERA}")
    options.add_edits(parser)


def picture_settings(given: Namespace) -> Settings:
    """Return how the picture is traced; raises ValueError, in one line, where the options do not fit its view."""
    settings = options.tracing_settings(given, method=given.method or default_for(given.view.view))
    check_view(settings, given.view.view)
    check_display(given)
    return settings


def wanted_state(scene: Scene, settings: Settings, given: Namespace, everything: bool = False) -> ViewState:
    """Return what the options ask for, with a caption that may have fields; `everything`: all buffers are wanted.

    Raises ValueError, in one line, for what the scene does not have, and what there is no memory for."""
    draw = replace(given.view, legend_at=given.legend_at, savings=given.savings, caption=given.caption)
    if draw.view.of_light:
        draw = replace(draw, light=options.light_index(given, f"--view {draw.view}:", draw.light, scene))
    for one in DRAWN:
        draw = one.put(draw, getattr(given, one.name))
    draw = draw.with_span(given.range)
    warmup = Warmup(given.before, given.warmup, given.repeat)
    meshes = options.mesh_options(given).of_file(given.path)
    path, time = str(given.path.absolute()), options.moment(scene, given)
    state = ViewState(path, meshes, options.edits_of(given), time, given.camera, settings, draw, warmup=warmup)
    stills.check_lights(state, scene, everything)
    return state.with_warmup(unknown=commands.chance(state))


def check_display(given: Namespace) -> None:
    """Raise ValueError, in one line, for options that do nothing in the view."""
    view, shares = given.view.view, given.view.shares
    for one in settings_of(DrawOptions):
        unasked = given.range is None if one.name == "spans" else getattr(given, one.name, None) == one.default
        if one.option and not unasked and not one.applies(ViewState(draw=DrawOptions(view=view, shares=shares))):
            used = ", ".join(other for other in View if one.applies(ViewState(draw=DrawOptions(view=other))))
            raise ValueError(
                f"{one.option} does nothing in the view {view}{':share' if shares else ''}; it is for {used}"
            )


def check_view(settings: Settings, view: View, option: str = "--method") -> None:
    """Raise ValueError, in one line, where the method has nothing for a view of what single methods have; `option` is
    the one that names methods."""
    method = Method.parse(settings.method)
    names = {method.base, *method.additions}
    shown = {
        View.CERTIFICATE: method.has_certificates and not method.adaptive,  # which may make none
        View.CUTS: method.clusters,
        View.VOXELS: "voxels" in names,
        View.CELL_LIGHTS: bool({"lie", "lie-exact"} & names),
        View.SLACK: method.base == CERTIFIED,
        View.REGRET: method.base == CERTIFIED,
    }
    if not shown.get(view, True):
        raise ValueError(f"--view {view}: the method {method} has nothing for it; give {option} {SHOWN_BY[view]}")
    if view.records is Record.FATES and method.clusters:
        why = f"the method {method} shades by clusters of lights: single lights have no rays"
        raise ValueError(f"--view {view}: {why}; give {option} {BY_MODES}")


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
            data = codec.from_text(read_regular(path, _LARGEST_STATE))
            of_picture = isinstance(data, dict) and "state" in data
            state = capture.carried_from_json(data).view_state() if of_picture else codec.state_from_file(data)
        except FileNotFoundError:
            raise capture.CaptureError(f"{path}: no such file") from None
        except (OSError, ValueError) as error:
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
    saved, state = given.path, state_of(given.path)
    for _ in range(2):  # once more, without what the view that is given has no use for
        kept, _ = parser.parse_known_args([given.scene, *commands.options(state)])
        kept.accelerator, kept.time = state.settings.accelerator, None
        given = parser.parse_args(words, kept)
        state = state.with_draw(view=given.view.view, shares=given.view.shares)
    given.path = Path(state.scene)
    if given.frame is None and given.time is None:
        given.time = state.time
    if "buffers" in given and not (given.output or given.buffers or given.to_tev or given.print_command):
        given.output = _free_name(f"{saved.stem}-rendered")
    return given


def _free_name(stem: str) -> Path:
    """Return a name of a PNG in this folder that is not taken."""
    path, count = Path(f"{stem}.png"), 2
    while path.exists():
        path, count = Path(f"{stem}-{count}.png"), count + 1
    return path

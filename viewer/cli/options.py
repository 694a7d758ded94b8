"""Options that several commands have, and what they mean: the scene, its edits, the moment, and how it is traced."""

from __future__ import annotations

import argparse
import math
import os
from argparse import Namespace
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tracer.compiling.compilation import compiled_before, is_first, make_all_ready
from tracer.editing.edits import NO_EDITS, Edits, edited
from tracer.experiments.warmup_frames import MOST_WARMUP_FRAMES, WarmupFrame
from tracer.geometry.accelerators import BVH8
from tracer.method import DEFAULT_METHOD, additions, bases
from tracer.runtime.kernel_cache import outlives_process
from tracer.scene.load import load_visible_scene
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Scene
from tracer.scene.things import things
from tracer.settings import Settings
from tracer.util.setting import settings_of
from viewer.cli.arguments import UPS, Parser, before, camera, count, light_at, method, number, pixel, size
from viewer.cli.console import Work
from viewer.services import stills
from viewer.state.draw_options import Slice
from viewer.state.view_state import EDITS, as_options
from viewer.util import resources
from viewer.views.legend import lights_in_words

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.renderer import Renderer

CAMERA = "position, direction, up, angle; a file with that, or a saved picture"
METHODS = "a method of the list below, with additions as in certified+cache"
INDEX = count(0, 2**31 - 1)
_LISTED = 8  # names that a message lists, at most
_METAVARS: dict[type, str] = {int: "N", float: "X", Slice: "AXIS:PART"}

# --- the scene -------------------------------------------------------------------------------------


def add_scene(parser: Parser, more: str = "") -> None:
    """Add the scene, and where its files may be."""
    names = ", ".join(resources.embedded_scenes())
    help_ = f"a file (.aff .nff .obj .ply .stl .gltf .glb) or a scene that comes with the program ({names}){more}"
    parser.add_argument("scene", nargs="?", metavar="SCENE", help=help_)
    add_folders(parser)


def add_folders(parser: Parser) -> None:
    """Add which files a scene may read, and whether it may take more memory than there is."""
    help_ = "another folder than its own that the scene may read files from; may be given several times"
    parser.add_argument("--folder", type=Path, action="append", default=[], metavar="DIR", help=help_)
    help_ = "read a scene even if it needs more memory than there is, which may end this program or others"
    parser.add_argument("--beyond-memory", action=_BeyondMemory, nargs=0, help=help_)


class _BeyondMemory(argparse.Action):
    """An option that all readers of scenes learn of by the environment, also those in other processes."""

    def __call__(self, *_: object) -> None:
        os.environ["SHADOWCULL_BEYOND_MEMORY"] = "1"


def read_scene(path: Path, options: Namespace, work: Work) -> Scene:
    """Read a scene, say its warnings, and edit it where the command has options for that.

    Raises SceneError, ValueError and OSError in one line, and Cancelled."""
    scene = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
    for warning in scene.warnings:
        work.note(f"warning: {warning}")
    if not hasattr(options, "hidden"):
        return scene
    check_edits(edits := edits_of(options), scene)
    return edited(scene, edits).scene


def add_meshes(parser: Parser) -> None:
    """Add how meshes are read; without these options a model that comes alone is set in a studio."""
    add = parser.add_argument_group("meshes (OBJ, PLY, STL, glTF, GLB)").add_argument
    help_ = "the axis that points up in a model without camera and lights (default: a guess)"
    add("--up", choices=UPS, metavar="|".join(UPS), help=help_)
    help_ = (
        "where the file has no normals, round edges that are bent by up to DEG degrees; 0: none (default: 40 for a "
        "model without camera and lights, else 0)"
    )
    add("--crease", type=number(0.0, 180.0), metavar="DEG", help=help_)
    help_ = "no floor, lamps and upright view for a model without camera and lights, and no rounded edges"
    add("--no-studio", action="store_true", help=help_)


def mesh_options(options: Namespace) -> MeshOptions:
    """Return how meshes are read."""
    return MeshOptions(not options.no_studio, options.up, options.crease)


# --- edits -----------------------------------------------------------------------------------------


def add_edits(parser: argparse.ArgumentParser) -> None:
    """Add what edits the scene before it is traced; each option has the name of its field of `Edits`."""
    group = parser.add_argument_group("edits of the scene, each of which may be given several times")
    kinds: dict[str, Any] = {"N": INDEX, "N=X,Y,Z": _light_at, "NAME": str, "NAME=T": _name_at}
    for name, kind in EDITS.items():
        group.add_argument(kind.option, dest=name, type=kinds[kind.metavar], action="append", default=[],
                           metavar=kind.metavar, help=kind.help)  # fmt: skip


def _light_at(text: str) -> tuple[int, tuple[float, ...]]:
    light, *place = light_at(text)
    return int(light), tuple(place)


def _name_at(text: str) -> tuple[str, float]:
    name, _, time = text.rpartition("=")
    try:
        found = float(time)
    except ValueError:
        found = math.nan
    if not name or not math.isfinite(found):
        raise ValueError(f"{text!r} is not an object and a time; give them like train=2.5")
    return name, found


def edits_of(options: Namespace) -> Edits:
    """Return the edits that are asked for."""
    edits: dict[str, Any] = {}
    for name in EDITS:
        found, is_set = getattr(options, name), isinstance(getattr(NO_EDITS, name), frozenset)
        edits[name] = frozenset(found) if is_set else tuple(sorted(dict(found).items()))
    return Edits(**edits)


def check_edits(edits: Edits, scene: Scene) -> None:
    """Raise ValueError, in one line, for what the scene does not have."""
    known = as_options(edits.within(scene))
    for word in as_options(edits):
        if word in known:
            continue
        option, _, target = word.partition("=")
        kind = {"--make-static": "moving object", "--make-moving": "static object"}.get(option, "object")
        names = [one.name for one in things(scene) if kind == "object" or one.moves == (kind == "moving object")]
        more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
        why = f"no {kind} of this name; there is {', '.join(names[:_LISTED]) or 'none'}{more}"
        if "light" in option:
            why = lights_in_words(len(scene.lights))
        elif option == "--hide-primitive":
            why = f"the scene has the primitives 0 to {scene.primitive_count - 1}"
        raise ValueError(f"{option} {target}: {why}")


def light_index(options: Namespace, option: str, number: int, scene: Scene) -> int:
    """Return which of the lights of the scene, as it is edited, has this number in its file.

    Raises ValueError, in one line, where none has."""
    edits = edits_of(options)
    index = edits.light_index(number)
    if index is not None and index < len(scene.lights):
        return index
    off = f"this light is switched off (--without-light {number})"
    there = lights_in_words(len(scene.lights) + len(edits.lights_off))
    raise ValueError(f"{option}{number}: {off if index is None else there}")


# --- the moment ------------------------------------------------------------------------------------


def add_moment(parser: Parser) -> None:
    """Add two ways to name a moment of the animation, of which one may be given."""
    moment = parser.add_mutually_exclusive_group()
    moment.add_argument("--frame", type=count(), metavar="N", help="number of the frame in the animation (default: 0)")
    moment.add_argument("--time", type=number(), metavar="T", help="time in seconds, instead of a frame")


def moment(scene: Scene, options: Namespace) -> float:
    """Return the time that is asked for, that of the first frame by default; raises ValueError in one line."""
    start, end = scene.time_range
    if options.time is not None:
        if not start <= options.time <= end:
            raise ValueError(f"--time {options.time:g}: the scene's time runs from {start:g} to {end:g} seconds")
        return float(options.time)
    frame = options.frame or 0
    if not 0 <= frame < scene.frames:
        only = "is 0" if scene.frames == 1 else f"are 0 to {scene.frames - 1}"
        raise ValueError(f"--frame {frame}: the scene's frame numbers {only}")
    return scene.frame_time(frame)


def add_history(parser: Parser) -> None:
    """Add the frames from which modes are learnt: those before on the path, or any."""
    help_ = "first trace the N frames before it, from which culling learns"
    parser.add_argument("--warmup", type=count(0, MOST_WARMUP_FRAMES), default=0, metavar="N", help=help_)
    help_ = "before these, trace the frames of this list of [time, camera], or of a JSON file of `hunt`"
    parser.add_argument("--before", type=before, default=(), metavar="JSON", help=help_)


def warmup_times(scene: Scene, time: float, warmup: int, work: Work) -> list[float]:
    """Return the times of the frames of `--warmup`, with a note where there are not so many."""
    times = stills.times_before(scene, time, warmup)
    if len(times) < warmup:
        come = {0: "no frame comes", 1: "only one frame comes"}.get(len(times), f"only {len(times)} frames come")
        work.note(f"--warmup {warmup}: {come} before this one")
    return times


# --- a pixel --------------------------------------------------------------------------------------


def add_pixel(parser: Parser) -> None:
    """Add what names a pixel of a picture of a scene, and the frames before it."""
    add = parser.add_argument
    add_scene(parser)
    help_ = "column and row, counted from the upper left"
    add("--pixel", type=pixel, required=True, metavar="X,Y", help=help_)
    add_moment(parser)
    add_size(parser)
    help_ = f"how shadow rays are culled: {METHODS} (default: {DEFAULT_METHOD})"
    add("--method", type=method, metavar="METHOD", help=help_)
    add("--camera", type=camera, metavar="JSON", help=f"another camera: {CAMERA}")
    add_edits(parser)
    add_history(parser)
    help_ = "then trace the frame itself N times (default: 1 without --warmup and --before, else 0)"
    add("--repeat", type=count(0, 1000), metavar="N", help=help_)


def pixel_settings(options: Namespace) -> Settings:
    """Return what the options say of tracing; raises ValueError, in one line, also for a pixel outside the picture."""
    settings, (x, y) = tracing_settings(options), options.pixel
    if not (x < settings.width and y < settings.height):
        raise ValueError(f"--pixel {x},{y}: the picture is {settings.width} x {settings.height}")
    return settings


def frames_before(scene: Scene, options: Namespace, work: Work) -> list[WarmupFrame]:
    """Return the frames that are traced before the picture: the frame itself once where no others are, as in the window
    at rest."""
    time = moment(scene, options)
    repeats = options.repeat if options.repeat is not None else 0 if options.warmup or options.before else 1
    times = [*warmup_times(scene, time, options.warmup, work), *[time] * repeats]
    return [*options.before, *(WarmupFrame(then, options.camera) for then in times)]


def traced(renderer: Renderer, frames: Sequence[WarmupFrame], work: Work) -> Iterator[Frame]:
    """Trace frames one after another, and give each; raises Cancelled."""
    for done, one in enumerate(frames):
        work.count(f"tracing, frame {done + 1} of {len(frames)}", done, len(frames))
        yield renderer.render(one.time, one.camera, work.cancelled)


# --- tracing ---------------------------------------------------------------------------------------


def add_size(parser: Parser) -> None:
    """Add the size of pictures."""
    default = (Settings.width, Settings.height)
    help_ = "width and height in pixels (default: {}x{})".format(*default)
    parser.add_argument("--size", type=size, default=default, metavar="WxH", help=help_)


def add_settings(parser: argparse._ActionsContainer, holder: type, *names: str, **defaults: Any) -> None:
    """Add the options of settings, as these are declared; `defaults` are those of the command where they differ.

    A value has the setting's name in the namespace."""
    for one in settings_of(holder):
        if one.name not in names:
            continue
        help_, default = f"{one.help[:1].lower()}{one.help[1:].rstrip('.')}", defaults.get(one.name, one.default)
        if one.kind is bool:
            kept: dict[str, Any] = {"action": "store_const", "const": not one.default}
            help_ = f"do not {help_}" if one.default else help_
        else:
            choices = "|".join(map(str, one.choices))
            kept = {"type": one.parse, "metavar": choices or _METAVARS.get(one.kind, one.name.upper())}
            meanings = "; ".join(f"{choice}: {meaning}" for choice, meaning in one.choices.items() if meaning)
            told = f"as the {one.unset} says" if default is None else str(default).removesuffix(".0")
            help_ += f"{f'. {meanings}' if meanings else ''} (default: {told})"
        parser.add_argument(one.option, dest=one.name, default=default, help=help_.replace("%", "%%"), **kept)


def add_tracing(parser: Parser, accelerator: str = BVH8, zoom_factor: bool = True) -> None:
    """Add what all commands that trace have in common, with the structure that is theirs by default.

    `zoom_factor`: it is an option."""
    others = ["method", "verify", "samples"] + ([] if zoom_factor else ["zoom_factor"])
    common = [one.name for one in settings_of(Settings) if one.option and one.name not in others]
    group = parser.add_argument_group("how it is traced")
    add_settings(group, Settings, *common, accelerator=accelerator)
    add_meshes(parser)


def tracing_settings(options: Namespace, **more: Any) -> Settings:
    """Return what the options say of tracing, and `more`, which wins; raises ValueError in one line."""
    width, height = options.size
    stills.check_size(width, height)
    given = {one.name: getattr(options, one.name, None) for one in settings_of(Settings) if one.option}
    given = {"width": width, "height": height} | {name: value for name, value in given.items() if value is not None}
    return Settings(**given | more).validated()


def prepare_kernels(work: Work, lights: int, accelerator: str, *methods: str) -> None:
    """Compile or load every kernel that these methods need for so many lights.

    The first time takes a while and says so."""
    picture_only = all(map(is_first, methods))
    if not compiled_before(lights, accelerator, picture_only):
        always = "at every start, as the cache folder cannot be written to"
        often = "once for this version" if outlives_process() else always
        work.note(f"compiling the kernels, {often}; this takes a minute or less")
    make_all_ready(methods, lights, accelerator, work.progress)


def method_summaries() -> str:
    """Say in a line for each method what the registry says of it."""
    lines = [(kind.name, kind.summary) for kind in bases(measures=True)]
    lines += [(f"+{kind.name}", kind.summary) for kind in additions(measures=True)]
    width = max(len(name) for name, _ in lines)
    return "\nmethods:\n" + "".join(f"  {name:{width}}  {summary}\n" for name, summary in lines)

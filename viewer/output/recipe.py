"""All that a picture depends on: as the options of `shadowcull render` that make it again, and as JSON in the picture.

Modes come from the frames before, and certificates and the caches as well.  A picture that shows them can be made again
where those frames are known: any frames, each by its time and camera (`before`), then so many frames of the path before
it (`warmup`), then the same frame so many times (`repeats`).  Where they are not, `history` says why, in words; a saved
picture may then carry the modes themselves.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from pathlib import Path

from tracer.experiments.warmup_frames import WarmupFrame
from tracer.method import Method
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.load import AFF_EXTENSIONS
from tracer.scene.mesh_options import AS_IN_FILE, MeshOptions
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings
from viewer.state import codec
from viewer.state import edits as scene_edits
from viewer.state.draw_options import MIDDLE, SHADING, DrawOptions, Slice
from viewer.state.palette import BENEATH
from viewer.state.tone import NEUTRAL, Tone
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import View
from viewer.util import resources
from viewer.views.wipe import wipe_column

MOST_BEFORE = 100_000  # frames
CHANCE = "what is certified depends on time and threads"
BUILT = "what rays have had built depends on all that has been seen"


@dataclass(frozen=True)
class Style:
    """How a frame is drawn, without tracing it: shares instead of counts in maps of work, rings around wrong pixels for
    a picture that is shown `magnified` times, how much of the light shows under flat colours, how bright the picture
    beneath the difference is, borders between primitives, where the legend is if there is one, the caption, the
    tone of its colours, whether what this clips is marked, the range of a map of numbers, the slice `cut` through
    space, and, where what culling saves stands above it, what that says of steps and time (`savings`)."""

    shares: bool = False
    marked: bool = True
    magnified: int = 1
    shading: float = SHADING
    beneath: float = BENEATH
    outlines: bool = False
    legend: tuple[float, float] | None = None
    caption: str = ""
    tone: Tone = NEUTRAL
    clipping: bool = False
    span: tuple[float, float] | None = None
    cut: Slice = MIDDLE
    savings: str | None = None


@dataclass(frozen=True)
class Recipe:
    """See the module.  `camera` None is the scene's own; `settings` are those of the picture's own frame; `by_gpu` says
    that a GPU drew the view, which may round otherwise.  `folders` are those that the user lets the scene read: a
    picture does not carry them, or it could name any.  `modes` are those that its frame went by, in the place of frames
    before it (`viewer.output.kept_modes`).  `edits` are what is otherwise than in the scene's file; `light`
    counts those that are on."""

    scene: Path
    time: float
    camera: Camera | None
    settings: Settings
    view: View = View.COLOR
    light: int = 0
    wipe: float = 0.5
    style: Style = field(default_factory=Style)
    warmup: int = 0
    repeats: int = 0
    history: str = ""
    by_gpu: bool = False
    folders: tuple[Path, ...] = ()
    before: tuple[WarmupFrame, ...] = ()
    modes: str = ""
    meshes: MeshOptions = AS_IN_FILE
    edits: Edits = NO_EDITS

    @property
    def size(self) -> tuple[int, int]:
        return self.settings.width, self.settings.height

    @property
    def draw(self) -> DrawOptions:
        """How the frame is drawn."""
        style = self.style
        options = DrawOptions(
            view=self.view, light=self.light, wipe=self.wipe, slice=style.cut, beneath=style.beneath,
            shading=style.shading, tone=style.tone, outlines=style.outlines, shares=style.shares,
            mark_wrong=style.marked, clipping=style.clipping, magnified=style.magnified, savings=style.savings,
            caption=style.caption, legend=style.legend is not None,
            legend_at=style.legend or DrawOptions().legend_at,
        )  # fmt: skip
        return options.with_span(style.span)

    @property
    def needs_history(self) -> bool:
        """Whether frames before it show in the picture."""
        return needs_history(self.settings.method, self.view, self.tells_counters)

    @property
    def tells_counters(self) -> bool:
        """Whether what is drawn tells how many rays were culled."""
        return self.style.savings is not None

    @property
    def by_one_thread(self) -> bool:
        """Whether it takes a single thread to make it again."""
        certified = Method.parse(self.settings.method).has_certificates
        return self.settings.threads == 1 and certified and self.needs_history

    def state(self) -> ViewState:
        """Return the state that a picture carries."""
        settings = self.settings if self.by_one_thread else replace(self.settings, threads=0)
        warmup = Warmup(self.before, self.warmup, self.repeats, self.modes, self.history)
        return ViewState(
            str(self.scene.absolute()),
            self.meshes,
            self.edits,
            self.time,
            self.camera,
            settings,
            self.draw,
            warmup=warmup,
        )


def of_state(state: ViewState) -> Recipe:
    """Return the inverse of `Recipe.state`."""
    draw, warmup = state.draw, state.warmup
    style = Style(
        shares=draw.shares, marked=draw.mark_wrong, magnified=draw.magnified, shading=draw.shading,
        beneath=draw.beneath, outlines=draw.outlines, legend=draw.legend_at if draw.legend else None,
        caption=draw.caption, tone=draw.tone, clipping=draw.clipping, span=draw.span, cut=draw.slice,
        savings=draw.savings,
    )  # fmt: skip
    return Recipe(
        Path(state.scene), state.time, state.camera, state.settings, draw.view, draw.light, draw.wipe, style,
        warmup=warmup.of_path, repeats=warmup.repeats, history=warmup.unknown, before=warmup.frames,
        modes=warmup.modes, meshes=state.meshes, edits=state.edits,
    )  # fmt: skip


def needs_history(method: str, view: View, counters: bool = False) -> bool:
    """Whether a picture by a method in a view depends on the frames before it; `counters` stand beside it, or not."""
    parsed = Method.parse(method)
    of_culling = view is View.CERTIFICATE or ((view.needs_work or view.needs_fates) and parsed.culls)
    return of_culling or counters or view.of_modes or view is View.TREE or not parsed.exact


def by_chance(settings: Settings, view: View, counters: bool = False) -> bool:
    """Whether chance has a part in it: what is certified within a limit of time, or by several threads, or what `auto`
    measures."""
    method = Method.parse(settings.method)
    limited = method.has_certificates and (math.isfinite(settings.certificate_seconds) or settings.threads != 1)
    return (
        needs_history(settings.method, view, counters)
        and method.exact
        and not view.of_modes
        and (limited or method.adaptive)
    )


def cannot_come_back(settings: Settings, view: View, counters: bool = False) -> str:
    """Why no frames before it bring a picture of the window back, in words; nothing where some do, or none count."""
    if view is View.TREE:
        return BUILT
    return CHANCE if by_chance(settings, view, counters) else ""


def arguments(recipe: Recipe, scene: Scene | None, output: str) -> list[str]:
    """The words after `shadowcull` that make this picture again, to the bit; `scene` names frames by their numbers."""
    settings, view, style, usual = recipe.settings, recipe.view, recipe.style, Style()
    words = ["render", scene_word(recipe.scene), "-o", f"./{output}" if output.startswith("-") else output]
    words += ["--size", f"{settings.width}x{settings.height}", *_moment(recipe.time, scene)]
    words += ["--method", settings.method]
    light = f":{recipe.edits.light_number(recipe.light)}" if view.of_light else ""
    wipe = f":{_wipe(recipe.wipe, settings.width)}" if view is View.WIPE else ""
    shares = ":share" if view.needs_work and style.shares else ""
    if view is not View.COLOR:
        words += ["--view", f"{view.value}{light}{wipe}{shares}"]
    if recipe.camera is not None:
        words += ["--camera", json.dumps(recipe.camera.to_json())]
    of_settings: tuple[tuple[str, object, object], ...] = (
        ("--samples", settings.samples, 1),
        ("--depth", settings.depth, 10),
        ("--zoom-factor", settings.zoom_factor, 4.0),
        ("--lamp-radius", settings.lamp_radius, None),
        ("--lamp-samples", settings.lamp_samples, None),
        ("--lightcuts-error", settings.lightcuts_error, 0.02),
        ("--lightcuts-nodes", settings.lightcuts_nodes, 1000),
        ("--accelerator", settings.accelerator, "bvh8"),
        ("--threads", settings.threads if recipe.by_one_thread else 0, 0),
        ("--warmup", recipe.warmup, 0),
        ("--repeat", recipe.repeats, 0),
        ("--shading", style.shading, usual.shading),
        ("--beneath", style.beneath, usual.beneath),
        ("--magnified", style.magnified, usual.magnified),
        ("--exposure", style.tone.exposure, usual.tone.exposure),
        ("--white", style.tone.white, usual.tone.white),
        ("--tone", style.tone.curve.value, usual.tone.curve.value),
    )
    for option, value, default in of_settings:
        if value != default:  # a negative number would look like an option
            words += [f"{option}={value}"] if str(value).startswith("-") else [option, str(value)]
    flags = (
        ("--symmetric", settings.symmetric),
        ("--verify", settings.verify),
        ("--outlines", style.outlines),
        ("--no-marks", not style.marked),
        ("--mark-clipped", style.clipping),
        ("--legend", style.legend is not None),
    )
    words += [option for option, given in flags if given]
    if style.legend is not None and style.legend != (0.0, 1.0):
        words += ["--legend-at", f"{style.legend[0]!r},{style.legend[1]!r}"]
    if style.span is not None:
        words += [f"--range={style.span[0]!r}:{style.span[1]!r}"]
    if view.has_slice and style.cut != usual.cut:
        words += ["--slice", style.cut.in_words()]
    if style.savings is not None:
        words += [f"--savings={style.savings}"] if style.savings else ["--savings"]
    if style.caption:
        words += [f"--caption={style.caption.replace('{', '{{').replace('}', '}}')}"]
    if recipe.before:
        words += ["--before", codec.text(recipe.before)]
    words += scene_edits.as_options(recipe.edits)
    for folder in recipe.folders:
        words += ["--folder", str(folder.absolute())]
    return words + _of_meshes(recipe)


def _of_meshes(recipe: Recipe) -> list[str]:
    """How the scene is read, where that can be chosen."""
    meshes = recipe.meshes
    if recipe.scene.suffix.lower() in AFF_EXTENSIONS:
        return []
    up = [f"--up={meshes.up}"] if meshes.up is not None else []
    crease = [f"--crease={meshes.crease!r}"] if meshes.crease is not None else []
    return [*up, *crease, *([] if meshes.studio else ["--no-studio"])]


def _wipe(wipe: float, width: int) -> str:
    """The place of a wipe's line, as few digits as may be for the same column."""
    column = wipe_column(width, wipe)
    return "1" if column >= width else f"{(column + 0.5) / width:.9f}"


def scene_word(path: Path) -> str:
    """What names a scene on the command line: of one that comes with the program its name, else where its file is."""
    own = next((name for name, file in resources.embedded_scenes().items() if _same(file, path)), None)
    return own or str(path.absolute())


def _same(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except OSError:
        return False


def _moment(time: float, scene: Scene | None) -> list[str]:
    """The number of the frame where it is one's time to the bit, else the time."""
    if scene is not None:
        start, end = scene.time_range
        number = round((time - start) / (end - start) * (scene.frames - 1)) if scene.frames > 1 and end > start else 0
        if scene.frame_time(number) == time:
            return ["--frame", str(number)]
    return [f"--time={time!r}"]

"""The command `explain`: why the shadow rays of one pixel were culled or traced, and what became of all its rays."""

from __future__ import annotations

import json
from argparse import Namespace
from collections.abc import Sequence
from functools import cache

from rich.console import Console
from rich.text import Text
from rich.tree import Tree

from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame
from tracer.method import DEFAULT_METHOD, Method
from tracer.mode_origins import ModeOrigins
from tracer.reasons import Why
from tracer.renderer import Renderer
from tracer.scene.lights import named_light
from tracer.scene.load import check_scene_file
from tracer.scene.model import Scene
from tracer.told_rays import RayTree
from tracer.why import why
from viewer.cli import arguments, options
from viewer.cli.arguments import Parser, count
from viewer.cli.console import working
from viewer.output.explained import ray_data, why_data, why_lines
from viewer.output.ray_rows import Filter, RayRows, Row, Shown, totals
from viewer.services.origin_pixels import Found, OriginPixels, can_trace_once_more, trace_once_more, with_origins
from viewer.util.messages import printable

EPILOG = """\
examples:
  shadowcull explain default --pixel 200,300
  shadowcull explain kitchen.aff --frame 50 --warmup 10 --pixel 256,400 --only wrong
  shadowcull explain default --pixel 200,300 --method certified
  shadowcull explain default --pixel 200,300 --accelerator kdtree --json

The tree has the pixel's primary, reflected and refracted rays, and below each the shadow rays from where it ends: not
due, culled and by what, passed over, or traced, with the steps and tests of the ray alone and what blocks it. Culling
uses what earlier frames have shown: --warmup N first traces the N frames before, and --repeat N the frame itself.
"""


def parser() -> Parser:
    description = "Say what became of each ray of a pixel: which shadow rays were due, culled or traced, and why."
    parser = Parser("explain", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_scene(parser)
    help_ = "column and row, counted from the upper left"
    add("--pixel", type=arguments.pixel, required=True, metavar="X,Y", help=help_)
    options.add_moment(parser)
    options.add_size(parser)
    help_ = f"how shadow rays are culled: {options.METHODS} (default: {DEFAULT_METHOD})"
    add("--method", type=arguments.method, metavar="M", help=help_)
    only = ("all", "traced", "untraced", "blocked", "wrong")
    add("--only", choices=only, default="all", help="which shadow rays are listed (default: all)")
    add("--light", type=count(0, 2**31 - 1), metavar="N", help="only shadow rays to this light")
    add("--json", action="store_true", help="all rays as JSON on standard output")
    add("--camera", type=arguments.camera, metavar="JSON", help=f"another camera: {options.CAMERA}")
    options.add_edits(parser)
    options.add_history(parser)
    help_ = "then trace the frame itself N times (default: 1 without --warmup and --before, else 0)"
    add("--repeat", type=count(0, 1000), metavar="N", help=help_)
    options.add_tracing(parser)
    return parser


def run(given: Namespace) -> int:
    """Trace a frame, and print the reasons and the tree of a pixel's rays; raises SceneError and ValueError in one
    line, or Cancelled."""
    check_scene_file(given.path)
    settings = options.tracing_settings(given)
    x, y = given.pixel
    if not (x < settings.width and y < settings.height):
        raise ValueError(f"--pixel {x},{y}: the picture is {settings.width} x {settings.height}")
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        light = None if given.light is None else options.light_index(given, "--light ", given.light, scene)
        time = options.moment(scene, given)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        renderer = Renderer(scene, settings, work.progress)
        times = options.warmup_times(scene, time, given.warmup, work)
        times += [time] * _repeats(given)
        before = [*given.before, *(WarmupFrame(then, given.camera) for then in times)]
        origins, places = ModeOrigins(len(scene.lights)), None
        for done, earlier in enumerate(before):
            work.count(f"warming up, frame {done + 1} of {len(before)}", done, len(before) + 1)
            modes = renderer.render(earlier.time, earlier.camera, work.cancelled).modes
            were, places = places, scene.light_positions(earlier.time)
            origins.add(done, modes, None if were is None else (were != places).any(axis=1))  # lights that have moved
        work.count("tracing", len(before), len(before) + 1)
        frame = renderer.render(time, given.camera, work.cancelled)
        found = why(renderer, frame, x, y, work.cancelled)
        work.count("looking for the frames that set its modes", len(before), len(before) + 1)
        found = _with_origins(found, renderer, frame, origins, before)
    tree = found.tree
    assert tree is not None
    if given.json:
        print(json.dumps(ray_data(tree, scene) | {"why": why_data(found, scene)}, indent=2))
        return 0
    title = (
        f"{given.path.name}, {time:.3f} s, pixel {x},{y} of {frame.width} × {frame.height}, method {settings.method}"
    )
    _print(found, tree, scene, Filter(Shown(given.only), light), title)
    return 0


def _repeats(given: Namespace) -> int:
    """Return how often the frame itself is traced before.

    Where no others come before it, that is once, as in the window at rest, so that what culls by earlier frames has
    seen one."""
    if given.repeat is not None:
        return int(given.repeat)
    return 0 if given.warmup or given.before else 1


def _with_origins(
    found: Why, renderer: Renderer, frame: Frame, modes: ModeOrigins, before: Sequence[WarmupFrame]
) -> Why:
    """Add the frames, and the pixels of these, that gave the primitive its modes."""
    unit = int(frame.cell[found.y, found.x])
    origins = modes.of(unit) if found.primitive >= 0 and frame.settings.keeps_modes else None
    if origins is None:
        return found

    def name(number: int) -> str:
        return "the frame before" if len(before) == 1 else f"frame {number + 1} of the {len(before)} frames before this"

    @cache
    def pixels(number: int) -> Found | None:
        if not can_trace_once_more(frame.settings, frame.lights):
            return None
        then, uses_cells = before[number], Method.parse(frame.settings.method).uses_cells
        return trace_once_more(renderer, then.time, then.camera, frame.settings, unit, uses_cells)

    def pixel(number: int, light: int, lit: bool) -> OriginPixels | None:
        known = pixels(number)
        return None if known is None else known.get((light, lit), OriginPixels(0, None))

    return with_origins(found, origins, pixel, name)


def _print(found: Why, tree: RayTree, scene: Scene, shown: Filter, title: str) -> None:
    console = Console()
    if not console.is_terminal:
        console = Console(width=100_000, soft_wrap=True)  # a line for each row, whatever reads it
    console.print(Text(printable(title), "bold"))
    for line in why_lines(found, scene, shown.light):
        console.print(Text(printable(line)))
    said = [totals(tree)]
    if shown != Filter():
        of = "" if shown.light is None else f" of {named_light(scene.lights, shown.light)}"
        said.append(f"shadow rays shown: {shown.shown.value}{of}")
    drawn = Tree(Text("\n".join(said), "bold"), guide_style="dim")
    for row in RayRows(tree, scene, shown).top:
        _add(drawn, row)
    console.print(drawn, markup=False, highlight=False)
    if tree.frame.statistics.decision:
        console.print(Text(tree.frame.statistics.decision, "italic"))


def _add(tree: Tree, row: Row) -> None:
    """Add a row, and those below it, but for the single samples and lights of many with the same fate."""
    red, green, blue = (round(255 * channel) for channel in row.color)
    below = tree.add(Text(printable(row.text), f"rgb({red},{green},{blue})" if len(row.places) else "bold"))
    if "fate" in row.key:
        return
    for one in row.rows:
        _add(below, one)

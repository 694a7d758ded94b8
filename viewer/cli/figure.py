"""The command `figure`: one frame by several methods, side by side."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from tracer.geometry.world import World
from tracer.scene.load import check_scene_file
from tracer.util.text import printable
from viewer.cli import arguments, options, pictures
from viewer.cli.arguments import Parser
from viewer.cli.console import print_table, titled, working
from viewer.output import explorable
from viewer.output.comparison import ENDINGS, Comparison, Crop
from viewer.services import stills
from viewer.state.views import View
from viewer.util.files import check_writable

EPILOG = """\
examples:
  shadowcull figure default -o methods.pdf --frame 50 --warmup 20 --size 640x480
  shadowcull figure kitchen.aff -o paper.png --frame 100 --warmup 20 --crops '40,60,80,60;200,90,80,60'
  shadowcull figure default -o explore.html --frame 50 --warmup 20 --size 320x240
  shadowcull figure kitchen.aff -o cost.pdf --frame 100 --warmup 20 --view cost --methods none,certified,certified+cache

Each method has a column, with modes of its own: the picture with the crops marked in it, each crop enlarged without
smoothing, its difference to the picture of none, and the counters. Differences have one range of colours, and so have
maps of work. The counters are those of the kd-tree, ray by ray, unless --accelerator says otherwise; the work that
goes into certificates is among them. The figure carries how it was made: `shadowcull check` draws it again.

A .html is one page for a browser: a reader clicks pixels for their modes, what blocks their lights, their rays and each
method's answer, chooses views and methods, none among them, and wipes between two. `check` does not take it.
"""


def parser() -> Parser:
    description = "Draw one frame by several methods side by side: crops, what differs from none, and counts."
    parser = Parser("figure", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_scene(parser, pictures.OR_PICTURE)
    add(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="the figure, a .png or .pdf, which says how it was made, or a .html to explore",
    )
    help_ = "which methods, in the order of the columns (default: none,paper,certified)"
    add("--methods", type=arguments.methods, default=["none", "paper", "certified"], metavar="METHOD,...", help=help_)
    help_ = "rectangles of pixels that are shown enlarged"
    add("--crops", type=arguments.crops, default=(), metavar="X,Y,W,H;...", help=help_)
    options.add_history(parser)
    options.add_moment(parser)
    pictures.add_picture(parser)
    options.add_tracing(parser, "kdtree")  # whose steps are the paper's
    parser.set_defaults(repeat=0, verify=False)
    return parser


def run(given: Namespace) -> int:
    """Trace and draw; raises SceneError, ValueError and OSError, each in one line, or Cancelled."""
    check_scene_file(given.path)
    view = given.view.view
    ending = given.output.suffix.lower() if given.output else ""
    if ending not in (*ENDINGS, explorable.ENDING):
        raise ValueError(f"figure: give -o FILE, one of {' '.join((*ENDINGS, explorable.ENDING))}")
    explored = ending == explorable.ENDING
    check_writable(given.output)
    if view is View.CERTIFICATE:
        raise ValueError("figure: certificates are of one method alone; give another --view")
    pictures.check_display(given)
    settings = options.tracing_settings(given)
    for method in given.methods:
        pictures.check_view(replace(settings, method=method), view, "--methods")
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        state = pictures.wanted_state(scene, settings, given)
        crops = tuple(Crop(*crop) for crop in given.crops)
        wanted = Comparison(tuple(given.methods), crops).checked(state.size)
        if explored:
            explorable.check(*state.size, crops)
            state = state.with_settings(modes=True)
        options.warmup_times(scene, state.time, state.warmup.of_path, work)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, *wanted.methods)
        world = World(scene, state.time, given.accelerator, work.progress)

        def tell(method: str, done: int, total: int) -> None:
            work.count(f"{method}, frame {done + 1} of {total}", done, total)

        records = explorable.RECORDS if explored else ()
        shown = stills.trace_methods(scene, state, wanted, world, tell, work.cancelled, records)
        work.progress("drawing", 1.0)
        if explored:
            explorable.save(shown, world, given.output)
        else:
            stills.save_methods(shown, given.output)
    table = titled(f"{scene.path.name}, {state.time:.3f} s")
    table.add_column("")
    for method in shown.frames:
        table.add_column(method, justify="right")
    for line in zip(*(shown.counts(method) for method in shown.frames)):
        table.add_row(line[0][0], *(value for _, value in line))
    print_table(table)
    print(printable(given.output))
    return 0

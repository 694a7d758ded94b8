"""The command `zoom`: towards a primitive in steps, as the paper's Figure 4.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from tracer.experiments import zoom
from tracer.experiments.titles import NEVER_WHOLE, WRONG_PIXELS, happenings, never_whole, title, verdict
from tracer.experiments.zoom import ZoomTest
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file
from viewer.cli import arguments, options
from viewer.cli.arguments import INTERRUPTED, Parser, count
from viewer.cli.console import columns_help, listed, print_table, working
from viewer.output import exports
from viewer.output.reports import STEPS
from viewer.state.methods import NO_CULLING
from viewer.state.plans import ZoomPlan, parse_factors
from viewer.util.messages import say

WHICH = (
    "zoom: towards which primitive? give --pixel X,Y, for what a pixel of the picture shows, or --primitive N; the "
    "viewer's inspector shows its number, and so does the array 'primitive' of render --buffers"
)
EPILOG = f"""\
examples:
  shadowcull zoom figure4 --primitive 0 --size 128x128 --factors 4,64 --plot figure4.png
  shadowcull zoom kitchen.aff --frame 100 --primitive 15548 --size 256x256 --ratio 0.9 --factors 4,64
  shadowcull zoom figure4 --pixel 64,64 --size 128x128 --json zoom.json --csv zoom.csv

The camera moves straight towards the primitive; the first frames stay in place until the modes settle. The primitive
is culled by what its few pixels met from afar, until it covers more than the zoom factor times the pixels of its
last examination. Every culled shadow ray is verified, and a pixel with a wrong answer is a wrong pixel: in the files
wrong_of_primitive counts those of the primitive, wrong those of the whole picture. Ctrl-C keeps the finished frames;
the exit code is then 130.

{columns_help(STEPS)}"""


def parser() -> Parser:
    description = "Move towards a primitive in steps, and show whether its shadows stay right for each zoom factor."
    parser = Parser("zoom", description, EPILOG)
    add = parser.add_argument
    options.add_scene(parser)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--primitive", type=count(0, 2**31 - 1), metavar="N", help="towards this primitive")
    help_ = "towards what this pixel of the first frame shows"
    which.add_argument("--pixel", type=arguments.pixel, metavar="X,Y", help=help_)
    options.add_moment(parser)
    add("--camera", type=arguments.camera, metavar="JSON", help=f"where to start from: {options.CAMERA}")
    options.add_settings(parser, ZoomPlan, "steps", "ratio", "factors")
    options.add_size(parser)
    add("--json", type=Path, metavar="FILE", help="every figure of every step")
    add("--csv", type=Path, metavar="FILE", help="a line for each step")
    add("--plot", type=Path, metavar="FILE", help="counts, modes and wrong pixels over the steps: a .png, .svg or .pdf")
    options.add_tracing(parser, zoom_factor=False)
    parser.set_defaults(verify=True)
    return parser


def run(given: Namespace) -> int:
    """Do a zoom test, print what happened, and write its files.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished."""
    check_scene_file(given.path)
    if given.primitive is None and given.pixel is None:
        raise ValueError(WHICH)
    settings = options.tracing_settings(given)
    factors = parse_factors(given.factors)
    zoom.settings_of_tests(settings, factors, given.steps, given.ratio)
    if given.pixel is not None:
        zoom.check_pixel(given.pixel, given.size)
    wanted = exports.wanted_files(given)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        time = options.moment(scene, given)
        if given.primitive is not None:
            zoom.check_primitive(scene, given.primitive)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, zoom.METHOD)
        world = World(scene, time, settings.accelerator, work.progress)
        rays = replace(settings, method=NO_CULLING, depth=0, verify=False)  # the primary ones alone
        frame = Renderer(scene, rays, world=world).render(time, given.camera, work.cancelled)
        primitive = zoom.primitive_at(frame, *given.pixel) if given.pixel is not None else given.primitive
        start = zoom.aim(frame, primitive)
        test = ZoomTest(scene, settings, start, factors, given.steps, given.ratio)
        results = work.perform(test, world)
        failures = exports.write_files(results, wanted)
    print_table(listed(STEPS, happenings(results), title(results), f"wrong: {WRONG_PIXELS}", lambda row: row[0]))
    for approach in results.approaches:
        print(verdict(approach))
    if never_whole(results):
        say(f"primitive {results.primitive}: {NEVER_WHOLE}")
    if failures:
        raise OSError("; ".join(failures))
    return 0 if test.whole else INTERRUPTED

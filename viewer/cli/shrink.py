"""The command `shrink`: a wrong pixel in as small a scene as still shows it.

Ctrl-C ends it after the last whole try: what is left by then is written."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from tracer.experiments.shrink import WrongPixel
from tracer.scene.load import check_scene_file
from tracer.util.text import printable
from viewer.cli import options
from viewer.cli.arguments import INTERRUPTED, Parser
from viewer.cli.console import working
from viewer.services.shrinking import FIGURE, FRAMES, SCENE, TEST, ShrinkRun

EPILOG = """\
examples:
  shadowcull shrink kitchen.aff --frame 12 --size 256x256 --pixel 147,125 --before '[[0, null]]' -o wrong
  shadowcull shrink kitchen.aff --frame 84 --size 256x256 --pixel 208,86 --warmup 84 --method cells -o wrong
  shadowcull explain wrong/scene.aff --pixel 147,125 --size 256x256 --before wrong/wrong.json --only wrong
  shadowcull check wrong/wrong.png

Frames before it, lights, objects, triangles, spheres and cones are left out, many at once and at last one by one, until
leaving out any single one makes the pixel right. The folder gets the scene that is left, without textures; the frames
and all about the pixel; a figure beside the right picture, which `shadowcull check` draws again; and a test for pytest,
which fails as long as the pixel is wrong. Each JSON of `shadowcull hunt` has the command that shrinks its pixel. Ctrl-C
keeps what is left by then; the exit code is then 130.
"""


def parser() -> Parser:
    description = "Reduce a wrong pixel to the few triangles, lights and frames that it takes."
    parser = Parser("shrink", description, EPILOG + options.method_summaries())
    options.add_pixel(parser)
    help_ = "a folder, new or empty, for the scene, the frames, a figure and a test"
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help=help_)
    options.add_tracing(parser)
    return parser


def run(given: Namespace) -> int:
    """Shrink, and say what is left; raises SceneError, ValueError and OSError, each in one line, or Cancelled."""
    check_scene_file(given.path)
    settings = options.pixel_settings(given)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        time, before = options.moment(scene, given), options.frames_before(scene, given, work)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        x, y = given.pixel
        wrong = WrongPixel(x, y, time, given.camera, tuple(before), settings)
        run = ShrinkRun(scene, wrong, given.output)
        left = work.perform(run)
    print(printable(run.rule))
    if left.counts == left.first:
        print(f"{left.first}: nothing of it can be left out")
    else:
        print(f"{left.first}: {left.counts} are left, after {left.tries:,} tries in {run.seconds:.1f} s")
    for name in (SCENE, FRAMES, FIGURE, TEST):
        print(printable(given.output / name))
    return 0 if run.whole else INTERRUPTED

"""The command `cube`: what a light sees, as its light buffer has it."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from PIL import Image

from tracer.methods.lightbuffer import LightBuffer
from tracer.renderer import Renderer
from tracer.scene.lights import named_light
from tracer.scene.load import check_scene_file
from tracer.setting import setting_of
from tracer.settings import Settings
from viewer.cli import options
from viewer.cli.arguments import Parser, count
from viewer.cli.console import print_table, titled, working
from viewer.output.light_cube import picture_of, seen
from viewer.util.files import check_writable
from viewer.util.messages import printable
from viewer.views.legend import lights_in_words

EPILOG = """\
examples:
  shadowcull cube default --light 1 -o cube.png
  shadowcull cube kitchen.aff --side 512 --accelerator kdtree

The legends say what the colours mean; --no-legend draws a pixel for each cell.
"""


def parser() -> Parser:
    description = (
        "Save what a light sees, as the method lightbuffer has it: its cube unfolded, with what is known of each cell "
        "on the left, and the distance at which full shadow begins on the right."
    )
    parser = Parser("cube", description, EPILOG)
    add = parser.add_argument
    options.add_scene(parser)
    add("--light", type=count(0, 2**31 - 1), default=0, metavar="N", help="which light (default: 0)")
    help_ = "cells along an edge, a power of two from 16 to 1024 (default: 256)"
    add("--side", type=setting_of(Settings, "light_buffer_side").parse, default=256, metavar="N", help=help_)
    add("-o", "--output", type=Path, default=Path("cube.png"), metavar="FILE", help="the picture (default: cube.png)")
    add("--no-legend", action="store_true", help="a pixel for each cell, without legends")
    options.add_moment(parser)
    options.add_tracing(parser, zoom_factor=False)
    parser.set_defaults(size=(16, 16))
    return parser


def run(given: Namespace) -> int:
    """Save the unfolded cube of a light, and print what its cells have; raises SceneError and ValueError in one line,
    or Cancelled."""
    check_scene_file(given.path)
    check_writable(given.output)
    settings = options.tracing_settings(given, method="lightbuffer", light_buffer_side=given.side)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        if not given.light < len(scene.lights):
            raise ValueError(f"--light {given.light}: {lights_in_words(len(scene.lights))}")
        time = options.moment(scene, given)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        renderer = Renderer(scene, settings, work.progress)
        frame = renderer.render(time, None, work.cancelled)
        method = renderer.state.method("lightbuffer")
        assert isinstance(method, LightBuffer)
        found = method.cube_of(given.light)
    if found is None:
        why = method.why_not(given.light) or "there is nothing static"
        raise ValueError(f"--light {given.light} has no light buffer, and its shadow rays are traced: {why}")
    light = named_light(scene.lights, given.light)
    Image.fromarray(picture_of(found, "" if given.no_legend else light)).save(given.output)
    counts = seen(found).counts
    table = titled(f"{given.path.name}, {light}, {time:.3f} s")
    table.add_column("cells of its cube")
    table.add_column("", justify="right")
    for name, number in counts.items():
        table.add_row(name, f"{number / sum(counts.values()):.1%}")
    table.add_row("memory", f"{found.bytes / 1e6:.1f} MB")
    table.add_row("building, all lights", f"{1e3 * frame.statistics.phases['certification']:.0f} ms")
    print_table(table)
    print(printable(given.output))
    return 0

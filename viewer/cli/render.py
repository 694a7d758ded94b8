"""The command `render`: one frame of a scene into a picture, its buffers, or both.

Whatever can be known to fail is found out before the tracing: the size, the frame, the camera, and whether the files
can be written.
"""

from __future__ import annotations

import shlex
from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tracer.frame import Frame, Settings
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file
from tracer.scene.model import Scene
from tracer.statistics import FrameStatistics
from viewer.cli import options, pictures
from viewer.cli.arguments import Parser, count
from viewer.cli.console import Work, print_table, titled, working
from viewer.output import capture, commands, exr, figure1_drawing, other_programs
from viewer.output.exr import buffers
from viewer.services import stills
from viewer.services.refinement import has_lamps
from viewer.state import terms, verified
from viewer.state.readings import MOST_RECORDED
from viewer.state.view_state import ViewState
from viewer.util.files import check_writable, write_whole
from viewer.util.messages import printable, say

PICTURES = (*capture.KINDS, exr.ENDING)
BYTES_OF_A_LIGHT = 7  # of a pixel: samples asked and reached in 2 each, lit, due and shadow_mode in 1 each

EPILOG = """\
examples:
  shadowcull render -o room.png
  shadowcull render kitchen.aff -o soft.png --frame 100 --samples 16 --lamp-radius 0.1 --lamp-samples 64
  shadowcull render kitchen.aff -o bright.png --exposure 1 --white 4 --tone filmic
  shadowcull render kitchen.aff -o modes.png --frame 50 --warmup 20 --view shadow:2 --legend
  shadowcull render kitchen.aff -o cells.png --frame 50 --warmup 20 --method certified --view certificate:0
  shadowcull render kitchen.aff --frame 50 --warmup 20 --figure1 kitchen.svg
  shadowcull render Robot.aff --frame 10 --warmup 10 --buffers robot.npz
  shadowcull render Robot.aff -o robot.exr --frame 10 --warmup 10 --verify
  shadowcull render saved.png --samples 16 --size 1920x1080
  shadowcull render state.json --view cost
  shadowcull render kitchen.aff -o same.png --camera saved.png
  shadowcull render bunny.ply -o bunny.png --camera '{"position": [0, 1, 3], "direction": [0, 0, -1], "angle": 40}'

Culling uses what earlier frames have shown: --warmup N first traces the N frames before the one that is rendered.

A picture saved by the window or by render carries its scene, camera, time, settings and view. Given instead of SCENE,
it is rendered again, and options replace what it carries. Without -o the result is NAME-rendered.png. So is a
state as JSON.

The .npz holds color (H,W,3 float32), depth (H,W float32, distance along the unit ray, inf for a miss), primitive and
cell (H,W int32, -1 for a miss), occlusion_mode (H,W uint8, 255 for a miss), shadow_mode (H,W,lights uint8), and for
each light and primary hit lit and due (H,W,lights bool); with --verify also reference (H,W,3 float32), the colour
with every shadow answer right, and wrong (H,W int32), the number of wrong shadow answers of each pixel. The method
certified adds certificate (H,W,lights uint8: 0 none, 1 full shadow, 2 lit, 3 candidates), and the views saved and
cost add arrays of their names (H,W int32). An .exr holds the same as channels; it needs OpenEXR (install
shadowcull[exr]).

The views difference and wipe verify by themselves: wrong pixels, and the traced picture beside the correct one.
"""


def parser() -> Parser:
    description = "Trace one frame, print its statistics, and write it as a picture, as buffers, or as a figure."
    parser = Parser("render", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_scene(parser, ", or a saved picture or a state as .json, to render it again")
    help_ = "the picture; a .png also remembers how it was made, and an .exr has all buffers"
    add("-o", "--output", type=Path, metavar="FILE", help=help_)
    options.add_moment(parser)
    pictures.add_picture(parser)
    options.add_history(parser)
    add("--repeat", type=count(0, 1000), default=0, metavar="N", help="then trace the frame itself N times")
    add("--print-command", action="store_true", help="print the whole command for this picture, and trace nothing")
    help_ = "show the frame and its buffers in tev or HDRView, which is open there"
    add("--to-tev", type=other_programs.address, metavar="HOST:PORT", help=help_)
    add("--half", action="store_true", help="colours and normals of an .exr with 16 bits, not 32")
    add("--buffers", type=Path, metavar="FILE.npz", help="what was found at each pixel, as arrays; see below")
    help_ = "the paper's Figure 1 with the numbers of this frame, for slides"
    add("--figure1", type=Path, metavar="FILE.svg", help=help_)
    options.add_tracing(parser)
    options.add_settings(parser, Settings, "verify")
    return parser


def run(given: Namespace) -> int:
    """Trace one frame and write it; raises SceneError, ValueError and OSError in one line, or Cancelled."""
    check_scene_file(given.path)
    view = given.view.view
    as_exr = given.output is not None and given.output.suffix.lower() == exr.ENDING
    everything = given.buffers is not None or as_exr or given.to_tev is not None
    if as_exr:
        exr.check()
    if not given.print_command:
        _check_outputs(given)
    settings = pictures.picture_settings(given)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        wanted = stills.with_caption_filled(pictures.wanted_state(scene, settings, given), scene)
        if given.print_command:
            words = commands.words(wanted, scene, str(given.output or f"{given.path.stem}.png"), given.folder)
            print(shlex.join(["shadowcull", *words]))
            return 0
        pictures.check_tree(settings, view, scene)
        if not stills.lights_fit(wanted, scene, everything):
            raise ValueError(_too_many_lights(given, settings.width * settings.height, len(scene.lights)))
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        renderer = Renderer(scene, replace(settings, verify=False), work.progress)
        modes = given.figure1 is not None and not Method.parse(settings.method).culls  # it says what they would do
        traced = replace(wanted, settings=replace(wanted.settings, modes=True)) if modes else wanted
        frame = _traced(renderer, traced, everything, work)
        work.progress("writing", 1.0)
        if as_exr:
            exr.write(given.output, frame, stills.text(frame.pixels, frame, scene, wanted), given.half)
        elif given.output is not None:
            write_picture(given.output, scene, frame, wanted)
        if given.buffers is not None:
            arrays: dict[str, Any] = buffers(frame)
            write_whole(given.buffers, lambda file: np.savez(file, **arrays))
        if given.figure1 is not None:
            figure1_drawing.write_svg(given.figure1, frame, scene)
        if given.to_tev is not None:
            other_programs.send(given.to_tev, f"{scene.path.stem} {wanted.time:g} s {settings.method}", frame)
    title = f"{given.path.name}, {wanted.time:.3f} s, {frame.width} × {frame.height}, method {settings.method}"
    by_beams = terms.asks_by_beams(frame, has_lamps(scene.lights, frame.settings))
    remarks = " ".join(filter(None, (terms.BY_BEAMS if by_beams else "", _first(wanted))))
    print_table(_statistics_table(frame.statistics, title, frame.settings, remarks))
    for written in (given.output, given.buffers, given.figure1):
        if written is not None:
            print(printable(written))
    return 0


def _first(wanted: ViewState) -> str:
    """Say why a method that culls by what earlier frames have shown has culled nothing, where there were none."""
    method = wanted.settings.method
    if wanted.warmup.frames or wanted.warmup.of_path or wanted.warmup.repeats or not Method.parse(method).uses_modes:
        return ""
    return f"{method} culls by what earlier frames have shown, and this is the first: give --warmup N, or --repeat N."


def _traced(renderer: Renderer, wanted: ViewState, everything: bool, work: Work) -> Frame:
    options.warmup_times(renderer.scene, wanted.time, wanted.warmup.of_path, work)
    settings = wanted.settings

    def show(done: int, frames: int) -> None:
        label = f"warming up, frame {done + 1} of {frames - 1}"
        if done == frames - 1:
            label = f"tracing {settings.width} × {settings.height}"
        work.count(label, done, frames - 1 + settings.samples)

    return stills.trace(renderer, wanted, everything, show, work.cancelled)


def _too_many_lights(given: Namespace, pixels: int, lights: int) -> str:
    view = given.view.view
    option = f"--view {view.value}" if given.buffers is None and view.needs_lights else "--buffers"
    needed, most = (BYTES_OF_A_LIGHT * n / 1e9 for n in (pixels * lights, MOST_RECORDED))
    return (
        f"{option}: {lights:,} lights at {pixels:,} pixels take {needed:.1f} GB, {most:.1f} GB at most; "
        f"give a smaller --size, of up to {MOST_RECORDED // lights:,} pixels"
    )


def _check_outputs(given: Namespace) -> None:
    files = given.output, given.buffers, given.figure1
    if not any(files) and given.to_tev is None:
        raise ValueError("render: nothing to write; give -o out.png, --buffers out.npz, --figure1 out.svg, or several")
    output, npz, figure = files
    if output is not None and output.suffix.lower() not in PICTURES:
        raise ValueError(f"{output}: unknown kind of picture; give one of {' '.join(PICTURES)}")
    if npz is not None and npz.suffix.lower() != ".npz":
        raise ValueError(f"{npz}: --buffers writes a .npz")
    if figure is not None and figure.suffix.lower() != ".svg":
        raise ValueError(f"{figure}: --figure1 writes a .svg")
    for path in filter(None, files):
        check_writable(path)


def write_picture(path: Path, scene: Scene, frame: Frame, wanted: ViewState) -> None:
    """Write the frame as its state draws it; a PNG remembers, as the window's captures do, how it was made."""
    pixels, missing = stills.draw(frame, scene, wanted)
    if missing:
        say(missing)
    capture.write(path, pixels, stills.text(pixels, frame, scene, wanted))


def _statistics_table(statistics: FrameStatistics, title: str, settings: Settings, remarks: str) -> Table:
    """Show the counters of a frame, primary, secondary and shadow rays apart, and what is wrong where it was
    verified."""
    table = titled(title, "\n".join(filter(None, (statistics.decision, remarks))))
    table.add_column("")
    for name in ("primary", "secondary", "shadow"):
        table.add_column(name, justify="right")
    kinds = (statistics.primary, statistics.secondary, statistics.shadow)
    traced = (statistics.primary.rays, statistics.secondary.rays, statistics.shadow.traced)
    table.add_row("rays traced", *(f"{rays:,}" for rays in traced))
    table.add_row("traversal steps", *(f"{kind.traversal_steps:,}" for kind in kinds))
    table.add_row("intersection tests", *(f"{kind.intersection_tests:,}" for kind in kinds), end_section=True)
    shadow = statistics.shadow

    def add(name: str, rays: int, share: str | None = None) -> None:
        table.add_row(name, f"{rays / max(shadow.due, 1):.1%}" if share is None else share, "", f"{rays:,}")

    add(f"shadow rays {terms.DUE}", shadow.due, "")
    add(f"  {terms.SAVED}", shadow.saved)
    add(f"    {terms.CULLED}", shadow.culled)
    add(f"    {terms.DYNAMIC_ONLY}", shadow.dynamic_only)
    for name, rays in ((terms.CANDIDATES_ONLY, shadow.candidates_only), (terms.CACHE_HITS, shadow.cache_hits)):
        if rays:
            add(f"  {name}", rays)
    add(f"  {terms.TRACED}", shadow.traced)
    if (wrong := statistics.wrong) is not None:
        if statistics.cuts is None:
            share = f"{wrong.answers / max(wrong.due, 1):.3%}"
            add(verified.named(terms.WRONG, wrong), wrong.answers, share)
        name = verified.named(terms.WRONG_PIXELS if statistics.cuts is None else terms.BEYOND, wrong)
        add(name, wrong.pixels, f"{wrong.pixels / max(wrong.shaded, 1):.3%}")
    if shadow.passed_over:
        add(f"samples {terms.PASSED_OVER}", shadow.passed_over, "")
    if statistics.certificates and terms.made(settings.method)[0]:
        add(terms.made(settings.method)[0], statistics.certificates, "")
        add("  traversal steps", statistics.certificate_steps, "")
        add("  intersection tests", statistics.certificate_tests, "")
    table.add_row("occlusion tests", f"{statistics.occlusion_tests:,}", "", "", end_section=True)
    for name, seconds in statistics.phases.items():
        table.add_row(terms.phase(name, settings)[0], f"{1000.0 * seconds:,.1f} ms", "", "")
    table.add_row("frame", f"{1000.0 * statistics.seconds:,.1f} ms", "", "")
    return table

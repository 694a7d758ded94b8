"""The command `render`: one frame of a scene into a picture, its buffers, or both.

Whatever can be known to fail is found out before the tracing: the size, the frame, the camera, and whether the files
can be written.
"""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tracer.frame import Frame, Settings
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file
from tracer.util.text import printable, shell_line
from viewer.cli import options, pictures
from viewer.cli.arguments import Parser, count
from viewer.cli.console import print_table, titled, working
from viewer.output import capture, commands, exr, figure1_drawing, other_programs
from viewer.output.exr import buffers
from viewer.services import stills
from viewer.services.refinement import has_lamps
from viewer.state import terms
from viewer.state.frame_rows import rows
from viewer.state.view_state import ViewState
from viewer.util.files import check_writable, write_whole

PICTURES = (*capture.KINDS, exr.ENDING)
EPILOG = """\
examples:
  shadowcull render -o room.png
  shadowcull render kitchen.aff -o soft.png --frame 100 --samples 16 --lamp-radius 0.1 --lamp-samples 64
  shadowcull render kitchen.aff -o bright.png --exposure 1 --white 4 --tone filmic
  shadowcull render kitchen.aff -o modes.png --frame 50 --warmup 20 --view shadow:2 --legend
  shadowcull render kitchen.aff -o cells.png --frame 50 --warmup 20 --method certified --view certificate:0
  shadowcull render kitchen.aff --frame 50 --warmup 20 --figure1 kitchen.svg
  shadowcull render Robot.aff -o robot.exr --buffers robot.npz --frame 10 --warmup 10 --verify
  shadowcull render saved.png --samples 16 --size 1920x1080
  shadowcull render kitchen.aff -o same.png --camera saved.png
  shadowcull render bunny.ply -o bunny.png --camera '{"position": [0, 1, 3], "direction": [0, 0, -1], "angle": 40}'

Culling uses what earlier frames have shown: --warmup N first traces the N frames before the one that is rendered.

A picture saved by the window or by render carries its scene, camera, time, settings and view. Given instead of SCENE,
it is rendered again, as is a state as JSON, and options replace what it carries. Without -o the result is
NAME-rendered.png.

The .npz holds color, depth (along the unit ray, inf for a miss), primitive and cell (-1 for a miss), occlusion_mode,
shadow_mode (255 for a miss), and for each light and primary hit lit and due; with --verify also reference, the colour
with every shadow answer right, and wrong, the number of wrong answers of each pixel; certificate, saved and cost with
the method and the views of these names. An .exr holds the same as channels; it needs OpenEXR (install
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
    help_ = "show the frame and its buffers in tev or HDRView, which listens there"
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
    as_exr = given.output is not None and given.output.suffix.lower() == exr.ENDING
    everything = given.buffers is not None or as_exr or given.to_tev is not None
    if as_exr:
        exr.check()
    if not given.print_command:
        _check_outputs(given)
    settings = pictures.picture_settings(given)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        wanted = stills.with_caption_filled(pictures.wanted_state(scene, settings, given, everything), scene)
        if given.print_command:
            words = commands.words(wanted, scene, str(given.output or f"{given.path.stem}.png"), given.folder)
            print(shell_line(["shadowcull", *words]))
            return 0
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method)
        renderer = Renderer(scene, replace(settings, verify=False), work.progress)
        modes = given.figure1 is not None and not Method.parse(settings.method).culls  # it says what they would do
        traced = replace(wanted, settings=replace(wanted.settings, modes=True)) if modes else wanted
        options.warmup_times(scene, wanted.time, wanted.warmup.of_path, work)

        def show(done: int, frames: int) -> None:
            last = f"tracing {settings.width} × {settings.height}"
            label = last if done == frames - 1 else f"warming up, frame {done + 1} of {frames - 1}"
            work.count(label, done, frames - 1 + settings.samples)

        frame = stills.trace(renderer, traced, everything, show, work.cancelled)
        work.progress("writing", 1.0)
        if as_exr:
            exr.write(given.output, frame, stills.text(frame.pixels, frame, scene, wanted), given.half)
        elif given.output is not None:
            pixels, missing = stills.draw(frame, scene, wanted)
            if missing:
                work.note(missing)
            capture.write(given.output, pixels, stills.text(pixels, frame, scene, wanted))
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
    print_table(_statistics_table(frame, title, remarks))
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


def _check_outputs(given: Namespace) -> None:
    files = given.output, given.buffers, given.figure1
    if not any(files) and given.to_tev is None:
        raise ValueError("render: nothing to write; give -o out.png, --buffers out.npz, --figure1 out.svg, or several")
    for path, option, endings in zip(files, ("-o", "--buffers", "--figure1"), (PICTURES, (".npz",), (".svg",))):
        if path is not None and path.suffix.lower() not in endings:
            raise ValueError(f"{path}: unknown kind of file; {option} writes {' '.join(endings)}")
    for path in filter(None, files):
        check_writable(path)


def _statistics_table(frame: Frame, title: str, remarks: str) -> Table:
    """Show the numbers of a frame, as the panel Statistics does."""
    table = titled(title, "\n".join(filter(None, (frame.statistics.decision, remarks))))
    for justify in ("left", "right", "right"):
        table.add_column("", justify=justify)  # type: ignore[arg-type]
    table.show_header = False
    for group, found in groupby(rows(frame), lambda row: row.group):
        table.add_row(group, style="bold")
        for row in found:
            table.add_row(row.name, row.text(row.number), row.share)
        table.add_section()
    return table

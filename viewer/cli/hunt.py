"""The command `hunt`: the worst wrong pixels of a method along a path, and beside it.

Ctrl-C ends it after the last whole picture: what was found is shown, and written where it was to go.
"""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from tracer.experiments import hunt
from tracer.experiments.camera_path import along_path
from tracer.experiments.hunt import Hunt, Search
from tracer.experiments.titles import title
from tracer.geometry.world import World
from tracer.scene.load import check_scene_file
from tracer.scene.model import Cancelled, Scene
from tracer.util.text import printable
from viewer.cli import arguments, options
from viewer.cli.arguments import INTERRUPTED, Parser
from viewer.cli.console import Work, listed, print_table, working
from viewer.output import exports
from viewer.output.findings import comparison_of, save_json
from viewer.output.reports import findings
from viewer.services import stills
from viewer.state.methods import NO_CULLING
from viewer.state.plans import HuntPlan
from viewer.util.files import take_folder

ALL = "hunt.json"
"""What holds all findings; each has a figure and a JSON of its own beside it."""
EPILOG = """\
examples:
  shadowcull hunt kitchen.aff --frames 0-99 --size 256x256 --output wrong
  shadowcull hunt kitchen.aff --method paper --step 10 --around 100 --radius 0.5 --seed 7
  shadowcull hunt default --method certified --around 50
  shadowcull check wrong/*.png
  shadowcull explain kitchen.aff --frame 12 --size 256x256 --pixel 147,125 --before '[[0, null]]' --only wrong

Every culled shadow ray is verified. Wrong pixels are ranked by how far their colour is from the right one,
and of each primitive and light the worst is kept, with the fewest frames before it that make the pixel just as wrong.
--output writes for each a figure, which `shadowcull check` draws again, and a JSON, which --before of render, figure
and explain takes. Ctrl-C keeps what was found; the exit code is then 130.
"""


def parser() -> Parser:
    description = "Search a path of frames, and pictures beside it, for the worst wrong pixels of a method."
    parser = Parser("hunt", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_scene(parser)
    help_ = f"whose wrong pixels: {options.METHODS} (default: paper)"
    add("--method", type=arguments.method, default="paper", metavar="METHOD", help=help_)
    help_ = "the frames A to B of the path, or one (default: all)"
    add("--frames", type=arguments.frame_span, metavar="A-B", help=help_)
    help_ = f"stand still, and let time pass: {options.CAMERA}"
    add("--camera", type=arguments.camera, metavar="JSON", help=help_)
    options.add_settings(parser, HuntPlan, "step", "around", "radius", "seed", "keep", around=0)
    options.add_size(parser)
    help_ = "a folder for a figure and a JSON of each finding, and for hunt.json"
    add("-o", "--output", type=Path, metavar="DIR", help=help_)
    options.add_tracing(parser)
    return parser


def run(given: Namespace) -> int:
    """Hunt, print what was found, and write it.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no picture was finished."""
    check_scene_file(given.path)
    settings = options.tracing_settings(given, verify=True)
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        first, last = given.frames or (0, scene.frames - 1)
        times = [take.time for take in along_path(scene, first, last)][:: given.step]
        search = Search(settings, times, given.camera, given.around, given.radius, given.seed, given.keep)
        if given.output is not None:
            take_folder(given.output, lambda path: path.name == ALL or path.match("find-*.*"))
        options.prepare_kernels(work, len(scene.lights), given.accelerator, settings.method, NO_CULLING)
        world = World(scene, times[0], settings.accelerator, work.progress)
        found = work.perform(Hunt(scene, search), world)
        written = _write(found, scene, search, world, given, work) if given.output is not None else []
    if found.finds:
        heading, caption = f"{title(found)}: the worst wrong pixels", "off by: of the colour, of 1; light: (+ others)"
        print_table(listed(findings(scene, found.finds), found.finds, heading, caption))
    print(printable(found.summary))
    for file in written:
        print(printable(file))
    return INTERRUPTED if work.stopped else 0  # also where figures were not drawn


def _write(found: hunt.Results, scene: Scene, search: Search, world: World, given: Namespace, work: Work) -> list[Path]:
    """Write the files of all findings; once it was stopped the JSON alone, as figures take long."""
    written, meshes = [], options.mesh_options(given).of_file(Path(scene.path))
    for rank, find in enumerate(found.finds, 1):
        stem = given.output / f"find-{rank}"
        state, figure = comparison_of(find, found, scene, search.settings, meshes)
        save_json(find, found, scene, state, stem.with_suffix(".json"))
        if not work.stopped:
            work.count(f"figure {rank} of {len(found.finds)}", rank - 1, len(found.finds))
            try:
                shown = stills.trace_methods(scene, state, figure, world, cancelled=work.cancelled)
                stills.save_methods(shown, stem.with_suffix(".png"))
                written.append(stem.with_suffix(".png"))
            except Cancelled:
                work.note("cancelled: the figures from here on are not drawn")
        written.append(stem.with_suffix(".json"))
    exports.write_json(given.output / ALL, found.to_dict(scene))
    return [*written, given.output / ALL]

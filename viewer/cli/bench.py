"""The command `bench`: a path of frames by several methods, as the paper's Table 1.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from rich.table import Table

from tracer.experiments import experiment
from tracer.experiments.experiment import REFERENCE, Experiment, Results
from tracer.experiments.titles import title
from tracer.geometry.world import World
from tracer.method import line_up
from tracer.scene.load import check_scene_file
from tracer.settings import Settings
from viewer.cli import arguments, options
from viewer.cli.arguments import INTERRUPTED, Parser, count
from viewer.cli.console import columns_help, fitted, listed, print_table, terminal_width, working
from viewer.output import exports
from viewer.output.reports import METHOD, TABLE_1, caveats, table_1

ALL = "all"  # methods that are worth comparing in the scene
EPILOG = f"""\
examples:
  shadowcull bench kitchen.aff --path-frames 100
  shadowcull bench Robot.aff --frames 100:200 --size 256x256 --verify
  shadowcull bench kitchen.aff --path-frames 100 --methods paper,cells,certified,certified+cache
  shadowcull bench default --methods none,paper --symmetric --json default.json --csv default.csv
  shadowcull bench kitchen.aff --path-frames 100 --verify --plot kitchen.svg

Savings compare the work of shadow rays with that of the method none, averaged over frames, as in the paper's Table 1.
Ctrl-C keeps the finished frames, in the table and in the files; the exit code is then 130, and a second Ctrl-C ends
it at once. The JSON holds every figure of every frame, the CSV is the table, and the plot shows the savings of each
frame, their average and maximum, and with --verify the wrong answers.

{columns_help(TABLE_1)}"""


def parser() -> Parser:
    description = "Render a path of frames by several methods and print what each saves, as the paper's Table 1."
    parser = Parser("bench", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_scene(parser)
    help_ = (
        f"which methods: {options.METHODS}; none is always measured too; or all, for those that are worth "
        "comparing in the scene (default: paper)"
    )
    add("--methods", type=arguments.methods_or_all, default=["paper"], metavar="METHOD,...", help=help_)
    add("--path-frames", type=count(1, 1_000_000), metavar="N", help="resample the animation to N frames")
    add("--frames", metavar="A:B", help="the frames A to B - 1 of the path; either may be left out (default: all)")
    options.add_size(parser)
    options.add_settings(parser, Settings, "verify")
    add("--json", type=Path, metavar="FILE", help="every figure of every frame")
    add("--csv", type=Path, metavar="FILE", help="the table")
    add("--plot", type=Path, metavar="FILE", help="savings per frame, drawn for a slide: a .png, .svg or .pdf")
    options.add_tracing(parser, "kdtree")  # whose steps are the paper's
    return parser


def run(given: Namespace) -> int:
    """Run an experiment, print its table and write its files.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished."""
    check_scene_file(given.path)
    settings = options.tracing_settings(given)
    methods = experiment.with_reference([method for method in given.methods if method != ALL])
    wanted = exports.wanted_files(given)
    if "plot" in wanted and methods == [REFERENCE] and ALL not in given.methods:
        raise ValueError(f"--plot: nothing to compare with {REFERENCE}; give another of --methods")
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        if ALL in given.methods:  # and those that are named besides
            methods = experiment.with_reference([*line_up(len(scene.lights)), *methods])
        times = experiment.path_times(scene, given.path_frames)
        numbers = frame_range(given.frames or ":", len(times))
        options.prepare_kernels(work, len(scene.lights), given.accelerator, *methods)
        world = World(scene, times[0], settings.accelerator, work.progress)
        measured = Experiment(scene, settings, methods, times, numbers)
        results = work.perform(measured, world)
        failures = exports.write_files(results, wanted)
    print_table(bench_table(results, terminal_width()))
    if failures:
        raise OSError("; ".join(failures))
    return 0 if measured.whole else INTERRUPTED


def frame_range(text: str, count: int) -> range:
    """Read `A:B`, the frames A to B - 1 of a path of `count`; either may be left out."""
    first, colon, last = text.partition(":")
    try:
        numbers = range(int(first or 0), int(last or count))
    except ValueError:
        numbers = range(0)
    if not colon or not numbers or not 0 <= numbers.start < numbers.stop <= count:
        raise ValueError(f"--frames {text}: give A:B, the frames A to B - 1 of the {count} there are")
    return numbers


def bench_table(results: Results, width: int | None) -> Table:
    """Make the table for a terminal so wide; None for any width."""
    rows, heading = experiment.table(results), f"Work of shadow rays\n{title(results)}"
    columns, said = [METHOD, *table_1(results)], [*caveats(results), "--csv FILE has all figures"]
    return fitted(columns, lambda some: [listed(some, rows, heading, "; ".join(said))], width)[0]

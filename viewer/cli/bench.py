"""The command `bench`: a path of frames by several methods, as the paper's Table 1, or under several kinds of lamps.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import Any

from rich.table import Table

from tracer.experiments import experiment, lamp_experiment
from tracer.experiments.experiment import REFERENCE, Experiment, Results
from tracer.experiments.lamp_experiment import CEILING, LampExperiment, LampResults
from tracer.experiments.runner import Run
from tracer.geometry.world import World
from tracer.method import line_up
from tracer.scene.load import check_scene_file
from tracer.settings import Settings
from viewer.cli import arguments, options
from viewer.cli.arguments import INTERRUPTED, Parser, count
from viewer.cli.console import columns_help, fitted, listed, print_table, terminal_width, titled, width_of, working
from viewer.output import exports
from viewer.output.reports import LAMPS, METHOD, TABLE_1, caveats, lamps_in_words, table_1, title
from viewer.state import terms

ALL = "all"  # methods that are worth comparing in the scene
EPILOG = f"""\
examples:
  shadowcull bench kitchen.aff --path-frames 100
  shadowcull bench Robot.aff --frames 100-199 --size 256x256 --verify
  shadowcull bench kitchen.aff --path-frames 100 --methods paper,cells,certified,certified+cache
  shadowcull bench kitchen.aff --path-frames 100 --lamp-radius 0.03,0.1 --lamp-samples 16,64 --accelerator bvh8
  shadowcull bench default --methods none,paper --symmetric --json default.json --csv default.csv
  shadowcull bench kitchen.aff --path-frames 100 --verify --plot kitchen.svg

Savings compare the work of shadow rays with that of the method none, averaged over frames, as in the paper's Table 1.
Ctrl-C keeps the finished frames, in the table and in the files; the exit code is then 130, and a second Ctrl-C ends
it at once. The JSON holds every figure of every frame, the CSV is the table, and the plot shows the savings of each
frame, their average and maximum, and with --verify the wrong answers.

Several values of --lamp-radius or --lamp-samples make another table: for each radius, number of samples and method
the time of a frame, its shadow rays, the speed-up over none, and how much that is of the speed-up of free, for which
shadow rays cost nothing. The JSON then has the figures of all lamps under "lamps".

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
    help_ = "the frames A to B of the path, or one (default: all)"
    add("--frames", type=arguments.frame_span, metavar="A-B", help=help_)
    options.add_size(parser)
    options.add_settings(parser, Settings, "verify")
    add("--json", type=Path, metavar="FILE", help="every figure of every frame")
    add("--csv", type=Path, metavar="FILE", help="the table")
    add("--plot", type=Path, metavar="FILE", help="savings per frame, drawn for a slide: a .png, .svg or .pdf")
    options.add_tracing(parser, "kdtree", many_lamps=True)  # whose steps are the paper's
    return parser


def run(given: Namespace) -> int:
    """Run an experiment, print its table and write its files.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished."""
    check_scene_file(given.path)
    radii, samples = given.lamp_radius or [None], given.lamp_samples or [None]
    settings = options.tracing_settings(given, lamp_radius=radii[0], lamp_samples=samples[0])
    methods = experiment.with_reference([method for method in given.methods if method != ALL])
    wanted = exports.wanted_files(given)
    by_lamps = len(radii) * len(samples) > 1
    if "plot" in wanted and methods == [REFERENCE] and ALL not in given.methods:
        raise ValueError(f"--plot: nothing to compare with {REFERENCE}; give another of --methods")
    if "plot" in wanted and by_lamps:
        raise ValueError("--plot: it draws one kind of lamps; give one --lamp-radius and one --lamp-samples")
    with working() as work:
        scene = options.read_scene(given.path, given, work)
        if ALL in given.methods:  # and those that are named besides
            methods = experiment.with_reference([*line_up(len(scene.lights)), *methods])
        times = experiment.path_times(scene, given.path_frames)
        first, last = given.frames or (0, len(times) - 1)
        if last >= len(times):
            raise ValueError(f"--frames {first}-{last}: the path has {len(times)} frames, counted from 0")
        numbers = range(first, last + 1)
        options.prepare_kernels(work, len(scene.lights), given.accelerator, *methods)
        world = World(scene, times[0], settings.accelerator, work.progress)
        measured: Run[Any]
        if by_lamps:
            kinds = lamp_experiment.kinds_of_lamps(scene, radii, samples)
            measured = LampExperiment(scene, settings, methods, kinds, times, numbers)
        else:
            measured = Experiment(scene, settings, methods, times, numbers)
        results: Any = work.perform(measured, world)  # type: ignore[misc]
        failures = exports.write_files(results, wanted)
    if isinstance(results, LampResults):
        print_table(lamp_table(results, terminal_width()))
    else:
        print_table(bench_table(results, given.verify, terminal_width()))
    if failures:
        raise OSError("; ".join(failures))
    return 0 if measured.whole else INTERRUPTED


MOST_COLUMNS = 5
"""Methods that have columns, at most; more have lines."""


def bench_table(results: Results, verified: bool, width: int | None) -> Table:
    """Make the table for a terminal so wide; None for any width."""
    rows, columns = experiment.table(results), table_1(verified)
    heading = f"Work of shadow rays\n{title(results)}"
    caption = "; ".join([*caveats(results), *([] if verified else ["--verify counts wrong answers"])])
    if len(rows) <= MOST_COLUMNS:
        table = titled(heading, caption)
        table.add_column("")
        for row in rows:
            table.add_column(row.method.replace("+", "\n+"), justify="right")
        for column in columns:
            table.add_row(column.meaning, *(column.cell(row) for row in rows))
        if width is None or width_of(table) <= width:
            return table
    caption += "; --csv FILE has all figures"
    return fitted([METHOD, *columns], lambda some: [listed(some, rows, heading, caption)], width)[0]


def lamp_table(results: LampResults, width: int | None) -> Table:
    """Make a table with a row for each method under each kind of lamps, as `bench_table`."""
    heading = f"What culling is worth under lamps\n{title(results.runs[0])}"
    caption = "\n".join((
        f"shadow rays: due per frame; speed-up: over {REFERENCE}, all frames; {CEILING}: shadow rays cost nothing",
        f"saved: shadow rays {terms.MEANINGS[terms.SAVED]}; --csv FILE has all figures",
    ))  # fmt: skip
    rows = lamp_experiment.table(results)
    return fitted(LAMPS, lambda some: [listed(some, rows, heading, caption, lamps_in_words)], width, least=5)[0]

"""The command `bench`: a path of frames by several methods, as the paper's Table 1, or under several kinds of lamps.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Sequence
from pathlib import Path

from rich.table import Table

from tracer.experiments import experiment, lamp_experiment
from tracer.experiments.experiment import REFERENCE, Experiment, Results, Row
from tracer.experiments.lamp_experiment import CEILING, LampExperiment, LampResults, LampRow
from tracer.geometry.world import World
from tracer.method import line_up
from tracer.scene.load import check_scene_file
from tracer.settings import Settings
from viewer.cli import arguments, options
from viewer.cli.arguments import INTERRUPTED, Parser, count
from viewer.cli.console import left_out, named, print_table, terminal_width, titled, width_of, working
from viewer.output import exports
from viewer.output.reports import SPEED_UP, WRONG, caveats, frames_in_words, leaders, lines
from viewer.state import terms
from viewer.util.messages import printable

ALL = "all"  # methods that are worth comparing in the scene
EPILOG = """\
examples:
  shadowcull bench kitchen.aff --path-frames 100
  shadowcull bench Robot.aff --frames 100:200 --size 256x256 --verify
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
"""


def parser() -> Parser:
    description = "Render a path of frames by several methods and print what each saves, as the paper's Table 1."
    parser = Parser("bench", description, EPILOG + options.method_summaries())
    add = parser.add_argument
    options.add_scene(parser)
    help_ = (
        f"which methods: {options.METHODS}; none is always measured too; or all, for those that are worth "
        "comparing in the scene (default: paper)"
    )
    add("--methods", type=arguments.methods_or_all, default=["paper"], metavar="M,...", help=help_)
    add("--path-frames", type=count(1, 1_000_000), metavar="N", help="resample the animation to N frames")
    add("--frames", metavar="A:B", help="only the frames A to B - 1 of the path")
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
        numbers = frame_range(given.frames, len(times))
        options.prepare_kernels(work, len(scene.lights), given.accelerator, *methods)
        world = World(scene, times[0], settings.accelerator, work.progress)
        if by_lamps:
            kinds = lamp_experiment.kinds_of_lamps(scene, radii, samples)
            lamps = work.perform(LampExperiment(scene, settings, methods, kinds, times, numbers), world)
            finished = len(lamps.runs) == len(kinds) and len(lamps.runs[-1].frames) == len(numbers)
            cancelled = f"in lamps {len(lamps.runs)} of {len(kinds)}; the table is of the frames that are done"
        else:
            results = work.perform(Experiment(scene, settings, methods, times, numbers), world)
            finished = len(results.frames) == len(numbers)
            cancelled = f"after {len(results.frames)} of {len(numbers)} frames; the table is of these"
        if not finished:
            work.note(f"cancelled {cancelled}")
        failures = exports.write_files(lamps if by_lamps else results, wanted)
    if by_lamps:
        print_table(lamp_table(lamps, terminal_width()))
    else:
        print_table(bench_table(results, given.verify, terminal_width()))
        for line in leaders(experiment.table(results), timed=not given.verify):
            print(line)
    if failures:
        raise OSError("; ".join(failures))
    return 0 if finished else INTERRUPTED


def frame_range(text: str | None, count: int) -> range:
    """Read `A:B`, the frames A to B - 1 of a path of `count`; either may be left out."""
    if text is None:
        return range(count)
    first, colon, last = text.partition(":")
    try:
        numbers = range(int(first or 0), int(last or count))
    except ValueError:
        numbers = range(0)
    if not colon or not numbers or not 0 <= numbers.start < numbers.stop <= count:
        raise ValueError(f"--frames {text}: give A:B, the frames A to B - 1 of the {count} there are")
    return numbers


# --- tables ----------------------------------------------------------------------------------------

MOST_COLUMNS = 5
"""Methods that have columns, at most; more have lines."""
# What columns are called where methods have lines; the other figures are left to the files.
COLUMNS = {
    "traversal steps saved, average": "steps\nsaved",
    "intersection tests saved, average": "tests\nsaved",
    WRONG: "wrong",
    "time of a frame, median": "a frame",
    "time of all frames": "all\nframes",
    "  of it preparing": "preparing",
    SPEED_UP: "speed-\nup",
    "memory of the method": "memory",
}
_LEAST_WANTED = ("preparing", "all\nframes", "memory", "a frame", "tests\nsaved", "wrong")
"""Columns that are left out, one after another, where there is no room for all."""


def bench_table(results: Results, verified: bool, width: int | None) -> Table:
    """Make the table for a terminal so wide; None for any width."""
    rows = experiment.table(results)
    if len(rows) <= MOST_COLUMNS:
        table = _begun(results, verified)
        table.add_column("")
        for row in rows:
            table.add_column(row.method.replace("+", "\n+"), justify="right")
        for heading, cell in lines(verified):
            table.add_row(heading, *(cell(row) for row in rows))
        if width is None or width_of(table) <= width:
            return table
    left = left_out(_LEAST_WANTED, lambda left: [_by_lines(results, rows, verified, left)], width)
    return _by_lines(results, rows, verified, left)


def _by_lines(results: Results, rows: Sequence[Row], verified: bool, left: Sequence[str]) -> Table:
    table = _begun(results, verified)
    table.add_column("method", no_wrap=True)
    shown = [(COLUMNS[name], cell) for name, cell in lines(verified) if name in COLUMNS and COLUMNS[name] not in left]
    for heading, _ in shown:
        table.add_column(heading, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(row.method, *(cell(row) for _, cell in shown))
    missing = named([heading for heading in left if verified or heading != "wrong"])
    wider = f"a wider terminal shows {missing}, too; " if missing else ""
    table.caption = f"{table.caption}; {wider}--csv FILE has all figures"
    return table


def _begun(results: Results, verified: bool) -> Table:
    caption = [*caveats(results), *([] if verified else ["--verify counts wrong answers"])]
    return titled(f"Work of shadow rays\n{_which(results)}", "; ".join(caption))


def _which(results: Results) -> str:
    width, height = results.size
    return f"{printable(Path(results.scene).name)}, {width} × {height}, {frames_in_words(results)}"


_OF_LAMPS: dict[str, Callable[[LampRow], str]] = {
    "frame,\nmedian": lambda row: f"{1000.0 * row.frame_seconds:,.1f} ms",
    "shadow\nrays": lambda row: f"{row.shadow_rays:,.0f}",
    "saved": lambda row: "" if row.method in (REFERENCE, CEILING) else f"{row.known:.1%}",
    "speed-\nup": lambda row: f"{row.speed_up:.2f}",
    "of free": lambda row: f"{row.share_of_free:.1%}",
}


def lamp_table(results: LampResults, width: int | None) -> Table:
    """Make a table with a row for each method under each kind of lamps, as `bench_table`."""
    return _lamp_table(
        results, left_out(("shadow\nrays", "saved", "of free"), lambda left: [_lamp_table(results, left)], width)
    )


def _lamp_table(results: LampResults, left: Sequence[str]) -> Table:
    wider = f"\na wider terminal shows {named(left)}, too; --csv FILE has all figures" if left else ""
    table = titled(
        f"What culling is worth under lamps\n{_which(results.runs[0])}",
        f"shadow rays: due per frame; speed-up: over {REFERENCE}, all frames; {CEILING}: shadow rays cost nothing\n"
        f"{terms.SAVED} are shadow rays {terms.MEANINGS[terms.SAVED]}{wider}",
    )
    shown = {name: cell for name, cell in _OF_LAMPS.items() if name not in left}
    for name in ("radius", "samples", "method", *shown):
        table.add_column(name, justify="left" if name == "method" else "right", no_wrap=True)
    before: tuple[str, str] | None = None
    for row in lamp_experiment.table(results):
        radius = "scene's" if row.lamp_radius is None else f"{row.lamp_radius:g}"
        kind = radius, "scene's" if row.lamp_samples is None else str(row.lamp_samples)
        if before is not None and kind != before:
            table.add_section()
        table.add_row(*(kind if kind != before else ("", "")), row.method, *(cell(row) for cell in shown.values()))
        before = kind
    return table

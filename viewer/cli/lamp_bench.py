"""The command `bench` with several kinds of lamps: what each method is worth under each of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from rich.table import Table

from tracer.experiments.experiment import REFERENCE, in_turn, with_reference
from tracer.experiments.lamp_experiment import CEILING, LampResults, LampRow, run_lamps, table
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.scene.model import Cancelled, Scene
from viewer.cli.console import Work
from viewer.cli.narrow_tables import left_out, named
from viewer.output.reports import frames_in_words
from viewer.state import terms


def run(
    scene: Scene,
    settings: Settings,
    methods: list[str],
    kinds: list[tuple[float | None, int | None]],
    times: list[float],
    numbers: range,
    work: Work,
) -> LampResults:
    """The results of all kinds of lamps, or of what was done when `work` was cancelled; raises Cancelled where that is
    nothing."""
    names = list(dict.fromkeys([*methods, CEILING]))
    world = World(scene, times[0], settings.accelerator, work.progress)
    each = len(numbers) * len(names)
    total, done = len(kinds) * each, 0

    def show() -> None:
        lamps, place = divmod(min(done, total - 1), each)
        frame, turn = divmod(place, len(names))
        method = in_turn(with_reference(names), frame)[turn]
        label = f"lamps {lamps + 1} of {len(kinds)}, frame {frame + 1} of {len(numbers)}, {method}"
        work.count(label, done, total)

    def on_frame(number: int, method: str, frame: Frame) -> None:
        nonlocal done
        done += 1
        show()

    show()
    results = None
    for grown in run_lamps(scene, settings, methods, kinds, times, numbers, work.cancelled, world, on_frame):
        results = grown
    if results is None:
        raise Cancelled("cancelled")
    return results


def lamp_table(results: LampResults, width: int | None) -> Table:
    """A row for each method under each kind of lamp, in so many columns; None for as many as it takes."""
    return _table(results, left_out(LEAST_WANTED, lambda left: [_table(results, left)], width))


def _table(results: LampResults, left: Sequence[str]) -> Table:
    first = results.runs[0]
    width, height = first.size
    title = f"What culling is worth under lamps\n{Path(first.scene).name}, {width} × {height}, {frames_in_words(first)}"
    made = Table(title=title, title_justify="left", title_style="bold", caption_justify="left")
    for name in ("radius", "samples", "method"):
        made.add_column(name, justify="left" if name == "method" else "right", no_wrap=True)
    shown = [(name, cell) for name, cell in _FIGURES.items() if name not in left]
    for name, _ in shown:
        made.add_column(name, justify="right", no_wrap=True)
    before: tuple[float | None, int | None] | None = None
    for row in table(results):
        kind = row.lamp_radius, row.lamp_samples
        if before is not None and kind != before:
            made.add_section()
        made.add_row(*(_kind(row) if kind != before else ("", "")), row.method, *(cell(row) for _, cell in shown))
        before = kind
    wider = f"\na wider terminal shows {named(left)}, too; --csv FILE has all figures" if left else ""
    made.caption = (
        f"shadow rays: due per frame; speed-up: over {REFERENCE}, all frames; {CEILING}: shadow rays cost nothing\n"
        f"{terms.SAVED} are shadow rays {terms.MEANINGS[terms.SAVED]}{wider}"
    )
    return made


def _kind(row: LampRow) -> tuple[str, str]:
    radius = "scene's" if row.lamp_radius is None else f"{row.lamp_radius:g}"
    return radius, "scene's" if row.lamp_samples is None else str(row.lamp_samples)


_FIGURES: dict[str, Callable[[LampRow], str]] = {
    "frame,\nmedian": lambda row: f"{1000.0 * row.frame_seconds:,.1f} ms",
    "shadow\nrays": lambda row: f"{row.shadow_rays:,.0f}",
    "saved": lambda row: "" if row.method in (REFERENCE, CEILING) else f"{row.known:.1%}",
    "speed-\nup": lambda row: f"{row.speed_up:.2f}",
    "of free": lambda row: f"{row.share_of_free:.1%}",
}
LEAST_WANTED = ("shadow\nrays", "saved", "of free")
"""Columns that are left out, one after another, where there is no room for all."""

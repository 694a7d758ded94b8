"""The command `bench` with several kinds of lamps: what each method is worth under each of them."""

from __future__ import annotations

from pathlib import Path

from rich.table import Table

from tracer.experiment import REFERENCE
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.lamp_experiment import CEILING, LampResults, LampRow, run_lamps, table
from tracer.scene.model import Cancelled, Scene
from viewer.cli.console import Work
from viewer.output.reports import frames_in_words


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
    done = 0

    def on_frame(number: int, method: str, frame: Frame) -> None:
        nonlocal done
        done += 1
        lamps = min(done // each, len(kinds) - 1) + 1
        work.count(f"lamps {lamps} of {len(kinds)}, {', '.join(names)}", done, len(kinds) * each)

    results = None
    for grown in run_lamps(scene, settings, methods, kinds, times, numbers, work.cancelled, world, on_frame):
        results = grown
    if results is None:
        raise Cancelled("cancelled")
    return results


def lamp_table(results: LampResults) -> Table:
    """A row for each method under each kind of lamp."""
    first = results.runs[0]
    width, height = first.size
    title = f"What culling is worth under lamps\n{Path(first.scene).name}, {width} × {height}, {frames_in_words(first)}"
    made = Table(title=title, title_justify="left", title_style="bold", caption_justify="left")
    for name in ("radius", "samples", "method", "frame, median", "shadow rays", "known", "speed-up", "of free"):
        made.add_column(name, justify="left" if name == "method" else "right")
    before: tuple[float | None, int | None] | None = None
    for row in table(results):
        kind = row.lamp_radius, row.lamp_samples
        if before is not None and kind != before:
            made.add_section()
        made.add_row(*(_kind(row) if kind != before else ("", "")), *_figures(row))
        before = kind
    made.caption = (
        f"shadow rays: due per frame; speed-up: over {REFERENCE}, all frames; {CEILING}: shadow rays cost nothing\n"
        "known: shadow rays that are culled, or tested against dynamic objects only"
    )
    return made


def _kind(row: LampRow) -> tuple[str, str]:
    radius = "scene's" if row.lamp_radius is None else f"{row.lamp_radius:g}"
    return radius, "scene's" if row.lamp_samples is None else str(row.lamp_samples)


def _figures(row: LampRow) -> tuple[str, ...]:
    measured = "" if row.method in (REFERENCE, CEILING) else f"{row.known:.1%}"
    milliseconds, rays = f"{1000.0 * row.frame_seconds:,.1f} ms", f"{row.shadow_rays:,.0f}"
    return row.method, milliseconds, rays, measured, f"{row.speed_up:.2f}", f"{row.share_of_free:.1%}"

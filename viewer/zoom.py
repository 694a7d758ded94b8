"""The command `zoom`: towards a primitive in steps, as the paper's Figure 4.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

import csv
import io
import json
from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from pathlib import Path

from rich.table import Table

from tracer import zoom
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.load import load_visible_scene
from tracer.scene.model import Cancelled, Scene
from tracer.zoom import Aim, Approach, Change, Results, Step
from viewer.console import Work, print_table, working
from viewer.headless import moment, prepare_kernels, tracing_settings
from viewer.outputs import check_outputs, write_each, write_text

WHICH = (
    "zoom: towards which primitive? give --pixel X,Y, for what a pixel of the picture shows, or --primitive N; the "
    "viewer's inspector tells its number, and so does the array 'primitive' of render --buffers"
)


def run(path: Path, options: Namespace) -> bool:
    """Do a zoom test, print what happened, and write its files; returns whether it was not stopped before its end.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished.
    """
    if options.primitive is None and options.pixel is None:
        raise ValueError(WHICH)
    settings = tracing_settings(options)
    check_outputs({"--json": options.json, "--csv": options.csv, "--plot": options.plot})
    if options.plot is not None:
        from viewer import figures  # loads matplotlib

        figures.check_ending(options.plot)
    results = None
    with working() as work:
        scene = load_visible_scene(path, work.progress)
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        time = moment(scene, options.frame, options.time)
        prepare_kernels(work, len(scene.lights))
        world = World(scene, time, settings.accelerator, work.progress)
        start = _aim(scene, settings, world, time, options, work)
        frames, done = len(options.factors) * (options.steps + zoom.STILL_FRAMES), 0

        def on_frame(factor: float, number: int, frame: Frame) -> None:
            nonlocal done
            done += 1
            work.count(f"towards primitive {start.primitive}, zoom factor {factor:g}, step {number}", done, frames)

        work.count(f"towards primitive {start.primitive}", 0, frames)
        way = (options.factors, options.steps, options.ratio)
        for grown in zoom.run(scene, settings, start, *way, work.cancelled, world, on_frame):
            results = grown
        if results is None:
            raise Cancelled("cancelled")
        if done < frames:
            work.note(f"cancelled after {done} of {frames} frames; the tables are of these")
        failures = write_each(_writers(results, options))
    for approach in results.approaches:
        print_table(_steps_table(approach))
    print_table(_summary_table(results))
    if failures:
        raise OSError("; ".join(failures))
    return done == frames


def _aim(scene: Scene, settings: Settings, world: World, time: float, options: Namespace, work: Work) -> Aim:
    """Where to start from, seen in a picture of the primary rays alone."""
    look = replace(settings, method="none", depth=0, verify=False)
    frame = Renderer(scene, look, world=world).render(time, options.camera, work.cancelled)
    if options.pixel is not None:
        return zoom.aim(frame, zoom.primitive_at(frame, *options.pixel))
    if not 0 <= options.primitive < scene.primitive_count:
        raise ValueError(f"--primitive {options.primitive}: the scene's are 0 to {scene.primitive_count - 1}")
    return zoom.aim(frame, options.primitive)


def parse_factors(text: str) -> list[float]:
    """Zoom factors, from words like "4, 16", each once; raises ValueError in one line."""
    try:
        factors = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        factors = []
    if not factors or not all(1.0 <= factor <= 1e6 for factor in factors):
        raise ValueError(f"{text!r} are no zoom factors; give numbers from 1 up, like 4,16")
    return list(dict.fromkeys(factors))


def happenings(approach: Approach) -> list[Step]:
    """The steps where something happens: a mode changes, or the primitive's wrong pixels become more or fewer."""
    wrong_before = [0, *(step.wrong_of_primitive for step in approach.steps)]
    return [s for s, wrong in zip(approach.steps, wrong_before) if s.changes or s.wrong_of_primitive != wrong]


def changes_in_words(changes: Sequence[Change]) -> list[str]:
    """What changes in a step, e.g. "lights 0, 2: init → non shadow"; lights that change alike are told together."""
    return [f"{who}{_spoken(before)} → {_spoken(after)}" for who, before, after in _gathered(changes)]


def modes_in_words(changes: Sequence[Change]) -> str:
    """The modes that are new in a step, shorter: "fully rendered, lights 0, 2: non shadow"."""
    return ", ".join(f"{who}{_spoken(after)}" for who, _, after in _gathered(changes))


def _gathered(changes: Sequence[Change]) -> list[tuple[str, str, str]]:
    """(whose mode, before, after), the occlusion mode first."""
    lights: dict[tuple[str, str], list[str]] = {}
    for change in changes:
        if change.light is not None:
            lights.setdefault((change.before, change.after), []).append(str(change.light))
    own = [("", change.before, change.after) for change in changes if change.light is None]
    return own + [(f"light{'s' * (len(n) > 1)} {', '.join(n)}: ", *modes) for modes, n in lights.items()]


def _spoken(mode: str) -> str:
    return mode.replace("_", " ").lower()


def title(results: Results) -> str:
    """Which test this is, in one line."""
    name, (width, height) = Path(results.scene).name, results.size
    return f"{name}, {results.time:.3f} s, towards primitive {results.primitive}, {width} x {height}"


def _steps_table(approach: Approach) -> Table:
    table = Table(title=f"zoom factor {approach.factor:g}", title_justify="left", caption_justify="left")
    for heading in ("step", "distance", "pixels", "highest", "wrong", "in all"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("modes from there on")
    for step in happenings(approach):
        numbers = (step.pixels, step.highest, step.wrong_of_primitive, step.wrong)
        modes = modes_in_words(step.changes)
        table.add_row(str(step.number), f"{step.distance:.4g}", *(f"{number:,}" for number in numbers), modes)
    table.caption = "wrong: pixels of the primitive with wrong shadows; in all: of the whole picture"
    return table


SUMMARY = ("factor", "examined anew", "wrong pixels", "most", "at the end", "culled", "dynamic only")


def summary(approach: Approach) -> tuple[str, ...]:
    """What came of one factor, a cell for each heading of SUMMARY."""
    anew, wrong = approach.examined_anew, approach.wrong_steps
    due = max(1, sum(step.due for step in approach.steps))
    culled, alone = (sum(getattr(step, name) for step in approach.steps) / due for name in ("culled", "dynamic_only"))
    return (
        f"{approach.factor:g}",
        f"step {', '.join(map(str, anew))}" if anew else "never",
        f"step {wrong[0]} to {wrong[-1]}" if wrong else "none",
        f"{approach.most_wrong:,}",
        f"{approach.steps[-1].wrong_of_primitive:,}" if approach.steps else "",
        f"{culled:.1%}",
        f"{alone:.1%}",
    )


def _summary_table(results: Results) -> Table:
    table = Table(*SUMMARY, title=title(results), title_justify="left", title_style="bold", caption_justify="left")
    table.caption = "of the shadow rays due: culled, and those that asked moving objects alone"
    for approach in results.approaches:
        table.add_row(*summary(approach))
    return table


def _writers(results: Results, options: Namespace) -> Iterator[Callable[[], None]]:
    """What writes each file that was asked for."""
    if options.json is not None:
        yield lambda: write_text(options.json, json.dumps(results.to_dict()))
    if options.csv is not None:
        yield lambda: write_text(options.csv, csv_text(results))
    if options.plot is not None:
        from viewer import figures

        yield lambda: figures.save(figures.zoom_figure(results), options.plot)


def csv_text(results: Results) -> str:
    """A line for each step of each factor, as CSV."""
    plain = [f.name for f in fields(Step) if f.name not in ("camera", "shadows", "changes")]
    lights = max((len(step.shadows) for approach in results.approaches for step in approach.steps), default=0)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["factor", *plain, *(f"shadow_{light}" for light in range(lights)), "changes"])
    for approach in results.approaches:
        for step in approach.steps:
            values = [getattr(step, name) for name in plain]
            changes = "; ".join(changes_in_words(step.changes))
            writer.writerow([approach.factor, *values, *(mode or "" for mode in step.shadows), changes])
    return text.getvalue()

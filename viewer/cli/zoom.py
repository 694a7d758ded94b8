"""The command `zoom`: towards a primitive in steps, as the paper's Figure 4.

Ctrl-C ends it after the last whole frame: what is done is shown, and written where it was to go.
"""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from rich.table import Table

from tracer.experiments import zoom
from tracer.experiments.zoom import Aim, Approach, Results
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Cancelled, Scene
from viewer.cli.console import Work, print_table, working
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.tracing_options import moment, prepare_kernels, tracing_settings
from viewer.output import exports
from viewer.output.reports import (
    NEVER_WHOLE,
    SUMMARY,
    WRONG_PIXELS,
    happenings,
    modes_in_words,
    never_whole,
    summary,
    zoom_title,
)
from viewer.state.methods import NO_CULLING
from viewer.util.messages import say

WHICH = (
    "zoom: towards which primitive? give --pixel X,Y, for what a pixel of the picture shows, or --primitive N; the "
    "viewer's inspector shows its number, and so does the array 'primitive' of render --buffers"
)


def run(path: Path, options: Namespace) -> bool:
    """Do a zoom test, print what happened, and write its files; returns whether it was not stopped before its end.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no frame was finished.
    """
    check_scene_file(path)
    if options.primitive is None and options.pixel is None:
        raise ValueError(WHICH)
    settings = tracing_settings(options)
    zoom.settings_of_tests(settings, options.factors, options.steps, options.ratio)
    if options.pixel is not None:
        zoom.check_pixel(options.pixel, options.size)
    wanted = exports.wanted_files(options)
    results = None
    with working() as work:
        scene = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        time = moment(scene, options.frame, options.time)
        if options.primitive is not None:
            zoom.check_primitive(scene, options.primitive)
        prepare_kernels(work, len(scene.lights), options.accelerator, zoom.METHOD)
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
        failures = exports.write_files(exports.ZOOM_WRITERS, results, wanted)
    for approach in results.approaches:
        print_table(_steps_table(approach))
    print_table(_summary_table(results))
    if never_whole(results):
        say(f"primitive {results.primitive}: {NEVER_WHOLE}")
    if failures:
        raise OSError("; ".join(failures))
    return done == frames


def _aim(scene: Scene, settings: Settings, world: World, time: float, options: Namespace, work: Work) -> Aim:
    """Where to start from, seen in a picture of the primary rays alone."""
    look = replace(settings, method=NO_CULLING, depth=0, verify=False)
    frame = Renderer(scene, look, world=world).render(time, options.camera, work.cancelled)
    if options.pixel is not None:
        return zoom.aim(frame, zoom.primitive_at(frame, *options.pixel))
    return zoom.aim(frame, options.primitive)


def _steps_table(approach: Approach) -> Table:
    table = Table(title=f"zoom factor {approach.factor:g}", title_justify="left", caption_justify="left")
    for heading in ("step", "distance", "pixels", "highest", "wrong", "in picture"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("modes from there on")
    for step in happenings(approach):
        numbers = (step.pixels, step.highest, step.wrong_of_primitive, step.wrong)
        modes = modes_in_words(step.changes)
        table.add_row(str(step.number), f"{step.distance:.4g}", *(f"{number:,}" for number in numbers), modes)
    table.caption = f"wrong: {WRONG_PIXELS}; in picture: those of the whole picture"
    return table


def _summary_table(results: Results) -> Table:
    table = Table(*SUMMARY, title=zoom_title(results), title_justify="left", title_style="bold", caption_justify="left")
    table.caption = "wrong pixels: those of this primitive\nculled, dynamic only: shares of the shadow rays due"
    for approach in results.approaches:
        table.add_row(*summary(approach))
    return table

"""The command `hunt`: the worst wrong pixels of a method along a path, and beside it.

Ctrl-C ends it after the last whole picture: what was found is shown, and written where it was to go.
"""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from rich.table import Table

from tracer.experiments import counterexample, hunt
from tracer.experiments.hunt import Search
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.scene.lights import number_of
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Cancelled, Scene
from viewer.cli.console import Work, print_table, working
from viewer.cli.mesh_arguments import as_arguments, mesh_options
from viewer.cli.tracing_options import prepare_kernels, tracing_settings
from viewer.services import counterexamples
from viewer.state import flight
from viewer.state.methods import NO_CULLING
from viewer.util.messages import printable


def run(path: Path, options: Namespace) -> bool:
    """Hunt, print what was found, and write it; returns whether it was not stopped before its end.

    Raises SceneError, ValueError and OSError, each in one line, or Cancelled where no picture was finished."""
    check_scene_file(path)
    settings = replace(tracing_settings(options), method=options.method, verify=True)
    found, whole = None, True
    with working() as work:
        scene = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        search = _search(scene, settings, options)
        if options.output is not None:
            counterexamples.check_folder(options.output)
        prepare_kernels(work, len(scene.lights), options.accelerator, settings.method, NO_CULLING)
        world = World(scene, search.times[0], settings.accelerator, work.progress)
        done = 0

        def on_frame(label: str, frame: Frame) -> None:
            nonlocal done
            done += 1
            work.count(label, done, search.frames)

        work.count(f"frame 1 of {len(search.times)}", 0, search.frames)
        for grown in hunt.run(scene, search, work.cancelled, world, on_frame):
            found = grown
        if found is None:
            raise Cancelled("cancelled")
        whole = not work.stopped
        if not whole:
            work.note(f"cancelled after {done} of {search.frames} pictures; the table is of these")
        written = _write(found, scene, search, world, options, work) if options.output is not None else []
    if found.finds:
        print_table(_table(found, scene))
    print(printable(found.summary))
    for file in written:
        print(printable(file))
    return whole


def _search(scene: Scene, settings: Settings, options: Namespace) -> Search:
    first, last = options.frames or (0, scene.frames - 1)
    takes = flight.along_path(scene, first, last)[:: options.step]
    return Search(
        settings,
        [take.time for take in takes],
        options.camera,
        options.around,
        options.radius,
        options.seed,
        options.keep,
    )


def _write(
    found: hunt.Results, scene: Scene, search: Search, world: World, options: Namespace, work: Work
) -> list[Path]:
    """The files of all finds; of a hunt that was stopped the JSON alone, as figures take long."""
    written = []
    for number, find in enumerate(found.finds, 1):
        stem = options.output / f"find-{number}"
        counterexamples.save_json(find, found, scene, stem.with_suffix(".json"), as_arguments(mesh_options(options)))
        if not work.stopped:
            work.count(f"figure {number} of {len(found.finds)}", number - 1, len(found.finds))
            meshes = mesh_options(options).of_file(Path(scene.path))
            folders = tuple(options.folder)
            wanted = counterexamples.comparison_of(find, found, scene, search.settings, folders, meshes)
            try:
                counterexamples.save_figure(wanted, scene, world, stem.with_suffix(".png"), cancelled=work.cancelled)
                written.append(stem.with_suffix(".png"))
            except Cancelled:
                work.note("cancelled: the figures from here on are not drawn")
        written.append(stem.with_suffix(".json"))
    counterexamples.save_all(found, scene, options.output)
    return [*written, options.output / counterexamples.ALL]


def _table(found: hunt.Results, scene: Scene) -> Table:
    size = f"{found.size[0]} × {found.size[1]}"
    title = f"{Path(found.scene).name}, {size}, method {found.method}: the worst wrong pixels"
    table = Table(title=title, title_justify="left", title_style="bold", caption_justify="left")
    for heading in ("", "difference", "pixel", "wrong pixels"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("frame", no_wrap=True)
    for heading in ("primitive", "light", "culled by", "truly", "learnt"):
        table.add_column(heading, overflow="fold")
    for number, find in enumerate(found.finds, 1):
        table.add_row(
            str(number),
            f"{find.difference:.3f}",
            f"{find.x},{find.y}",
            f"{find.pixels:,}",
            counterexample.frame_of(find, scene),
            printable(counterexample.primitive_of(find, scene)),
            f"{number_of(scene.lights, find.light)}" + (f" (+{find.more_lights})" if find.more_lights else ""),
            counterexample.verdict_of(find),
            "blocked" if find.lit else "lit",
            counterexample.taught_by(find, scene),
        )
    table.caption = "difference: of the colour, of 1; wrong pixels: of the picture; light: (+ others)"
    return table

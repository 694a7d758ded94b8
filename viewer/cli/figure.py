"""The command `figure`: one frame by several methods, side by side."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from rich.table import Table

from tracer.geometry.world import World
from tracer.scene.load import check_scene_file, load_visible_scene
from viewer.cli.console import print_table, working
from viewer.cli.edit_options import edited_scene
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.render import check_display, check_view, recipe_of, times_before
from viewer.cli.tracing_options import prepare_kernels, tracing_settings
from viewer.output import comparison_figure
from viewer.output.comparison_figure import ENDINGS, Crop, Shown
from viewer.services import comparison, stills
from viewer.services.comparison import Comparison
from viewer.state.views import View
from viewer.util.files import check_writable
from viewer.util.messages import printable


def figure(path: Path, options: Namespace) -> None:
    """Trace and draw; raises SceneError, ValueError and OSError, each in one line, or Cancelled."""
    check_scene_file(path)
    view = options.view.view
    if options.output is None or options.output.suffix.lower() not in ENDINGS:
        raise ValueError(f"figure: give -o FILE, one of {' '.join(ENDINGS)}")
    check_writable(options.output)
    if view is View.CERTIFICATE:
        raise ValueError("figure: certificates are of one method alone; give another --view")
    if view is View.TREE:
        raise ValueError("figure: all methods share one tree; give another --view, or `render --view tree`")
    check_display(options)
    settings = replace(tracing_settings(options), samples=options.samples)
    for method in options.methods:
        check_view(replace(settings, method=method), view, "--methods")
    with working() as work:
        read = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        scene = edited_scene(read, options)
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        recipe = recipe_of(path, scene, settings, options)
        crops = tuple(Crop(*crop) for crop in options.crops)
        wanted = Comparison(recipe, tuple(options.methods), crops).checked()
        stills.check_light(recipe, scene)
        if not stills.lights_fit(recipe, scene):
            raise ValueError(f"--view {view.value}: too many lights for pictures of this size")
        times_before(scene, recipe.time, recipe.warmup, work)
        prepare_kernels(work, len(scene.lights), options.accelerator, *wanted.methods)
        world = World(scene, recipe.time, options.accelerator, work.progress)

        def tell(method: str, done: int, total: int) -> None:
            work.count(f"{method}, frame {done + 1} of {total}", done, total)

        shown = comparison.trace(scene, wanted, world, tell, work.cancelled)
        work.progress("drawing", 1.0)
        comparison_figure.save(shown, options.output, comparison.text(shown, wanted))
    print_table(_table(shown))
    print(printable(options.output))


def _table(shown: Shown) -> Table:
    table = Table(title=f"{shown.scene.path.name}, {shown.recipe.time:.3f} s", title_justify="left", title_style="bold")
    table.add_column("")
    columns = [shown.counts(method) for method in shown.frames]
    for method in shown.frames:
        table.add_column(method, justify="right")
    for line in zip(*columns):
        table.add_row(line[0][0], *(value for _, value in line))
    return table

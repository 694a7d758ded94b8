"""The command `cube`: what a light sees, as its light buffer has it."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from PIL import Image
from rich.table import Table

from tracer.methods.lightbuffer import LightBuffer
from tracer.renderer import Renderer
from tracer.scene.lights import named_light
from tracer.scene.load import check_scene_file, load_visible_scene
from viewer.cli.console import print_table, working
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.tracing_options import moment, prepare_kernels, tracing_settings
from viewer.output.light_cube import EMPTY, FEW, MANY, ONE, described, picture_of, seen
from viewer.util.messages import printable
from viewer.views.legend import lights_in_words


def cube(path: Path, options: Namespace) -> None:
    """Save the unfolded cube of a light, and print what its cells have; raises SceneError and ValueError in one line,
    or Cancelled."""
    check_scene_file(path)
    settings = replace(tracing_settings(options), method="lightbuffer", light_buffer_side=options.side).validated()
    with working() as work:
        scene = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        if not options.light < len(scene.lights):
            raise ValueError(f"--light {options.light}: {lights_in_words(len(scene.lights))}")
        time = moment(scene, options.frame, options.time)
        prepare_kernels(work, len(scene.lights), options.accelerator, settings.method)
        renderer = Renderer(scene, settings, work.progress)
        frame = renderer.render(time, None, work.cancelled)
        method = renderer.state.method("lightbuffer")
        assert isinstance(method, LightBuffer)
        found = method.cube_of(options.light)
    if found is None:
        why = method.why_not(options.light) or "there is nothing static"
        raise ValueError(f"--light {options.light} has no light buffer, and its shadow rays are traced: {why}")
    options.output.parent.mkdir(parents=True, exist_ok=True)
    name = named_light(scene.lights, options.light)
    Image.fromarray(picture_of(found) if options.no_legend else described(found, name)).save(options.output)
    counts = seen(found).counts
    table = Table(title=f"{path.name}, {name}, {time:.3f} s", title_justify="left")
    table.add_column("cells of its cube")
    table.add_column("", justify="right")
    for name, number in zip((EMPTY, ONE, FEW, MANY), counts, strict=True):
        table.add_row(name, f"{number / counts.cells:.1%}")
    table.add_row("memory", f"{found.bytes / 1e6:.1f} MB")
    table.add_row("building, all lights", f"{1e3 * frame.statistics.phases['certification']:.0f} ms")
    print_table(table)
    print(printable(options.output))

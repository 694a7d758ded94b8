"""The command `render`: one frame of a scene into a picture, its buffers, or both.

Whatever can be known to fail is found out before the tracing: the size, the frame, the camera, and whether the files
can be written.
"""

from __future__ import annotations

import shlex
from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from tracer.frame import Frame, Settings
from tracer.geometry.accelerators import BVH8, LAZY
from tracer.geometry.world import LARGE
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Scene
from viewer.cli.console import Work, print_table, statistics_table, working
from viewer.cli.edit_options import edited_scene, edits_of, light_index
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.tracing_options import moment, prepare_kernels, tracing_settings
from viewer.output import exr, figure1_svg, png, recipe, tev
from viewer.output.buffers import buffers
from viewer.output.recipe import Recipe, Style
from viewer.services import stills
from viewer.services.lamps import LampSamples
from viewer.state import terms
from viewer.state.draw_options import MIDDLE
from viewer.state.methods import BY_MODES, CERTIFIED, SHOWN_BY, default_for
from viewer.state.readings import MOST_RECORDED
from viewer.state.tone import Tone
from viewer.state.views import View
from viewer.util.files import check_writable, write_whole
from viewer.util.messages import printable, say

PICTURES = {
    ".png": "PNG",
    ".jpg": "JPEG",
    ".jpeg": "JPEG",
    ".tif": "TIFF",
    ".tiff": "TIFF",
    ".bmp": "BMP",
    ".ppm": "PPM",
    exr.ENDING: "EXR",
}
BYTES_OF_A_LIGHT = 7  # of a pixel: samples asked and reached in 2 each, lit, due and shadow_mode in 1 each
LEGEND_PLACE = 0.0, 1.0  # the lower left corner


def render(path: Path, options: Namespace) -> None:
    """Trace one frame and write it; raises SceneError, ValueError and OSError in one line, or Cancelled."""
    check_scene_file(path)
    view = options.view.view
    as_exr = options.output is not None and options.output.suffix.lower() == exr.ENDING
    everything = options.buffers is not None or as_exr or options.to_tev is not None
    settings = replace(tracing_settings(options), method=options.method or default_for(view), samples=options.samples)
    if as_exr:
        exr.check()
    if not options.print_command:
        _check_outputs(options.output, options.buffers, options.figure1, options.to_tev is not None)
    check_view(settings, view)
    check_display(options)
    with working() as work:
        read = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        scene = edited_scene(read, options)
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        wanted = stills.with_caption_filled(recipe_of(path, scene, settings, options), scene)
        stills.check_light(wanted, scene)
        if options.print_command:
            words = recipe.arguments(wanted, scene, str(options.output or f"{path.stem}.png"))
            print(shlex.join(["shadowcull", *words]))
            return
        check_tree(settings, view, scene)
        if not stills.lights_fit(wanted, scene, everything):
            raise ValueError(_too_many_lights(options, settings.width * settings.height, len(scene.lights)))
        prepare_kernels(work, len(scene.lights), options.accelerator, settings.method)
        renderer = Renderer(scene, replace(settings, verify=False), work.progress)
        modes = options.figure1 is not None and not Method.parse(settings.method).culls  # it says what they would do
        asked = replace(wanted, settings=replace(wanted.settings, modes=True)) if modes else wanted
        frame = _traced(renderer, asked, everything, work)
        work.progress("writing", 1.0)
        if as_exr:
            exr.write(options.output, frame, stills.text(frame.pixels, frame, scene, wanted), options.half)
        elif options.output is not None:
            write_picture(options.output, scene, frame, wanted)
        if options.buffers is not None:
            arrays: dict[str, Any] = buffers(frame)
            write_whole(options.buffers, lambda file: np.savez(file, **arrays))
        if options.figure1 is not None:
            figure1_svg.write(options.figure1, frame, scene)
        if options.to_tev is not None:
            tev.send(options.to_tev, f"{scene.path.stem} {wanted.time:g} s {settings.method}", frame)
    title = f"{path.name}, {wanted.time:.3f} s, {frame.width} × {frame.height}, method {settings.method}"
    by_beams = terms.asks_by_beams(frame, LampSamples().any(scene.lights, frame.settings))
    remarks = " ".join(filter(None, (terms.BY_BEAMS if by_beams else "", _first(wanted))))
    print_table(statistics_table(frame.statistics, title, frame.settings, remarks))
    for written in (options.output, options.buffers, options.figure1):
        if written is not None:
            print(printable(written))


def _first(wanted: Recipe) -> str:
    """Why a method that culls by what earlier frames have shown has culled nothing, where there were none."""
    method = wanted.settings.method
    if wanted.before or wanted.warmup or wanted.repeats or not Method.parse(method).uses_modes:
        return ""
    return f"{method} culls by what earlier frames have shown, and this is the first: give --warmup N, or --repeat N."


def recipe_of(path: Path, scene: Scene, settings: Settings, options: Namespace) -> Recipe:
    """What the options ask for, with a caption that may have fields.

    Raises ValueError, in one line, for a moment that the scene does not have."""
    view, light, wipe, shares = options.view
    if view.of_light:
        light = light_index(options, f"--view {view.value}:", light, scene)
    else:
        light = edits_of(options).light_index(light) or 0
    style = Style(
        shares=shares,
        marked=not options.no_marks,
        magnified=options.magnified,
        shading=options.shading,
        beneath=options.beneath,
        outlines=options.outlines,
        legend=(options.legend_at or LEGEND_PLACE) if options.legend else None,
        caption=options.caption,
        tone=_tone(options),
        clipping=options.mark_clipped,
        span=options.range,
        cut=options.slice,
        savings=options.savings,
    )
    time = moment(scene, options.frame, options.time)
    history = ""
    if recipe.by_chance(settings, view, style.savings is not None):
        history = f"what the method {settings.method} makes depends on time and threads"
    return Recipe(
        path, time, options.camera, settings, view, light, wipe, style, options.warmup, options.repeat, history,
        folders=tuple(options.folder), before=options.before, meshes=mesh_options(options).of_file(path),
        edits=edits_of(options),
    )  # fmt: skip


def times_before(scene: Scene, time: float, warmup: int, work: Work) -> list[float]:
    """Times of the frames of `--warmup`, with a note where there are not so many."""
    times = stills.times_before(scene, time, warmup)
    if len(times) < warmup:
        come = {0: "no frame comes", 1: "only one frame comes"}.get(len(times), f"only {len(times)} frames come")
        work.note(f"--warmup {warmup}: {come} before this one")
    return times


def _traced(renderer: Renderer, wanted: Recipe, everything: bool, work: Work) -> Frame:
    times_before(renderer.scene, wanted.time, wanted.warmup, work)
    settings = wanted.settings

    def show(done: int, frames: int) -> None:
        label = f"warming up, frame {done + 1} of {frames - 1}"
        if done == frames - 1:
            label = f"tracing {settings.width} × {settings.height}"
        work.count(label, done, frames - 1 + settings.samples)

    return stills.trace(renderer, wanted, everything, show, work.cancelled)


def _too_many_lights(options: Namespace, pixels: int, lights: int) -> str:
    option = (
        "--buffers"
        if options.buffers is not None or not options.view.view.needs_lights
        else f"--view {options.view.view.value}"
    )
    needed, most = (BYTES_OF_A_LIGHT * n / 1e9 for n in (pixels * lights, MOST_RECORDED))
    return (
        f"{option}: {lights:,} lights at {pixels:,} pixels take {needed:.1f} GB, {most:.1f} GB at most; "
        f"give a smaller --size, of up to {MOST_RECORDED // lights:,} pixels"
    )


def _check_outputs(output: Path | None, npz: Path | None, figure: Path | None, sent: bool) -> None:
    if output is None and npz is None and figure is None and not sent:
        raise ValueError("render: nothing to write; give -o out.png, --buffers out.npz, --figure1 out.svg, or several")
    if output is not None and output.suffix.lower() not in PICTURES:
        raise ValueError(f"{output}: unknown kind of picture; give one of {' '.join(PICTURES)}")
    if npz is not None and npz.suffix.lower() != ".npz":
        raise ValueError(f"{npz}: --buffers writes a .npz")
    if figure is not None and figure.suffix.lower() != ".svg":
        raise ValueError(f"{figure}: --figure1 writes a .svg")
    for path in (output, npz, figure):
        if path is not None:
            check_writable(path)


def _tone(options: Namespace) -> Tone:
    return Tone(options.exposure, options.white, options.tone)


def check_display(options: Namespace) -> None:
    """Raises ValueError for options that the view has no use for."""
    view, shares = options.view.view, options.view.shares
    if not view.shows_picture and not _tone(options).neutral:
        raise ValueError(f"--exposure, --white and --tone are for pictures: --view {view.value} shows none")
    if options.mark_clipped and not view.shows_clipped:
        raise ValueError(f"--mark-clipped is for the views color and wipe, not {view.value}")
    if options.slice != MIDDLE and not view.has_slice:
        raise ValueError(f"--slice is for the views voxels and tree, not {view.value}")
    if options.range is not None and (not view.has_range or shares):
        names = ", ".join(one.value for one in View if one.has_range)
        raise ValueError(f"--range is for views of numbers: {names}{' as counts' if shares else ''}")


def check_view(settings: Settings, view: View, option: str = "--method") -> None:
    """Raise ValueError, in one line, where the method has nothing for a view of what single methods have; `option` is
    the one that names methods."""
    method = Method.parse(settings.method)
    if view is View.CERTIFICATE and (method.adaptive or not method.has_certificates):
        may = "may make" if method.adaptive else "makes"
        raise ValueError(f"--view certificate: the method {settings.method} {may} none; give {option} {CERTIFIED}")
    if view is View.CUTS and not method.clusters:
        why = f"the method {settings.method} makes no clusters of lights"
        raise ValueError(f"--view {view.value}: {why}; give {option} {SHOWN_BY[view]}")
    if view.needs_fates and method.clusters:
        why = f"the method {settings.method} shades by clusters of lights, and single lights have no rays"
        raise ValueError(f"--view {view.value}: {why}; give {option} {BY_MODES}")
    shows = {View.VOXELS: ("voxels",), View.CELL_LIGHTS: ("lie-exact", "lie")}.get(view)
    if shows is not None and not any(name == method.base or method.has(name) for name in shows):
        raise ValueError(f"--view {view.value}: not with the method {settings.method}; give {option} {shows[0]}")


def check_tree(settings: Settings, view: View, scene: Scene) -> None:
    """Raise ValueError, in one line, where a view of what rays have had built meets a tree that is built before."""
    static = len(scene.objects[0].triangles) + len(scene.objects[0].quadrics)
    waits = settings.accelerator == LAZY or (settings.accelerator == BVH8 and static > LARGE)
    if view is View.TREE and not waits:
        why = f"{settings.accelerator} builds all of its tree before rays come; give --accelerator {LAZY}"
        raise ValueError(f"--view {view.value}: {why}")


def write_picture(path: Path, scene: Scene, frame: Frame, wanted: Recipe) -> None:
    """The frame as its recipe draws it; a PNG remembers, as the window's captures do, how it was made."""
    pixels, missing = stills.draw(frame, scene, wanted)
    if missing:
        say(missing)
    image = Image.fromarray(pixels)
    notes = png.notes(stills.text(pixels, frame, scene, wanted))
    kind = PICTURES[path.suffix.lower()]
    extras: dict[str, dict[str, Any]] = {"PNG": {"pnginfo": notes}, "JPEG": {"quality": 95}}
    png.write_image(path, image, kind, **extras.get(kind, {}))

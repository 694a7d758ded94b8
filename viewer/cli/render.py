"""The command `render`: one frame of a scene into a picture, its buffers, or both.

Whatever can be known to fail is found out before the tracing: the size, the frame, the camera, and whether the files
can be written.
"""

from __future__ import annotations

import math
from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from PIL import Image, PngImagePlugin

from tracer.culling import modes
from tracer.frame import Frame
from tracer.method import Method
from tracer.one_light import with_light
from tracer.renderer import Renderer
from tracer.scene.load import check_scene_file, load_visible_scene
from tracer.scene.model import Scene
from viewer.cli.console import Work, print_table, statistics_table, working
from viewer.cli.mesh_arguments import mesh_options
from viewer.cli.tracing_options import moment, prepare_kernels, tracing_settings
from viewer.output import capture
from viewer.output.legend import Chosen, legend_of
from viewer.output.legend_picture import with_legend
from viewer.output.pictures import lights_in_words, picture
from viewer.state.methods import CERTIFIED, default_for
from viewer.state.readings import MOST_RECORDED, can_record_lights, records_lights
from viewer.state.session import Session
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
}
BYTES_OF_A_LIGHT = 7  # of a pixel: samples asked and reached in 2 each, lit, due and shadow_mode in 1 each
LEGEND_PLACE = 0.0, 1.0  # the lower left corner


def render(path: Path, options: Namespace) -> None:
    """Trace one frame and write it; raises SceneError, ValueError and OSError in one line, or Cancelled."""
    check_scene_file(path)
    view, light = options.view.view, options.view.light
    modes = view.of_modes or options.buffers is not None
    settings = replace(tracing_settings(options), method=options.method or default_for(view), modes=modes)
    _check_outputs(options.output, options.buffers)
    method = Method.parse(settings.method)
    if view is View.CERTIFICATE and (method.adaptive or not method.has_certificates):
        may = "may make" if method.adaptive else "makes"
        raise ValueError(f"--view certificate: the method {settings.method} {may} none; give --method {CERTIFIED}")
    with working() as work:
        scene = load_visible_scene(path, work.progress, options.folder, mesh_options(options))
        for warning in scene.warnings:
            work.note(f"warning: {warning}")
        if view.of_light and light >= len(scene.lights):
            raise ValueError(f"--view {view.value}:{light}: {lights_in_words(len(scene.lights))}")
        pixels, count, all_of_them = settings.width * settings.height, len(scene.lights), options.buffers is not None
        if (all_of_them or view is View.LIGHTS) and not can_record_lights(pixels, count):
            raise ValueError(_too_many_lights(options, pixels, count))
        lights = all_of_them or records_lights(view, pixels, count)
        time = moment(scene, options.frame, options.time)
        prepare_kernels(work, len(scene.lights), options.accelerator, settings.method)
        renderer = Renderer(scene, replace(settings, verify=False), work.progress)
        before = _render_before(renderer, time, options, work)
        work.count(f"tracing {settings.width} × {settings.height}", before, before + options.samples)
        verify = settings.verify or view.needs_verify
        renderer.settings = replace(
            settings, samples=options.samples, verify=verify, record_lights=lights, record_work=view.needs_work
        )
        frame = renderer.render(time, options.camera, work.cancelled)
        if view.needs_lights and not lights:
            frame = with_light(renderer, frame, light)
        work.progress("writing", 1.0)
        if options.output is not None:
            _write_picture(options.output, scene, frame, options)
        if options.buffers is not None:
            arrays: dict[str, Any] = buffers(frame)
            write_whole(options.buffers, lambda file: np.savez(file, **arrays))
    title = f"{path.name}, {time:.3f} s, {frame.width} × {frame.height}, method {settings.method}"
    print_table(statistics_table(frame.statistics, title, verify))
    for written in (options.output, options.buffers):
        if written is not None:
            print(printable(written))


def buffers(frame: Frame) -> dict[str, np.ndarray]:
    """The arrays of `--buffers`, by name; the frame must have been rendered with `record_lights`.

    A verified frame has `reference` and `wrong` as well, one with certificates `certificate`, and one that recorded
    its work `saved`, `cost` and `due_rays`."""
    assert frame.lit is not None and frame.due is not None
    arrays: dict[str, np.ndarray] = {
        "color": frame.color,
        "depth": frame.depth,
        "primitive": frame.primitive,
        "cell": frame.cell,
        "occlusion_mode": frame.occlusion_mode,
        "shadow_mode": frame.shadow_mode,
        "lit": frame.lit,
        "due": frame.due,
    }
    if frame.reference is not None and frame.wrong is not None:
        arrays |= {"reference": frame.reference, "wrong": frame.wrong}
    if frame.certificates is not None:
        planes = [modes.shadow_mode(frame.certificates, light) for light in range(frame.lights)]
        arrays["certificate"] = np.stack(planes, axis=-1) if planes else np.empty((*frame.primitive.shape, 0), np.uint8)
    work = {"saved": frame.saved, "cost": frame.cost, "due_rays": frame.due_rays}
    arrays |= {name: array for name, array in work.items() if array is not None}
    return arrays


def _too_many_lights(options: Namespace, pixels: int, lights: int) -> str:
    option = "--buffers" if options.buffers is not None else f"--view {options.view.view.value}"
    needed, most = (BYTES_OF_A_LIGHT * n / 1e9 for n in (pixels * lights, MOST_RECORDED))
    return (
        f"{option}: {lights:,} lights at {pixels:,} pixels take {needed:.1f} GB, {most:.1f} GB at most; "
        f"give a smaller --size, of up to {MOST_RECORDED // lights:,} pixels"
    )


def _check_outputs(output: Path | None, npz: Path | None) -> None:
    if output is None and npz is None:
        raise ValueError("render: nothing to write; give -o out.png, --buffers out.npz, or both")
    if output is not None and output.suffix.lower() not in PICTURES:
        raise ValueError(f"{output}: unknown kind of picture; give one of {' '.join(PICTURES)}")
    if npz is not None and npz.suffix.lower() != ".npz":
        raise ValueError(f"{npz}: --buffers writes a .npz")
    for path in (output, npz):
        if path is not None:
            check_writable(path)


def _times_before(scene: Scene, time: float, count: int) -> list[float]:
    """Times of the frames that lead up to `time`, one frame's duration apart, none before the animation starts.

    A scene of one frame stands still: its frame is repeated.
    """
    start, end = scene.time_range
    if scene.frames < 2 or end <= start:
        return [time] * count
    step = (end - start) / (scene.frames - 1)
    whole = (time - start) / step
    # A time that is a frame's own reaches back to the very first frame, whatever rounding did to the quotient.
    available = math.floor(whole + 1e-6)
    first = max(available - count, 0)
    if abs(whole - available) < 1e-6:
        return [scene.frame_time(i) for i in range(first, available)]
    return [time - step * (available - i) for i in range(first, available)]


def _render_before(renderer: Renderer, time: float, options: Namespace, work: Work) -> int:
    """Render the frames of `--warmup`; returns how many there are."""
    times = _times_before(renderer.scene, time, options.warmup)
    if len(times) < options.warmup:
        work.note(f"--warmup {options.warmup}: only {len(times)} frames come before this one")
    for done, earlier in enumerate(times):
        work.count(f"warming up, frame {done + 1} of {len(times)}", done, len(times) + options.samples)
        renderer.render(earlier, options.camera, work.cancelled)
    return len(times)


def _write_picture(path: Path, scene: Scene, frame: Frame, options: Namespace) -> None:
    """The frame in the view asked for; a PNG remembers, as the window's captures do, how it was made."""
    view, light, wipe, shares = options.view
    pixels = picture(frame, view, light, marked=not options.no_marks, wipe=wipe, shares=shares)
    if options.legend:
        name = scene.lights[light].name if view.of_light else ""
        legend = legend_of(frame, view, Chosen(light, name, not options.no_marks, shares))
        described = with_legend(pixels, legend, LEGEND_PLACE) if legend is not None else None
        if described is None:
            say(f"no legend: {'the picture is too small for it' if legend else 'the traced picture needs none'}")
        pixels = pixels if described is None else described
    image = Image.fromarray(pixels)
    settings = replace(frame.settings, verify=options.verify)  # what was chosen; a view verifies by itself
    session = Session(scene, frame.time, options.camera, settings=settings, view=view, light=light, wipe=wipe)
    session.meshes = mesh_options(options)
    notes = PngImagePlugin.PngInfo()
    size = (frame.width, frame.height)
    text = capture.metadata(session.snapshot(), session.frame, size, frame.statistics.to_dict())
    notes.add_itxt(capture.CHUNK, text)
    notes.add_text("Software", "Shadowcull")
    kind = PICTURES[path.suffix.lower()]
    extras: dict[str, dict[str, Any]] = {"PNG": {"pnginfo": notes}, "JPEG": {"quality": 95}}

    def write(file: BinaryIO) -> None:
        image.save(file, kind, **extras.get(kind, {}))

    write_whole(path, write)

"""A picture by its state, or one by several methods: traced with the frames before it, drawn, and with what is kept of
it.

What the command `render`, films, figures and the window's own saved pictures have in common."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import word_type
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.inspect.one_light import with_light
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene import fingerprint
from tracer.scene.model import Scene
from tracer.util.version import program_version
from viewer.output import capture, commands
from viewer.output.comparison import Comparison, Shown
from viewer.output.overlays import with_caption, with_legend, with_savings
from viewer.state import codec
from viewer.state.methods import can_ask
from viewer.state.plans import MOST_PICTURE_PIXELS
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import MOST_RECORDED, Record, View, can_record_lights, recording
from viewer.views import colorize, legend_of
from viewer.views.legend import lights_in_words


def check_size(width: int, height: int) -> None:
    """Raise ValueError, in one line, for a picture that is too large."""
    if width * height > MOST_PICTURE_PIXELS:
        raise ValueError(f"{width} x {height} pixels are too many: {MOST_PICTURE_PIXELS:,} at most")


def check_lights(state: ViewState, scene: Scene, everything: bool = False) -> None:
    """Raise ValueError, in one line, where the scene does not have the light of the view, or where memory has no room
    for what all lights send to each pixel: for a view that shows it, or `everything`, as buffers have it."""
    draw, (width, height), lights = state.draw, state.size, len(scene.lights)
    if draw.view.of_light and draw.light >= lights:
        there = lights_in_words(lights + len(state.edits.lights_off))
        raise ValueError(f"--view {draw.view.value}:{state.edits.light_number(draw.light)}: {there}")
    recorded = everything or draw.view is View.LIGHTS or draw.view.records is Record.FATES
    if recorded and not can_record_lights(width * height, lights):
        what, most = "all buffers" if everything else f"the view {draw.view.value}", MOST_RECORDED // lights
        raise ValueError(f"{what} with {lights:,} lights: not enough memory; make the picture {most:,} pixels at most")


def times_before(scene: Scene, time: float, count: int) -> list[float]:
    """Times of the frames that lead up to `time`, one frame's duration apart, none before the animation starts.

    A scene of one frame stands still: its frame is repeated."""
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


def trace(
    renderer: Renderer, state: ViewState, everything: bool = False,
    on_frame: Callable[[int, int], None] = lambda done, total: None, cancelled: Callable[[], bool] = lambda: False,
    records: Iterable[Record] = (),
) -> Frame:  # fmt: skip
    """The state's frame, after those before it; `everything`: with modes, and all lights recorded; `records` besides
    those of its view.

    `on_frame` is told how many of these are done, before each.  Raises Cancelled."""
    scene, settings, view = renderer.scene, state.settings, state.draw.view
    times = times_before(scene, state.time, state.warmup.of_path) + [state.time] * state.warmup.repeats
    earlier = [*state.warmup.frames, *(WarmupFrame(time, state.camera) for time in times)]
    before = earlier if not state.warmup.modes else []
    modes = settings.modes or view.of_modes or everything or state.draw.savings is not None
    renderer.settings = replace(settings, samples=1, verify=False, modes=modes)
    for done, one in enumerate(before):
        on_frame(done, len(before) + 1)
        renderer.render(one.time, one.camera, cancelled)
    if state.warmup.modes:
        word = np.dtype(word_type(len(scene.lights)))
        renderer.begin_with(commands.unpacked(state.warmup.modes, renderer.units, word))
    on_frame(len(before), len(before) + 1)
    recorded = recording(view, settings.width * settings.height, len(scene.lights))
    recorded["verify"] |= settings.verify
    recorded["record_lights"] |= everything
    recorded |= {one.value: True for one in records}
    renderer.settings = replace(settings, modes=modes, **recorded)
    frame = renderer.render(state.time, state.camera, cancelled)
    if view.asks is not None and can_ask(frame, view):
        frame.layers |= view.asks(renderer, frame, state.draw.light, cancelled)
    lacks_light = view.records is Record.LIGHTS and not recorded["record_lights"]
    return with_light(renderer, frame, state.draw.light) if lacks_light else frame


def draw(
    frame: Frame, scene: Scene, state: ViewState, view: NDArray[np.uint8] | None = None
) -> tuple[NDArray[np.uint8], str]:
    """(h, w, 3) uint8, the frame as the state draws it, with all that goes over, above and below it; and why there is
    no legend where one was wanted, in words.  `view` is the view itself, where it is drawn already."""
    pixels = colorize(frame, state.draw) if view is None else view
    options, missing = state.draw, ""
    if options.legend:
        legend = legend_of(frame, options, scene.lights)
        described = with_legend(pixels, legend, options.legend_at) if legend is not None else None
        if described is None:
            none = f"the view {options.view.value} needs none"
            missing = f"no legend: {'the picture is too small for it' if legend is not None else none}"
        pixels = pixels if described is None else described
    pixels = with_savings(pixels, frame, options.savings)
    return with_caption(pixels, options.caption), missing


def with_caption_filled(state: ViewState, scene: Scene) -> ViewState:
    """The state with the fields of its caption (`capture.FIELDS`) filled in; raises CaptureError."""
    if not state.draw.caption:
        return state
    caption = capture.filled(state.draw.caption, fields_of(state, scene), what="caption")
    return state.with_draw(caption=caption)


def fields_of(state: ViewState, scene: Scene) -> dict[str, Any]:
    """Return the values of `capture.FIELDS` but for date and time."""
    draw, settings = state.draw, state.settings
    return {
        "scene": scene.path.stem, "view": draw.view.value, "frame": Session(scene).frame_at(state.time),
        "seconds": state.time, "method": settings.method, "light": draw.light, "width": settings.width,
        "height": settings.height,
    }  # fmt: skip


def trace_methods(
    scene: Scene, state: ViewState, comparison: Comparison, world: World,
    on_frame: Callable[[str, int, int], None] = lambda method, done, total: None,
    cancelled: Callable[[], bool] = lambda: False, records: Iterable[Record] = (),
) -> Shown:  # fmt: skip
    """Trace the frame of a state by each method, and by "none" as what is right, with modes of their own; the state's
    own method does not count.  Raises Cancelled.

    `on_frame` gets the method, and how many of its frames are done, of how many."""
    frames: dict[str, Frame] = {}
    for method in dict.fromkeys(("none", *comparison.methods)):
        found = Method.parse(method)
        wanted = state.with_settings(method=method)
        if found.has_certificates:
            wanted = wanted.with_settings(threads=1)  # which certificates are made depends on the turns of threads
        if not (found.culls or state.settings.modes or state.draw.view.of_modes):  # it learns nothing
            wanted = wanted.with_warmup(frames=())
        renderer = Renderer(scene, wanted.settings, world=world)
        told = partial(on_frame, method)
        frames[method] = trace(renderer, wanted, on_frame=told, cancelled=cancelled, records=records)
    warmed = len(state.warmup.frames) + len(times_before(scene, state.time, state.warmup.of_path))
    shown = {method: frames[method] for method in comparison.methods}
    return Shown(scene, state, comparison, shown, frames["none"], warmed)


def save_methods(shown: Shown, path: Path, text: str = "") -> None:
    """Draw one frame by several methods as a figure, and write it with the text that it carries, its own by default;
    raises OSError in one line."""
    from viewer.output import comparison_figure  # loads matplotlib

    made = capture.Made(program_version(), fingerprint.of_scene(shown.scene))
    own = carried(shown.state, shown.reference, shown.scene, made=made, figure=codec.to_json(shown.comparison))
    own = replace(own, statistics={method: frame.statistics.to_dict() for method, frame in shown.frames.items()})
    comparison_figure.save(shown, path, text or own.text())


def carried(state: ViewState, frame: Frame, scene: Scene, **more: Any) -> capture.Carried:
    """Return what a picture of the frame carries, and `more` fields of it."""
    return capture.Carried(
        codec.state_to_json(state, of_picture=True), frame.camera.to_json(), Session(scene).frame_at(frame.time),
        (frame.width, frame.height), frame.statistics.to_dict(), **more,
    )  # fmt: skip


def text(pixels: NDArray[np.uint8], frame: Frame, scene: Scene, state: ViewState) -> str:
    """Return what a picture carries as text, with its modes, where these cannot be learnt again."""
    kept = state if commands.by_one_thread(state) else state.with_settings(threads=0)
    kept = kept.with_warmup(modes=commands.packed(frame, state))
    made = capture.Made(program_version(), fingerprint.of_scene(scene), fingerprint.of_pixels(pixels))
    return carried(kept, frame, scene, made=made).text()

"""One picture by its recipe: traced with the frames before it, drawn, and with what is kept of it.

What the command `render`, films, figures and the window's own saved pictures have in common.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracer import fingerprint
from tracer.culling.modes import word_type
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame
from tracer.one_light import with_light
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.version import program_version
from viewer.output import capture, kept_modes
from viewer.output.caption import with_caption
from viewer.output.legend_picture import with_legend
from viewer.output.recipe import Recipe
from viewer.output.savings_picture import with_savings
from viewer.state.readings import can_record_lights, records_lights
from viewer.state.session import Session
from viewer.state.views import View
from viewer.views import colorize, legend_of
from viewer.views.legend import lights_in_words


def check_light(recipe: Recipe, scene: Scene) -> None:
    """Raise ValueError, in one line, where the view speaks of a light that the scene does not have."""
    if recipe.view.of_light and recipe.light >= len(scene.lights):
        number, lights = recipe.edits.light_number(recipe.light), len(scene.lights) + len(recipe.edits.lights_off)
        raise ValueError(f"--view {recipe.view.value}:{number}: {lights_in_words(lights)}")


def times_before(scene: Scene, time: float, count: int) -> list[float]:
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


def trace(
    renderer: Renderer,
    recipe: Recipe,
    everything: bool = False,
    on_frame: Callable[[int, int], None] = lambda done, total: None,
    cancelled: Callable[[], bool] = lambda: False,
) -> Frame:
    """The recipe's frame, after those before it; `everything`: with modes, and all lights recorded.

    `on_frame` is told how many of these are done, before each.  Raises Cancelled."""
    scene, settings, view = renderer.scene, recipe.settings, recipe.view
    times = times_before(scene, recipe.time, recipe.warmup) + [recipe.time] * recipe.repeats
    before = [*recipe.before, *(WarmupFrame(time, recipe.camera) for time in times)] if not recipe.modes else []
    modes = settings.modes or view.of_modes or everything or recipe.tells_counters
    renderer.settings = replace(settings, samples=1, verify=False, modes=modes)
    for done, earlier in enumerate(before):
        on_frame(done, len(before) + 1)
        renderer.render(earlier.time, earlier.camera, cancelled)
    if recipe.modes:
        renderer.begin_with(kept_modes.unpacked(recipe.modes, renderer.units, np.dtype(word_type(len(scene.lights)))))
    on_frame(len(before), len(before) + 1)
    lights = everything or records_lights(view, settings.width * settings.height, len(scene.lights))
    renderer.settings = replace(
        settings,
        modes=modes,
        verify=settings.verify or view.needs_verify,
        record_lights=lights,
        record_fates=view.needs_fates,
        record_work=view.needs_work,
    )
    frame = renderer.render(recipe.time, recipe.camera, cancelled)
    return with_light(renderer, frame, recipe.light) if view.needs_lights and not lights else frame


def lights_fit(recipe: Recipe, scene: Scene, everything: bool = False) -> bool:
    """Whether there is memory for what all lights send to each pixel, where that is to be recorded."""
    width, height = recipe.size
    recorded = everything or recipe.view is View.LIGHTS or recipe.view.needs_fates
    return not recorded or can_record_lights(width * height, len(scene.lights))


def draw(frame: Frame, scene: Scene, recipe: Recipe) -> tuple[NDArray[np.uint8], str]:
    """(h, w, 3) uint8, the frame as the recipe draws it, with all that goes with it; and why there is no legend where
    one was wanted, in words."""
    pixels = colorize(frame, recipe.draw)
    return dressed(pixels, frame, scene, recipe)


def dressed(pixels: NDArray[np.uint8], frame: Frame, scene: Scene, recipe: Recipe) -> tuple[NDArray[np.uint8], str]:
    """What lies over a drawn view (h, w, 3), above and below it; as `draw`."""
    style, missing = recipe.style, ""
    if style.legend is not None:
        legend = legend_of(frame, recipe.draw, scene.lights)
        described = with_legend(pixels, legend, style.legend) if legend is not None else None
        if described is None:
            missing = f"no legend: {'the picture is too small for it' if legend else 'the traced picture needs none'}"
        pixels = pixels if described is None else described
    pixels = with_savings(pixels, frame, style.savings)
    return with_caption(pixels, style.caption), missing


def with_caption_filled(recipe: Recipe, scene: Scene) -> Recipe:
    """The recipe with the fields of its caption (`capture.FIELDS`) filled in; raises CaptureError."""
    if not recipe.style.caption:
        return recipe
    values = {
        "scene": scene.path.stem,
        "view": recipe.view.value,
        "frame": Session(scene).frame_at(recipe.time),
        "seconds": recipe.time,
        "method": recipe.settings.method,
        "light": recipe.light,
        "width": recipe.settings.width,
        "height": recipe.settings.height,
    }
    caption = capture.filled(recipe.style.caption, values, what="caption")
    return replace(recipe, style=replace(recipe.style, caption=caption))


def text(pixels: NDArray[np.uint8], frame: Frame, scene: Scene, recipe: Recipe) -> str:
    """What a picture carries: its recipe, its statistics, and what they were made of; and its modes, where these cannot
    be learnt again."""
    kept = replace(recipe, modes=kept_modes.packed(frame, recipe))
    more = {
        "picture": {"by_gpu": recipe.by_gpu},
        "made": {
            "version": program_version(),
            "scene": fingerprint.of_scene(scene),
            "pixels": fingerprint.of_pixels(pixels),
        },
    }
    number, size = Session(scene).frame_at(frame.time), (frame.width, frame.height)
    return capture.metadata(kept.state(), frame.camera, number, size, frame.statistics.to_dict(), more)

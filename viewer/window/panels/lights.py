"""The lights of the scene: as a list, to choose one from, and what lamps are made of them.

A scene may have thousands: a list draws the rows that are seen, and finds lights by words of their names."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from imgui_bundle import imgui

from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.scene.lights import Light, as_lamps, number_of
from tracer.scene.model import Scene
from tracer.util.setting import Setting
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, count, dropdown, em, one_of_list, paragraph, row, seen_rows, swatch, tooltip

FEW = 8
"""Lights that are listed without a field to find them."""
_ROWS = 6  # of the list that are seen at once
_SMALLEST, _LARGEST = 1e-5, 0.1  # radius on the slider, of the scene's diagonal
_SCENE_SAYS = "as the scene says"
_RADIUS = " A larger lamp has softer shadows, and more pixels in its penumbra, where no ray can be saved."
_SAMPLES = " Each takes a shadow ray. In motion there are few; at rest more follow, up to these."


@dataclass
class LightFilters:
    """What is typed above each list of lights."""

    texts: dict[str, str] = field(default_factory=dict)


def lamp_radius(ui: Ui, one: Setting) -> None:
    """Show the row of the radius: a slider from points on, as far as the scene is large."""
    c = ui.controller
    s, size = c.session.settings, diagonal(c.info.get("bounds"))
    row(one.label, one.help + _RADIUS)
    imgui.set_next_item_width(-imgui.get_frame_height() - em(0.3))
    shown = "%.7g" if s.lamp_radius else ("points" if s.lamp_radius == 0.0 else _SCENE_SAYS)
    smallest, flags = _SMALLEST * size, int(imgui.SliderFlags_.logarithmic)
    changed, value = imgui.slider_float("##lamp-radius", s.lamp_radius or 0.0, smallest, _LARGEST * size, shown, flags)
    if changed:
        c.settings.change(lamp_radius=0.0 if value <= smallest else float(f"{value:.3g}"))
    imgui.same_line(0.0, em(0.2))
    imgui.begin_disabled(s.lamp_radius is None)
    if imgui.button("x##lamp-radius"):
        c.settings.change(lamp_radius=None)
    imgui.end_disabled()
    tooltip("lights as the scene says")


def lamp_samples(ui: Ui, one: Setting) -> None:
    """Show the row of the samples: numbers that are worth choosing, where there is a lamp."""
    c = ui.controller
    s = c.session.settings
    row(one.label, one.help + _SAMPLES)
    imgui.begin_disabled(c.scheduler.lamps.wanted == 1 and not c.scheduler.lamps.any)
    choices = [(number, str(number or _SCENE_SAYS), "") for number in (None, 1, 4, 16, 64, 256)]
    chosen = one_of_list("##lamp-samples", str(s.lamp_samples or _SCENE_SAYS), choices, s.lamp_samples)
    imgui.end_disabled()
    if chosen != s.lamp_samples:
        c.settings.change(lamp_samples=chosen)


def diagonal(bounds: Sequence[Sequence[float]] | None) -> float:
    """Return how large a scene is; 1 where nothing is in it."""
    return (math.dist(*bounds) if bounds is not None else 0.0) or 1.0


def table(ui: Ui) -> None:
    """A list of all lights; a click chooses the one that views show."""
    _list(ui, "table", _ROWS, ui.controller.session.draw.light, ui.controller.settings.set_light)


def combo(
    ui: Ui, place: str, chosen: int | None, choose: Callable[[int], None], all_of_them: Callable[[], None] | None = None
) -> None:
    """A light to choose, or `all_of_them` together, which is None of them."""
    if dropdown("##light", "all lights" if chosen is None else ui.light_name(chosen)):
        if imgui.is_window_appearing():
            ui.state(LightFilters).texts[place] = ""
        if all_of_them is not None and imgui.selectable("all lights", chosen is None)[0]:
            all_of_them()
        if _list(ui, place, 2 * _ROWS, chosen, choose):
            imgui.close_current_popup()
        imgui.end_combo()


def _list(ui: Ui, place: str, most: int, chosen: int | None, choose: Callable[[int], None]) -> bool:
    """The lights that are found, so many rows of them at once; whether one was clicked."""
    clicked = False
    for number in rows(found(ui, place), most, imgui.get_text_line_height_with_spacing()):
        if _row(ui, number, chosen == number):
            choose(number)
            clicked = True
    return clicked


def rows(numbers: Sequence[int], most: int, height: float) -> Iterator[int]:
    """Yield the lights whose rows are to be drawn, each so high: those that are seen, up to `most` at once."""
    if imgui.begin_child("lights", (0.0, min(max(len(numbers), 1), most) * height + 2.0)):
        for place in seen_rows(len(numbers), height):
            yield numbers[place]
    imgui.end_child()


def _row(ui: Ui, index: int, chosen: bool) -> bool:
    scene, s = ui.controller.session.scene, ui.controller.session.settings
    assert scene is not None
    (light,) = as_lamps((scene.lights[index],), s.lamp_radius, s.lamp_samples)
    red, green, blue = (channel / max(*light.color, 1e-9) for channel in light.color)
    swatch((red, green, blue))
    remarks = [] if light.kind == "point" else [f"{light.kind}, {light.samples}"]
    remarks += ["moves"] if light.track else []
    remarks += ["not culled"] if index >= MAX_CULLED_LIGHTS else []
    said = f"  ({', '.join(remarks)})" if remarks else ""
    clicked, _ = imgui.selectable(f"{ui.light_name(index)}{said}##{index}", chosen)
    tooltip(description(light))
    return clicked


def found(ui: Ui, place: str, among: Scene | None = None) -> Sequence[int]:
    """Return the lights whose names have what is typed above them, of the scene that is shown or of another; all where
    they are few, and nothing is typed."""
    state, scene = ui.state(LightFilters), among or ui.controller.session.scene
    assert scene is not None
    number = len(scene.lights)
    if number <= FEW:
        return range(number)
    imgui.set_next_item_width(-1.0)
    hint = f"find among {count(number)} lights"
    _, text = imgui.input_text_with_hint(f"##find-{place}", hint, state.texts.get(place, ""))
    state.texts[place] = text
    numbers: Sequence[int] = ui.cached(f"lights {place}", scene, text, lambda: matching(scene.lights, text))
    if text:
        paragraph(f"{count(len(numbers))} of {count(number)}", QUIET)
    return numbers


def matching(lights: Sequence[Light], text: str) -> Sequence[int]:
    """Return numbers of the lights in whose number, name or kind every typed word occurs; a number alone is that
    light's."""
    words = text.lower().split()
    numbers = [number_of(lights, i) for i in range(len(lights))]
    if len(words) == 1 and words[0].isdecimal() and int(words[0]) in range(max(numbers, default=0) + 1):
        return [i for i, number in enumerate(numbers) if number == int(words[0])]
    said = (f"light {numbers[i]} {light.name.lower()} {light.kind}" for i, light in enumerate(lights))
    return [i for i, one in enumerate(said) if all(word in one for word in words)]


def description(light: Light) -> str:
    """Return a light in words: its kind, size, samples, falloff, place and colour."""
    size = f" of radius {light.radius:.4g}" if light.kind in ("sphere", "dome") else ""
    if light.kind == "rectangle":
        size = " of {:.4g} x {:.4g}".format(*(math.hypot(*edge) for edge in light.edges))
    samples = "" if light.kind == "point" else f", {light.samples} {'sample' if light.samples == 1 else 'samples'}"
    falloff = "no falloff" if light.falloff == "none" else "falls off with the square of the distance"
    place = "at ({:.4g}, {:.4g}, {:.4g}), colour ({:.3g}, {:.3g}, {:.3g})".format(*light.position, *light.color)
    return f"{light.kind}{size}{samples}; {falloff}; {place}"

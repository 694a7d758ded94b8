"""The lights of the scene: as a list, to choose one from, and what lamps are made of them.

A scene may have thousands: a list draws the rows that are seen, and finds lights by words of their names.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from imgui_bundle import imgui

from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.scene.lights import Light, as_lamps, number_of
from tracer.scene.model import Scene
from viewer.services.refinement import OFFERED
from viewer.window.setting_rows import ALL
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, count, em, paragraph, row, tooltip

FEW = 8
"""Lights that are listed without a field to find them."""
_ROWS = 6  # of the list that are seen at once
_SMALLEST, _LARGEST = 1e-5, 0.1  # radius on the slider, of the scene's diagonal
_SCENE_SAYS = "as the scene says"
_RADIUS = " A larger lamp has softer shadows, and more pixels in its penumbra, where no ray can be saved."
_SAMPLES = " Each takes a shadow ray. In motion there are few; at idle more follow, up to these."


@dataclass
class LightFilters:
    """What is typed above each list of lights."""

    texts: dict[str, str] = field(default_factory=dict)


def lamp_rows(ui: Ui) -> None:
    """Rows of settings: what lamps point lights are made, and how many samples these have."""
    c = ui.controller
    s = c.session.settings
    scene = c.session.scene
    assert scene is not None
    radius, samples = ALL["settings.lamp_radius"], ALL["settings.lamp_samples"]
    row(radius.label, radius.help + _RADIUS)
    size = diagonal(c.info.get("bounds"))
    smallest, largest = _SMALLEST * size, _LARGEST * size
    button = imgui.get_frame_height() if s.lamp_radius is not None else 0.0
    imgui.set_next_item_width(-button - (em(0.2) if button else 0.0) - 1.0)
    shown = "%.7g" if s.lamp_radius else ("points" if s.lamp_radius == 0.0 else _SCENE_SAYS)
    flags = int(imgui.SliderFlags_.logarithmic)
    changed, size = imgui.slider_float("##lamp-radius", s.lamp_radius or 0.0, smallest, largest, shown, flags)
    if changed:
        c.settings.change(lamp_radius=0.0 if size <= smallest else float(f"{size:.3g}"))
    if button:
        imgui.same_line(0.0, em(0.2))
        if imgui.button("x##lamp-radius", (button, button)):
            c.settings.change(lamp_radius=None)
        tooltip("lights as the scene says")
    row(samples.label, samples.help + _SAMPLES)
    most = c.scheduler.lamps.wanted
    imgui.begin_disabled(most == 1 and not c.scheduler.lamps.any)
    if imgui.begin_combo("##lamp-samples", str(s.lamp_samples) if s.lamp_samples else _SCENE_SAYS):
        for number in (None, *OFFERED):
            if imgui.selectable(str(number) if number else _SCENE_SAYS, s.lamp_samples == number)[0]:
                c.settings.change(lamp_samples=number)
        imgui.end_combo()
    imgui.end_disabled()


def diagonal(bounds: Sequence[Sequence[float]] | None) -> float:
    """How large a scene is; 1 where nothing is in it."""
    return (math.dist(*bounds) if bounds is not None else 0.0) or 1.0


def table(ui: Ui) -> None:
    """A list of all lights; a click chooses the one that views show."""
    shown = found(ui, "table")
    height = min(max(len(shown), 1), _ROWS) * imgui.get_text_line_height_with_spacing() + 2.0
    if imgui.begin_child("lights", (0.0, height)):
        _rows(ui, shown, ui.controller.session.draw.light, ui.controller.settings.set_light, described=True)
    imgui.end_child()


def combo(
    ui: Ui, place: str, chosen: int | None, choose: Callable[[int], None], all_of_them: Callable[[], None] | None = None
) -> None:
    """A light to choose, or `all_of_them` together, which is None of them."""
    if imgui.begin_combo("##light", "all lights" if chosen is None else ui.light_name(chosen)):
        if imgui.is_window_appearing():
            ui.state(LightFilters).texts[place] = ""
        if all_of_them is not None and imgui.selectable("all lights", chosen is None)[0]:
            all_of_them()
        shown = found(ui, place)
        if imgui.begin_child("lights", (0.0, min(max(len(shown), 1), 2 * _ROWS) * _line() + 2.0)):
            if _rows(ui, shown, chosen, choose, described=False):
                imgui.close_current_popup()
        imgui.end_child()
        imgui.end_combo()


def found(ui: Ui, place: str, among: Scene | None = None) -> Sequence[int]:
    """The lights whose names have what is typed above them, of the scene that is shown or of another; all where they
    are few, and nothing is typed."""
    state = ui.state(LightFilters)
    scene = among or ui.controller.session.scene
    assert scene is not None
    number = len(scene.lights)
    if number <= FEW:
        return range(number)
    text = state.texts.get(place, "")
    imgui.set_next_item_width(-1.0)
    _, text = imgui.input_text_with_hint(f"##find-{place}", f"find among {count(number)} lights", text)
    state.texts[place] = text
    numbers: Sequence[int] = ui.cached(f"lights {place}", scene, text, lambda: matching(scene.lights, text))
    if text:
        paragraph(f"{count(len(numbers))} of {count(number)}", QUIET)
    return numbers


def matching(lights: Sequence[Light], text: str) -> Sequence[int]:
    """Numbers of the lights in whose number, name or kind every typed word occurs; a number alone is that light's."""
    words = text.lower().split()
    if not words:
        return range(len(lights))
    if len(words) == 1 and words[0].isdecimal() and len(lights) and int(words[0]) <= number_of(lights, len(lights) - 1):
        return [i for i in range(len(lights)) if number_of(lights, i) == int(words[0])]
    said = (f"light {number_of(lights, i)} {light.name.lower()} {light.kind}" for i, light in enumerate(lights))
    return [i for i, one in enumerate(said) if all(word in one for word in words)]


def _rows(ui: Ui, numbers: Sequence[int], chosen: int | None, choose: Callable[[int], None], described: bool) -> bool:
    """Those rows of a list that are seen; whether one was clicked."""
    scene, s, any_clicked = ui.controller.session.scene, ui.controller.session.settings, False
    assert scene is not None
    clipper = imgui.ListClipper()
    clipper.begin(len(numbers), _line())
    while clipper.step():
        for k in range(clipper.display_start, clipper.display_end):
            index = numbers[k]
            (light,) = as_lamps((scene.lights[index],), s.lamp_radius, s.lamp_samples)
            _color(index, light)
            imgui.same_line()
            clicked, _ = imgui.selectable(f"{ui.light_name(index)}{_remarks(index, light)}##{index}", chosen == index)
            if described:
                tooltip(description(light))
            if clicked:
                choose(index)
                any_clicked = True
    clipper.end()
    return any_clicked


def _line() -> float:
    return float(imgui.get_text_line_height_with_spacing())


def _color(index: int, light: Light) -> None:
    strongest = max(*light.color, 1e-9)
    red, green, blue = (channel / strongest for channel in light.color)
    side = imgui.get_text_line_height()
    imgui.push_style_var(imgui.StyleVar_.frame_border_size, 1.0)  # white ones are seen on white
    imgui.color_button(f"##light{index}", (red, green, blue, 1.0), int(imgui.ColorEditFlags_.no_tooltip), (side, side))
    imgui.pop_style_var()


def _remarks(index: int, light: Light) -> str:
    parts = [] if light.kind == "point" else [f"{light.kind}, {light.samples}"]
    parts += ["moves"] if light.track else []
    parts += ["not culled"] if index >= MAX_CULLED_LIGHTS else []
    return f"  ({', '.join(parts)})" if parts else ""


def description(light: Light) -> str:
    """A light in words: its kind, size, samples, falloff, place and colour."""
    size = f" of radius {light.radius:.4g}" if light.kind in ("sphere", "dome") else ""
    if light.kind == "rectangle":
        size = " of {:.4g} x {:.4g}".format(*(math.hypot(*edge) for edge in light.edges))
    samples = "" if light.kind == "point" else f", {light.samples} {'sample' if light.samples == 1 else 'samples'}"
    falloff = "no falloff" if light.falloff == "none" else "falls off with the square of the distance"
    place = "at ({:.4g}, {:.4g}, {:.4g}), colour ({:.3g}, {:.3g}, {:.3g})".format(*light.position, *light.color)
    return f"{light.kind}{size}{samples}; {falloff}; {place}. Views of one light show the one that is chosen."

"""The list that a method is chosen from: in groups, each with its sentence."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import ImVec4, imgui

from tracer.fit import lamps_in, worth
from tracer.method import Kind, Method, additions
from viewer.state.methods import groups, toggled, with_base
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, em, fitted, outlined, tooltip

_NAMES = 10.5  # ems of the names; sentences begin behind them
_SENTENCE = 12.0  # ems that are worth beginning one


def method_list(ui: Ui, name: str, method: str, choose: Callable[[str], None], combined: bool = True) -> None:
    """A list to be opened, as wide as there is room for; `choose` is given the name of what is chosen.

    Methods that have nothing to say of the scene are pale.  `combined`: additions are in it."""
    lights = lights_to_fit(ui)
    parsed = Method.parse(method)
    room = imgui.calc_item_width() - imgui.get_frame_height() - 2.0 * imgui.get_style().frame_padding.x
    if not imgui.begin_combo(name, fitted(method, room), int(imgui.ComboFlags_.height_largest)):
        tooltip(Method.parse(method).kind.summary if method == parsed.base else method)
        return
    for heading, kinds in groups():
        imgui.separator_text(heading)
        for kind in kinds:
            if imgui.selectable(kind.name, kind is parsed.kind)[0]:
                choose(with_base(method, kind.name))
            _sentence(kind, lights)
    if combined:
        imgui.separator_text("Added to it, any number of them")
        for kind in additions(parsed.base):
            with outlined():
                changed, _ = imgui.checkbox(f"+{kind.name}", parsed.has(kind.name))
            if changed:
                choose(toggled(method, kind.name))
            _sentence(kind, lights)
    imgui.end_combo()


def _sentence(kind: Kind, lights: tuple[int, int]) -> None:
    """What the method of the last item does, behind its name, or as far as the window is wide enough for it."""
    tooltip(said_of(kind, lights))
    room = imgui.get_main_viewport().work_size.x - em(_NAMES + 3.0)
    if room < em(_SENTENCE):
        return
    imgui.same_line(em(_NAMES))
    imgui.text_colored(QUIET if kind.fits(*lights) else pale(), fitted(kind.summary, room))


def said_of(kind: Kind, lights: tuple[int, int]) -> str:
    """What a method does, and why it has nothing to say of so many lights and samples of them where it has not."""
    return " ".join(filter(None, (kind.summary, worth(kind, *lights))))


def lights_to_fit(ui: Ui) -> tuple[int, int]:
    """How many lights the scene has, and how many samples these have together as they are set."""
    session = ui.controller.session
    scene = session.scene
    if scene is None:
        return 0, 0
    radius, samples = session.settings.lamp_radius, session.settings.lamp_samples

    def look() -> int:
        return lamps_in(scene.lights, radius, samples)[1]

    return len(scene.lights), ui.cached("samples of the lights", scene, (radius, samples), look)


def pale() -> ImVec4:
    """The colour of methods that have nothing to say of the scene."""
    return imgui.get_style_color_vec4(imgui.Col_.text_disabled)

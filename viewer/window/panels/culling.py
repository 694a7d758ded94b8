"""The panel Culling: the method, what it trusts, and its settings; and the list that methods are chosen from."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from imgui_bundle import ImVec4, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.method import Kind, Method, additions
from tracer.methods.method_limits import lamps_in, worth
from tracer.util.setting import Setting
from viewer.services.controller import Controller
from viewer.state import verified
from viewer.state.methods import about, groups, toggled, with_base
from viewer.window import menus
from viewer.window.setting_rows import panel_rows
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, dropdown, em, fitted, outlined, paragraph, tooltip

_OF_MODES = ("settings.symmetric", "settings.zoom_factor")
_NAMES = 18.0  # ems of the names of methods; sentences begin behind them
_SENTENCE = 12.0  # ems that are worth beginning one


def show(ui: Ui) -> None:
    """Show the panel."""
    c = ui.controller
    method = Method.parse(c.session.settings.method)
    paragraph(trust(c), QUIET)

    def note(one: Setting) -> str:
        if one.path in _OF_MODES and not method.uses_modes:
            return f"\n{method.title} does not cull by modes: it changes those kept for the views alone."
        return ""

    panel_rows(ui, "Culling", 8.2 if method.has_certificates else 6.5, note=note)
    menus.button(ui, "Reset modes", icons.ICON_FA_ERASER, columns=2)
    imgui.same_line()
    menus.button(ui, "Trace again", icons.ICON_FA_ROTATE_RIGHT)
    said = wrong_answers(c)
    if said is not None:  # at the end, where it moves nothing
        paragraph(*said)


def trust(c: Controller) -> str:
    """Return what the chosen method trusts and whether it is exact, then what it does in the newest picture, and
    why."""
    frame, name = c.frame, c.session.settings.method
    kinds = Method.parse(name).kinds
    said = [kind.summary if len(kinds) == 1 else f"{kind.title}: {kind.summary}" for kind in kinds]
    if frame is not None and frame.settings.method == name and c.runs.current is None:
        said.append(frame.statistics.decision)
    return " ".join(filter(None, said))


def wrong_answers(c: Controller) -> tuple[str, ImVec4] | None:
    """Return what is wrong in the newest frame, and a colour; None where that is not known, or where the frame was
    traced with another method than the panel shows.  A run has figures of its own, in its panel."""
    if c.frame is None or not c.frame.settings.verify:
        return None
    if c.runs.current is not None:
        return f"The panel of the {c.runs.current.name} shows its wrong answers.", QUIET
    if c.frame.settings.method != c.scheduler.inputs.settings.method:
        return None
    said, color = verified.in_words(c.frame.statistics), ERROR if verified.is_wrong(c.frame.statistics) else QUIET
    if not c.scheduler.inputs.settings.verify or c.session.settings.verify:
        return said, color
    return f"{said} (verified for the view {c.session.draw.view.label})", color


# --- the list of methods -----------------------------------------------------------------------------


def method_list(ui: Ui, name: str, method: str, choose: Callable[[str], None], combined: bool = True) -> None:
    """Show a list to be opened, as wide as there is room for; `choose` is given the name of what is chosen.

    Methods that have nothing to say of the scene are pale.  `combined`: additions are in it."""
    parsed = Method.parse(method)
    if not dropdown(name, parsed.title, int(imgui.ComboFlags_.height_largest)):
        tooltip(f"{parsed.title}\n{about(*parsed.kinds)}")
        return

    def base(kind: Kind) -> None:
        if imgui.selectable(kind.title, kind is parsed.kind)[0]:
            choose(with_base(method, kind.name))

    def addition(kind: Kind) -> None:
        with outlined():
            if imgui.checkbox(kind.plus, parsed.has(kind.name))[0]:
                choose(toggled(method, kind.name))

    kinds_of_methods(ui, groups(), base)
    if combined:
        kinds_of_methods(ui, [("Additions, any number of them", additions(parsed.base))], addition)
    imgui.end_combo()


def kinds_of_methods(ui: Ui, groups: Iterable[tuple[str, Iterable[Kind]]], show: Callable[[Kind], None]) -> None:
    """Show kinds of methods below the heading of their group, with what each does; those that have nothing to say of
    the scene are pale."""
    lights, room = _lights_to_fit(ui), imgui.get_main_viewport().work_size.x - em(_NAMES + 3.0)
    for heading, kinds in groups:
        imgui.separator_text(heading)
        for kind in kinds:
            show(kind)
            tooltip("\n".join(filter(None, (worth(kind, *lights), about(kind)))))
            if room >= em(_SENTENCE):
                pale = imgui.get_style_color_vec4(imgui.Col_.text_disabled)
                imgui.same_line(em(_NAMES))
                imgui.text_colored(QUIET if kind.fits(*lights) else pale, fitted(kind.summary, room))


def _lights_to_fit(ui: Ui) -> tuple[int, int]:
    """Return how many lights the scene has, and how many samples these have together as they are set."""
    scene, settings = ui.controller.session.scene, ui.controller.session.settings
    if scene is None:
        return 0, 0
    chosen = settings.lamp_radius, settings.lamp_samples
    return len(scene.lights), ui.cached(
        "samples of the lights", scene, chosen, lambda: lamps_in(scene.lights, *chosen)[1]
    )

"""The row above the picture: how shadow rays are culled, what is shown, and for which light."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.state.views import View
from viewer.window.panels import lights
from viewer.window.panels.culling import method_list
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, em, right, tooltip

_METHODS, _VIEWS, _LIGHTS = 11.0, 11.0, 9.0  # ems of the lists
_GAP = 1.0


def height() -> float:
    """Return how much of the room for the picture the row takes."""
    return imgui.get_frame_height_with_spacing()


def show(ui: Ui, width: float) -> None:
    """Show the row; where it is narrow, the lists are."""
    c = ui.controller
    draw, scene, name = c.session.draw, c.session.scene, c.session.settings.method
    of_light = draw.view.of_light and scene is not None and len(scene.lights) > 0
    names = sum(imgui.calc_text_size(word).x + em(0.3 + _GAP) for word in ("Method", "View", "Light")[: 2 + of_light])
    factor = min(1.0, max(width - names, 0.0) / em(_METHODS + _VIEWS + _LIGHTS * of_light))
    key = ui.key_label("Shadow culling")
    _name("Method", "Which shadow rays are not traced." + (f" {key} turns culling off and on." if key else ""))
    imgui.set_next_item_width(factor * em(_METHODS))
    method_list(ui, "##method", name, lambda chosen: c.settings.change(method=chosen))
    imgui.same_line(0.0, em(_GAP))
    _name("View", f"{draw.view.help}\nThe key of each view stands beside it in the list.")
    imgui.set_next_item_width(factor * em(_VIEWS))
    _views(ui)
    if of_light:
        imgui.same_line(0.0, em(_GAP))
        _name("Light", f"The light that the view is about{ui.key('Next light')}.")
        imgui.set_next_item_width(factor * em(_LIGHTS))
        lights.combo(ui, "view", draw.light, c.settings.set_light)


def _name(name: str, tip: str) -> None:
    imgui.align_text_to_frame_padding()
    imgui.text_colored(QUIET, name)
    tooltip(tip)
    imgui.same_line(0.0, em(0.3))


def _views(ui: Ui) -> None:
    """Show all views to choose from, each with its key."""
    chosen = ui.controller.session.draw.view
    if not imgui.begin_combo("##view", chosen.label, int(imgui.ComboFlags_.height_largest)):
        return
    for view in View:
        if imgui.selectable(f"{view.label}##{view.value}", view is chosen)[0]:
            ui.controller.session.set_draw(view=view)
        tooltip(view.help)
        if view is chosen:
            imgui.set_item_default_focus()
        imgui.same_line()
        right(ui.key_label(view.label), QUIET)
    imgui.end_combo()

"""The rows around the picture: method, view and light above it, time below it."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.views import View
from viewer.window import menus
from viewer.window.panels import lights
from viewer.window.panels.culling import method_list
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, dropdown, em, right, tooltip

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
    if not dropdown("##view", chosen.label, int(imgui.ComboFlags_.height_largest)):
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


# --- time ---------------------------------------------------------------------------------------------


def time_height() -> float:
    """Return how much of the room for the picture the row below it takes."""
    return imgui.get_frame_height_with_spacing() + em(0.3)


def show_time(ui: Ui) -> None:
    """Show the row below the picture: play, pause, step and scrub along the scene's own time."""
    c, session = ui.controller, ui.controller.session
    if session.scene is None:
        return
    imgui.dummy(ImVec2(0.0, em(0.05)))
    run, last = c.runs.current, session.scene.frames - 1
    imgui.begin_disabled(run is not None)
    _button(ui, "Step back", icons.ICON_FA_BACKWARD_STEP)
    _button(ui, "Play", icons.ICON_FA_PAUSE if session.playing else icons.ICON_FA_PLAY)
    _button(ui, "Step forward", icons.ICON_FA_FORWARD_STEP)
    _button(ui, "Follow the scene's path", icons.ICON_FA_ROUTE, lit=session.on_path)
    time, frame, words = session.time, session.frame, f"frame %d of {last}"
    if run is not None and c.frame is not None:  # the picture is the run's, of another moment
        time, words = c.frame.time, f"{run.name}: {run.label_shown}".replace("%", "%%")
        frame = session.frame_at(time)
    room = imgui.get_content_region_avail().x
    if imgui.calc_text_size(words).x > room - em(1.0):
        words = "%d"
    imgui.set_next_item_width(max(em(2.5), room))
    changed, frame = imgui.slider_int(
        "##frame", frame, 0, last, f"{words},  {time:.2f} s" if room > em(16.0) else words
    )
    if changed:
        c.motion.step(frame - session.frame)
    tooltip(f"drag to go through the frames; Ctrl+click to type a number ({time:.2f} s)")
    imgui.end_disabled()


def _button(ui: Ui, name: str, icon: str, lit: bool = False) -> None:
    """A button that runs a command, beside which the line goes on."""
    color = imgui.Col_.button_active if lit else imgui.Col_.button
    imgui.push_style_color(imgui.Col_.button, imgui.get_style_color_vec4(color))
    menus.button(ui, name, icon, width=2.0)
    imgui.pop_style_color()
    imgui.same_line(0.0, em(0.25))

"""Play, pause, step and scrub along the scene's own time, under the picture."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.window import menus
from viewer.window.ui import Ui
from viewer.window.widgets import em, tooltip


def height() -> float:
    """Return what the bar takes of the window, in ImGui's units."""
    return imgui.get_frame_height_with_spacing() + em(0.3)


def show(ui: Ui) -> None:
    """One line of buttons and the slider."""
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

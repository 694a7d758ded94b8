"""Play, pause, step and scrub along the scene's own time, under the picture."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

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
    play = icons.ICON_FA_PAUSE if session.playing else icons.ICON_FA_PLAY
    on_path = session.on_path
    for label, tip, command, act in (
        (f"{icons.ICON_FA_BACKWARD_STEP}##back", "one frame back", "Step back", lambda: c.motion.step(-1)),
        (f"{play}##play", "play or pause", "Play", c.motion.toggle_play),
        (f"{icons.ICON_FA_FORWARD_STEP}##forward", "one frame on", "Step forward", lambda: c.motion.step(1)),
        (f"{icons.ICON_FA_ROUTE}##follow", "the camera follows the scene's own path", "Follow the scene's path",
         lambda: c.motion.follow_path(not on_path)),
    ):  # fmt: skip
        lit = imgui.Col_.button_active if on_path and label.endswith("follow") else imgui.Col_.button
        imgui.push_style_color(imgui.Col_.button, imgui.get_style_color_vec4(lit))
        if imgui.button(label, ImVec2(em(2.0), 0.0)):
            act()
        imgui.pop_style_color()
        tooltip(f"{tip}{ui.key(command)}")
        imgui.same_line(0.0, em(0.25))
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

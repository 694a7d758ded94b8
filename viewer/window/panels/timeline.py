"""Play, pause, step and scrub along the scene's own time, under the picture."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.window.ui import Ui
from viewer.window.widgets import em, tooltip

_SHORTEST = 5.0  # ems of a slider that has its moment written beside it


def height() -> float:
    """What the bar takes of the window, in ImGui's units."""
    return imgui.get_frame_height_with_spacing() + em(0.3)


def show(ui: Ui) -> None:
    """One line of buttons and the scrubber."""
    c = ui.controller
    session = c.session
    if session.scene is None:
        return
    imgui.dummy(ImVec2(0.0, em(0.05)))
    run, last = c.runs.current, session.scene.frames - 1
    imgui.begin_disabled(run is not None)
    if _button(icons.ICON_FA_BACKWARD_STEP + "##back", f"one frame back{ui.key('Step back')}"):
        c.motion.step(-1)
    if _button(
        (icons.ICON_FA_PAUSE if session.playing else icons.ICON_FA_PLAY) + "##play", f"play or pause{ui.key('Play')}"
    ):
        c.motion.toggle_play()
    if _button(icons.ICON_FA_FORWARD_STEP + "##forward", f"one frame on{ui.key('Step forward')}"):
        c.motion.step(1)
    following = session.on_path
    if following:
        imgui.push_style_color(imgui.Col_.button, imgui.get_style_color_vec4(imgui.Col_.button_active))
    if _button(
        icons.ICON_FA_ROUTE + "##follow", "the camera follows the scene's own path" + ui.key("Follow the scene's path")
    ):
        c.motion.follow_path(not following)
    if following:
        imgui.pop_style_color()
    time, frame, words = session.time, session.frame, f"frame %d of {last}"
    if run is not None and c.frame is not None:  # the picture is the run's, of another moment
        time, words = c.frame.time, f"{run.name}: {run.label_shown}".replace("%", "%%")
        frame = session.frame_at(time)
    end = f"{time:.2f} s"
    room = imgui.get_content_region_avail().x - imgui.calc_text_size("000.00 s").x - imgui.get_style().item_spacing.x
    timed = room > em(_SHORTEST)
    if not timed:
        room = imgui.get_content_region_avail().x
    if imgui.calc_text_size(words.replace("%d", str(last))).x > room - em(1.0):
        words = f"%d / {last}" if room > em(_SHORTEST) else "%d"
    imgui.set_next_item_width(max(em(2.5), room))
    changed, frame = imgui.slider_int("##frame", frame, 0, last, words)
    if changed:
        c.motion.step(frame - session.frame)
    tooltip(f"drag to go through the frames; Ctrl+click to type a number ({end})")
    if timed:
        imgui.same_line()
        imgui.align_text_to_frame_padding()
        imgui.text_unformatted(end)
    imgui.end_disabled()


def _button(label: str, tip: str) -> bool:
    clicked = imgui.button(label, ImVec2(em(2.0), 0.0))
    tooltip(tip)
    imgui.same_line(0.0, em(0.25))
    return clicked

"""What the program says: the status bar, the log of all messages, and what stands in the place of a panel that
failed."""

from __future__ import annotations

import webbrowser

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.controller import Controller
from viewer.services.frame_scheduler import Activity
from viewer.state import terms, verified
from viewer.state.notices import Entry, Level
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, WARNING, clipped, count, em, paragraph, tooltip

IDLE, TRACING = "idle", "tracing"
_OPEN = f"{icons.ICON_FA_ARROW_UP_RIGHT_FROM_SQUARE} Open"
_ICONS = {
    Level.NOTICE: (icons.ICON_FA_CIRCLE_INFO, QUIET),
    Level.ERROR: (icons.ICON_FA_CIRCLE_EXCLAMATION, WARNING),
    Level.FAULT: (icons.ICON_FA_TRIANGLE_EXCLAMATION, ERROR),
}
_SUMMARY = (
    "the picture that is shown: its size, and the time of its first sample a pixel, with all that the view has counted "
    "or verified beside it; above the picture are medians of many frames without that"
)

# --- the bar ---------------------------------------------------------------------------------------


def show(ui: Ui) -> None:
    """Show the bar: what the program does now, or has to say, and what the picture cost."""
    c = ui.controller
    message = c.notices.current
    _badge(ui)
    right = _summary(c)
    width = imgui.calc_text_size(right).x + em(1.0)
    room, left = imgui.get_content_region_avail().x, imgui.get_cursor_pos_x()
    if width > 0.6 * room:  # a narrow window: what happens comes first
        right, width = "", 0.0
    if message is not None:
        said = f"{_ICONS[message.level][0]}  {message.text}{_times(message)}"
        button = imgui.calc_text_size(_OPEN).x + em(1.5) if message.file is not None else 0.0
        clipped(said, ERROR if message.error else None, room - width - button)
        if message.level is Level.FAULT:
            tooltip("Internal error. Nothing was lost; the log has the details, which help to fix it.")
        if message.error and imgui.is_item_clicked():
            c.notices.message = None
        _open_button(ui, message)
    else:
        text = doing(c)
        clipped(text if text != IDLE else f"{text}   {_hints(ui)}", QUIET, room - width)
    if right:
        imgui.same_line(left + room - width + em(0.5))
        imgui.text_colored(QUIET, right)
        tooltip(_SUMMARY)


def _hints(ui: Ui) -> str:
    """Return where to go on from, by the keys as they are."""
    hints = ((ui.key_label("Keyboard and mouse"), "keys"), (ui.key_label("Command palette"), "find anything"))
    told = ", ".join(f"{key}: {what}" for key, what in hints if key)
    return f"({told})" if told else ""


def _badge(ui: Ui) -> None:
    """Show how many errors and faults nobody has read yet; a click opens the log."""
    unread = ui.controller.notices.unread
    if not unread:
        return
    fault = any(entry.level is Level.FAULT for entry in unread)
    imgui.push_style_color(imgui.Col_.text, ERROR if fault else WARNING)
    imgui.push_style_var(imgui.StyleVar_.frame_padding, ImVec2(em(0.25), 0.0))
    if imgui.small_button(f"{icons.ICON_FA_TRIANGLE_EXCLAMATION} {len(unread)}###unread"):
        ui.show_panel("Log")
    imgui.pop_style_var()
    imgui.pop_style_color()
    tooltip(f"{unread[-1].text}\nClick to read the log.")
    imgui.same_line()


def _summary(c: Controller) -> str:
    """Return what is wrong in the picture, its size and cost, and how many pictures come while anything goes on."""
    frame, rate, parts = c.frame, c.history.frames_per_second, [""]
    if frame is not None:
        parts += [verified.in_short(frame.statistics), f"{frame.width} x {frame.height}"]
        parts.append(f"{1e3 * frame.statistics.seconds:.0f} ms")
    if rate is not None and rate >= 0.05 and c.active:
        parts.append(f"{rate:.0f} frames/s" if rate >= 9.5 else f"{rate:.1f} frames/s")
    return "   ".join(filter(None, parts))


# --- in words --------------------------------------------------------------------------------------


def doing(c: Controller) -> str:
    """Return what the program does now."""
    preparing, loading, run = c.loader.warm_up_job, c.loader.load_job, c.runs.current
    if preparing is not None and c.frame is None:
        return f"{preparing.title}: {100.0 * preparing.fraction:.0f} %"
    if loading is not None:
        return f"{loading.title}{f': {loading.label}' if loading.label else ''}   (Escape cancels)"
    if run is not None:
        return f"{run.name}: {run.label}{' is traced' if run.traced else ''}   (Escape stops it)"
    if preparing is not None:
        does, when = ("compiling", " (first start only)") if c.loader.compiles else ("loading", "")
        return f"{does} the kernels of other methods{when}: {100.0 * preparing.fraction:.0f} %"
    if c.loader.method_job is not None:
        return f"{c.loader.method_job.title}, once for this version"
    if c.session.scene is None:
        return "no scene is open"
    if c.motion.under_way or c.session.playing:
        return TRACING
    activity = c.scheduler.activity
    if activity is Activity.SAMPLING_LAMPS:
        return f"lamp samples: {c.scheduler.lamp_samples_shown} of {c.scheduler.lamps.wanted}"
    if activity is Activity.CERTIFYING:
        made = c.frame.statistics.certificates if c.frame is not None else 0
        makes, _ = terms.made(c.session.settings.method)
        return f"making certificates{f' ({makes} in the last picture: {count(made)})' if made else ''}"
    if c.renderer.busy or activity is Activity.TRACING:
        is_there = c.frame is not None and not c.scheduler.outdated and c.frame.camera == c.session.camera
        return "refining the picture" if is_there else TRACING
    if activity is Activity.ADDING_SAMPLES:
        return f"adding samples: {c.scheduler.samples_shown} of {c.scheduler.samples_wanted}"
    return IDLE


def traced_before_an_answer(c: Controller) -> str:
    """Return what is traced before a question about the picture is answered; "" where it is answered at once."""
    sampled = {Activity.SAMPLING_LAMPS: "the samples of lamps", Activity.ADDING_SAMPLES: "this sample"}
    return sampled.get(c.scheduler.activity, "this picture" if c.renderer.busy else "")


def first_picture(c: Controller) -> str:
    """Return what goes on while there is no picture, in a sentence."""
    now = doing(c)
    if now == IDLE:
        return "No picture has been traced yet."
    return "Tracing the first picture ..." if now == TRACING else f"{now[0].upper()}{now[1:]}"


# --- the log --------------------------------------------------------------------


def show_log(ui: Ui) -> None:
    """Show the panel: every message there was, newest first."""
    notices = ui.controller.notices
    notices.mark_read()
    entries = notices.entries()
    if imgui.button(f"{icons.ICON_FA_COPY}  Copy all") and entries:
        imgui.set_clipboard_text("".join(e.as_text for e in entries))
    tooltip("Copy everything that is listed, oldest first.")
    imgui.same_line()
    if imgui.button("Clear"):
        notices.clear()
    if imgui.begin_child("entries", ImVec2(0.0, 0.0)):
        if not entries:
            imgui.text_colored(QUIET, "No messages yet.")
        for number, entry in reversed(list(enumerate(entries))):
            imgui.push_id(number)
            _entry(ui, entry)
            imgui.pop_id()
    imgui.end_child()


def _entry(ui: Ui, entry: Entry) -> None:
    icon, color = _ICONS[entry.level]
    imgui.text_colored(QUIET, f"{entry.at:%H:%M:%S}")
    imgui.same_line(em(4.2))
    imgui.text_colored(color, icon)
    tooltip(entry.level.value)
    imgui.same_line(em(5.8))
    paragraph(entry.text + _times(entry))
    _open_button(ui, entry)
    if not entry.details:
        return
    imgui.indent(em(5.8))
    if imgui.tree_node("Details"):
        _copy_button(ui, entry)
        imgui.text_unformatted(entry.details.rstrip())
        imgui.tree_pop()
    imgui.unindent(em(5.8))


def instead_of_part(ui: Ui, name: str, entry: Entry) -> None:
    """Show what stands where a part of the window has failed: one line in a bar, which has no more room."""
    icon, color = _ICONS[entry.level]
    imgui.text_colored(color, icon)
    imgui.same_line()
    if name in ("The menus", "The status bar"):
        imgui.text_colored(color, f"{name} failed")
        tooltip(entry.text)
        imgui.same_line()
        again = imgui.small_button(f"Try again##{name}")
    else:
        clipped("This panel cannot be shown")
        paragraph(entry.text, QUIET)
        again = imgui.button(f"{icons.ICON_FA_ROTATE_RIGHT}  Try again")
        imgui.same_line()
        _copy_button(ui, entry)
    if again:
        ui.guard.again(name)


def _open_button(ui: Ui, entry: Entry) -> None:
    """Offer to open the file that was written, in the program that the desktop has for it."""
    if entry.file is None:
        return
    imgui.same_line()
    if imgui.small_button(_OPEN):
        asked = webbrowser.open(entry.file.absolute().as_uri())
        ui.controller.notices.say(f"the desktop {'was asked' if asked else 'has no program'} to open {entry.file}")
    tooltip(str(entry.file))


def _times(entry: Entry) -> str:
    return f"  ({entry.count} times)" if entry.count > 1 else ""


def _copy_button(ui: Ui, entry: Entry) -> None:
    if imgui.button(f"{icons.ICON_FA_COPY}  Copy details"):
        imgui.set_clipboard_text(entry.as_text)
        ui.controller.notices.say("details copied")

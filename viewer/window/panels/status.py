"""The status bar: what the program does now, in plain words, and what the picture cost."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.controller import Controller
from viewer.state import terms, verified
from viewer.state.history import rate_in_words
from viewer.state.notices import Level
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, WARNING, clipped, count, em, tooltip

IDLE, TRACING = "idle", "tracing"


def show(ui: Ui) -> None:
    """The bar."""
    c = ui.controller
    message = c.notices.current
    _badge(ui)
    right = _summary(ui)
    width = imgui.calc_text_size(right).x + em(1.0)
    room = imgui.get_content_region_avail().x
    left = imgui.get_cursor_pos_x()
    if width > 0.6 * room:  # a narrow window: what happens comes first
        right, width = "", 0.0
    if imgui.begin_child("message", (max(em(4.0), room - width), imgui.get_text_line_height() + 2.0)):
        if message is not None:
            icon = icons.ICON_FA_CIRCLE_EXCLAMATION if message.error else icons.ICON_FA_CIRCLE_INFO
            clipped(f"{icon}  {message.text}", ERROR if message.error else None)
            if message.error and imgui.is_item_clicked():
                c.notices.message = None
        else:
            text = doing(c)
            clipped(text if text != IDLE else f"{text}   {_hints(ui)}", QUIET)
    imgui.end_child()
    if right:
        imgui.same_line(left + max(0.0, room - width + em(0.5)))
        imgui.text_colored(QUIET, right)
        tooltip(
            "the picture that is shown: its size, and the time of its first sample a pixel, with all that the view "
            "has counted or verified beside it; above the picture are medians of many frames without that"
        )


def _hints(ui: Ui) -> str:
    """Where to go on from, by the keys as they are."""
    hints = [(ui.key("Keyboard and mouse"), "keys"), (ui.key("Command palette"), "find anything")]
    told = [f"{key.strip(' ()')}: {what}" for key, what in hints if key]
    return f"({', '.join(told)})" if told else ""


def _badge(ui: Ui) -> None:
    """How many errors and faults nobody has read yet; a click shows them."""
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


def doing(c: Controller) -> str:
    """What the program does now."""
    preparing, loading = c.loader.warm_up_job, c.loader.load_job
    if preparing is not None and c.frame is None:
        return f"{preparing.title}: {100.0 * preparing.fraction:.0f} %"
    if loading is not None:
        return f"{loading.title}{f': {loading.label}' if loading.label else ''}   (Escape cancels)"
    if c.runs.current is not None:
        run = c.runs.current
        return f"{run.name}{f', traced: {run.label}' if run.traced else ' is starting'}   (Escape stops it)"
    if preparing is not None:
        what = "compiling what makes certificates (first start only)"
        return f"{what if c.loader.compiles else 'loading what makes certificates'}: {100.0 * preparing.fraction:.0f} %"
    if c.loader.method_job is not None:
        return f"{c.loader.method_job.title}, once for this version"
    if c.session.scene is None:
        return "no scene is open"
    if c.motion.under_way or c.session.playing:
        return TRACING
    if c.scheduler.refines_lamps:
        return f"lamp samples: {c.scheduler.lamp_samples_shown} of {c.scheduler.lamps.wanted}"
    if c.scheduler.certifies:
        made = c.frame.statistics.certificates if c.frame is not None else 0
        before = ", before more samples" if c.session.settings.samples > 1 else ""
        makes, _ = terms.made(c.session.settings.method)
        return f"preparing{before}{f' ({makes} in the last picture: {count(made)})' if made else ''}"
    if c.renderer.busy or c.scheduler.awaits:
        return "refining the picture" if c.scheduler.becoming_finer or _learns(c) else TRACING
    if c.scheduler.adds_samples:
        return f"adding samples: {c.scheduler.samples_shown} of {c.scheduler.samples_wanted}"
    return IDLE


def _learns(c: Controller) -> bool:
    """Whether the picture is there, and whether it is being refined."""
    return c.frame is not None and not c.scheduler.outdated and c.frame.camera == c.session.camera


def _summary(ui: Ui) -> str:
    """What is wrong in the picture, its size and cost, and how many pictures come while anything goes on."""
    c = ui.controller
    frame = c.frame
    parts: list[str] = []
    if frame is not None:
        parts += filter(None, (verified.in_short(frame.statistics),))
        parts += [f"{frame.width} x {frame.height}", f"{1e3 * frame.statistics.seconds:.0f} ms"]
    rate = c.history.frames_per_second
    if rate is not None and c.active:
        parts.append(rate_in_words(rate))
    return "   ".join(filter(None, parts))


def traced_before_an_answer(c: Controller) -> str:
    """What is traced before a question about the picture is answered; nothing where it is answered at once."""
    if c.scheduler.refines_lamps:
        return "the samples of lamps"
    if c.scheduler.adds_samples:
        return "this sample"
    return "this picture" if c.renderer.busy else ""


def first_picture(c: Controller) -> str:
    """What goes on while there is no picture, in a sentence."""
    now = doing(c)
    if now == IDLE:
        return "No picture has been traced yet."
    return "Tracing the first picture ..." if now == TRACING else f"{now[0].upper()}{now[1:]}"

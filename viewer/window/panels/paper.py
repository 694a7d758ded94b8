"""The paper's text, run line by line for the clicked pixel, with the values that its lines read and write."""

from __future__ import annotations

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.inspect.paper_steps import PaperSteps, Step, text
from tracer.method import Method, title_of
from viewer.state.methods import with_base
from viewer.window import menus
from viewer.window.command import Command, Condition
from viewer.window.panels.inspector import unanswered
from viewer.window.style import TEAL
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, paragraph, write

PAPER = "Paper"
_BACK, _ON, _CHANGE = "Step to the line before", "Step to the next line", "Next change of a mode"
_INDENT, _BUTTON, _TEXT = 0.32, 2.0, 0.54  # ems: of a blank at a line's beginning, of a button; of the width for text


def commands(ui: Ui) -> list[Command]:
    """What the menu Culling has of it."""
    s = ui.controller.stepping
    there = Condition(lambda: s.shown and s.now is not None, "click a pixel, and show the panel Paper")
    return [
        Command("Step through the paper", "Culling", lambda: ui.show_panel(PAPER), "F6", separated=True, also="debug",
                tip="the paper's text, run line by line for the clicked pixel"),
        Command(_BACK, "Culling", lambda: s.go(-1), "F7", enabled=there, repeats=True,
                tip="back in the paper's text, also into the frame before"),
        Command(_ON, "Culling", lambda: s.go(1), "F8", enabled=there, repeats=True,
                tip="on in the paper's text; after its last line the same frame is traced once more"),
        Command(_CHANGE, "Culling", s.go_to_change, "F9", enabled=there,
                tip="to the next line that changes a mode, else to the end of the frame, and on into the next"),
    ]  # fmt: skip


def show(ui: Ui) -> None:
    """The panel."""
    c, s = ui.controller, ui.controller.stepping
    s.watch()
    if c.selection.picked is None:
        paragraph("Click a pixel: the paper's text then runs for its rays, line by line.", QUIET)
    elif s.now is None or c.session.scene is None:
        paragraph(s.problem or unanswered(ui), QUIET)
        other = s.problem and Method.parse(c.session.settings.method).kind.name != "paper"
        if other and c.runs.current is None and imgui.button(f"Use {title_of('paper')}"):
            c.settings.change(method=with_base(c.session.settings.method, "paper"))
    else:
        jumps = icons.ICON_FA_BACKWARD_STEP, icons.ICON_FA_FORWARD_STEP, icons.ICON_FA_FORWARD_FAST
        for name, icon in zip((_BACK, _ON, _CHANGE), jumps, strict=True):
            menus.button(ui, name, icon, width=_BUTTON)
            imgui.same_line()
        imgui.align_text_to_frame_padding()
        where = f"frame {s.frame + 1} of {len(s.runs)}, step {s.place + 1} of {len(s.now.steps)}"
        write("the next frame is being traced" if s.wanted is not None else where, QUIET)
        imgui.same_line()
        clipped(s.now.heading(s.now.steps[s.place], c.session.scene))
        if s.now.remark:
            paragraph(s.now.remark, QUIET)
        if not s.now.changes:
            paragraph("No line changes a mode in this frame. Backspace forgets all modes, to be set anew.", QUIET)
        _text(ui, s.now, s.place)


def _text(ui: Ui, now: PaperSteps, place: int) -> None:
    """All lines, the one that acts set off; beside it, and beside those that ran for the same, their values."""
    step = now.steps[place]
    ran: dict[int, Step] = ui.cached(
        "lines that ran", now, place, lambda: {one.line: one for one in now.steps[: place + 1] if one.part == step.part}
    )
    if not imgui.begin_table("text", 2, int(imgui.TableFlags_.scroll_y | imgui.TableFlags_.sizing_stretch_prop)):
        return
    for name, weight in (("text", _TEXT), ("values", 1.0 - _TEXT)):
        imgui.table_setup_column(name, int(imgui.TableColumnFlags_.width_stretch), weight)
    for number, line in text().items():
        imgui.table_next_row()
        imgui.table_next_column()
        acts, words = number == step.line, line.lstrip()
        if acts:
            imgui.table_set_bg_color(imgui.TableBgTarget_.row_bg0, imgui.get_color_u32(imgui.Col_.frame_bg_active))
            ui.cached("scrolled to", now, place, lambda: imgui.set_scroll_here_y(0.4))  # once, when it begins to act
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + em(_INDENT) * (len(line) - len(words)))
        (paragraph if acts else clipped)(words or " ", QUIET if words.startswith(("#", "@", '"')) else None)
        imgui.table_next_column()
        if not acts:
            clipped(", ".join(map(str, ran[number].values)) if number in ran else " ", QUIET)
            continue
        paragraph(", ".join(filter(None, (step.note, *(str(one) for one in step.values if not one.before)))) or " ")
        for changed in filter(lambda one: one.before, step.values):
            paragraph(str(changed), TEAL)
    imgui.end_table()

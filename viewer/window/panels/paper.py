"""The paper's text, run line by line for the clicked pixel, with the values that its lines read and write."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.inspect.paper_steps import Step, Value, text
from tracer.method import title_of
from viewer.services.stepping import Stepping
from viewer.state.methods import with_base
from viewer.window import menus
from viewer.window.command import Command, Condition
from viewer.window.panels.inspector import unanswered
from viewer.window.panels.links import Pointed
from viewer.window.style import TEAL
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, paragraph, write

PAPER = "Paper"
_INDENT, _BUTTON = 0.32, 2.0  # ems, of a blank at the beginning of a line, and of a button
_TEXT = 0.6  # of the width, for the text


@dataclass
class PaperState:
    """The step that the text was scrolled to last."""

    scrolled_to: Step | None = None


def commands(ui: Ui) -> list[Command]:
    """What the menu Culling has of it."""
    s = ui.controller.stepping
    there = Condition(lambda: s.shown and s.step is not None, "click a pixel, and show the panel Paper")
    back = Condition(lambda: s.shown and (s.place > 0 or s.frame > 0), "this is the first step")
    return [
        Command("Step through the paper", "Culling", lambda: ui.show_panel(PAPER), "F6", separated=True,
                also="debug line pseudocode", tip="the paper's text, run line by line for the clicked pixel"),
        Command("Step back", "Culling", lambda: s.go(-1), "F7", enabled=back, repeats=True,
                tip="to the line before, also of the frame before"),
        Command("Step", "Culling", lambda: s.go(1), "F8", enabled=there, repeats=True,
                tip="to the next line; at the end the same frame is traced once more, with what is known by then"),
        Command("Next change of a mode", "Culling", s.go_to_change, "F9", enabled=there,
                tip="to the next line that changes a mode, or else the end of the frame, and then on into the next"),
    ]  # fmt: skip


def show(ui: Ui) -> None:
    """The panel."""
    c, s = ui.controller, ui.controller.stepping
    s.watch()
    if c.selection.picked is None:
        paragraph("Click a pixel: the paper's text then runs for its rays, line by line.", QUIET)
        return
    step = s.step
    if step is None:
        _none(ui)
        return
    if step.part.light >= 0 and step.part.ray == 0:
        ui.state(Pointed).light = step.part.light  # its ray stands out in the picture
    _tools(ui, s, step)
    _text(ui, step)


def _none(ui: Ui) -> None:
    """Why there are no steps, and what to do about it."""
    c, problem = ui.controller, ui.controller.stepping.problem
    paragraph(problem or unanswered(ui), QUIET)
    if problem and c.runs.current is None and imgui.button(f"Use {title_of('paper')}"):
        c.settings.change(method=with_base(c.session.settings.method, "paper"))


def _tools(ui: Ui, s: Stepping, step: Step) -> None:
    """The buttons, where one is, and what the line is run for."""
    now, scene = s.now, ui.controller.session.scene
    assert now is not None and scene is not None
    for name, icon in (("Step back", icons.ICON_FA_BACKWARD_STEP), ("Step", icons.ICON_FA_FORWARD_STEP),
                       ("Next change of a mode", icons.ICON_FA_FORWARD_FAST)):  # fmt: skip
        menus.button(ui, name, icon, width=_BUTTON)
        imgui.same_line()
    imgui.align_text_to_frame_padding()
    where = f"frame {s.frame + 1} of {len(s.frames)}, step {s.place + 1} of {len(now.steps)}"
    write("the next frame is being traced" if s.waits else where, QUIET)
    imgui.same_line()
    clipped(now.heading(step, scene))
    if now.remark:
        paragraph(now.remark, QUIET)


# --- the text ----------------------------------------------------------------------------------------


def _text(ui: Ui, step: Step) -> None:
    """All lines, the one that acts set off, and beside those that have run for the same what they read and wrote."""
    s, state = ui.controller.stepping, ui.state(PaperState)
    ran: dict[int, tuple[Value, ...]] = ui.cached("lines that have run", s.now, s.place, lambda: _ran(s))
    flags = imgui.TableFlags_.scroll_y | imgui.TableFlags_.sizing_stretch_prop
    if not imgui.begin_table("text", 2, int(flags)):
        return
    for name, weight in (("text", _TEXT), ("values", 1.0 - _TEXT)):
        imgui.table_setup_column(name, int(imgui.TableColumnFlags_.width_stretch), weight)
    for number, line in text():
        imgui.table_next_row()
        imgui.table_next_column()
        acts = number == step.line
        if acts:
            color = imgui.get_color_u32(imgui.Col_.frame_bg_active)
            imgui.table_set_bg_color(imgui.TableBgTarget_.row_bg0, color)
            if state.scrolled_to is not step:
                imgui.set_scroll_here_y(0.4)
                state.scrolled_to = step
        words = line.lstrip()
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + em(_INDENT) * (len(line) - len(words)))
        clipped(words, QUIET if words.startswith(("#", "@", '"')) else None)
        if number in ran:
            imgui.table_next_column()
            _values(step.note if acts else "", ran[number], acts)
    imgui.end_table()


def _ran(s: Stepping) -> dict[int, tuple[Value, ...]]:
    """The values of lines that have run for the same, up to the one that is shown, by their lines."""
    assert s.now is not None
    found: dict[int, tuple[Value, ...]] = {}
    for step in reversed(s.now.steps[: s.place + 1]):
        if step.part != s.now.steps[s.place].part:
            break
        found.setdefault(step.line, step.values)
    return found


def _values(note: str, values: tuple[Value, ...], acts: bool) -> None:
    """What a line has read and written; what it has changed in a colour of its own."""
    if not acts:
        clipped(", ".join(map(str, values)), QUIET)
        return
    same = ", ".join(str(one) for one in values if not one.before)
    if said := " ".join(filter(None, (note, same))):
        paragraph(said)
    for one in values:
        if one.before:
            paragraph(str(one), TEAL)
    if note and not values:
        paragraph("they have found nothing more", QUIET)
    imgui.dummy(ImVec2(0.0, 0.0))

"""From a plot over frames back to one of them: a line and a word where the pointer is, a click, and a menu."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from imgui_bundle import imgui, implot

from tracer.experiments.experiment import REFERENCE, Results
from viewer.services.runs import Experiment
from viewer.util.numbers import whole_percent
from viewer.window.palette import GREY
from viewer.window.ui import Ui

_MENU = "frame of the plot"


@dataclass
class PlotMenu:
    """The frame that the menu of a plot is about, its name, and the one that the pointer was on last."""

    frame: int = 0
    name: str = ""
    pointed: int | None = None


def pointed(first: int, last: int, frames: Sequence[int] | None = None) -> int | None:
    """The frame that the pointer is on, of those of the plot that is being drawn, with a line there: its number, or its
    place among `frames`."""
    if last < first or not implot.is_plot_hovered():
        return None
    x = implot.get_plot_mouse_pos().x
    if frames is None:
        found = at = min(max(round(x), first), last)
    else:
        found = int(np.argmin(np.abs(np.asarray(frames) - x)))
        at = frames[found]
    implot.plot_inf_lines("##pointed", np.array([float(at)]), implot.Spec(line_color=GREY, line_weight=1.0))
    return found


def handle(ui: Ui, plot: str, number: int | None, values: list[str]) -> None:
    """After the plot of a name: say which of the window's pictures it is, and go there where that is clicked."""
    c = ui.controller
    moment = c.record.moments.get(number) if number is not None else None
    said = []
    if moment is not None:
        width, height, part = moment.settings.width, moment.settings.height, c.history.shaded_of(moment.number)
        shaded = f", {whole_percent(part)} shaded" if part < 1.0 else ""
        said = [f"{moment.time:.3f} s, {moment.settings.method}, {width} x {height}{shaded}"]
    named = in_words(ui, number) if number is not None else ""
    _menu(ui, plot, number, named, [*said, *values], lambda chosen, modes: c.travel.go(chosen, modes))


def in_words(ui: Ui, number: int) -> str:
    """What a picture is called: its number in the plots, and that of the frame of the scene's path."""
    c = ui.controller
    moment = c.record.moments.get(number)
    return c.travel.named(moment) if moment is not None else f"picture {number}"


def of_experiment(ui: Ui, run: Experiment, results: Results, place: int | None, values: list[str]) -> None:
    """The same for the frames of an experiment, by the method that it shows."""
    c = ui.controller
    number = results.frames[place] if place is not None else None
    if number is not None:
        for method, figures in results.methods.items():
            if run.settings.verify and method != REFERENCE and place is not None:
                values = [*values, f"{method}: {figures['wrong'][place]} wrong answers"]

    def go(chosen: int, modes: bool) -> None:
        c.travel.go_to_experiment(run, chosen, modes)

    named = c.travel.named_of_experiment(run, number) if number is not None else ""
    _menu(ui, "experiment", number, named, values, go)


def _menu(ui: Ui, plot: str, number: int | None, name: str, said: list[str], go: Callable[[int, bool], None]) -> None:
    """What the pointer is told, and what it can do."""
    state = ui.state(PlotMenu)
    imgui.push_id(plot)
    if number is not None:
        state.pointed = number
        if imgui.is_mouse_clicked(imgui.MouseButton_.left):
            go(number, False)
        elif imgui.is_mouse_clicked(imgui.MouseButton_.right):
            state.frame, state.name = number, name.split(",")[0]
            imgui.open_popup(_MENU)
        elif not imgui.is_popup_open(_MENU) and imgui.begin_tooltip():
            imgui.text_unformatted("\n".join([name, *said, "click: go there; right button: with its modes"]))
            imgui.end_tooltip()
    if imgui.begin_popup(_MENU):
        for modes, what in ((False, ""), (True, " with its modes")):
            if imgui.menu_item(f"Go to {state.name}{what}", "", False, True)[0]:
                go(state.frame, modes)
        imgui.end_popup()
    imgui.pop_id()

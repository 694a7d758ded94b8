"""A hunt for counterexamples: what to search, the worst wrong pixels so far, and what is wrong with one of them."""

from __future__ import annotations

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.experiments import counterexample, hunt
from tracer.experiments.counterexample import Counterexample
from tracer.scene.model import Scene
from viewer.output.reports import findings
from viewer.window.panels.culling import method_list
from viewer.window.panels.rays import show_rays
from viewer.window.panels.runs import Part, frames_row, results_table, show_run
from viewer.window.setting_rows import plan_rows
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, in_window_style, paragraph, properties, row, same_line_for, tooltip

_LIST, _DETAILS = 13.0, 14.0  # ems of width


def show(ui: Ui) -> None:
    """The panel: what to search, the list of findings, and the one that was clicked."""
    runs, scene = ui.controller.runs, ui.controller.session.scene
    found, parts = runs.hunt.results if runs.hunt is not None else None, list[Part]()
    if found is not None and runs.hunt is not None and scene is not None and runs.hunt.is_of(scene):
        parts.append(("Findings", _LIST, lambda: _findings(ui, found, scene)))
        if runs.chosen_find is not None and runs.chosen_find < len(found.finds):
            find, number = found.finds[runs.chosen_find], runs.chosen_find
            parts.append(("Details", _DETAILS, lambda: _details(ui, number, find, scene)))
    show_run(
        ui, runs.hunt, lambda: _plan(ui), runs.start_hunt,
        tip="Search the frames for the worst wrong pixels of the method",
        doing="Searching for wrong pixels",
        parts=parts,
        why="Start lists the worst wrong pixels of a method. Click one to fly there; the Inspector explains it.",
    )  # fmt: skip


def _plan(ui: Ui) -> None:
    plan = ui.controller.runs.hunt_plan
    with properties("plan", 4.6) as shown:
        if shown:
            row("Method", "The method whose wrong pixels are searched; an exact one has none.")
            method_list(ui, "##method", plan.method, lambda name: setattr(plan, "method", name), combined=False)
            frames_row(ui, plan, "First and last frame of the path, traced one after another.")
            plan_rows(ui, plan, "step", "around", "radius", "seed", "size")


def _findings(ui: Ui, found: hunt.Results, scene: Scene) -> None:
    """A line for each, the worst first; a click flies there."""
    paragraph(in_window_style(found.summary), QUIET)
    if found.finds:
        tip = lambda find: f"Fly there. {counterexample.in_its_frame(find)}"  # noqa: E731
        columns = findings(scene, found.finds)
        chosen = ui.controller.runs.chosen_find
        results_table("findings", columns, found.finds, lambda number: _fly(ui, number), chosen, tip)


def _fly(ui: Ui, number: int) -> None:
    ui.controller.navigator.go_to_find(number)
    ui.show_panel("Inspector")


def _details(ui: Ui, number: int, find: Counterexample, scene: Scene) -> None:
    """What can be done with a finding, and what is wrong there, in colours and words."""
    imgui.begin_disabled(ui.controller.runs.current is not None)
    if imgui.button(f"{icons.ICON_FA_PAPER_PLANE}  Fly there"):
        _fly(ui, number)
    shrink = f"{icons.ICON_FA_COMPRESS}  Shrink"
    same_line_for(shrink)
    if imgui.button(shrink):
        ui.controller.shrinking.start_find(number)
    tooltip("The few triangles, lights and frames that it takes, with a figure and a test, into a folder.")
    imgui.end_disabled()
    rays = f"{icons.ICON_FA_CODE_BRANCH}  Rays"
    same_line_for(rays)
    if imgui.button(rays):
        show_rays(ui)
    tooltip(f"what became of each ray of the pixel{ui.key('Rays of the clicked pixel')}")
    for sentence in (*counterexample.in_words(find, scene), counterexample.in_its_frame(find)):
        paragraph(in_window_style(sentence))
    if ui.controller.scheduler.is_frozen:
        paragraph("The picture stays as it was found, in its size and at 1 sample a pixel, until you move.", QUIET)

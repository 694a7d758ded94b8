"""Where the panels are: what is docked where at first, as data, and how that is kept.

The docking is ImGui's.  Hidden panels are not drawn, and keep their place in the docking, so that they come back as
they were."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from imgui_bundle import ImVec2, hello_imgui, imgui

from viewer.window.panels import (
    camera,
    compare,
    culling,
    experiment,
    figure1,
    find,
    hunt,
    inspector,
    light_buffer,
    paper,
    picture,
    pixels,
    plots,
    saving,
    scene,
    statistics,
    status,
    tour,
    view,
    what_if,
    zoom,
)
from viewer.window.ui import Ui
from viewer.window.widgets import tooltip

PICTURE, TOUR = "Picture", "Tour"

PANELS: dict[str, Callable[[Ui], None]] = {
    PICTURE: picture.show,
    "View": view.show,
    "Statistics": statistics.show,
    "Culling": culling.show,
    "Figure 1": figure1.show,
    "Inspector": inspector.show,
    "Experiment": experiment.show,
    "Zoom test": zoom.show,
    "Hunt": hunt.show,
    "Plots": plots.show,
    "Find": find.show,
    "Compare": compare.show,
    "Scene": scene.show,
    "What if": what_if.show,
    "Pixels": pixels.show,
    "Light buffer": light_buffer.show,
    paper.PAPER: paper.show,
    "Rendering": view.show_rendering,
    "Camera": camera.show,
    "Saving": saving.show,
    "Film": saving.show_film,
    "Log": status.show_log,
    TOUR: tour.show,
}
"""What shows each panel, in the order of the menu and of tabs."""


_WHOLE, _COLUMN, _ANSWERS, _TABLES = "MainDockSpace", "Right", "RightBottom", "Bottom"
_RUNS = ("Experiment", "Zoom test", "Hunt")
_PLACES = {
    _COLUMN: ("View", "Culling", "Figure 1", "Statistics", "Scene", "Rendering", "Camera", "Saving", "Film"),
    _ANSWERS: ("Inspector", "Plots", "What if"),
    _TABLES: (*_RUNS, "Find", "Pixels", "Compare", "Light buffer", paper.PAPER, "Log"),
    TOUR: (TOUR,),
}
"""Where panels are: in a column as high as the window, or in a part below it for what is pointed at; below the picture,
for what needs width; and the tour above the column, where it takes no room from the picture."""


class Workspace(NamedTuple):
    """A layout for one kind of work: the share of the window's width that the column has, those of the window's and the
    column's height that the lower parts have, and the panels that are open at first."""

    name: str
    help: str
    column: float
    tables: float
    answers: float
    open: tuple[str, ...]


MEASURE, _TOUR = "Measure", 0.24  # the workspace that runs have, and the tour's share of the column
WORKSPACES = (
    Workspace(
        "Explore", "room for the picture, and a column: how shadow rays are culled, what is shown, and why",
        0.235, 0.35, 0.46, ("View", "Culling", "Figure 1", "Inspector"),
    ),
    Workspace(
        MEASURE, "experiments, zoom tests and hunts, with plots, and statistics beside a comparison",
        0.235, 0.365, 0.5, ("Culling", "Statistics", "Plots", *_RUNS, "Compare"),
    ),
    Workspace(
        "Debug", "rays of a pixel, objects and primitives, pixels, edits and the log",
        0.3, 0.33, 0.6,
        ("View", "Culling", "Scene", "Inspector", "What if", "Find", "Pixels", "Compare", "Light buffer", "Log"),
    ),
)  # fmt: skip
SIDES = tuple(label for label in PANELS if label not in (PICTURE, TOUR))
"""All panels around the picture that are there to be opened."""

_KEY_OWNER = 0x5C011  # any number that no widget has


class Layout:
    """See the module.  `params` are those that the window is made with."""

    def __init__(self, ui: Ui, params: hello_imgui.RunnerParams) -> None:
        self._ui, self._params = ui, params
        self._sizes: dict[str, tuple[float, float]] = {}  # that workspaces had when they were shown last
        self._to_front: set[str] = set()  # panels to be focused when they are drawn next
        self._of_run = ""  # the panel to be shown once the workspace is there that runs have
        params.docking_params, *params.alternative_docking_layouts = map(self._docked, WORKSPACES)
        ui.show_panel, ui.panel_labels, ui.reset_layout = self.show, SIDES, self.reset

    # --- what the commands ask for ---------------------------------------------------------------

    def show(self, label: str) -> None:
        """Open a panel, and bring it to the front; that of a run in the workspace that has room for results, unless it
        is open here."""
        ui, now = self._ui, self._ui.workspace
        ui.panels_hidden = False
        window = self._docking.dockable_window_of_name(label)
        if label in _RUNS and not window.is_visible and now != MEASURE:
            hello_imgui.switch_layout(MEASURE)  # in the next frame
            self._of_run = label
            back = f"{ui.key_or_menu(now)} brings back {now} as it was"
            ui.controller.notices.say(f"{label} is in the workspace {MEASURE}; {back}")
        else:
            window.is_visible = True
            self._to_front.add(label)

    def reset(self) -> None:
        """Open the panels of this workspace and no others, docked where they were at first."""
        self._ui.panels_hidden = False
        workspace = next(one for one in WORKSPACES if one.name == self._ui.workspace)
        for window in self._docking.dockable_windows:
            window.is_visible = window.label in (PICTURE, *workspace.open)
        self._docking.layout_reset = True

    def show_menu(self) -> None:
        """Show the menu of panels: a tick for each that is open."""
        if imgui.begin_menu("Panels"):
            for label in SIDES:
                window = self._docking.dockable_window_of_name(label)
                _, window.is_visible = imgui.menu_item(label, "", window.is_visible, True)
            imgui.end_menu()

    def show_workspaces(self) -> None:
        """Show the workspaces at the right end of the menu bar, the one that is shown set off."""
        widths = [imgui.calc_text_size(one.name).x for one in WORKSPACES]
        gap, now = imgui.get_style().item_spacing.x * 2.0, self._ui.workspace
        left = imgui.get_window_width() - sum(widths) - gap * len(widths)
        imgui.set_cursor_pos_x(max(imgui.get_cursor_pos_x() + gap, left))
        for workspace, width in zip(WORKSPACES, widths):
            clicked, _ = imgui.selectable(workspace.name, workspace.name == now, 0, ImVec2(width, 0.0))
            tooltip(f"Workspace: {workspace.help}{self._ui.key(workspace.name)}")
            if clicked:
                hello_imgui.switch_layout(workspace.name)
            imgui.same_line(0.0, gap)
        imgui.new_line()

    # --- one frame -------------------------------------------------------------------------------

    def update(self) -> None:
        """Keep shares as they were, and show the tour's panel while it is taken, before the panels are drawn."""
        self._keep_shares()
        self._ui.workspace = hello_imgui.current_layout_name()
        if self._of_run and self._ui.workspace == MEASURE:
            self.show(self._of_run)
            self._of_run = ""
        self._docking.dockable_window_of_name(TOUR).is_visible = self._ui.tour.step is not None
        node, no_tabs = _node_of(PICTURE), int(imgui.internal.DockNodeFlagsPrivate_.no_tab_bar)
        if node is not None and not node.local_flags & no_tabs:  # it is always there, and needs the room
            node.set_local_flags(node.local_flags | no_tabs)
        if not imgui.get_io().want_text_input:  # else Tab would begin to edit a field of the panel that was used last
            imgui.internal.set_key_owner(imgui.Key.tab, _KEY_OWNER)

    def _keep_shares(self) -> None:
        """Let each side keep its share of the window as that changes its size; else the picture alone would shrink."""
        picture = _node_of(PICTURE)
        if picture is None:
            return
        size, workspace = imgui.internal.dock_node_get_root_node(picture).size, hello_imgui.current_layout_name()
        if min(size.x, size.y) <= 0.0:
            return
        before = self._sizes.get(workspace, (size.x, size.y))
        self._sizes[workspace] = size.x, size.y
        if before == (size.x, size.y):
            return
        for node in {node.id_: node for label in PANELS for node in _with_parents(_node_of(label))}.values():
            node.size_ref = ImVec2(node.size_ref.x * size.x / before[0], node.size_ref.y * size.y / before[1])

    # --- the panels ------------------------------------------------------------------------------

    @property
    def _docking(self) -> hello_imgui.DockingParams:
        """The docking of the workspace that is shown."""
        return self._params.docking_params

    def _docked(self, workspace: Workspace) -> hello_imgui.DockingParams:
        """Return a workspace as Hello ImGui has it."""
        docking = hello_imgui.DockingParams(layout_name=workspace.name)
        # Without the cross beside the tabs, which closes all of them; and not what Hello ImGui has by default, which
        # would give it a background whatever the style.
        docking.main_dock_space_node_flags = int(imgui.internal.DockNodeFlagsPrivate_.no_close_button)
        split, side = hello_imgui.DockingSplit, imgui.Dir
        docking.docking_splits = [
            split(_WHOLE, _COLUMN, side.right, workspace.column), split(_WHOLE, _TABLES, side.down, workspace.tables),
            split(_COLUMN, TOUR, side.up, _TOUR), split(_COLUMN, _ANSWERS, side.down, workspace.answers),
        ]  # fmt: skip
        spaces = {label: space for space, labels in _PLACES.items() for label in labels}
        docking.dockable_windows = [
            self._window(label, spaces.get(label, _WHOLE), label in (PICTURE, *workspace.open)) for label in PANELS
        ]
        return docking

    def _window(self, label: str, space: str, is_open: bool) -> hello_imgui.DockableWindow:
        window = hello_imgui.DockableWindow(label, space, lambda: self._draw(label), is_visible_=is_open)
        window.call_begin_end = False
        return window

    def _draw(self, label: str) -> None:
        """Draw a panel, unless it is hidden."""
        is_picture = label == PICTURE
        if self._ui.panels_hidden and not is_picture:
            return
        # What lies in the main window is on its background already.  Filling it once more for each panel is half of
        # all the work where a processor draws.
        flags = int(imgui.WindowFlags_.no_background) if _in_main_window(label) else 0
        flags |= int(imgui.WindowFlags_.no_focus_on_appearing)  # so that tabs come back as they were
        if is_picture:
            scrolling = imgui.WindowFlags_.no_scrollbar | imgui.WindowFlags_.no_scroll_with_mouse
            flags |= int(scrolling | imgui.WindowFlags_.no_collapse)
        if label in self._to_front:
            self._to_front.discard(label)
            imgui.set_next_window_focus()
        # A tab in the back has no cross, nor room for one: so all are found by eye, and none is closed by mistake.
        shown, stays = imgui.begin(label, True if _in_front(label) and not is_picture else None, flags)
        try:
            if shown:
                self._ui.guard.panel(f"The panel {label}", lambda: PANELS[label](self._ui))
        finally:
            imgui.end()
        if stays is False:
            self._docking.dockable_window_of_name(label).is_visible = False
            if label == TOUR:
                self._ui.tour.end()


def _in_front(label: str) -> bool:
    """Return whether a panel is no tab behind another's."""
    window = imgui.internal.find_window_by_name(label)
    node: Any = window.dock_node if window is not None else None
    front = node.visible_window if node is not None else None
    return window is None or front is None or front.id_ == window.id_


def _node_of(label: str) -> Any:
    """Return the node of the docking that a panel has or, while it is not drawn, will have again; None if it floats."""
    window = imgui.internal.find_window_by_name(label)
    return imgui.internal.dock_builder_get_node(window.dock_id) if window is not None and window.dock_id else None


def _with_parents(node: Any) -> Iterator[Any]:
    while node is not None:
        yield node
        node = node.parent_node


def _in_main_window(label: str) -> bool:
    """Return whether a panel is docked there, and floats neither alone nor with others."""
    window = imgui.internal.find_window_by_name(label)
    root = window.root_window_dock_tree if window is not None else None
    return root is not None and root.name.startswith("MainDockSpace")


# --- its file --------------------------------------------------------------------------------------


def ready_file(folder: Path) -> Path:
    """Return the file that Hello ImGui reads the layout from, and writes it to, in a folder that is there."""
    with suppress(OSError):  # then the layout is not remembered; saving the settings says why
        folder.mkdir(parents=True, exist_ok=True)
    return folder / "layout.ini"

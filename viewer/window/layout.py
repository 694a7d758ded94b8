"""Where the panels are: what is docked where at first, as data, and how that is kept.

The docking is ImGui's.  Hidden panels are not drawn, and keep their place in the docking, so that they come back as
they were."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
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
    picture,
    pixels,
    plots,
    saving,
    scene,
    statistics,
    status,
    view,
    what_if,
    zoom,
)
from viewer.window.ui import Ui

PICTURE = "Picture"


class Panel(NamedTuple):
    """`space` names the part of the docking where it is at first."""

    label: str
    space: str
    show: Callable[[Ui], None]


# New part, the part that it is cut off from, at which side, and its share of that.
SPACES = (
    ("Left", "MainDockSpace", imgui.Dir.left, 0.225),
    ("Right", "MainDockSpace", imgui.Dir.right, 0.295),
    ("Bottom", "MainDockSpace", imgui.Dir.down, 0.30),
    ("LeftBottom", "Left", imgui.Dir.down, 0.52),
    ("RightBottom", "Right", imgui.Dir.down, 0.37),
    ("RightMiddle", "Right", imgui.Dir.down, 0.52),
)
PANELS = {
    panel.label: panel
    for panel in (
        Panel(PICTURE, "MainDockSpace", picture.show),
        Panel("Scene", "Left", scene.show),
        Panel("Camera", "Left", camera.show),
        Panel("Statistics", "LeftBottom", statistics.show),
        Panel("View", "Right", view.show),
        Panel("Rendering", "Right", view.show_rendering),
        Panel("Saving", "Right", saving.show),
        Panel("Culling", "RightMiddle", culling.show),
        Panel("Inspector", "RightBottom", inspector.show),
        Panel("What if", "LeftBottom", what_if.show),
        Panel("Figure 1", "Bottom", figure1.show),
        Panel("Plots", "Bottom", plots.show),
        Panel("Compare", "Bottom", compare.show),
        Panel("Pixels", "Bottom", pixels.show),
        Panel("Find", "Bottom", find.show),
        Panel("Light buffer", "Bottom", light_buffer.show),
        Panel("Experiment", "Bottom", experiment.show),
        Panel("Zoom test", "Bottom", zoom.show),
        Panel("Hunt", "Bottom", hunt.show),
        Panel("Film", "Bottom", saving.show_film),
        Panel("Log", "Bottom", status.show_log),
    )
}
SIDES = tuple(label for label in PANELS if label != PICTURE)
"""All panels around the picture."""

_KEY_OWNER = 0x5C011  # any number that no widget has


class Layout:
    """See the module.  `params` are those that the window is made with."""

    def __init__(self, ui: Ui, params: hello_imgui.RunnerParams) -> None:
        self._ui, self._docking = ui, params.docking_params
        self._size = (0.0, 0.0)
        self._to_front: set[str] = set()  # panels to be focused when they are drawn next
        # Without the cross beside the tabs, which closes all of them; and not what Hello ImGui has by default, which
        # would give it a background whatever the style.
        self._docking.main_dock_space_node_flags = int(imgui.internal.DockNodeFlagsPrivate_.no_close_button)
        self._docking.docking_splits = [
            hello_imgui.DockingSplit(of, space, side, share) for space, of, side, share in SPACES
        ]
        self._docking.dockable_windows = [self._window(panel) for panel in PANELS.values()]
        ui.show_panel, ui.panel_labels, ui.reset_layout = self.show, SIDES, self.reset

    # --- what the commands ask for ---------------------------------------------------------------

    def show(self, label: str) -> None:
        """Open a panel, and bring it to the front."""
        self._ui.panels_hidden = False
        self._docking.dockable_window_of_name(label).is_visible = True
        self._to_front.add(label)

    def reset(self, labels: Collection[str] = tuple(PANELS)) -> None:
        """Open these panels and no others, docked where they were at first."""
        self._ui.panels_hidden = False
        for window in self._docking.dockable_windows:
            window.is_visible = window.label in labels
        self._docking.layout_reset = True

    def show_menu(self) -> None:
        """Show the menu of panels: a tick for each that is open."""
        if imgui.begin_menu("Panels"):
            for label in SIDES:
                window = self._docking.dockable_window_of_name(label)
                _, window.is_visible = imgui.menu_item(label, "", window.is_visible, True)
            imgui.end_menu()

    # --- one frame -------------------------------------------------------------------------------

    def update(self) -> None:
        """Keep shares as they were, before the panels are drawn."""
        self._keep_shares()
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
        size, before = imgui.internal.dock_node_get_root_node(picture).size, self._size
        self._size = size.x, size.y
        if before == self._size or min(before) <= 0.0 or min(self._size) <= 0.0:
            return
        for node in {node.id_: node for label in PANELS for node in _with_parents(_node_of(label))}.values():
            node.size_ref = ImVec2(node.size_ref.x * size.x / before[0], node.size_ref.y * size.y / before[1])

    # --- the panels ------------------------------------------------------------------------------

    def _window(self, panel: Panel) -> hello_imgui.DockableWindow:
        window = hello_imgui.DockableWindow(panel.label, panel.space, lambda: self._draw(panel))
        window.call_begin_end = False
        return window

    def _draw(self, panel: Panel) -> None:
        """Draw a panel, unless it is hidden."""
        is_picture = panel.label == PICTURE
        if self._ui.panels_hidden and not is_picture:
            return
        # What lies in the main window is on its background already.  Filling it once more for each panel is half of
        # all the work where a processor draws.
        flags = int(imgui.WindowFlags_.no_background) if _in_main_window(panel.label) else 0
        flags |= int(imgui.WindowFlags_.no_focus_on_appearing)  # so that tabs come back as they were
        if is_picture:
            scrolling = imgui.WindowFlags_.no_scrollbar | imgui.WindowFlags_.no_scroll_with_mouse
            flags |= int(scrolling | imgui.WindowFlags_.no_collapse)
        if panel.label in self._to_front:
            self._to_front.discard(panel.label)
            imgui.set_next_window_focus()
        # A tab in the back has no cross, nor room for one: so all are found by eye, and none is closed by mistake.
        shown, stays = imgui.begin(panel.label, True if _in_front(panel.label) and not is_picture else None, flags)
        try:
            if shown:
                self._ui.guard.panel(f"The panel {panel.label}", lambda: panel.show(self._ui))
        finally:
            imgui.end()
        if stays is False:
            self._docking.dockable_window_of_name(panel.label).is_visible = False


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

"""Where the panels are: docked around the picture, folded into a strip where the window is small, or hidden.

The docking is ImGui's.  This module says what is docked where at first, keeps each panel's share of the window
when the window's size changes, and decides whether the panels are drawn at all.  Panels that are folded or hidden
keep their place in the docking, so that they come back as they were.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from imgui_bundle import ImVec2, hello_imgui, imgui

from viewer.window.panels import strip
from viewer.window.panels.catalogue import PANELS, PICTURE, Panel
from viewer.window.ui import Ui
from viewer.window.widgets import em

SMALLEST = (
    66.0,
    38.0,
)  # width and height in ems that leave room for docked panels, and their words, beside the picture
_NOTICED = 1.5  # pixels by which a panel's size must differ from its share to have been changed by the user
_TABS_AFTER = 3  # frames that ImGui needs to make the tabs of panels that come back
_KEY_OWNER = 0x5C011  # any number that no widget has


class Layout:
    """See the module.  `params` are those that the window is made with."""

    def __init__(self, ui: Ui, params: hello_imgui.RunnerParams) -> None:
        self._ui = ui
        self._params = params
        self._size = (0.0, 0.0)
        self._shares: dict[int, tuple[float, float]] = {}
        self._to_front: set[str] = set()  # panels to be focused when they are drawn next
        self._tabs: list[str] = []  # the panels that were to be seen before they were folded or hidden
        self._back_for = 0  # frames since they came back
        docking = params.docking_params
        # Without the cross beside the tabs, which closes all of them; and not what Hello ImGui has by default, which
        # would give it a background whatever the style.
        docking.main_dock_space_node_flags = int(imgui.internal.DockNodeFlagsPrivate_.no_close_button)
        docking.docking_splits = _splits()
        docking.dockable_windows = [self._window(panel) for panel in PANELS.values()]
        ui.show_panel, ui.reset_layout = self.show, self.reset
        ui.panel_labels = tuple(label for label in PANELS if label != PICTURE)

    def go_on_from(self, other: Layout) -> None:
        """Begin with the shares of the window that panels had there, as the file of the layout has whole pixels."""
        self._shares, self._size = dict(other._shares), (1.0, 1.0)

    # --- what the commands ask for ---------------------------------------------------------------

    def show(self, label: str) -> None:
        """Bring a panel to the eye, wherever it is."""
        fold = self._ui.fold
        fold.hidden = False
        if fold.folded:
            fold.drawer = label
        else:
            self._params.docking_params.dockable_window_of_name(label).is_visible = True
            self._to_front.add(label)

    def reset(self) -> None:
        """Open all panels, docked where they were at first."""
        self._ui.fold.hidden = False
        for window in self._params.docking_params.dockable_windows:
            window.is_visible = True
        self._params.docking_params.layout_reset = True

    def menu(self) -> None:
        """What is in the menu of panels: a tick for each that is there."""
        for label in PANELS:
            if label == PICTURE:
                continue
            window, fold = self._params.docking_params.dockable_window_of_name(label), self._ui.fold
            there = fold.drawer == label if fold.folded else window.is_visible
            clicked, wanted = imgui.menu_item(label, "", there, True)
            if clicked and fold.folded:
                fold.drawer = label if wanted else ""
            elif clicked:
                window.is_visible = wanted

    # --- one frame -------------------------------------------------------------------------------

    def update(self) -> None:
        """Before the panels are drawn: fold them or unfold them, and keep their shares of the window."""
        fold = self._ui.fold
        room = imgui.get_main_viewport().work_size
        fold.folded = room.x < em(SMALLEST[0]) or room.y < em(SMALLEST[1])
        if not fold.folded:
            fold.drawer = ""
        margin = ImVec2(strip.WIDTH if fold.folded and not fold.hidden else 0.0, 0.0)
        self._params.imgui_window_params.full_screen_window_margin_bottom_right = margin
        self._keep_shares()
        self._keep_tabs()
        self._hide_tab_bar(fold.away)
        if not imgui.get_io().want_text_input:  # else Tab would begin to edit a field of the panel that was used last
            imgui.internal.set_key_owner(imgui.Key.tab, _KEY_OWNER)

    def _keep_shares(self) -> None:
        """When the window's size changes, each side keeps its share of it; else the picture alone would shrink."""
        nodes = list(self._nodes())
        if not nodes:
            return
        size = imgui.internal.dock_node_get_root_node(nodes[0]).size
        now = (size.x, size.y)
        resized = now != self._size and min(now) > 0.0 and min(self._size) > 0.0
        for node in nodes:
            share = self._shares.get(node.id_)
            if resized and share is not None:
                node.size_ref = ImVec2(share[0] * now[0], share[1] * now[1])
            elif share is None or _differ(node.size_ref, share, now):
                self._shares[node.id_] = (node.size_ref.x / max(now[0], 1.0), node.size_ref.y / max(now[1], 1.0))
        self._size = now

    def _keep_tabs(self) -> None:
        """Panels that come back bring their tabs to the front that were there before."""
        if self._ui.fold.away:
            self._back_for = 0
            return
        self._back_for += 1
        if self._back_for == _TABS_AFTER:
            self._to_front.update(self._tabs)
        elif self._back_for > _TABS_AFTER:
            self._tabs = [label for label in PANELS if label != PICTURE and _seen(label)]

    def _nodes(self) -> Iterator[Any]:
        """The nodes of the docking whose size is their own: all that do not hold the picture."""
        picture = _node_of(PICTURE)
        if picture is None:
            return
        root = imgui.internal.dock_node_get_root_node(picture)
        around = {node.id_ for node in _with_parents(picture)}
        seen: set[int] = set()
        for label in PANELS:
            for node in _with_parents(_node_of(label)):
                if node.id_ in seen or node.id_ in around:
                    continue
                seen.add(node.id_)
                if imgui.internal.dock_node_get_root_node(node).id_ == root.id_:
                    yield node

    def _hide_tab_bar(self, alone: bool) -> None:
        """A picture that stands alone needs no tab."""
        node, flag = _node_of(PICTURE), int(imgui.internal.DockNodeFlagsPrivate_.no_tab_bar)
        if node is not None and bool(node.local_flags & flag) != alone:
            node.set_local_flags(node.local_flags ^ flag)

    # --- the panels ------------------------------------------------------------------------------

    def _window(self, panel: Panel) -> hello_imgui.DockableWindow:
        window = hello_imgui.DockableWindow(panel.label, panel.space, lambda: self._draw(panel))
        window.call_begin_end = False
        return window

    def _draw(self, panel: Panel) -> None:
        """A docked panel, unless it is folded or hidden."""
        alone = panel.label == PICTURE
        if self._ui.fold.away and not alone:
            return
        # What lies in the main window is on its background already.  Filling it once more for each panel is half of
        # all the work where a processor draws.
        flags = int(imgui.WindowFlags_.no_background) if _in_main_window(panel.label) else 0
        if alone:
            scrolling = imgui.WindowFlags_.no_scrollbar | imgui.WindowFlags_.no_scroll_with_mouse
            flags |= int(scrolling | imgui.WindowFlags_.no_collapse)
        if panel.label in self._to_front:
            self._to_front.discard(panel.label)
            imgui.set_next_window_focus()
        # A tab in the back has no cross, nor room for one: so all are found by eye, and none is closed by mistake.
        shown, stays = imgui.begin(panel.label, True if not alone and _in_front(panel.label) else None, flags)
        try:
            if shown:
                self._ui.guard.panel(f"The panel {panel.label}", lambda: panel.show(self._ui))
        finally:
            imgui.end()
        if stays is False:
            self._params.docking_params.dockable_window_of_name(panel.label).is_visible = False


def _splits() -> list[hello_imgui.DockingSplit]:
    split: Callable[..., hello_imgui.DockingSplit] = hello_imgui.DockingSplit
    down = imgui.Dir.down
    return [
        split("MainDockSpace", "Left", imgui.Dir.left, 0.225),
        split("MainDockSpace", "Right", imgui.Dir.right, 0.295),
        split("MainDockSpace", "Bottom", down, 0.30),
        split("Left", "LeftBottom", down, 0.52),
        split("Right", "RightBottom", down, 0.37),
        split("Right", "RightMiddle", down, 0.56),
    ]


def _seen(label: str) -> bool:
    """Whether a panel was drawn, and not behind another's tab."""
    window = imgui.internal.find_window_by_name(label)
    return window is not None and window.was_active and not window.hidden


def _in_front(label: str) -> bool:
    """Whether a panel is no tab behind another's."""
    window = imgui.internal.find_window_by_name(label)
    node: Any = window.dock_node if window is not None else None
    front = node.visible_window if node is not None else None
    return window is None or front is None or front.id_ == window.id_


def _node_of(label: str) -> Any:
    """The node of the docking that a panel has or, while it is not drawn, will have again; None if it floats."""
    window = imgui.internal.find_window_by_name(label)
    return imgui.internal.dock_builder_get_node(window.dock_id) if window is not None and window.dock_id else None


def _with_parents(node: Any) -> Iterator[Any]:
    while node is not None:
        yield node
        node = node.parent_node


def _differ(size: ImVec2, share: tuple[float, float], whole: tuple[float, float]) -> bool:
    return abs(size.x - share[0] * whole[0]) > _NOTICED or abs(size.y - share[1] * whole[1]) > _NOTICED


def _in_main_window(label: str) -> bool:
    """Whether a panel is docked there, and floats neither alone nor with others."""
    window = imgui.internal.find_window_by_name(label)
    root = window.root_window_dock_tree if window is not None else None
    return root is not None and root.name.startswith("MainDockSpace")

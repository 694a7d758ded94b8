"""Where the panels are: docked around the picture, folded into a strip where the window is small, or hidden.

The docking is ImGui's.  This module says what is docked where at first, keeps each panel's share of the window
when the window's size changes, and decides whether the panels are drawn at all.  Panels that are folded or hidden
keep their place in the docking, so that they come back as they were.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from imgui_bundle import ImVec2, hello_imgui, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.output.figure1 import TITLE
from viewer.window.panels import (
    camera,
    compare,
    culling,
    experiment,
    figure1,
    film,
    find,
    hunt,
    inspector,
    light_buffer,
    log,
    picture,
    pixels,
    plots,
    rendering,
    saving,
    scene,
    statistics,
    view,
    what_if,
    zoom,
)
from viewer.window.ui import Ui
from viewer.window.widgets import clipped, em, tooltip

PICTURE = "Picture"


@dataclass(frozen=True)
class Panel:
    """`space` names a part of the docking; `wide` says that the panel is meant to be wider than high."""

    label: str
    space: str
    icon: str
    show: Callable[[Ui], None]
    wide: bool = False


PANELS = {
    panel.label: panel
    for panel in (
        Panel(PICTURE, "MainDockSpace", icons.ICON_FA_IMAGE, picture.show),
        Panel("Scene", "Left", icons.ICON_FA_CUBES, scene.show),
        Panel("Camera", "Left", icons.ICON_FA_VIDEO, camera.show),
        Panel("Statistics", "LeftBottom", icons.ICON_FA_CHART_COLUMN, statistics.show),
        Panel("View", "Right", icons.ICON_FA_EYE, view.show),
        Panel("Rendering", "Right", icons.ICON_FA_SLIDERS, rendering.show),
        Panel("Saving", "Right", icons.ICON_FA_CAMERA, saving.show),
        Panel("Culling", "RightMiddle", icons.ICON_FA_SCISSORS, culling.show),
        Panel("Inspector", "RightBottom", icons.ICON_FA_MAGNIFYING_GLASS, inspector.show),
        Panel("What if", "LeftBottom", icons.ICON_FA_WAND_MAGIC_SPARKLES, what_if.show),
        Panel(TITLE, "Bottom", icons.ICON_FA_DIAGRAM_PROJECT, figure1.show, wide=True),
        Panel("Plots", "Bottom", icons.ICON_FA_CHART_LINE, plots.show, wide=True),
        Panel("Compare", "Bottom", icons.ICON_FA_CODE_COMPARE, compare.show, wide=True),
        Panel("Pixels", "Bottom", icons.ICON_FA_BORDER_ALL, pixels.show, wide=True),
        Panel("Find", "Bottom", icons.ICON_FA_TABLE_LIST, find.show, wide=True),
        Panel("Light buffer", "Bottom", icons.ICON_FA_CUBE, light_buffer.show, wide=True),
        Panel("Experiment", "Bottom", icons.ICON_FA_FLASK, experiment.show, wide=True),
        Panel("Zoom test", "Bottom", icons.ICON_FA_MAGNIFYING_GLASS_PLUS, zoom.show, wide=True),
        Panel("Hunt", "Bottom", icons.ICON_FA_CROSSHAIRS, hunt.show, wide=True),
        Panel("Film", "Bottom", icons.ICON_FA_FILM, film.show, wide=True),
        Panel("Log", "Bottom", icons.ICON_FA_LIST, log.show, wide=True),
    )
}

SMALLEST = (66.0, 38.0)
"""Width and height in ems that leave room for docked panels, and their words, beside the picture."""
_NOTICED = 1.5  # pixels by which a panel's size must differ from its share to have been changed by the user
_TABS_AFTER = 3  # frames that ImGui needs to make the tabs of panels that come back
STRIP = 2.4
"""Width of the strip, in ems."""
_DRAWER, _WIDE = 21.0, 44.0  # width of an open panel in ems; it leaves some of the picture to be seen
_SHARE = 0.86  # of the room beside the strip, which an open panel takes at most
_FLAGS = int(
    imgui.WindowFlags_.no_title_bar
    | imgui.WindowFlags_.no_resize
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_docking
    | imgui.WindowFlags_.no_saved_settings
)
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
        ui.show_panel, ui.desktop.reset_layout = self.show, self.reset
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
        margin = ImVec2(STRIP if fold.folded and not fold.hidden else 0.0, 0.0)
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


def show_strip(ui: Ui) -> None:
    """The strip, and beside it, over the picture, the panel that was opened by it; only where panels are folded."""
    fold = ui.fold
    if not fold.folded or fold.hidden:
        return
    area = imgui.get_main_viewport()
    status = imgui.get_frame_height() + imgui.get_style().window_padding.y  # what the status bar takes
    bottom = min(area.work_pos.y + area.work_size.y, area.pos.y + area.size.y - status)
    top, right, height = area.work_pos.y, area.work_pos.x + area.work_size.x, bottom - area.work_pos.y
    _strip(ui, ImVec2(right - em(STRIP), top), height)
    panel = PANELS.get(fold.drawer)
    if panel is None:
        return
    room = area.work_size.x - em(STRIP)
    width = min(em(_WIDE if panel.wide else _DRAWER), _SHARE * room)
    _drawer(ui, panel, ImVec2(right - em(STRIP) - width, top), ImVec2(width, height))


def _strip(ui: Ui, at: ImVec2, height: float) -> None:
    imgui.set_next_window_pos(at)
    imgui.set_next_window_size(ImVec2(em(STRIP), height))
    imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(em(0.25), em(0.25)))
    imgui.begin("##strip", None, _FLAGS | int(imgui.WindowFlags_.no_scrollbar))
    imgui.pop_style_var()
    panels = [panel for panel in PANELS.values() if panel.label != PICTURE]
    gap = em(0.15)
    side = min(em(STRIP - 0.5), imgui.get_content_region_avail().y / len(panels) - gap)
    imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(gap, gap))
    imgui.push_style_var(imgui.StyleVar_.frame_padding, ImVec2(0.0, 0.0))
    for panel in panels:
        is_open = ui.fold.drawer == panel.label
        slot = imgui.Col_.button_active if is_open else imgui.Col_.window_bg
        imgui.push_style_color(imgui.Col_.button, imgui.get_style_color_vec4(slot))
        if imgui.button(f"{panel.icon}##{panel.label}", ImVec2(em(STRIP - 0.5), side)):
            ui.fold.drawer = "" if is_open else panel.label
        imgui.pop_style_color()
        tooltip(panel.label)
    imgui.pop_style_var(2)
    imgui.end()


def _drawer(ui: Ui, panel: Panel, at: ImVec2, size: ImVec2) -> None:
    imgui.set_next_window_pos(at)
    imgui.set_next_window_size(size)
    imgui.begin("##drawer", None, _FLAGS)
    side = imgui.get_frame_height()
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(panel.icon)
    imgui.same_line()
    clipped(panel.label)
    imgui.same_line(imgui.get_window_width() - side - em(0.55))
    if imgui.button(icons.ICON_FA_XMARK, ImVec2(side, side)):
        ui.fold.drawer = ""
    tooltip("close (Escape)")
    imgui.separator()
    if imgui.begin_child(f"{panel.label}##in drawer"):
        ui.guard.panel(f"The panel {panel.label}", lambda: panel.show(ui))
    imgui.end_child()
    imgui.end()

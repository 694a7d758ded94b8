"""All panels that can be docked: where each is at first, its icon, and what draws it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.output.figure1 import TITLE
from viewer.window.panels import (
    camera,
    compare,
    culling,
    experiment,
    figure1,
    filming,
    find,
    hunt,
    inspector,
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
        Panel("Experiment", "Bottom", icons.ICON_FA_FLASK, experiment.show, wide=True),
        Panel("Zoom test", "Bottom", icons.ICON_FA_MAGNIFYING_GLASS_PLUS, zoom.show, wide=True),
        Panel("Hunt", "Bottom", icons.ICON_FA_CROSSHAIRS, hunt.show, wide=True),
        Panel("Film", "Bottom", icons.ICON_FA_FILM, filming.show, wide=True),
        Panel("Log", "Bottom", icons.ICON_FA_LIST, log.show, wide=True),
    )
}

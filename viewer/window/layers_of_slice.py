"""Going through the layers of a slice, by keys and by hand."""

from __future__ import annotations

from typing import NamedTuple

from viewer.state.draw_options import AXES, Slice
from viewer.state.readings import VOXELS, can_draw
from viewer.state.views import View
from viewer.views.tree import tree_of
from viewer.views.tree_slice import LAYERS, layer_of, place_of
from viewer.views.voxel_slice import middle_of
from viewer.views.voxels import voxels_of
from viewer.window.ui import Ui


class Layer(NamedTuple):
    """The layer that is cut, of so many, and where its middle lies along the axis."""

    number: int
    many: int
    place: float


def layer_now(ui: Ui) -> Layer | None:
    """That of the view's slice; None while there is nothing to cut."""
    frame, cut, view = ui.controller.frame, ui.controller.session.cut, ui.controller.session.view
    if frame is not None and view is View.VOXELS and VOXELS in frame.structures:
        states = voxels_of(frame)
        return Layer(cut.layer(states.shape), states.shape[cut.axis], middle_of(states.grid, cut))
    if frame is not None and view is View.TREE and can_draw(frame, view):
        return Layer(layer_of(cut), LAYERS, place_of(tree_of(frame), cut))
    return None


def go_to(cut: Slice, layer: int, many: int) -> Slice:
    """The slice in another layer of so many, or in the last one before these end."""
    return cut._replace(at=(min(max(layer, 0), many - 1) + 0.5) / many)


def step(ui: Ui, layers: int) -> None:
    """Go on by so many layers."""
    s, layer = ui.controller.session, layer_now(ui)
    if layer is not None:
        s.cut = go_to(s.cut, layer.number + layers, layer.many)


def turn(ui: Ui) -> None:
    """Cut across the next axis."""
    s = ui.controller.session
    s.cut = s.cut._replace(axis=(s.cut.axis + 1) % len(AXES))

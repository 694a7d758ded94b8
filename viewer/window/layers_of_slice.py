"""Going through the layers of a slice, by keys and by hand."""

from __future__ import annotations

from viewer.state.readings import VOXELS, voxels_of
from viewer.state.slices import AXES, Slice
from viewer.window.ui import Ui


def go_to(cut: Slice, layer: int, many: int) -> Slice:
    """The slice in another layer of so many, or in the last one before these end."""
    return cut._replace(at=(min(max(layer, 0), many - 1) + 0.5) / many)


def step(ui: Ui, layers: int) -> None:
    """Go on by so many layers."""
    s, frame = ui.controller.session, ui.controller.frame
    if frame is not None and VOXELS in frame.structures:
        shape = voxels_of(frame).shape
        s.cut = go_to(s.cut, s.cut.layer(shape) + layers, shape[s.cut.axis])


def turn(ui: Ui) -> None:
    """Cut across the next axis."""
    s = ui.controller.session
    s.cut = s.cut._replace(axis=(s.cut.axis + 1) % len(AXES))

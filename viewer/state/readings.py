"""What of a frame views and panels ask about, and whether there is memory to record it."""

from __future__ import annotations

from tracer.frame import Frame
from viewer.state.views import View

MOST_RECORDED = 1 << 28
"""Pixels times lights, at most, of which all samples are recorded: a gigabyte of memory."""

MOST_TOGETHER = 32
"""Lights, at most, that are recorded together for a view of one: of more, the one is looked at alone, which is done
soon and asks for no other frame."""

CUT_NODES, CUT_BOUND = "cut nodes", "cut bound"  # layers of methods that shade by cuts of lights
CELL_LIGHTS = "cell lights"  # that of methods whose cells know which lights they must look at
VOXELS, LIGHT_CUBES = "voxels", "light cubes"  # structures of methods
TREE = "tree"  # that rays have built
TREE_IS_GONE = "the frame's tree was freed with its world"


def can_record_lights(pixels: int, lights: int) -> bool:
    """Return whether there is memory for what each light sends to each pixel."""
    return pixels * lights <= MOST_RECORDED


def records_lights(view: View, pixels: int, lights: int) -> bool:
    """Return whether frames of so many pixels are to record all lights for this view."""
    few = lights <= MOST_TOGETHER or not view.of_light
    return view.needs_lights and few and can_record_lights(pixels, lights)


def records_fates(view: View, pixels: int, lights: int) -> bool:
    """Return whether frames of so many pixels are to record what becomes of all shadow rays for this view."""
    return view.needs_fates and can_record_lights(pixels, lights)


def has_modes_of_cells(frame: Frame) -> bool:
    """Return whether what carries modes are virtual cells."""
    return frame.cells is not None and frame.certificates is None


def can_draw(frame: Frame, view: View, light: int = 0) -> bool:
    """Return whether the frame holds what the view shows, of this light where it is about one."""
    return view.declared.can_draw(frame, light)

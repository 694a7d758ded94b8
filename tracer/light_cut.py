"""The clusters of lights that shade a pixel: the cut of the block of points that it was shaded with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.rays import MISS
from tracer.methods.lightcuts import Lightcuts
from tracer.shading.lightcuts.seen import BOX, ERROR, SENT

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.renderer import Renderer


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class LightCut:
    """The n nodes of the cut that shades pixel (x, y) of a frame.

    Attributes
    ----------
    nodes : (n,) int32
        Their numbers in the tree of lights.
    boxes : (n, 6) float32
        The lower and the upper corner around the lights of each.
    lights : (n,) int32
        How many lights each stands for.
    sent : (n,) float32
        What is estimated to come from each to the pixel's point, the sum of three channels.
    errors : (n,) float32
        By what part of all light at a point of the block each may be wrong, where that is most.
    """

    frame: Frame
    x: int
    y: int
    nodes: NDArray[np.int32]
    boxes: NDArray[np.float32]
    lights: NDArray[np.int32]
    sent: NDArray[np.float32]
    errors: NDArray[np.float32]


def light_cut(renderer: Renderer, frame: Frame, x: int, y: int) -> LightCut | None:
    """Find the cut that shades a pixel.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame, and has begun no other since.
    frame : Frame
        The picture, all of it.
    x, y : int
        Column and row of the pixel.

    Returns
    -------
    LightCut or None
        Its cut; None where the pixel shows nothing, or no cuts take part in the frame.

    Raises
    ------
    IndexError
        If the picture has no such pixel.
    LookupError
        If the renderer has begun another frame.
    """
    if not (0 <= x < frame.width and 0 <= y < frame.height):
        raise IndexError(f"no pixel {x},{y}: the picture is {frame.width} x {frame.height}")
    work = renderer.work_on(frame)
    method = next((one for one in work.methods if isinstance(one, Lightcuts)), None)
    if method is None or method.tree is None or frame.primitive[y, x] == MISS:
        return None
    watching = method.watching(work, y * frame.width + x)
    if watching is None:
        return None
    stage, watched = watching
    work.shade_again(x, y, [stage])
    count = int(watched.cut[0])
    nodes, told = watched.cut[1 : count + 1], watched.nodes[:count]
    spans = method.tree.spans[nodes]
    return LightCut(
        frame, x, y, nodes, told[:, BOX : BOX + 6], spans[:, 1] - spans[:, 0], told[:, SENT], told[:, ERROR]
    )

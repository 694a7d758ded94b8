"""What views read off a frame, and whether the frame has it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.culling.voxels.tell import VoxelStates
from tracer.frame import EVERYWHERE, Frame, Region
from tracer.geometry.tree_parts import TreeParts
from viewer.state.views import Arrival, MovingShadow, View

MOST_RECORDED = 1 << 28
"""Pixels times lights, at most, of which all samples are recorded: a gigabyte of memory."""

MOST_TOGETHER = 32
"""Lights, at most, that are recorded together for a view of one: of more, the one is looked at alone, which is done
soon and asks for no other frame."""

CUT_NODES, CUT_BOUND = "cut nodes", "cut bound"  # layers of methods that shade by cuts of lights
CELL_LIGHTS = "cell lights"  # that of methods whose cells know which lights they must look at
VOXELS, LIGHT_CUBES = "voxels", "light cubes"  # structures of methods
TREE = "tree"  # that rays have built

_NO_CUTS = "the method of the frame shades by all lights, not by clusters of them"
_NO_CELLS = "the method of the frame has no cells that know which lights they must look at"
_NO_VOXELS = "the method of the frame has no voxels"
_NO_TREE = "all of the frame's tree was built before its rays came"
TREE_IS_GONE = "the frame's tree was let go of with its world"
_NO_WORK = "the frame did not record the work at its pixels"
_NO_LIGHTS = "the frame did not record which samples of its lights reach its pixels"


def can_draw(frame: Frame, view: View, light: int = 0) -> bool:
    """Whether the frame holds what the view shows, of this light where it is a view of one."""
    if view.needs_verify:
        return frame.wrong is not None
    if view.needs_work:
        return work_of(frame, view) is not None
    if view.needs_lights:
        return frame.asked is not None and frame.only_light in ((None, light) if view.of_light else (None,))
    if view.needs_fates:
        return frame.fates is not None
    if view is View.CERTIFICATE:
        return frame.certificates is not None
    if view is View.CUTS:
        return CUT_NODES in frame.layers
    if view is View.CELL_LIGHTS:
        return CELL_LIGHTS in frame.layers
    if view is View.VOXELS:
        return VOXELS in frame.structures
    if view is View.TREE:
        return TREE in frame.structures and frame.structures[TREE].alive
    return frame.settings.keeps_modes or not view.of_modes


def can_record_lights(pixels: int, lights: int) -> bool:
    """Whether there is memory for what each light sends to each pixel."""
    return pixels * lights <= MOST_RECORDED


def records_lights(view: View, pixels: int, lights: int) -> bool:
    """Whether frames of so many pixels are to record all lights for this view."""
    few = lights <= MOST_TOGETHER or not view.of_light
    return view.needs_lights and few and can_record_lights(pixels, lights)


def records_fates(view: View, pixels: int, lights: int) -> bool:
    """Whether frames of so many pixels are to record what becomes of the shadow rays to all lights for this view."""
    return view.needs_fates and can_record_lights(pixels, lights)


def depth_range(frame: Frame) -> tuple[float, float]:
    """Nearest and farthest distance worth a colour: the 1st and 99th percentile of what is hit (0, 1 for nothing)."""
    step = max(1, frame.height * frame.width // 20000)
    sample = frame.depth.reshape(-1)[::step]
    sample = sample[np.isfinite(sample)]
    if len(sample) == 0:
        return 0.0, 1.0
    low, high = np.percentile(sample, (1.0, 99.0))
    return float(low), float(max(high, low * (1.0 + 1e-6) + 1e-12))


def untrusted(frame: Frame, light: int) -> NDArray[np.bool_]:
    """(units,): whether a unit has a shadow mode of a light by which it would be culled if it were fully rendered."""
    if not has_shadow_mode(frame.modes, light):
        return np.zeros(len(frame.modes), np.bool_)
    shadow, occlusion = shadow_mode(frame.modes, light), occlusion_mode(frame.modes)
    culls = (shadow == ShadowMode.FULL_SHADOW) | (shadow == ShadowMode.NON_SHADOW)
    return culls & (occlusion != OcclusionMode.FULLY_RENDERED) & (occlusion != OcclusionMode.DYNAMIC)


def has_modes_of_cells(frame: Frame) -> bool:
    """Whether what carries modes are virtual cells."""
    return frame.cells is not None and frame.certificates is None


def work_of(frame: Frame, view: View) -> NDArray[np.int32] | None:
    """(h, w) what a heat map shows at each pixel; None where the frame did not record it."""
    return frame.saved if view is View.SAVED else frame.cost


def whole_of(frame: Frame, view: View) -> NDArray[np.int32]:
    """(h, w) what the work at each pixel is a share of: the shadow rays that were due, or all rays that tracing without
    culling takes.

    Raises ValueError for a frame without that record."""
    if frame.saved is None or frame.cost is None or frame.due_rays is None:
        raise ValueError(_NO_WORK)
    return frame.due_rays if view is View.SAVED else frame.saved + frame.cost


def samples_of(frame: Frame, light: int) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """(h, w) samples of a light that each pixel faces, and those of them that reach it: 0 where it is not known yet.

    Raises ValueError for a frame without that record."""
    if frame.asked is None or frame.reached is None or frame.only_light not in (None, light):
        raise ValueError(_NO_LIGHTS)
    column = light if frame.only_light is None else 0
    return frame.asked[..., column], frame.reached[..., column]


def arrivals(frame: Frame, light: int) -> NDArray[np.uint8]:
    """(h, w) Arrival of a light at each pixel; raises ValueError for a frame without that record."""
    asked, reached = samples_of(frame, light)
    penumbra = np.where(2 * reached.astype(np.int32) > asked, Arrival.MOST, Arrival.FEW)
    lit = np.where(reached == 0, Arrival.DARK, np.where(reached == asked, Arrival.LIT, penumbra))
    found = np.where(asked == 0, Arrival.AWAY, lit).astype(np.uint8)
    if frame.shaded is not None:
        found[~frame.shaded] = Arrival.UNKNOWN
    return found


def moving_shadows(frame: Frame, light: int, where: Region = EVERYWHERE) -> NDArray[np.uint8]:
    """(h, w) MovingShadow of a light at each pixel, or at some; raises ValueError for a frame without a record of
    fates."""
    dynamic_only, dark = frame.fate(light, where) == Fate.DYNAMIC_ONLY, frame.moving_shadow(light, where)
    found = np.where(dynamic_only, MovingShadow.LIT, MovingShadow.NONE).astype(np.uint8)
    hit = frame.primitive[where] >= 0
    seen = occlusion_mode(frame.modes[frame.unit[where][hit]])
    found[hit] = np.where(seen == OcclusionMode.DYNAMIC, np.uint8(MovingShadow.OBJECT), found[hit])
    found[dark] = np.where(dynamic_only[dark], MovingShadow.DARK, MovingShadow.TRACED)
    return found


def lights_due(frame: Frame) -> NDArray[np.int32]:
    """(h, w) how many lights each pixel faces with any of their samples; -1 where it is not known yet.

    Raises ValueError for a frame without that record."""
    if frame.asked is None or frame.only_light is not None:
        raise ValueError(_NO_LIGHTS)
    found = np.count_nonzero(frame.asked, axis=-1).astype(np.int32)
    return found if frame.shaded is None else np.where(frame.shaded, found, np.int32(-1))


def lights_top(due: NDArray[np.int32]) -> int:
    """What has the last colour of the map of `lights_due`, of `cut_nodes` or of `cell_lights`: the most, 1 at least."""
    return max(1, int(due.max(initial=0)))


def cut_nodes(frame: Frame) -> NDArray[np.int32]:
    """(h, w) how many clusters of lights each pixel is shaded by; -1 where it is not known yet.

    Raises ValueError for a frame by a method that has none."""
    if CUT_NODES not in frame.layers:
        raise ValueError(_NO_CUTS)
    return frame.layers[CUT_NODES]


def cell_lights(frame: Frame) -> NDArray[np.int32]:
    """(h, w) how many lights the cell of each pixel must look at; -1 where it lies in none, or is not known yet.

    Raises ValueError for a frame by a method that has no such cells."""
    if CELL_LIGHTS not in frame.layers:
        raise ValueError(_NO_CELLS)
    return frame.layers[CELL_LIGHTS]


def voxels_of(frame: Frame) -> VoxelStates:
    """The voxels as the frame found them; raises ValueError for a frame by a method that has none."""
    if VOXELS not in frame.structures:
        raise ValueError(_NO_VOXELS)
    found: VoxelStates = frame.structures[VOXELS]
    return found


def tree_of(frame: Frame) -> TreeParts:
    """The tree that the frame's rays were building; raises ValueError for a frame whose tree was there before, or is
    no more."""
    if TREE not in frame.structures:
        raise ValueError(_NO_TREE)
    found: TreeParts = frame.structures[TREE]
    if not found.alive:
        raise ValueError(TREE_IS_GONE)
    return found


def work_top(frame: Frame, view: View) -> float:
    """What has a heat map's last colour: the 99th percentile of pixels that hit something, 1 at least.

    Raises ValueError for a frame without that record."""
    work = work_of(frame, view)
    if work is None:
        raise ValueError(_NO_WORK)
    step = max(1, work.size // 20000)
    sample = work.reshape(-1)[::step][frame.primitive.reshape(-1)[::step] >= 0]
    return max(1.0, float(np.percentile(sample, 99.0))) if len(sample) else 1.0


def span_of(frame: Frame, view: View) -> tuple[float, float]:
    """What the first and the last colour of the map stand for in a view with a range, unless others are chosen.

    Raises ValueError for a frame without that record, and for other views."""
    if view is View.DEPTH:
        return depth_range(frame)
    if view is View.LIGHTS:
        return 0.0, float(lights_top(lights_due(frame)))
    if view is View.CUTS:
        return 0.0, float(lights_top(cut_nodes(frame)))
    if view is View.CELL_LIGHTS:
        return 0.0, float(lights_top(cell_lights(frame)))
    if view is View.TREE:
        return 0.0, float(tree_of(frame).levels)
    if not view.has_range:
        raise ValueError(f"the view {view.value} has no range")
    return 0.0, work_top(frame, view)

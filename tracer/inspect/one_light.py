"""What one light sends to each pixel of a picture that is there already.

To record every light at every pixel takes memory for all of them (`Settings.record_lights`).  Where there are too many,
a light can be looked at alone: the primary hits are shaded once more, by this light only and by tracing all of its
shadow rays.  That takes a moment, however many lights there are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from tracer.culling.counters import COUNTERS
from tracer.geometry.camera import pinhole
from tracer.methods.interface import StageTable
from tracer.runtime.parallel import for_each_chunk, thread_count
from tracer.scene.lights import Lamps
from tracer.shading.blocks import all_blocks
from tracer.shading.buffers import empty_buffers
from tracer.shading.tiles import tiles_of
from tracer.shading.whitted import shade_tile, trace_primary

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.renderer import Renderer


def with_light(renderer: Renderer, frame: Frame, light: int) -> Frame:
    """The frame with what one light sends to it.

    The world of the renderer must still be placed for this frame.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame.
    frame : Frame
        The picture, whole or shaded in part.
    light : int
        Number of the light.

    Returns
    -------
    Frame
        The same with `asked` and `reached` (h, w, 1), of all pixels, and `only_light` set. These are what is true, and
        so what any exact method finds.

    Raises
    ------
    IndexError
        If there is no such light.
    """
    if not 0 <= light < frame.lights:
        raise IndexError(f"no light {light}: there are {frame.lights}")
    state, settings = renderer.state, frame.settings
    lamps = state.lamps(settings).at(renderer.scene.light_positions(frame.time))
    shading = state.shading._replace(lamps=_alone(lamps, light))
    width, height, workers = frame.width, frame.height, thread_count(settings.threads)
    rays, lanes, tiles = pinhole(frame.camera, width, height), all_blocks(width, height), tiles_of(width, height)
    buffers = empty_buffers(width, height, 1, record_lights=True)
    counts, spaces = np.zeros((workers, COUNTERS), np.int64), state.workspaces(workers)
    placed, stages = renderer.world.placed, StageTable([], verify=False).given

    def work(chunk: int, worker: int) -> None:
        tile, counted, space = tiles[chunk], counts[worker], spaces[worker]
        trace_primary(placed, rays, tile, lanes, buffers, counted, space)
        shade_tile(placed, shading, rays, tile, lanes, 0, stages, buffers, counted, space)

    for_each_chunk(work, len(tiles), workers, None)
    asked, reached = (rows.reshape(height, width, 1) for rows in (buffers.asked, buffers.reached))
    return replace(frame, asked=asked, reached=reached, only_light=light, shaded=None)


def _alone(lamps: Lamps, light: int) -> Lamps:
    """One of the lamps, as if there were no other."""
    first, end = lamps.first[light : light + 2]
    one = slice(light, light + 1)
    return Lamps(
        lamps.places[one], lamps.samples[first:end], np.array([0, end - first], np.int32), lamps.rows[one],
        lamps.radii[one],
    )  # fmt: skip

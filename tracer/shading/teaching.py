"""Which pixels of a picture would teach something about shadows: those that are to be shaded first.

A unit that is seen whole is FULLY_RENDERED once as many of its pixels have set its modes as it covers
(`tracer.culling.occlusion.set_occlusion_modes`).  In motion only some pixels of each picture are shaded, and shading
those of units that are still to be taught lets later pictures cull their shadow rays the sooner.
"""

from __future__ import annotations

from tracer.culling.modes import DYNAMIC, FULLY_RENDERED, occlusion_bits
from tracer.geometry.rays import MISS
from tracer.runtime.kernels import kernel
from tracer.shading.blocks import block_of
from tracer.shading.primary import BLOCK


@kernel
def find_untaught(units, words, hidden, lanes):
    """Find the pixels of units that are seen whole, but not FULLY_RENDERED yet.

    units (height, width) int32 are what each pixel sees, words (units,) their modes, and hidden (units,) bool says what
    occlusion testing has found hidden.  lanes (rows, columns) int32, all zero, gets the bits of the pixels of each
    block, edges and all (`tracer.shading.blocks`).
    """
    height, width = units.shape
    for y in range(height):
        for x in range(width):
            unit = units[y, x]
            if unit == MISS or hidden[unit]:
                continue
            mode = occlusion_bits(words[unit])
            if mode != FULLY_RENDERED and mode != DYNAMIC:
                row, column = block_of(x, y)
                lanes[row, column] |= 1 << ((y % BLOCK) * BLOCK + x % BLOCK)

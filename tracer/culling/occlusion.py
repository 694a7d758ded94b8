"""Occlusion testing and occlusion-mode setting (§2.3 and §2.6 of the paper).

Neighbouring pixels that see different primitives are asked whether one hides the other: the ray of
the current pixel is tested against the primitive of the reference pixel, left and above.  If it
hits, something nearer hides that primitive here, and it is PARTIALLY_OCCLUDED.  A primitive that is
never found hidden has been seen whole and becomes FULLY_RENDERED at the end of the frame, or, where not all
of the frame's pixels are shaded, of the one that has shaded as many of its pixels as it covers.

Where modes are carried by cells of primitives (`tracer.culling.cells`), it is the reference pixel's
cell that the ray is tested against.  Cells of one triangle hide nothing of each other, and nothing is
tested where neighbouring pixels see the same primitive.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.cells import hits_unit
from tracer.culling.modes import DYNAMIC, FULLY_RENDERED, INIT, PARTIALLY_OCCLUDED, occlusion_bits
from tracer.geometry.camera import primary_ray
from tracer.geometry.memory import without_refcount
from tracer.geometry.rays import MISS
from tracer.runtime.kernels import inlined, kernel
from tracer.simd import address_of, bits_of, i32x16, lanes_below, load_i32, load_i32x16, local_memory, lowest_bit, store


@inlined
def _test(world, camera, x, y, primitive, first, unit, words, hidden):
    """Occlusion test: is this unit of a primitive hidden where pixel (x, y) sees another primitive?

    It is left out, though counted as published, where the answer is known or would change nothing."""
    mode = occlusion_bits(words[unit])
    if hidden[unit] or mode in (FULLY_RENDERED, DYNAMIC):
        return
    if hits_unit(world, primary_ray(camera, x, y), primitive, first, unit):
        hidden[unit] = True


@inlined
def _sixteen(row, x, width, spare):
    """Primitives from the x-th of a row on, MISS where the row has none; `spare` is memory to put them together in."""
    if x >= 0 and x + 16 <= width:
        return load_i32x16(row + 4 * x)
    store(spare, i32x16(MISS))
    for i in range(max(0, -x), min(16, width - x)):
        store(spare + 4 * i, load_i32(row + 4 * (x + i)))
    return load_i32x16(spare)


@inlined
def _compare(world, camera, primitives, first, units, x, y, rx, ry, symmetric, words, hidden):
    """Occlusion tests of two pixels that see different primitives, (rx, ry) the reference; how many."""
    reference, current, tests = primitives[ry, rx], primitives[y, x], 0
    if reference != MISS:
        _test(world, camera, x, y, reference, first, units[ry, rx], words, hidden)
        tests += 1
    if symmetric and current != MISS:
        _test(world, camera, rx, ry, current, first, units[y, x], words, hidden)
        tests += 1
    return tests


@kernel
def occlusion_testing(world, camera, primitives, first, units, symmetric, first_row, last_row, words, hidden):
    """Mark in hidden (units,) bool what rows first_row to last_row - 1 find occluded; returns the tests asked for.

    primitives (height, width) int32 are the nearest along the primary rays, units like primitives what of
    them carries modes, numbered from first (p + 1,) on, or, where that is empty, the primitives themselves.
    words (units,) are modes as the last frame left them: what is hidden matters of those alone that are not
    FULLY_RENDERED.  With `symmetric` the reference pixel's ray is also tested against the current unit.
    """
    world, camera, primitives = without_refcount((world, camera, primitives))
    first, units, words, hidden = without_refcount((first, units, words, hidden))
    height, width = primitives.shape
    spare, tests = local_memory(64), 0
    for y in range(first_row, last_row):
        row = address_of(primitives) + 4 * width * y
        step = 1 if y == 0 or y == height - 1 else max(1, width - 1)
        for x in range(0, width, step):
            if primitives[y, x] != MISS:
                hidden[units[y, x]] = True  # it may go on beyond the screen's edge
        for start in range(0, width, 16):
            there = lanes_below(width - start, 0)
            current = _sixteen(row, start, width, spare)
            left = there & ~bits_of(current == _sixteen(row, start - 1, width, spare))
            if start == 0:
                left &= ~1
            while left != 0:
                x = start + lowest_bit(left)
                left &= left - 1
                tests += _compare(world, camera, primitives, first, units, x, y, x - 1, y, symmetric, words, hidden)
            if y == 0:
                continue
            above = there & ~bits_of(current == _sixteen(row - 4 * width, start, width, spare))
            while above != 0:
                x = start + lowest_bit(above)
                above &= above - 1
                tests += _compare(world, camera, primitives, first, units, x, y, x, y - 1, symmetric, words, hidden)
    return tests


@kernel
def set_occlusion_modes(words, hidden, pixel_count, shaded_count, zoom_factor, highest_count, taught):
    """Set occlusion modes at the end of a frame (§2.6), over all units.

    pixel_count (units,) int32 are the frame's primary pixels, shaded_count (units,) int32 those of them whose shadow
    rays have set modes: all in a whole picture, some in one that was left before.  A unit that is seen whole is
    FULLY_RENDERED once as many pixels have set its modes, in this frame and in those just before it in which it was
    seen whole, as it covers now; taught (units,) int32 counts them.  So a whole picture makes it so at once, as
    published.  highest_count (units,) int32 is what a FULLY_RENDERED unit was last examined at; past zoom_factor times
    that it is INIT again.
    """
    for unit in range(len(words)):
        mode = occlusion_bits(words[unit])
        if mode == DYNAMIC:
            continue
        count = pixel_count[unit]
        if mode == FULLY_RENDERED:
            if count > zoom_factor * highest_count[unit]:
                mode = INIT
                highest_count[unit] = count
        else:  # PARTIALLY_OCCLUDED of the last frame starts this one as INIT
            mode = INIT
            if hidden[unit]:
                mode = PARTIALLY_OCCLUDED
                taught[unit] = 0
            elif count > 0:
                taught[unit] += shaded_count[unit]
                if taught[unit] >= count:
                    mode = FULLY_RENDERED
                    highest_count[unit] = count
                    taught[unit] = 0
        words[unit] = (np.uint64(words[unit]) & ~np.uint64(3)) | np.uint64(mode)


@kernel
def count_pixels(seen, pixel_count):
    """Primary pixels of every unit, of units `seen` (height, width), into pixel_count (units,) int32."""
    pixel_count[:] = 0
    for unit in seen.flat:
        if unit != MISS:
            pixel_count[unit] += 1

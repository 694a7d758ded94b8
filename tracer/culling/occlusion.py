"""Occlusion testing and occlusion-mode setting (§2.3 and §2.6 of the paper).

Neighbouring pixels that see different primitives are asked whether one hides the other: the ray of
the current pixel is tested against the primitive of the reference pixel, left and above.  If it
hits, something nearer hides that primitive here, and it is PARTIALLY_OCCLUDED.  A primitive that is
never found hidden has been seen whole and becomes FULLY_RENDERED at the end of the frame.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.modes import DYNAMIC, FULLY_RENDERED, INIT, PARTIALLY_OCCLUDED, occlusion_bits
from tracer.geometry.camera import primary_ray
from tracer.geometry.queries import hits_alone
from tracer.geometry.rays import MISS
from tracer.kernels import inlined, kernel


@inlined
def _test(world, camera, x, y, primitive, hidden):
    """Occlusion test: is `primitive` hidden where pixel (x, y) sees another one?"""
    if hits_alone(world, primary_ray(camera, x, y), primitive):
        hidden[primitive] = True


@kernel
def occlusion_testing(world, camera, primitives, symmetric, first_row, last_row, hidden):
    """Mark in hidden (units,) bool what rows first_row to last_row - 1 find occluded; returns the tests made.

    primitives (height, width) int32 are the nearest along the primary rays.  With `symmetric` the
    reference pixel's ray is also tested against the current primitive.
    """
    height, width = primitives.shape
    tests = 0
    for y in range(first_row, last_row):
        for x in range(width):
            current = primitives[y, x]
            if current != MISS and (x == 0 or y == 0 or x == width - 1 or y == height - 1):
                hidden[current] = True  # it may go on beyond the screen's edge
            for rx, ry in ((x - 1, y), (x, y - 1)):
                if rx < 0 or ry < 0:
                    continue
                reference = primitives[ry, rx]
                if reference == current:
                    continue
                if reference != MISS:
                    _test(world, camera, x, y, reference, hidden)
                    tests += 1
                if symmetric and current != MISS:
                    _test(world, camera, rx, ry, current, hidden)
                    tests += 1
    return tests


@kernel
def set_occlusion_modes(words, hidden, pixel_count, highest_count, zoom_factor):
    """Occlusion-mode setting at the end of a frame, over all units; clears `hidden`.

    pixel_count (units,) int32 are this frame's primary pixels.  highest_count (units,) int32 is
    what a FULLY_RENDERED unit was last examined at; past zoom_factor times that it is INIT again.
    """
    for unit in range(len(words)):
        mode, was_hidden = occlusion_bits(words[unit]), hidden[unit]
        hidden[unit] = False
        if mode == DYNAMIC:
            continue
        count = pixel_count[unit]
        if mode == FULLY_RENDERED:
            if count > zoom_factor * highest_count[unit]:
                mode = INIT
                highest_count[unit] = count
        else:  # PARTIALLY_OCCLUDED of the last frame starts this one as INIT
            mode = INIT
            if was_hidden:
                mode = PARTIALLY_OCCLUDED
            elif count > 0:
                mode = FULLY_RENDERED
                highest_count[unit] = count
        words[unit] = (np.uint64(words[unit]) & ~np.uint64(3)) | np.uint64(mode)


@kernel
def count_pixels(primitives, pixel_count):
    """Primary pixels of every unit, into pixel_count (units,) int32."""
    pixel_count[:] = 0
    for primitive in primitives.flat:
        if primitive != MISS:
            pixel_count[primitive] += 1

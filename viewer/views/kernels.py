"""The kernels that draw: each goes over a picture once, on one core and without the GIL.

They stand alone, as what they import decides when they are compiled anew.  `viewer.views.paint` says what is given.
"""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, kernel


@inlined
def _shade_row(color, y, shading, factor):
    """Find by what the light and shade of the picture multiplies flat colours, with the sums of fused products."""
    zero, one = np.float32(0), np.float32(1)
    red, green, blue = np.float32(0.2126), np.float64(np.float32(0.7152)), np.float64(np.float32(0.0722))
    for x in range(color.shape[1]):
        r, g, b = min(max(color[y, x, 0], zero), one), min(max(color[y, x, 1], zero), one), color[y, x, 2]
        luminance = np.float32(np.float64(g) * green + np.float64(r * red))
        luminance = np.float32(np.float64(min(max(b, zero), one)) * blue + np.float64(luminance))
        light = np.float32(0.25) + np.float32(0.95) * np.sqrt(luminance)
        factor[x] = one + shading * (light - one)


@inlined
def _line_row(cells, y, line, plain, factor):
    """Find by what lines multiply colours: `line` where the neighbour to the right, or below, is another."""
    h, w = cells.shape
    below = y + 1 if y + 1 < h else y
    for x in range(w):
        right = x + 1 if x + 1 < w else x
        cell = cells[y, x]
        factor[x] = line if (cells[y, right] != cell) | (cells[below, x] != cell) else plain


@kernel
def paint_table(index, table, stripe, color, shading, primitive, background, cells, line, outline, pixels):
    one, zero, most = np.float32(1), np.float32(0), np.float32(255)
    h, w = primitive.shape
    shade, border, edge = np.ones(w, np.float32), np.ones(w, np.float32), np.ones(w, np.float32)
    striped = len(table) // 2
    for y in range(h):
        if shading > zero:
            _shade_row(color, y, shading, shade)
        if line < one:
            _line_row(cells, y, line, one, border)
        if outline < one:
            _line_row(primitive, y, outline, one, edge)
        for x in range(w):
            missed, k = primitive[y, x] < 0, index[y, x]
            if stripe > 0 and (x + y) // stripe % 2 == 1:
                k += striped
            for c in range(3):
                shown = background[c] if missed else min(max(table[k, c] * shade[x], zero), one) * border[x]
                pixels[y, x, c] = np.uint8(np.rint(shown * edge[x] * most))


@kernel
def paint_colors(colors, everywhere, color, shading, primitive, background, outline, pixels):
    one, zero, most = np.float32(1), np.float32(0), np.float32(255)
    h, w = primitive.shape
    shade, edge = np.ones(w, np.float32), np.ones(w, np.float32)
    for y in range(h):
        if shading > zero:
            _shade_row(color, y, shading, shade)
        if outline < one:
            _line_row(primitive, y, outline, one, edge)
        for x in range(w):
            missed = primitive[y, x] < 0 and not everywhere
            for c in range(3):
                shown = background[c] if missed else min(max(colors[y, x, c] * shade[x], zero), one)
                pixels[y, x, c] = np.uint8(np.rint(shown * edge[x] * most))

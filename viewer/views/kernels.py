"""The kernels that draw: each goes over a picture once, on one core and without the GIL.

They stand alone, as what they import decides when they are compiled anew.  `viewer.views.paint` says what is given.
"""

from __future__ import annotations

import numpy as np

from tracer.kernels import inlined, kernel


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
def paint_classes(
    index, classes, palette, striped, stripe, color, shading, primitive, background, cells, line, outline, pixels
):
    one, zero, most = np.float32(1), np.float32(0), np.float32(255)
    h, w = primitive.shape
    shade, border, edge = np.ones(w, np.float32), np.ones(w, np.float32), np.ones(w, np.float32)
    row = np.empty((w, 3), np.float32)
    for y in range(h):
        _shade_row(color, y, shading, shade)
        if line < one:
            _line_row(cells, y, line, one, border)
        if outline < one:
            _line_row(primitive, y, outline, one, edge)
        for x in range(w):
            if primitive[y, x] < 0:
                row[x, 0], row[x, 1], row[x, 2] = background[0], background[1], background[2]
                shade[x] = border[x] = one
            else:
                k = classes[index[y, x]]
                row[x, 0], row[x, 1], row[x, 2] = palette[k, 0], palette[k, 1], palette[k, 2]
        if stripe > 1:
            for x in range(w):
                if primitive[y, x] >= 0 and (x + y) // stripe % 2 == 1:
                    k = classes[index[y, x]]
                    row[x, 0], row[x, 1], row[x, 2] = striped[k, 0], striped[k, 1], striped[k, 2]
        for x in range(w):
            for c in range(3):
                shown = min(max(row[x, c] * shade[x], zero), one) * border[x] * edge[x]
                pixels[y, x, c] = np.uint8(np.rint(shown * most))


@kernel
def paint_numbers(place, colors, unknown, color, shading, primitive, background, cells, line, outline, pixels):
    one, zero = np.float64(1), np.float64(0)
    h, w = primitive.shape
    shade, border, edge = np.ones(w, np.float32), np.ones(w), np.ones(w)
    for y in range(h):
        if shading > np.float32(0):
            _shade_row(color, y, shading, shade)
        if line < one:
            _line_row(cells, y, line, one, border)
        if outline < one:
            _line_row(primitive, y, outline, one, edge)
        for x in range(w):
            t = place[y, x]
            missed, known = primitive[y, x] < 0, t == t
            i = min(int(t), 255) if known else 0
            j = min(i + 1, 255)
            for c in range(3):
                if missed:
                    shown = np.float64(background[c])
                else:
                    flat = (colors[j, c] - colors[i, c]) * (t - i) + colors[i, c] if known else np.float64(unknown[c])
                    shown = min(max(flat * np.float64(shade[x]), zero), one) * border[x]
                pixels[y, x, c] = np.uint8(np.rint(shown * edge[x] * 255.0))


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

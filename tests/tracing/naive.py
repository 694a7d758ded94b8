"""Naive twins: the same answers as the kernels, written to be read in a minute, in float64."""

from __future__ import annotations

import numpy as np

from tracer.culling.modes import OcclusionMode

INIT, PARTIAL, FULLY, DYNAMIC = OcclusionMode


def closest_triangle(corners: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> tuple[float, int]:
    """(t, index) of the nearest of corners (n, 3, 3), inf and -1 for a miss: plane, then inside the edges."""
    best = (np.inf, -1)
    for index, (a, b, c) in enumerate(corners.astype(np.float64)):
        normal = np.cross(b - a, c - a)
        slope = normal @ direction
        if slope == 0.0:
            continue
        t = normal @ (a - origin) / slope
        point = origin + t * direction
        inside = all(normal @ np.cross(q - p, point - p) >= 0.0 for p, q in ((a, b), (b, c), (c, a)))
        if t > 0.0 and inside and t < best[0]:
            best = (t, index)
    return best


def edge_distance(corners: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> float:
    """Smallest |barycentric weight| with which the ray's line passes any triangle's edge: near 0, rounding decides."""
    a, b, c = np.moveaxis(corners.astype(np.float64), 1, 0)
    p = np.cross(direction, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / np.einsum("ij,ij->i", b - a, p)
        u = inverse * np.einsum("ij,ij->i", origin - a, p)
        v = inverse * (np.cross(origin - a, b - a) @ direction)
        weights = np.abs(np.stack([u, v, 1 - u - v]))
    return float(np.nanmin(weights, initial=np.inf))


def set_occlusion_mode(mode: int, hidden: bool, count: int, highest: int, zoom: float) -> tuple[int, int]:
    """(mode, highest count) of one unit at the end of a frame: the paper's section 2.6, rule by rule."""
    if mode == DYNAMIC:
        return DYNAMIC, highest
    if mode == PARTIAL:  # what was found in the last frame is forgotten
        mode = INIT
    if mode == FULLY:
        return (INIT, count) if count > zoom * highest else (FULLY, highest)
    if hidden:
        return PARTIAL, highest
    return (FULLY, count) if count > 0 else (INIT, highest)


def hidden_primitives(ids: np.ndarray, hits, symmetric: bool) -> tuple[set[int], int]:
    """(hidden, tests) by section 2.3; hits(x, y, primitive) tells whether a pixel's ray meets a primitive."""
    height, width = ids.shape
    hidden = {int(i) for i in np.concatenate([ids[0], ids[-1], ids[:, 0], ids[:, -1]]) if i >= 0}
    tests = 0
    for y in range(height):
        for x in range(width):
            for rx, ry in ((x - 1, y), (x, y - 1)):
                if rx < 0 or ry < 0 or ids[ry, rx] == ids[y, x]:
                    continue
                questions = [(x, y, int(ids[ry, rx]))] + ([(rx, ry, int(ids[y, x]))] if symmetric else [])
                for qx, qy, primitive in questions:
                    if primitive >= 0:
                        tests += 1
                        hidden |= {primitive} if hits(qx, qy, primitive) else set()
    return hidden, tests

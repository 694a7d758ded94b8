"""Naive twins: the same answers as the kernels, written to be read in a minute, in float64."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.scene.deformation import deformed
from tracer.scene.model import SPHERE, Scene

INIT, PARTIAL, FULLY, DYNAMIC = OcclusionMode


def closest_triangle(corners: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> tuple[float, int]:
    """(t, index) of the nearest of corners (n, 3, 3), inf and -1 for a miss: plane, then inside the edges."""
    t = meet_triangles(corners, origin, direction)
    index = int(t.argmin()) if len(t) else -1
    return (float(t[index]), index) if index >= 0 and t[index] < np.inf else (np.inf, -1)


def meet_triangles(corners: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """(n,) t of a ray on each of corners (n, 3, 3), inf for a miss."""
    corners = corners.astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (normal * (corners[:, 0] - origin)).sum(1) / (normal @ direction)
        points = origin + t[:, None] * direction
        edges = np.roll(corners, -1, axis=1) - corners
        sides = (normal[:, None] * np.cross(edges, points[:, None] - corners)).sum(2)
        return np.where((t > 0.0) & (sides >= 0.0).all(1) & np.isfinite(t), t, np.inf)


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


def meet_quadric(
    kind: int, to_world: np.ndarray, radii: np.ndarray, origin: np.ndarray, direction: np.ndarray
) -> tuple[float, float]:
    """(t, margin) of a ray on a unit sphere or a cone under a map (3, 4); by roots of a polynomial in t.

    t is inf for a miss; margin is near 0 where rounding decides: for a ray that grazes, or passes a cone's rim.
    """
    linear = to_world[:, :3].astype(np.float64)
    o, d = np.linalg.solve(linear, origin - to_world[:, 3]), np.linalg.solve(linear, direction)
    line = [np.polynomial.Polynomial((a, b)) for a, b in zip(o, d, strict=True)]
    if kind == SPHERE:
        surface = line[0] ** 2 + line[1] ** 2 + line[2] ** 2 - 1
    else:
        surface = line[0] ** 2 + line[1] ** 2 - (radii[0] + (float(radii[1]) - radii[0]) * line[2]) ** 2
    c, b, a = np.pad(surface.coef, (0, 3 - len(surface.coef)))
    margin = abs(b * b - 4 * a * c) / (b * b + abs(4 * a * c) + 1e-300)
    roots = [float(t.real) for t in surface.roots() if abs(t.imag) < 1e-12 and t.real > 0.0]
    if kind != SPHERE:
        heights = [float(line[2](t)) for t in roots]
        margin = min([margin, *(min(abs(z), abs(z - 1.0)) for z in heights)])
        roots = [t for t, z in zip(roots, heights, strict=True) if 0.0 <= z <= 1.0]
    return min(roots, default=np.inf), float(margin)


def meet_all(scene: Scene, time: float, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, float]:
    """(t, margin): where a ray meets each primitive of a scene at a time, (primitives,), inf for a miss, and how far
    it is from where rounding decides otherwise."""
    t, margin = np.full(scene.primitive_count, np.inf), np.inf
    for index, item in enumerate(scene.objects):
        if not scene.animation.visible(item.chain, time):
            continue
        place = scene.animation.matrix(item.chain, time)
        corners = deformed(item.deformation, time)[0] if item.deformation else item.triangles.corners
        corners = corners @ place[:3, :3].T + place[:3, 3]
        t[scene.triangle_offsets[index] : scene.triangle_offsets[index + 1]] = meet_triangles(
            corners, origin, direction
        )
        margin = min(margin, edge_distance(corners, origin, direction) if len(corners) else np.inf)
        for i, (kind, shape, radii) in enumerate(
            zip(item.quadrics.kind, item.quadrics.to_object, item.quadrics.radii, strict=True)
        ):
            whole = place[:3] @ np.concatenate([shape, [[0.0, 0.0, 0.0, 1.0]]])
            found, away = meet_quadric(int(kind), whole, radii, origin, direction)
            t[scene.quadric_offsets[index] + i] = found
            margin = min(margin, away)
    return t, margin


def set_occlusion_mode(
    mode: int, hidden: bool, count: int, shaded: int, highest: int, taught: int, zoom: float
) -> tuple[int, int, int]:
    """(mode, highest count, pixels that have taught) of one unit at the end of a frame of whose `count` pixels `shaded`
    are shaded: the paper's section 2.6, rule by rule, where these are all."""
    if mode == DYNAMIC:
        return DYNAMIC, highest, taught
    if mode == PARTIAL:  # what was found in the last frame is forgotten
        mode = INIT
    if mode == FULLY:
        return (INIT, count, taught) if count > zoom * highest else (FULLY, highest, taught)
    if hidden:
        return PARTIAL, highest, 0
    if count == 0 or taught + shaded < count:
        return INIT, highest, taught + shaded
    return FULLY, count, 0


def hidden_units(ids: np.ndarray, units: np.ndarray, hits, symmetric: bool) -> tuple[set[int], int]:
    """(hidden, tests) by section 2.3, of the units of primitives `ids` at each pixel; hits(x, y, primitive, unit)
    tells whether a pixel's ray meets a unit."""
    height, width = ids.shape
    hidden = {int(i) for i in np.concatenate([units[0], units[-1], units[:, 0], units[:, -1]]) if i >= 0}
    tests = 0
    for y in range(height):
        for x in range(width):
            for rx, ry in ((x - 1, y), (x, y - 1)):
                if rx < 0 or ry < 0 or ids[ry, rx] == ids[y, x]:
                    continue
                questions = [((x, y), (ry, rx))] + ([((rx, ry), (y, x))] if symmetric else [])
                for ray, seen in questions:
                    if ids[seen] >= 0:
                        tests += 1
                        hidden |= {int(units[seen])} if hits(*ray, int(ids[seen]), int(units[seen])) else set()
    return hidden, tests


class Modes:
    """What is known of each unit, in lists: occlusion mode, highest pixel count, and a shadow mode for each light."""

    CULLED_LIGHTS = 31

    def __init__(self, dynamic: Iterable[bool], lights: int) -> None:
        self.occlusion = [DYNAMIC if moves else INIT for moves in dynamic]
        self.highest = [0] * len(self.occlusion)
        self.taught = [0] * len(self.occlusion)
        self.shadow = [[int(ShadowMode.INIT)] * lights for _ in self.occlusion]

    def known(self, unit: int, light: int) -> int:
        """The shadow mode that culling may go by."""
        trusted = light < self.CULLED_LIGHTS and self.occlusion[unit] == FULLY
        return self.shadow[unit][light] if trusted else int(ShadowMode.INIT)

    def forget(self, light: int) -> None:
        """A light moved: what is known of it is void, and every unit is to be seen as a whole anew."""
        if light < self.CULLED_LIGHTS:
            for unit, mode in enumerate(self.occlusion):
                self.shadow[unit][light] = int(ShadowMode.INIT)
                self.occlusion[unit] = INIT if mode == FULLY else mode
        self.taught = [0] * len(self.occlusion)

    def end_frame(
        self,
        hidden: set[int],
        counts: list[int],
        shaded: list[int],
        learnt: Iterable[tuple[int, int, int]],
        zoom: float,
    ) -> None:
        """Sections 2.5 and 2.6: of the pixels counted `shaded` are, and `learnt` are (unit, light, mode) of the shadow
        rays."""
        for unit, light, mode in learnt:
            if light < self.CULLED_LIGHTS and self.occlusion[unit] != DYNAMIC:
                self.shadow[unit][light] |= int(mode)
        for unit, mode in enumerate(self.occlusion):
            self.occlusion[unit], self.highest[unit], self.taught[unit] = set_occlusion_mode(
                mode, unit in hidden, counts[unit], shaded[unit], self.highest[unit], self.taught[unit], zoom
            )

    def words(self) -> list[int]:
        """Packed: two bits of occlusion mode, then two of each light that is culled."""
        return [
            int(mode) + sum(known << (2 + 2 * light) for light, known in enumerate(shadow[: self.CULLED_LIGHTS]))
            for mode, shadow in zip(self.occlusion, self.shadow, strict=True)
        ]

"""Shadow testing and shadow-mode setting (§2.4 and §2.5 of the paper).

A shadow ray is *due* where the light is on the viewer's side of the surface.  What its primitive
is known to be, as the last frame left it, decides the ray's fate:

- FULLY_RENDERED and FULL_SHADOW: culled, the point is in shadow;
- FULLY_RENDERED and NON_SHADOW: dynamic objects alone are asked;
- anything else: static geometry is asked, and the answer is OR-ed into the shadow mode; where
  nothing static blocks the light, dynamic objects are asked.

Shadow rays start at the light.  They end a little above the surface (`lifted`), so that it does not
shadow itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import (
    DYNAMIC,
    FULL_SHADOW,
    FULLY_RENDERED,
    MAX_CULLED_LIGHTS,
    NON_SHADOW,
    add_shadow,
    occlusion_bits,
    shadow_bits,
)
from tracer.geometry.queries import any_dynamic_hits, any_static_hits
from tracer.geometry.rays import empty_rays
from tracer.kernels import inlined, subkernel

# Shadow counters; the first two are those that queries add to.
STEPS, TESTS, RAYS, DUE, CULLED, DYNAMIC_ONLY, WRONG = range(7)
SHADOW_COUNTERS = 7

NOT_DUE, BLOCKED, LIT = 0, 1, 2  # answers
LIGHT_MARGIN = np.float32(1e-5)  # of the way from the light: what lies nearer to it is the lamp itself


class Knowledge(NamedTuple):
    """What culling goes by: words (units,) as the last frame left them, what this worker gains for
    the next, of the same shape, and whether to cull and to verify what was culled."""

    words: NDArray[np.unsignedinteger]
    gained: NDArray[np.unsignedinteger]
    cull: bool
    verify: bool


@inlined
def lifted(position, geometric, offset, i):
    """Where a ray to or from the i-th surface point ends or starts: so far off the surface, on the viewer's side."""
    return (
        position[0, i] + offset * geometric[0, i],
        position[1, i] + offset * geometric[1, i],
        position[2, i] + offset * geometric[2, i],
    )


@subkernel
def _is_due(points, light, i):
    return (
        points.geometric[0, i] * (light[0] - points.position[0, i])
        + points.geometric[1, i] * (light[1] - points.position[1, i])
        + points.geometric[2, i] * (light[2] - points.position[2, i])
    ) > np.float32(0)


@subkernel
def _rays_from_light(points, light, index, count):
    """Shadow rays from a light to the points listed in index: t = 1 is the point."""
    rays = empty_rays(count)
    for k in range(count):
        target = lifted(points.position, points.geometric, points.offset[index[k]], index[k])
        for axis in range(3):
            rays.origin[axis, k] = light[axis]
            rays.direction[axis, k] = target[axis] - light[axis]
        rays.t_min[k], rays.t_max[k] = LIGHT_MARGIN, np.float32(1)
    return rays


@subkernel
def _choose_fates(points, light, number, knowledge, asked, known_lit, answer, counts):
    """Lists of points whose rays ask everything and of those that ask dynamic objects alone; their lengths."""
    asking, lit = 0, 0
    for i in range(len(points.unit)):
        answer[i] = NOT_DUE
        if not _is_due(points, light, i):
            continue
        counts[DUE] += 1
        word = knowledge.words[points.unit[i]]
        mode = np.uint64(0)
        if knowledge.cull and number < MAX_CULLED_LIGHTS and occlusion_bits(word) == FULLY_RENDERED:
            mode = shadow_bits(word, number)
        if mode == FULL_SHADOW:
            answer[i] = BLOCKED
            counts[CULLED] += 1
        elif mode == NON_SHADOW:
            known_lit[lit] = i
            lit += 1
            counts[DYNAMIC_ONLY] += 1
        else:
            asked[asking] = i
            asking += 1
    return asking, lit


@subkernel
def _ask_static(world, points, light, number, knowledge, asked, asking, open_, opened, answer, counts):
    """Ask static geometry, set shadow modes, and add the points where nothing blocks to open_; its new length."""
    blocked = np.empty(asking, np.bool_)
    any_static_hits(world, _rays_from_light(points, light, asked, asking), blocked, 0, asking, counts)
    for k in range(asking):
        i = asked[k]
        unit = points.unit[i]
        if number < MAX_CULLED_LIGHTS and occlusion_bits(knowledge.words[unit]) != DYNAMIC:
            add_shadow(knowledge.gained, unit, number, FULL_SHADOW if blocked[k] else NON_SHADOW)
        if blocked[k]:
            answer[i] = BLOCKED
        else:
            open_[opened] = i
            opened += 1
    return opened


@subkernel
def _ask_dynamic(world, points, light, open_, opened, answer, counts):
    blocked = np.zeros(opened, np.bool_)
    if len(world.roots) > 1:
        any_dynamic_hits(world, _rays_from_light(points, light, open_, opened), blocked, 0, opened, counts)
    for k in range(opened):
        answer[open_[k]] = BLOCKED if blocked[k] else LIT


@subkernel
def _verify(world, points, light, asked, asking, truth, counts):
    """Trace what was culled after all, its steps uncounted, correct the answers in truth, and count the wrong ones."""
    scratch = np.zeros(SHADOW_COUNTERS, np.int64)
    was_asked = np.zeros(len(truth), np.bool_)
    was_asked[asked[:asking]] = True
    index = np.empty(len(truth), np.int32)
    culled = 0
    for i in range(len(truth)):
        if truth[i] != NOT_DUE and not was_asked[i]:
            index[culled] = i
            culled += 1
    rays = _rays_from_light(points, light, index, culled)
    static, dynamic = np.zeros(culled, np.bool_), np.zeros(culled, np.bool_)
    any_static_hits(world, rays, static, 0, culled, scratch)
    any_dynamic_hits(world, rays, dynamic, 0, culled, scratch)
    for k in range(culled):
        traced = BLOCKED if static[k] or dynamic[k] else LIT
        counts[WRONG] += traced != truth[index[k]]
        truth[index[k]] = traced


@subkernel
def shadow_testing(world, points, light, number, knowledge, answer, truth, counts):
    """Answer, for light `number` at light (3,), whether it reaches each point: NOT_DUE, BLOCKED or LIT.

    Where knowledge asks to verify, truth gets the answers as tracing every ray gives them.
    """
    n = len(points.unit)
    asked, open_ = np.empty(n, np.int32), np.empty(n, np.int32)
    asking, opened = _choose_fates(points, light, number, knowledge, asked, open_, answer, counts)
    counts[RAYS] += asking + (opened if len(world.roots) > 1 else 0)
    opened = _ask_static(world, points, light, number, knowledge, asked, asking, open_, opened, answer, counts)
    _ask_dynamic(world, points, light, open_, opened, answer, counts)
    if knowledge.verify:
        truth[:] = answer
        if knowledge.cull:
            _verify(world, points, light, asked, asking, truth, counts)

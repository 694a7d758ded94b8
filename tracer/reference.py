"""The paper in one file: its algorithm with one ray at a time, to be read and to be compared with.

`Reference.render` is Figure 1, and the sections follow in the paper's order: §2.2 modes, §2.3 occlusion testing, §2.4
shadow testing, §2.5 shadow-mode setting, §2.6 occlusion-mode setting.  Whitted's shading, which asks for shadow rays,
comes last.  There are no tiles, no threads, no vectors and no methods; pictures, modes and counters are those of the
method `paper` with the kd-tree, over any sequence of whole frames (tests/tracing/test_reference.py).

Where this departs from the text of the paper, or chooses where the text is silent:

=====  ==============================================================================================================
§2.2   Modes and pixel counts belong to one resolution. `Renderer` keeps them for each that it renders at; a coarser one
       takes over what a finer one has just seen whole.
§2.2   A light that moves loses its shadow modes, and every FULLY_RENDERED primitive is examined anew: its pixels have
       said nothing of that light yet.
§2.2   Only the first 31 lights have shadow modes: a word of 64 bits has room for no more.
§2.3   A primitive at the screen's edge is PARTIALLY_OCCLUDED: it may go on beyond the edge.
§2.3   With `symmetric`, the reference pixel's ray is tested against the current pixel's primitive as well.
§2.3   In the first row and column there is no pixel above or to the left, and nothing is compared with it. A pixel
       that sees nothing is compared like any other.
§2.4   Shadow modes speak of static occluders only, so that NON_SHADOW still asks the dynamic objects.
§2.4   NON_SHADOW, too, is trusted on FULLY_RENDERED primitives only: what was hidden may be in shadow.
§2.4   A shadow ray is due where the light is on the viewer's side of the geometric surface.
§2.4   The points that reflected and refracted rays meet use and set shadow modes as those of primary rays do.
§2.5   What a frame learns is used from the next frame on: within a frame all rays see the same modes.
§2.6   Only a primitive with a primary pixel becomes FULLY_RENDERED: one seen in a mirror alone was not seen whole.
§2.6   PARTIALLY_OCCLUDED lasts one frame. FULLY_RENDERED outlives later occlusion: shadows do not depend on the view.
§2.6   Pictures are whole and of one sample here. `Renderer` also sets modes by the first of several samples, and by
       pictures of which a part is shaded: a primitive is FULLY_RENDERED once as many pixels as it covers have set them.
=====  ==============================================================================================================
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import (
    DYNAMIC,
    FULL_SHADOW,
    FULLY_RENDERED,
    INIT,
    MAX_CULLED_LIGHTS,
    NON_SHADOW,
    PARTIALLY_OCCLUDED,
)
from tracer.geometry.accelerators import KD_TREE
from tracer.geometry.camera import Pinhole, pinhole, primary_ray
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY, any_hits, closest_hits, hits_alone
from tracer.geometry.rays import INFINITY, MISS, Hits, Ray, Rays
from tracer.geometry.world import World
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings
from tracer.shading.one_ray import ambient_light, counts_enough, dot, minus, phong, sent_on, surface_at
from tracer.shading.shading_data import make_shading_data

LIGHT_MARGIN = np.float32(1e-5)  # of the way from the light: what lies nearer to it is the lamp itself
ZERO, ONE = np.float32(0), np.float32(1)
COUNTED = (
    "primary_rays", "secondary_rays", "shadow_rays", "due", "culled", "dynamic_only", "occlusion_tests",
    "primary_steps", "primary_tests", "secondary_steps", "secondary_tests", "shadow_steps", "shadow_tests",
)  # fmt: skip
PRIMARY, SECONDARY, SHADOW, DUE, CULLED, DYNAMIC_ONLY, OCCLUSION_TESTS = range(7)
PRIMARY_COST, SECONDARY_COST, SHADOW_COST = 7, 9, 11  # steps, and after them tests


class Modes(NamedTuple):
    """§2.2: what each of p primitives keeps from frame to frame.

    occlusion (p,) uint8 and, for each of l lights, shadow (p, l) uint8; pixel_count (p,) int32, the primary pixels of
    the last frame, and highest_count (p,) int32, those it had when it was examined."""

    occlusion: NDArray[np.uint8]
    shadow: NDArray[np.uint8]
    pixel_count: NDArray[np.int32]
    highest_count: NDArray[np.int32]


class Work(NamedTuple):
    """A frame under way: the world and its lights (l, 3) as they are placed, the modes of the last frame, and what this
    one finds: primitive (h, w), the nearest at each pixel; occluded (p,) bool, those of which something is hidden;
    found (p, l) uint8, shadow modes to be set; and counts, as named in COUNTED."""

    world: Any
    shading: Any
    camera: Any
    lights: NDArray[np.float32]
    modes: Modes
    primitive: NDArray[np.int32]
    occluded: NDArray[np.bool_]
    found: NDArray[np.uint8]
    counts: NDArray[np.int64]


@dataclass(frozen=True)
class ReferenceFrame:
    """A picture: color (h, w, 3) float32, primitive (h, w) int32, the modes that it leaves, and counts by name."""

    color: NDArray[np.float32]
    primitive: NDArray[np.int32]
    modes: Modes
    counts: dict[str, int]


class Reference:
    """Renders frames of a scene by the paper's algorithm, one after the other.

    Parameters
    ----------
    scene : Scene
        What to render, by the light of points.
    settings : Settings
        Of these count width, height, depth, symmetric and zoom_factor.

    Raises
    ------
    ValueError
        If a light is not a point, or falls off with distance.
    """

    def __init__(self, scene: Scene, settings: Settings) -> None:
        for light in scene.lights:
            if light.samples > 1 or light.falloff != "none":
                raise ValueError(f"the reference knows points whose light does not fall off; {light.name} is none")
        self.scene, self.settings = scene, settings
        self.world = World(scene, accelerator=KD_TREE)
        self.shading = make_shading_data(scene, self.world.attributes)
        self.lights = scene.light_positions(scene.time_range[0]).astype(np.float32)
        p, lights = scene.primitive_count, min(len(scene.lights), MAX_CULLED_LIGHTS)
        occlusion = np.where(self.world.object_of != 0, DYNAMIC, INIT).astype(np.uint8)  # object 0 is static
        self.modes = Modes(
            occlusion, np.full((p, lights), INIT, np.uint8), np.zeros(p, np.int32), np.zeros(p, np.int32)
        )

    def render(self, time: float = 0.0, camera: Camera | None = None) -> ReferenceFrame:
        """Render the next frame: Figure 1 of the paper."""
        s = self.settings
        work = self._begin(time, pinhole(camera or self.scene.camera_at(time), s.width, s.height))
        hits = trace_primary_rays(work)
        test_occlusion(work, s.symmetric)
        color = shade(work, hits, s.depth)  # with shadow testing
        set_shadow_modes(work)
        set_occlusion_modes(work, s.zoom_factor)
        kept = Modes._make(array.copy() for array in self.modes)
        return ReferenceFrame(color, work.primitive, kept, dict(zip(COUNTED, work.counts.tolist(), strict=True)))

    def _begin(self, time: float, camera: Pinhole) -> Work:
        """Place objects and lights; §2.2: what was known of a light that has moved is void."""
        self.world.place(time)
        before, self.lights = self.lights, self.scene.light_positions(time).astype(np.float32)
        for light in np.flatnonzero((self.lights != before).any(axis=1)):
            if light < MAX_CULLED_LIGHTS:
                self.modes.shadow[:, light] = INIT
                self.modes.occlusion[self.modes.occlusion == FULLY_RENDERED] = INIT
        primitive = np.empty((self.settings.height, self.settings.width), np.int32)
        occluded, found = np.zeros(len(self.modes.occlusion), np.bool_), np.zeros_like(self.modes.shadow)
        counts = np.zeros(len(COUNTED), np.int64)
        placed = self.world.placed
        return Work(placed, self.shading, camera, self.lights, self.modes, primitive, occluded, found, counts)


# --- primary rays -------------------------------------------------------------------------------------


@kernel
def trace_primary_rays(work):
    """Find the nearest primitive at each pixel, and return where the rays hit them."""
    height, width = work.primitive.shape
    n = height * width
    hits = Hits(np.empty(n, np.float32), work.primitive.reshape(n), np.empty(n, np.float32), np.empty(n, np.float32))
    for i in range(n):
        ray = primary_ray(work.camera, i % width, i // width)
        hits.t[i], hits.primitive[i], hits.u[i], hits.v[i] = _nearest(work.world, ray, work.counts[PRIMARY_COST:])
    work.counts[PRIMARY] += n
    return hits


# --- §2.3 occlusion testing ---------------------------------------------------------------------------


@kernel
def test_occlusion(work, symmetric):
    """§2.3: find the primitives that are occluded somewhere, by comparing each pixel with its left and upper one."""
    height, width = work.primitive.shape
    for y in range(height):
        for x in range(width):
            compare_pixel(work, x, y, symmetric)


@inlined
def compare_pixel(work, x, y, symmetric):
    """Test one pixel against what its reference pixels see, and note what the screen's edge cuts off."""
    height, width = work.primitive.shape
    current = work.primitive[y, x]
    if current != MISS and (x == 0 or y == 0 or x == width - 1 or y == height - 1):
        work.occluded[current] = True
    for rx, ry in ((x - 1, y), (x, y - 1)):  # the reference pixels
        if rx < 0 or ry < 0 or work.primitive[ry, rx] == current:
            continue
        _test_one(work, x, y, work.primitive[ry, rx])
        if symmetric:
            _test_one(work, rx, ry, current)


@inlined
def _test_one(work, x, y, primitive):
    """Test a pixel's ray against a primitive that its neighbour sees: if it meets that, something nearer hides it."""
    if primitive != MISS:
        work.counts[OCCLUSION_TESTS] += 1
        if hits_alone(work.world, primary_ray(work.camera, x, y), primitive):
            work.occluded[primitive] = True


# --- §2.4 shadow testing, §2.5 shadow-mode setting ------------------------------------------------------


@subkernel
def reached_by_light(work, primitive, point, light):
    """§2.4: say whether a light reaches a point of a primitive: by the primitive's modes, or else by a shadow ray."""
    counts, modes = work.counts, work.modes
    counts[DUE] += 1
    seen_whole = modes.occlusion[primitive] == FULLY_RENDERED and light < MAX_CULLED_LIGHTS
    shadow = modes.shadow[primitive, light] if seen_whole else np.uint8(INIT)
    if shadow == FULL_SHADOW:
        counts[CULLED] += 1
        return False
    place = work.lights[light, 0], work.lights[light, 1], work.lights[light, 2]
    ray = _ray(place, minus(point, place), LIGHT_MARGIN, ONE)
    if shadow == NON_SHADOW:
        counts[DYNAMIC_ONLY] += 1
        counts[SHADOW] += work.world.has_dynamic
        return not _blocked(work.world, ray, DYNAMIC_OBJECTS, counts[SHADOW_COST:])
    counts[SHADOW] += 1
    in_shadow = _blocked(work.world, ray, STATIC_GEOMETRY, counts[SHADOW_COST:])
    if light < MAX_CULLED_LIGHTS:
        work.found[primitive, light] |= FULL_SHADOW if in_shadow else NON_SHADOW
    return not in_shadow and not _blocked(work.world, ray, DYNAMIC_OBJECTS, counts[SHADOW_COST:])


@kernel
def set_shadow_modes(work):
    """§2.5: OR what shadow rays have found into the shadow modes: FULL_SHADOW and NON_SHADOW make PARTIAL_SHADOW."""
    for primitive in range(len(work.modes.occlusion)):
        set_shadow_modes_of(work, primitive)


@inlined
def set_shadow_modes_of(work, primitive):
    """Set the shadow modes of one primitive."""
    modes = work.modes
    if modes.occlusion[primitive] != DYNAMIC:
        for light in range(modes.shadow.shape[1]):
            modes.shadow[primitive, light] |= work.found[primitive, light]


# --- §2.6 occlusion-mode setting ------------------------------------------------------------------------


@kernel
def set_occlusion_modes(work, zoom_factor):
    """§2.6: set the occlusion mode of every primitive at the end of the frame."""
    modes = work.modes
    modes.pixel_count[:] = 0
    for primitive in work.primitive.flat:
        if primitive != MISS:
            modes.pixel_count[primitive] += 1
    for p in range(len(modes.occlusion)):
        set_occlusion_mode_of(work, p, zoom_factor)


@inlined
def set_occlusion_mode_of(work, p, zoom_factor):
    """Set the occlusion mode of one primitive."""
    modes = work.modes
    count, mode = modes.pixel_count[p], modes.occlusion[p]
    if mode == DYNAMIC:
        return
    if mode == FULLY_RENDERED:
        if count > zoom_factor * modes.highest_count[p]:  # seen much closer: examine it anew
            modes.occlusion[p], modes.highest_count[p] = INIT, count
    elif work.occluded[p]:
        modes.occlusion[p] = PARTIALLY_OCCLUDED
    elif count > 0:
        modes.occlusion[p], modes.highest_count[p] = FULLY_RENDERED, count
    else:
        modes.occlusion[p] = INIT


# --- shading (Whitted 1980), which asks for shadow rays -------------------------------------------------


class Path(NamedTuple):
    """A ray on its way to a pixel: with what weight (3,) its light counts there, how long the way to its origin is, and
    after how many bounces it starts."""

    origin: Any
    direction: Any
    weight: Any
    length: Any
    bounce: Any


@kernel
def shade(work, hits, depth):
    """Return the picture (h, w, 3): local light where a ray hits, then on along the refracted and the reflected ray."""
    height, width = work.primitive.shape
    color, shading = np.empty((height, width, 3), np.float32), work.shading
    paths = np.empty((depth + 2, 11), np.float32)  # still to be followed
    for i in range(height * width):
        light = np.zeros(3)  # in float64 the sum of a pixel's few rays does not depend on their order
        ray = primary_ray(work.camera, i % width, i // width)
        path = Path((ray.ox, ray.oy, ray.oz), (ray.dx, ray.dy, ray.dz), (ONE, ONE, ONE), ZERO, 0)
        hit = hits.t[i], hits.primitive[i], hits.u[i], hits.v[i]
        pending = 0
        while True:
            if hit[1] == MISS:
                _add(light, path.weight, (shading.background[0], shading.background[1], shading.background[2]))
            else:
                cone = work.camera.spread * (path.length + hit[0])
                s = surface_at(work.world, shading, path.origin, path.direction, hit, cone)
                _add(light, path.weight, local_light(work, path, hit[1], s))
                if path.bounce < depth:
                    bent, through, reflected, mirror = sent_on(s, path.direction, path.bounce)
                    pending = _push(paths, pending, path, hit[0], s.above, reflected, mirror)
                    pending = _push(paths, pending, path, hit[0], s.below, bent, through)
            if pending == 0:
                break
            pending -= 1
            path = _path_at(paths, pending)
            hit = _nearest(work.world, _ray(path.origin, path.direction, ZERO, INFINITY), work.counts[SECONDARY_COST:])
            work.counts[SECONDARY] += 1
        for c in range(3):
            color[i // width, i % width, c] = light[c]
    return color


@subkernel
def local_light(work, path, primitive, s):
    """Return the light of a surface: ambient light, and what each light adds that reaches it."""
    red, green, blue = ambient_light(work.shading, s)
    for light in range(len(work.lights)):
        place = work.lights[light, 0], work.lights[light, 1], work.lights[light, 2]
        if not dot(s.geometric, minus(place, s.point)) > ZERO:
            continue  # the surface faces away: no shadow ray is due
        if reached_by_light(work, primitive, s.above, light):
            r, g, b = phong(s, path.direction, place, work.shading.lamps.rows[light])
            red, green, blue = red + r, green + g, blue + b
    return red, green, blue


@inlined
def _add(light, weight, color):
    for c in range(3):
        light[c] += weight[c] * color[c]


@inlined
def _push(paths, pending, path, t, origin, direction, share):
    """Put a ray that a surface sends on after the others, unless it counts too little; how many there are then."""
    weight = path.weight[0] * share[0], path.weight[1] * share[1], path.weight[2] * share[2]
    if not counts_enough(weight):
        return pending
    size = np.sqrt(dot(direction, direction))
    for c in range(3):
        paths[pending, c], paths[pending, 3 + c], paths[pending, 6 + c] = origin[c], direction[c] / size, weight[c]
    paths[pending, 9], paths[pending, 10] = path.length + t, path.bounce + 1
    return pending + 1


@inlined
def _path_at(paths, i):
    p = paths[i]
    return Path((p[0], p[1], p[2]), (p[3], p[4], p[5]), (p[6], p[7], p[8]), p[9], np.int64(p[10]))


# --- one ray --------------------------------------------------------------------------------------------


@subkernel
def _nearest(world, ray, cost):
    """Find the nearest hit: (t, primitive, u, v)."""
    hits = Hits(np.empty(1, np.float32), np.empty(1, np.int32), np.empty(1, np.float32), np.empty(1, np.float32))
    closest_hits(world, _batch(ray), hits, 0, 1, cost)
    return hits.t[0], hits.primitive[0], hits.u[0], hits.v[0]


@subkernel
def _blocked(world, ray, which, cost):
    """Say whether static geometry or dynamic objects, `which`, are in the way."""
    blocked = np.empty(1, np.uint8)
    any_hits(world, _batch(ray), which, blocked, 0, 1, cost)
    return blocked[0] != 0


@inlined
def _ray(origin, direction, t_min, t_max):
    return Ray(origin[0], origin[1], origin[2], direction[0], direction[1], direction[2], t_min, t_max)


@inlined
def _batch(ray):
    """One ray as queries take it."""
    origin, direction = np.empty((3, 1), np.float32), np.empty((3, 1), np.float32)
    t_min, t_max = np.empty(1, np.float32), np.empty(1, np.float32)
    origin[0, 0], origin[1, 0], origin[2, 0] = ray.ox, ray.oy, ray.oz
    direction[0, 0], direction[1, 0], direction[2, 0] = ray.dx, ray.dy, ray.dz
    t_min[0], t_max[0] = ray.t_min, ray.t_max
    return Rays(origin, direction, t_min, t_max)

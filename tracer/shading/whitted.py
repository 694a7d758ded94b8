"""Whitted's recursive shading (1980), wave by wave over the rays of a few pixels.

A wave is a batch of rays that have hit something.  Each is shaded by all lights, with shadow testing
and shadow-mode setting, and sends out the reflected and refracted rays of the next wave, as long as
the weight with which they would count is at least MIN_WEIGHT (adaptive depth control, Hall and
Greenberg 1983).  A wave is as small as it can be: misses leave it at once.

A tile is given as five numbers: left, top, right, bottom, and its number in the picture.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.counters import BY_LIGHT, PASSED_OVER, PRIMARY, RAYS, SECONDARY, SHADOW, SHADOW_COUNTERS
from tracer.culling.shadow_testing import shadow_batch_in, shadow_testing
from tracer.culling.stages import (
    APPROACH,
    CALL,
    FIND,
    FINISH,
    SELECT,
    SHADE,
    Call,
    looked_at,
    run_stages,
    selects,
    vectors,
    write_call,
    write_sample,
)
from tracer.geometry.memory import keep_alive, without_refcount
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.shading.blocks import BLOCK, LOCAL, PLANE, SENT, block_of, planes_at
from tracer.shading.bounce import next_wave
from tracer.shading.buffers import pixels_in, write
from tracer.shading.phong import add_light
from tracer.shading.points import points_at
from tracer.shading.primary import primary_wave, read_hits, write_hits
from tracer.shading.recording import (
    count_rays,
    count_shadow_rays,
    count_wrong,
    record_fates,
    record_lights,
    record_normals,
)
from tracer.shading.spatial_sort import sorted_by_position
from tracer.shading.wave import accumulate, drop_misses, room, trace
from tracer.simd import f32_at, load_i64, local_memory

NUMBERS = PLANE // 4  # of a plane


@kernel
def trace_primary(world, camera, tile, lanes, buffers, counts, space):
    """Primary rays of a tile: depth, primitive and barycentric weights into the buffers."""
    world, buffers, space = without_refcount(world), without_refcount(buffers), without_refcount(space)
    place = pixels_in(space.pixels).place
    wave = primary_wave(camera, tile, buffers.primitive.shape[1], lanes, space.wave, place)
    trace(world, wave, counts[PRIMARY:])
    counts[PRIMARY + RAYS] += wave.size
    write_hits(wave, place, buffers)


@kernel
def shade_tile(world, shading, camera, tile, lanes, depth, stages, buffers, counts, space):
    """Shade a tile whose primary hits the buffers hold, with at most `depth` bounces: the pixels whose bits are set in
    `lanes` (`primary_wave`)."""
    world, shading, stages = without_refcount(world), without_refcount(shading), without_refcount(stages)
    buffers, space = without_refcount(buffers), without_refcount(space)
    pixels, spare = pixels_in(space.pixels), space.next

    # Start with what the primary rays have hit.
    wave = primary_wave(camera, tile, buffers.primitive.shape[1], lanes, space.wave, pixels.place)
    count, progressive = wave.size, len(buffers.planes.values) > 0
    read_hits(wave, pixels.place, buffers)
    pixels.light[:, :count] = 0
    pixels.reference[:, :count] = 0
    count_rays(wave, pixels, buffers)
    wave = drop_misses(wave, shading.background, pixels.light, pixels.reference)

    for bounce in range(depth + 1):
        # Add the light that reaches the points of this wave.
        points = points_at(world, shading, wave, space.points, camera.spread, stages.verify)
        _add_lights(world, shading, wave, points, stages, counts, pixels, tile[4], bounce, buffers, space)
        if bounce == 0:
            record_normals(wave, points, pixels, buffers)
            if progressive:
                for c in range(3):
                    for i in range(count):
                        pixels.local[c, i] = pixels.light[c, i]
        if bounce == depth:
            break
        # Send reflected and refracted rays on to the next one.
        wave, spare = next_wave(points, wave, bounce, spare)
        if wave.size == 0:
            break
        trace(world, wave, counts[SECONDARY:])
        counts[SECONDARY + RAYS] += wave.size
        count_rays(wave, pixels, buffers)
        wave = drop_misses(wave, shading.background, pixels.light, pixels.reference)
        if wave.size == 0:
            break
        if len(shading.lamps.samples) > 1:
            wave, spare = sorted_by_position(wave, spare)

    write(buffers.color, pixels.place, count, pixels.light)
    if progressive:
        _take_apart(pixels, count, buffers)
    if stages.verify:
        write(buffers.reference, pixels.place, count, pixels.reference)


@subkernel
def _add_lights(world, shading, wave, points, stages, counts, pixels, tile, bounce, buffers, space):
    """Local light of a wave, with shadow testing for every sample of every light."""
    counts, lamps = counts[SHADOW:], shading.lamps
    batch = shadow_batch_in(room(space.shadows, wave.size))
    scratch, call = room(space.scratch, wave.size), local_memory(CALL)
    write_call(
        call,
        Call(0, 0, 0, tile, bounce, points.memory, wave.memory, batch.memory, scratch, lamps.samples, pixels.place),
    )
    run_stages(stages, FIND, call, 0, wave.size, counts)
    if selects(stages.looks, wave.size):
        run_stages(stages, SELECT, call, 0, wave.size, counts)
    lights, counted = len(lamps.places), counts
    if stages.shades:
        run_stages(stages, SHADE, call, 0, wave.size, counted)
        lights, counts = min(lights, stages.everything), np.zeros(SHADOW_COUNTERS, np.int64)
    for light in range(lights):
        if light >= stages.everything and not _is_looked_at(stages.looks, light, wave.size):
            counts[PASSED_OVER] += wave.size * (lamps.first[light + 1] - lamps.first[light])
            continue
        write_sample(call, lamps.first[light], 0)
        run_stages(stages, APPROACH, call, light, wave.size, counts)
        if light >= stages.everything and not _is_looked_at(stages.looks, light, wave.size):
            counts[PASSED_OVER] += wave.size * (lamps.first[light + 1] - lamps.first[light])
            continue
        for sample in range(lamps.first[light], lamps.first[light + 1]):
            write_sample(call, sample, sample - lamps.first[light])
            shadow_testing(world, points, wave.size, lamps.samples[sample], light, stages, call, batch, counts)
            if not stages.shades:
                add_light(points, lamps, light, sample, batch.lit, wave, points.light)
            if stages.verify:
                add_light(points, lamps, light, sample, batch.truth, wave, points.reference)
                count_wrong(wave, batch, pixels, buffers.wrong)
            if bounce == 0 and len(buffers.asked) > 0:
                record_lights(wave, light, batch, pixels, buffers)
            if bounce == 0 and len(buffers.fates) > 0:
                record_fates(wave, light, batch, pixels, buffers)
            if len(buffers.saved) > 0:
                count_shadow_rays(wave, batch, pixels, buffers, not stages.shades)
    run_stages(stages, FINISH, call, 0, wave.size, counts)
    if stages.shades:
        for k in range(BY_LIGHT, SHADOW_COUNTERS):
            counted[k] += counts[k]  # what modes say
    accumulate(wave, points.light, pixels.light)
    if stages.verify:
        accumulate(wave, points.reference, pixels.reference)
    keep_alive((scratch, batch.memory, counts))


@inlined
def _is_looked_at(looks, light, count):
    """Whether any of `count` points must look at a light."""
    looked, some = looked_at(looks, light, count), False
    for v in range(0, vectors(count), 64):
        some |= looked == 0 or load_i64(looked + v // 8) != 0
    return some


@subkernel
def _take_apart(pixels, count, buffers):
    """What has arrived at the pixels' surfaces, and what mirrors and glass sent them besides."""
    width = buffers.primitive.shape[1]
    for i in range(count):
        x, y = pixels.place[i] % width, pixels.place[i] // width
        row, column = block_of(x, y)
        values = f32_at(planes_at(buffers.planes, row, column) + 4 * (y % BLOCK * BLOCK + x % BLOCK))
        for c in range(3):
            values[NUMBERS * (LOCAL + c)] = np.float32(pixels.local[c, i])
            values[NUMBERS * (SENT + c)] = np.float32(pixels.light[c, i] - pixels.local[c, i])


@kernel
def find_in_tile(world, shading, camera, tile, lanes, stages, buffers, space):
    """Let the stages find out what is known of a tile's primary hits, which the buffers hold, before it is shaded."""
    world, shading, stages = without_refcount(world), without_refcount(shading), without_refcount(stages)
    buffers, space = without_refcount(buffers), without_refcount(space)
    pixels, uncounted = pixels_in(space.pixels), np.zeros(SHADOW_COUNTERS, np.int64)
    wave = primary_wave(camera, tile, buffers.primitive.shape[1], lanes, space.wave, pixels.place)
    read_hits(wave, pixels.place, buffers)
    wave = drop_misses(wave, shading.background, pixels.light, pixels.reference)
    points = points_at(world, shading, wave, space.points, camera.spread, stages.verify)
    _find(shading, wave, points, stages, uncounted, pixels, tile[4], space)


@subkernel
def _find(shading, wave, points, stages, counts, pixels, tile, space):
    """Call the stages' kernels for a new wave."""
    shadows, scratch, call = room(space.shadows, wave.size), room(space.scratch, wave.size), local_memory(CALL)
    samples = shading.lamps.samples
    write_call(call, Call(0, 0, 0, tile, 0, points.memory, wave.memory, shadows, scratch, samples, pixels.place))
    run_stages(stages, FIND, call, 0, wave.size, counts)
    keep_alive((shadows, scratch))

"""Whitted's recursive shading (1980), wave by wave over the rays of a few pixels.

A wave is a batch of rays that have hit something.  Each is shaded by all lights, with shadow testing
and shadow-mode setting, and sends out the reflected and refracted rays of the next wave, as long as
the weight with which they would count is at least MIN_WEIGHT (adaptive depth control, Hall and
Greenberg 1983).  A wave is as small as it can be: misses leave it at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.answers import ANSWER_ROWS, answers_in
from tracer.culling.certified.lookup import find_cells
from tracer.culling.certified.requests import Requests, request_at_hits, request_at_points
from tracer.culling.shadow import RAYS, SHADOW_COUNTERS, shadow_testing
from tracer.geometry.memory import borrowed
from tracer.kernels import inlined, kernel, subkernel
from tracer.shading.blocks import BLOCK, LOCAL, PLANE, SENT, Planes, block_of, planes_at
from tracer.shading.bounce import next_wave
from tracer.shading.phong import add_light
from tracer.shading.places import sorted_by_place
from tracer.shading.points import POINT_ROWS, points_at
from tracer.shading.primary import block_at, blocks_of, keep_hits, primary_wave, recall_hits
from tracer.shading.wave import WAVE_ROWS, bring_home, room, trace, without_misses
from tracer.simd import any_lane, f32_at, i32x16, select

TILE = 64  # pixels on a side: more would make a few packets more coherent, but leave too little to share among threads

# A worker's counters: primary steps, tests, rays; then secondary; then those of shadow rays.
PRIMARY, SECONDARY, SHADOW = 0, 3, 6
COUNTERS = SHADOW + SHADOW_COUNTERS


class Buffers(NamedTuple):
    """One picture: color and normal (height * width, 3), depth, u and v (height, width) float32,
    primitive (height, width) int32; due and lit (height * width, lights) bool, or without rows;
    reference like color and wrong (height * width,) int32, or without rows where nothing is verified; cell
    (height * width,) int32, or without rows where there are no certified cells; saved, cost and
    due_rays (height * width,) int32, or without rows; and planes for a picture that is shaded in parts."""

    color: NDArray[np.float32]
    normal: NDArray[np.float32]
    depth: NDArray[np.float32]
    primitive: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    due: NDArray[np.bool_]
    lit: NDArray[np.bool_]
    reference: NDArray[np.float32]
    wrong: NDArray[np.int32]
    cell: NDArray[np.int32]
    saved: NDArray[np.int32]
    cost: NDArray[np.int32]
    due_rays: NDArray[np.int32]
    planes: Planes


class Workspace(NamedTuple):
    """Memory that one worker shades in, tile after tile (`workspace`)."""

    wave: NDArray[np.float32]
    next: NDArray[np.float32]
    points: NDArray[np.float32]
    answers: NDArray[np.float32]
    tile: NDArray[np.float64]


class Tile(NamedTuple):
    """A tile's pixels in the order of its primary rays: place (n,) int32 in the picture, and the light (3, n)
    float64 that has come home to them; reference like light, local that of the first wave alone.

    Sums are float64, in which those of a pixel's few float32 come out the same in any order: a pixel's rays change
    places with the company they keep, and that is other pixels where a picture is shaded in parts."""

    place: NDArray[np.int32]
    light: NDArray[np.float64]
    reference: NDArray[np.float64]
    local: NDArray[np.float64]


TILE_ROWS = 10
NUMBERS = PLANE // 4  # of a plane


def workspace() -> Workspace:
    """For waves of four times as many rays as a tile has pixels; larger ones find memory as they go."""

    def rows(count: int, n: int, kind: type = np.float32) -> NDArray:
        # A line of the cache more than whole pages, lest all rows meet in the same lines.
        return np.empty((count, -(-n // 1024) * 1024 + 16), kind)

    n = 4 * TILE * TILE
    return Workspace(
        rows(WAVE_ROWS, n),
        rows(WAVE_ROWS, n),
        rows(POINT_ROWS, n),
        rows(ANSWER_ROWS, n),
        rows(TILE_ROWS, n, np.float64),
    )


@inlined
def tile_in(memory):
    """A tile's pixels, in a workspace's memory for them."""
    return Tile(memory[0].view(np.int32), memory[1:4], memory[4:7], memory[7:10])


@kernel
def trace_primary(world, camera, tile, lanes, buffers, counts, space):
    """Primary rays of a tile (left, top, right, bottom): depth, primitive and barycentric weights into the buffers."""
    world, buffers, space = borrowed(world), borrowed(buffers), borrowed(space)
    place = tile_in(space.tile).place
    wave = primary_wave(camera, tile, buffers.primitive.shape[1], lanes, space.wave, place)
    trace(world, wave, counts[PRIMARY:])
    counts[PRIMARY + RAYS] += wave.size
    keep_hits(wave, place, buffers)


@kernel
def request_in_tiles(camera, tiles, numbers, certified, requests, lights, buffers):
    """Request the certificates that the primary hits of some tiles are about to need.

    Tiles have `numbers` (k,) among all (n, 4); their hits are in the buffers; requests has a row for each tile."""
    certified, requests, buffers = borrowed(certified), borrowed(requests), borrowed(buffers)
    width, hits = np.int32(buffers.primitive.shape[1]), (buffers.primitive, buffers.u, buffers.v)
    for number in numbers:
        tile = tiles[number]
        here = Requests(requests.key[number], requests.u[number], requests.v[number], requests.of[number])
        for block in range(certified.first_vector, blocks_of(tile), certified.stride):
            x, y, inside = block_at(tile, block)
            if any_lane(inside):
                place = select(inside, y * width + x, i32x16(0))
                request_at_hits(certified, here, lights, camera.origin, hits, place, inside)


@subkernel
def _light(world, look, wave, points, knowledge, answers, counts, tile, first, buffers):
    """Local light of a wave, with shadow testing for every light; `first` for the wave of primary rays."""
    if knowledge.certify:
        certified = knowledge.certified
        find_cells(certified, points, wave.size)
        if first:
            record_cells(wave, points, tile, buffers.cell)
    for number in range(len(look.lights)):
        shadow_testing(world, points, wave.size, look.lights[number], number, knowledge, answers, counts[SHADOW:])
        add_light(points, look, number, answers.lit, wave, points.light)
        if knowledge.verify:
            add_light(points, look, number, answers.truth, wave, points.reference)
            _note_wrong(wave, answers, tile, buffers.wrong)
        if first and len(buffers.due) > 0:
            _record(wave, number, answers, tile, buffers)
        if len(buffers.saved) > 0:
            _record_work(wave, answers, tile, buffers)
    if knowledge.certify and not first:  # the first wave's requests were made before
        request_at_points(certified, points, wave.size, answers.untried, answers.doubtful)
    bring_home(wave, points.light, tile.light)
    if knowledge.verify:
        bring_home(wave, points.reference, tile.reference)


@subkernel
def record_cells(wave, points, tile, cell):
    """Write the certified cells of primary hits into the picture."""
    for i in range(wave.size):
        cell[tile.place[wave.pixel[i]]] = points.unit[i]


@subkernel
def _record_work(wave, answers, tile, buffers):
    """Count the shadow rays that are due, those that asked static geometry, and those that need not."""
    for i in range(wave.size):
        place, due, live = tile.place[wave.pixel[i]], answers.due[i >> 4] >> (i & 15), answers.live[i >> 4] >> (i & 15)
        buffers.saved[place] += due & ~live & 1
        buffers.cost[place] += live & 1
        buffers.due_rays[place] += due & 1


@subkernel
def _note_wrong(wave, answers, tile, wrong):
    for i in range(wave.size):
        wrong[tile.place[wave.pixel[i]]] += ((answers.lit[i >> 4] ^ answers.truth[i >> 4]) >> (i & 15)) & 1


@subkernel
def _record(wave, number, answers, tile, buffers):
    """Which shadow rays of primary hits are due, and their answers."""
    for i in range(wave.size):
        place = tile.place[wave.pixel[i]]
        buffers.due[place, number] = (answers.due[i >> 4] >> (i & 15)) & 1
        buffers.lit[place, number] = (answers.lit[i >> 4] >> (i & 15)) & 1


@subkernel
def _count_rays(wave, tile, buffers):
    """Count the rays of a wave at their pixels, where that is asked for."""
    if len(buffers.cost) > 0:
        for i in range(wave.size):
            buffers.cost[tile.place[wave.pixel[i]]] += 1


@inlined
def write(pixels, place, count, rows):
    """The first `count` columns of rows (3, n) become pixels (any, 3)."""
    for i in range(count):
        for c in range(3):
            pixels[place[i], c] = rows[c, i]


@subkernel
def see_normals(wave, points, tile, buffers):
    """Write the shading normals of primary hits into the picture."""
    for i in range(wave.size):
        for axis in range(3):
            buffers.normal[tile.place[wave.pixel[i]], axis] = points.normal[axis, i]


@subkernel
def _take_apart(tile, count, buffers):
    """What has arrived at the pixels' surfaces, and what mirrors and glass sent them besides."""
    width = buffers.primitive.shape[1]
    for i in range(count):
        x, y = tile.place[i] % width, tile.place[i] // width
        row, column = block_of(x, y)
        values = f32_at(planes_at(buffers.planes, row, column) + 4 * (y % BLOCK * BLOCK + x % BLOCK))
        for c in range(3):
            values[NUMBERS * (LOCAL + c)] = np.float32(tile.local[c, i])
            values[NUMBERS * (SENT + c)] = np.float32(tile.light[c, i] - tile.local[c, i])


@kernel
def shade_tile(world, look, camera, tile, lanes, depth, knowledge, buffers, counts, space):
    """Shade a tile whose primary hits the buffers hold, with at most `depth` bounces: the pixels whose bits are set in
    `lanes` (`primary_wave`)."""
    world, look, knowledge = borrowed(world), borrowed(look), borrowed(knowledge)
    buffers, space = borrowed(buffers), borrowed(space)
    pixels, spare = tile_in(space.tile), space.next
    wave = primary_wave(camera, tile, buffers.primitive.shape[1], lanes, space.wave, pixels.place)
    count, in_parts = wave.size, len(buffers.planes.values) > 0
    recall_hits(wave, pixels.place, buffers)
    pixels.light[:, :count] = 0
    pixels.reference[:, :count] = 0
    _count_rays(wave, pixels, buffers)
    wave = without_misses(wave, look.background, pixels.light, pixels.reference)
    for bounce in range(depth + 1):
        points = points_at(world, look, wave, space.points, camera.spread, knowledge)
        asks = bounce > 0 or knowledge.certified.costly_rays
        answers = answers_in(room(space.answers, wave.size), wave.size, asks, knowledge.certify)
        _light(world, look, wave, points, knowledge, answers, counts, pixels, bounce == 0, buffers)
        if bounce == 0:
            see_normals(wave, points, pixels, buffers)
            if in_parts:
                pixels.local[:, :count] = pixels.light[:, :count]
        if bounce == depth:
            break
        wave, spare = next_wave(points, wave, spare)
        if wave.size == 0:
            break
        trace(world, wave, counts[SECONDARY:])
        counts[SECONDARY + RAYS] += wave.size
        _count_rays(wave, pixels, buffers)
        wave = without_misses(wave, look.background, pixels.light, pixels.reference)
        if wave.size == 0:
            break
        if len(look.lights) > 1:
            wave, spare = sorted_by_place(wave, spare)
    write(buffers.color, pixels.place, count, pixels.light)
    if in_parts:
        _take_apart(pixels, count, buffers)
    if knowledge.verify:
        write(buffers.reference, pixels.place, count, pixels.reference)

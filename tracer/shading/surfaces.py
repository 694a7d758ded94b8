"""What primary hits look like before any shadow ray is traced, at every pixel.

A picture that is shaded in parts knows each pixel's surface from the start: its normal, its material,
and the local light it would have if nothing stood in the way (ambient, and Phong of every light it
faces, textures included).  Shading then finds out what part of that light arrives, and what mirrors and
glass send besides; `tracer.shading.filling` needs no more than that from a pixel's neighbours.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.lookup import find_cells
from tracer.culling.shadow import faces
from tracer.geometry.facets import MATERIAL, OBJECT
from tracer.geometry.memory import borrowed, pointer
from tracer.geometry.rays import MISS
from tracer.kernels import kernel, subkernel
from tracer.shading.filling import NORMAL, POSITION, TURNS, UNSHADOWED, where
from tracer.shading.phong import add_light
from tracer.shading.points import points_at
from tracer.shading.primary import ALL_LANES, primary_wave, recall_hits
from tracer.shading.wave import bring_home, room, without_misses
from tracer.shading.whitted import record_cells, see_normals, tile_in

MATERIALS = 1 << 16  # in the number of a surface; an object's number is above


@subkernel
def _put_planes(wave, points, look, tile, count, buffers):
    """What all pixels of a tile know of their surfaces; there is none where rays miss, but background."""
    planes, width, facets = buffers.planes, buffers.primitive.shape[1], look.facets.view(np.int32)
    values, plane = pointer(planes.values), TURNS * planes.columns
    surfaces = pointer(planes.values.view(np.int32))
    for i in range(count):
        at = where(planes, tile.place[i] % width, tile.place[i] // width)
        surfaces[at] = MISS
        for c in range(3):
            values[at + plane * (UNSHADOWED + c)] = np.float32(tile.light[c, i])
    for i in range(wave.size):
        place = tile.place[wave.pixel[i]]
        at = where(planes, place % width, place // width)
        facet = facets[wave.hits.primitive[i]]
        surfaces[at] = facet[MATERIAL] + MATERIALS * facet[OBJECT]
        for c in range(3):
            values[at + plane * (NORMAL + c)] = points.normal[c, i]
            values[at + plane * (POSITION + c)] = wave.hits.t[i] * wave.rays.direction[c, i]


@kernel
def see_surfaces(world, look, camera, tile, knowledge, buffers, space):
    """Normals, surfaces, unshadowed light and certified cells of a tile whose primary hits the buffers hold."""
    world, look, knowledge = borrowed(world), borrowed(look), borrowed(knowledge)
    buffers, space = borrowed(buffers), borrowed(space)
    pixels = tile_in(space.tile)
    wave = primary_wave(camera, tile, buffers.primitive.shape[1], ALL_LANES, space.wave, pixels.place)
    count = wave.size
    recall_hits(wave, pixels.place, buffers)
    pixels.light[:, :count] = 0
    wave = without_misses(wave, look.background, pixels.light, pixels.reference)
    points = points_at(world, look, wave, space.points, camera.spread, knowledge)
    facing = room(space.answers, wave.size)[0].view(np.int32)
    for number in range(len(look.lights)):
        for v in range((wave.size + 15) // 16):
            facing[v] = faces(points, look.lights[number], v)
        add_light(points, look, number, facing, wave, points.light)
    bring_home(wave, points.light, pixels.light)
    see_normals(wave, points, pixels, buffers)
    _put_planes(wave, points, look, pixels, count, buffers)
    if knowledge.certify:
        find_cells(knowledge.certified, points, wave.size)
        record_cells(wave, points, pixels, buffers.cell)

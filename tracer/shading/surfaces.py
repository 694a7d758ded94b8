"""What primary hits shading like before any shadow ray is traced, at every pixel.

A picture that is refined progressively knows each pixel's surface from the start: its normal, its material,
and the local light it would have if nothing stood in the way (ambient, and Phong of every light it
faces, textures included).  Shading then finds out what part of that light arrives, and what mirrors and
glass send besides; `tracer.shading.filling` needs no more than that from a pixel's neighbours.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.camera import primary_direction
from tracer.geometry.memory import data_pointer, without_refcount
from tracer.geometry.primitives import COLUMNS, MATERIAL, OBJECT
from tracer.geometry.rays import MISS
from tracer.runtime.kernels import inlined, kernel
from tracer.shading.blocks import NORMAL, PLANE, POSITION, SURFACE, UNSHADOWED, block_of, planes_at
from tracer.shading.phong import fall_off, highlight, toward
from tracer.shading.points import ambient_at, colors_at, diffuse_at, material_at, normals_at
from tracer.shading.primary import BLOCK, block_at, blocks_of
from tracer.shading.shading_data import EXPONENT, SHINE, SPECULAR
from tracer.simd import (
    address_of,
    any_lane,
    as_i32,
    bits_of,
    f32_at,
    f32x16,
    gather_f32x16,
    gather_i32x16,
    i32x16,
    lane_of,
    load_columns,
    local_memory,
    select,
    store,
    store_three,
    to_f32,
)

MATERIALS = 1 << 16  # in the number of a surface; an object's number is above
ZERO, ONE = np.float32(0), np.float32(1)


@inlined
def _unshadowed(shading, m, color, position, geometric, normal, direction, hit):
    """The light that points of these materials and colours send to the viewer where nothing is in the way."""
    r, g, b = ambient_at(shading, m, color)
    red, green, blue = diffuse_at(m, color)
    lamps = shading.lamps
    for number in range(len(lamps.places)):
        # All samples of a lamp shine from its centre here.
        place, row = lamps.places[number], lamps.rows[number]
        samples = np.float32(lamps.first[number + 1] - lamps.first[number])
        x, y, z = place[0] - position[0], place[1] - position[1], place[2] - position[2]
        faces = hit & (geometric[0] * x + geometric[1] * y + geometric[2] * z > ZERO)
        cosine, reached, mirrored, near = toward(place, position, normal, direction, faces)
        if not any_lane(reached):
            continue
        specular = highlight(reached, m[SHINE], m[EXPONENT], mirrored)
        cosine, specular = fall_off(row, near, cosine, specular)
        r = r + select(reached, samples * row[0] * (red * cosine + m[SPECULAR] * specular), ZERO)
        g = g + select(reached, samples * row[1] * (green * cosine + m[SPECULAR + 1] * specular), ZERO)
        b = b + select(reached, samples * row[2] * (blue * cosine + m[SPECULAR + 2] * specular), ZERO)
    return r, g, b


@kernel
def see_surfaces(world, shading, camera, tile, buffers):
    """Normals, surfaces and unshadowed light of a tile (left, top, right, bottom) whose primary hits the buffers
    hold, a block at a time."""
    world, shading, buffers = without_refcount(world), without_refcount(shading), without_refcount(buffers)
    planes, normals, width = buffers.planes, data_pointer(buffers.normal), np.int32(buffers.primitive.shape[1])
    rows = local_memory(192)
    channel, background = f32_at(rows), shading.background
    for number in range(blocks_of(tile)):
        x, y, inside = block_at(tile, number)
        if not any_lane(inside):
            continue
        row, column = block_of(lane_of(x, 0), lane_of(y, 0))
        block = planes_at(planes, row, column)

        # The hits, as they were found.
        place = select(inside, y * width + x, i32x16(0))
        primitive = gather_i32x16(address_of(buffers.primitive), place)
        hit = inside & (primitive > np.int32(MISS))
        if not any_lane(hit):
            store(block + PLANE * SURFACE, i32x16(MISS))
            store_three(
                block + PLANE * UNSHADOWED, PLANE, (f32x16(background[0]), f32x16(background[1]), f32x16(background[2]))
            )
            continue
        t = gather_f32x16(address_of(buffers.depth), place)
        u, v = gather_f32x16(address_of(buffers.u), place), gather_f32x16(address_of(buffers.v), place)
        primitive = select(hit, primitive, i32x16(0))
        direction = primary_direction(camera, to_f32(x), to_f32(y))
        seen = t * direction[0], t * direction[1], t * direction[2]
        position = camera.origin[0] + seen[0], camera.origin[1] + seen[1], camera.origin[2] + seen[2]

        # What is there, and its light.
        store(rows, primitive)
        attributes = load_columns(address_of(shading.attributes), rows, COLUMNS)
        w, there = ONE - u - v, bits_of(hit)
        geometric, normal, _, against = normals_at(world, attributes, there, primitive, position, direction, w, u, v)
        color = colors_at(shading, attributes, there, primitive, w, u, v, against, camera.spread * t)
        m = material_at(shading, select(hit, as_i32(attributes[MATERIAL]), i32x16(0)))
        r, g, b = _unshadowed(shading, m, color, position, geometric, normal, direction, hit)

        surface = as_i32(attributes[MATERIAL]) + np.int32(MATERIALS) * as_i32(attributes[OBJECT])
        store(block + PLANE * SURFACE, select(hit, surface, i32x16(MISS)))
        store_three(block + PLANE * NORMAL, PLANE, normal)
        store_three(block + PLANE * POSITION, PLANE, seen)
        light = select(hit, r, background[0]), select(hit, g, background[1]), select(hit, b, background[2])
        store_three(block + PLANE * UNSHADOWED, PLANE, light)
        store_three(rows, 64, normal)
        for lane in range(BLOCK * BLOCK):
            if (there >> lane) & 1:
                pixel = 3 * np.int64(lane_of(place, lane))
                for axis in range(3):
                    normals[pixel + axis] = channel[16 * axis + lane]

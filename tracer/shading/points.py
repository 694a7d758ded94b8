"""Surface points: what shading and shadow testing need to know of a wave's hits, sixteen at a time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.intersect import quadric_normal
from tracer.geometry.memory import data_pointer
from tracer.geometry.primitives import CORNER_NORMALS, FACE_NORMAL, MATERIAL, OBJECT, TEXTURE
from tracer.geometry.rays import RAY_OFFSET
from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.shading_data import AMBIENT, DIFFUSE, EXPONENT, IOR, MATERIAL_COLUMNS, SHINE, SPECULAR, TRANSMISSION
from tracer.shading.textures import MAPPING_COLUMNS, SPANNED, texture_colors
from tracer.shading.wave import HIT_PRIMITIVE, HIT_T, HIT_U, HIT_V, PATH_LENGTH, room, row_of
from tracer.simd import (
    address_of,
    any_lane,
    as_i32,
    bits_of,
    f32_at,
    f32x16,
    gather_f32x16,
    i32x16,
    lane_of,
    lanes_below,
    load_columns,
    load_f32x16,
    load_i32x16,
    load_three,
    local_memory,
    lowest_bit,
    mask16,
    maximum,
    select,
    square_root,
    store,
    store_three,
)
from tracer.simd.records import IntRow, Memory, Row, Row3, row_count, row_number, rows_of

ATTRIBUTE_COLUMNS = 16
ZERO, ONE = np.float32(0), np.float32(1)


class Points(NamedTuple):
    """n surface points, in rows of `memory` (POINT_ROWS, n) float32.

    position, geometric normal (towards the viewer), shading normal (in the geometric one's half space), the material's
    diffuse colour under the texture's, its specular colour, and the light that goes from there to the viewer, which is
    the ambient light at first, each (3, n); reference like light; exponent, shine, transmission and ior of the
    material; offset (n,), how far above the surface rays start; primitive (n,) int32; entering (n / 16,) int32, the
    bits of those whose ray came from outside; lifted (3, n), the points that far above the surface."""

    memory: Memory
    position: Row3
    geometric: Row3
    normal: Row3
    diffuse: Row3
    specular: Row3
    light: Row3
    reference: Row3
    exponent: Row
    shine: Row
    transmission: Row
    ior: Row
    offset: Row
    primitive: IntRow
    entering: IntRow
    lifted: Row3


points_in = rows_of(Points)
POINT_ROWS = row_count(Points)
(
    POSITION_ROW, GEOMETRIC_ROW, NORMAL_ROW, DIFFUSE_ROW, SPECULAR_ROW, LIGHT_ROW, REFERENCE_ROW, EXPONENT_ROW,
    SHINE_ROW, TRANSMISSION_ROW, IOR_ROW, OFFSET_ROW, PRIMITIVE_ROW, LIFTED_ROW,
) = (
    row_number(Points, field)
    for field in (
        "position", "geometric", "normal", "diffuse", "specular", "light", "reference", "exponent",
        "shine", "transmission", "ior", "offset", "primitive", "lifted",
    )
)  # fmt: skip


@inlined
def _length(a):
    return square_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@inlined
def _unit(a):
    length = _length(a)
    scale = select(length > ZERO, ONE / length, ZERO)
    return a[0] * scale, a[1] * scale, a[2] * scale


@inlined
def _chosen(mask, a, b):
    return select(mask, a[0], b[0]), select(mask, a[1], b[1]), select(mask, a[2], b[2])


@inlined
def _opposite(a):
    return -a[0], -a[1], -a[2]


@inlined
def _to_world(maps, objects, a):
    """Normals carried out of their objects' spaces: by the transposed maps (objects, 12) into them, to any length."""
    at, first = address_of(maps), objects * np.int32(12)
    x, y, z = a
    return (
        gather_f32x16(at, first) * x + gather_f32x16(at + 16, first) * y + gather_f32x16(at + 32, first) * z,
        gather_f32x16(at + 4, first) * x + gather_f32x16(at + 20, first) * y + gather_f32x16(at + 36, first) * z,
        gather_f32x16(at + 8, first) * x + gather_f32x16(at + 24, first) * y + gather_f32x16(at + 40, first) * z,
    )


@inlined
def _mixed(attributes, first, w, u, v):
    """Three columns from `first` on, and those three and six after them, weighted by corner."""
    return (
        w * attributes[first] + u * attributes[first + 3] + v * attributes[first + 6],
        w * attributes[first + 1] + u * attributes[first + 4] + v * attributes[first + 7],
        w * attributes[first + 2] + u * attributes[first + 5] + v * attributes[first + 8],
    )


@subkernel
def _texture(shading, textured, primitive, w, u, v, across, cosine, cone):
    """Colours that textures have in the lanes of a mask, 1 in the others.

    across spans twice the triangle; cosine is that of the rays against it, and cone their width.
    """
    rows = local_memory(64)
    store(rows, select(textured, primitive, i32x16(0)))
    m = load_columns(address_of(shading.mappings), rows, MAPPING_COLUMNS)
    cosine = maximum(cosine, np.float32(1e-3))
    area = _length(across) * cosine * square_root(cosine)
    covered = select(area > ZERO, cone * cone * m[SPANNED] / area, ZERO)
    s, t = w * m[0] + u * m[2] + v * m[4], w * m[1] + u * m[3] + v * m[5]
    red, green, blue = texture_colors(shading, m, s, t, covered)
    return select(textured, red, ONE), select(textured, green, ONE), select(textured, blue, ONE)


@subkernel
def _quadric_normal(world, rows, lane, primitive):
    """Normal of a quadric, in world space and of any length, at the point whose place is in this lane of three rows
    of vectors; it takes the place of what the next three rows, and those after them, have there."""
    m, at, value = data_pointer(world.to_object), 12 * world.object_of[primitive], f32_at(rows)
    px, py, pz = value[lane], value[16 + lane], value[32 + lane]
    x = m[at] * px + m[at + 1] * py + m[at + 2] * pz + m[at + 3]
    y = m[at + 4] * px + m[at + 5] * py + m[at + 6] * pz + m[at + 7]
    z = m[at + 8] * px + m[at + 9] * py + m[at + 10] * pz + m[at + 11]
    nx, ny, nz = quadric_normal(world.quadrics, primitive - len(world.triangles), x, y, z)
    for axis in range(3):
        normal = m[at + axis] * nx + m[at + 4 + axis] * ny + m[at + 8 + axis] * nz
        value[16 * (3 + axis) + lane] = value[16 * (6 + axis) + lane] = normal


@inlined
def _quadrics(world, position, there, primitive, geometric, normal):
    """Normals of a vector of points, those on quadrics made good."""
    rest = bits_of(primitive > np.int32(len(world.triangles) - 1)) & there
    if rest == 0:
        return geometric, normal
    rows = local_memory(576)
    store_three(rows, 64, position)
    store_three(rows + 192, 64, geometric)
    store_three(rows + 384, 64, normal)
    while rest != 0:
        lane = lowest_bit(rest)
        rest &= rest - 1
        _quadric_normal(world, rows, lane, np.int64(lane_of(primitive, lane)))
    geometric = load_f32x16(rows + 192), load_f32x16(rows + 256), load_f32x16(rows + 320)
    return geometric, (load_f32x16(rows + 384), load_f32x16(rows + 448), load_f32x16(rows + 512))


@inlined
def normals_at(world, attributes, there, primitive, position, direction, w, u, v):
    """Unit normals of a vector of points, the geometric one towards the viewer and the shading one in its half space,
    whether rays of this direction come from outside, and their cosines against the geometric normal that points
    there; attributes are the columns of the primitives' rows, and there the bits of the lanes that mean anything."""
    geometric = attributes[FACE_NORMAL], attributes[FACE_NORMAL + 1], attributes[FACE_NORMAL + 2]
    normal = _mixed(attributes, CORNER_NORMALS, w, u, v)
    objects = as_i32(attributes[OBJECT])
    moves = objects > np.int32(0)
    if any_lane(moves):
        geometric = _chosen(moves, _to_world(world.to_object, objects, geometric), geometric)
        normal = _chosen(moves, _to_world(world.to_object, objects, normal), normal)
    shrunk = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2] < np.float32(1e-24)
    normal = _chosen(shrunk, geometric, normal)
    geometric, normal = _quadrics(world, position, there, primitive, geometric, normal)

    geometric, normal = _unit(geometric), _unit(normal)
    d = direction
    against = geometric[0] * d[0] + geometric[1] * d[1] + geometric[2] * d[2]
    entering = against <= ZERO
    geometric = _chosen(entering, geometric, _opposite(geometric))
    behind = geometric[0] * normal[0] + geometric[1] * normal[1] + geometric[2] * normal[2] < ZERO
    return geometric, _chosen(behind, _opposite(normal), normal), entering, against


@inlined
def colors_at(shading, attributes, there, primitive, w, u, v, against, cone):
    """Colours that a vector of points has by textures, 1 where there are none."""
    textured = (as_i32(attributes[TEXTURE]) > np.int32(-1)) & mask16(there)
    if not any_lane(textured):
        return f32x16(ONE), f32x16(ONE), f32x16(ONE)
    across = attributes[FACE_NORMAL], attributes[FACE_NORMAL + 1], attributes[FACE_NORMAL + 2]
    return _texture(shading, textured, primitive, w, u, v, across, maximum(against, -against), cone)


@subkernel
def one_color(shading, primitive, u, v, against, cone):
    """The colour that one point has by textures, 1 where there are none."""
    rows = local_memory(64)
    store(rows, i32x16(np.int32(primitive)))
    attributes = load_columns(address_of(shading.attributes), rows, ATTRIBUTE_COLUMNS)
    weights = f32x16(ONE - u - v), f32x16(u), f32x16(v)
    color = colors_at(shading, attributes, 1, i32x16(np.int32(primitive)), *weights, f32x16(against), f32x16(cone))
    return lane_of(color[0], 0), lane_of(color[1], 0), lane_of(color[2], 0)


@inlined
def material_at(shading, material):
    """The columns of the rows of materials."""
    rows = local_memory(64)
    store(rows, material)
    return load_columns(address_of(shading.materials), rows, MATERIAL_COLUMNS)


@inlined
def ambient_at(shading, m, color):
    """Ambient light of materials, given by their columns, seen through textures' colours."""
    return (
        shading.ambient[0] * m[AMBIENT] * color[0],
        shading.ambient[1] * m[AMBIENT + 1] * color[1],
        shading.ambient[2] * m[AMBIENT + 2] * color[2],
    )


@inlined
def diffuse_at(m, color):
    """Diffuse colours of materials, seen through textures' colours."""
    return m[DIFFUSE] * color[0], m[DIFFUSE + 1] * color[1], m[DIFFUSE + 2] * color[2]


@inlined
def _put_surface(points, shading, v, material, color, verify):
    """What the materials are made of, seen through the textures' colours."""
    m = material_at(shading, material)
    stride = 4 * points.memory.shape[1]
    at = address_of(points.memory) + 64 * v
    ambient = ambient_at(shading, m, color)
    store_three(at + stride * LIGHT_ROW, stride, ambient)
    if verify:
        store_three(at + stride * REFERENCE_ROW, stride, ambient)
    store_three(at + stride * DIFFUSE_ROW, stride, diffuse_at(m, color))
    store_three(at + stride * SPECULAR_ROW, stride, (m[SPECULAR], m[SPECULAR + 1], m[SPECULAR + 2]))
    store(at + stride * EXPONENT_ROW, m[EXPONENT])
    store(at + stride * SHINE_ROW, m[SHINE])
    store(at + stride * TRANSMISSION_ROW, m[TRANSMISSION])
    store(at + stride * IOR_ROW, m[IOR])


@inlined
def _hit(wave, row, v):
    return load_f32x16(row_of(wave.memory, row) + 64 * v)


@subkernel
def points_at(world, shading, wave, memory, spread, verify):
    """The surface points of a wave each of whose rays hits something, in this memory or, where they are many, in more.

    spread is the width of a pixel at distance 1.  Where answers are verified, there is a reference for the light.
    """
    points = points_in(room(memory, wave.size))
    stride = 4 * points.memory.shape[1]
    for k in range((wave.size + 15) // 16):
        there = lanes_below(wave.size, k)
        o, d = load_three(wave.origin, k), load_three(wave.direction, k)
        t, u, v = _hit(wave, HIT_T, k), _hit(wave, HIT_U, k), _hit(wave, HIT_V, k)
        numbers = row_of(wave.memory, HIT_PRIMITIVE) + 64 * k
        primitive = load_i32x16(numbers)
        x, y, z = o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]
        at = address_of(points.memory) + 64 * k
        store_three(at + stride * POSITION_ROW, stride, (x, y, z))
        largest = maximum(t, maximum(maximum(x, -x), maximum(maximum(y, -y), maximum(z, -z))))
        offset = np.float32(RAY_OFFSET) * largest
        store(at + stride * OFFSET_ROW, offset)
        store(at + stride * PRIMITIVE_ROW, primitive)

        attributes = load_columns(address_of(shading.attributes), numbers, ATTRIBUTE_COLUMNS)
        w = ONE - u - v
        geometric, normal, entering, against = normals_at(world, attributes, there, primitive, (x, y, z), d, w, u, v)
        points.entering[k] = bits_of(entering)
        store_three(at + stride * GEOMETRIC_ROW, stride, geometric)
        gx, gy, gz = geometric
        store_three(at + stride * LIFTED_ROW, stride, (x + offset * gx, y + offset * gy, z + offset * gz))
        store_three(at + stride * NORMAL_ROW, stride, normal)

        cone = spread * (_hit(wave, PATH_LENGTH, k) + t)
        color = colors_at(shading, attributes, there, primitive, w, u, v, against, cone)
        _put_surface(points, shading, k, as_i32(attributes[MATERIAL]), color, verify)
    return points

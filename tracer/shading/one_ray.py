"""Whitted's shading (1980) of one ray at a time: the surface that it hits, a light's part, and the rays sent on.

`tracer.shading.points`, `phong` and `bounce` do the same for sixteen rays; both give the same bits.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.intersect import quadric_normal
from tracer.geometry.primitives import CORNER_NORMALS, FACE_NORMAL, MATERIAL
from tracer.geometry.rays import RAY_OFFSET
from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.bounce import MIN_WEIGHT, SPLITS, reflected
from tracer.shading.phong import one_highlight
from tracer.shading.points import one_color
from tracer.shading.shading_data import AMBIENT, DIFFUSE, EXPONENT, IOR, SHINE, SPECULAR, TRANSMISSION

ZERO, ONE, TWO = np.float32(0), np.float32(1), np.float32(2)


class Surface(NamedTuple):
    """Where a ray hits: the point, the geometric normal on the viewer's side, the shading normal, whether the ray comes
    from outside, the points a little above and below the surface from which rays start, the material's row (16,), and
    the texture's colour, all float32."""

    point: Any
    geometric: Any
    normal: Any
    entering: Any
    above: Any
    below: Any
    material: Any
    texture: Any


@subkernel
def surface_at(world, shading, origin, direction, hit, cone):
    """Describe the surface where a ray hits; cone is the width of a pixel there."""
    t, primitive, u, v = hit
    point = _along(origin, t, direction)
    row = shading.attributes[primitive]
    if primitive < len(world.triangles):
        geometric, normal = _triangle_normals(world, row, primitive, u, v)
    else:
        geometric = normal = _quadric_normal(world, primitive, point)
    geometric, normal = _unit(geometric), _unit(normal)
    against = dot(geometric, direction)
    entering = against <= ZERO
    geometric = geometric if entering else _opposite(geometric)
    normal = _opposite(normal) if dot(geometric, normal) < ZERO else normal
    offset = np.float32(RAY_OFFSET) * max(t, max(abs(point[0]), max(abs(point[1]), abs(point[2]))))
    above, below = _along(point, offset, geometric), _along(point, -offset, geometric)
    material = shading.materials[row.view(np.int32)[MATERIAL]]
    texture = one_color(shading, primitive, u, v, against, cone)
    return Surface(point, geometric, normal, entering, above, below, material, texture)


@inlined
def ambient_light(shading, s):
    """Return the ambient light that a surface sends to the viewer."""
    a, m, texture = shading.ambient, s.material, s.texture
    return a[0] * m[AMBIENT] * texture[0], a[1] * m[AMBIENT + 1] * texture[1], a[2] * m[AMBIENT + 2] * texture[2]


@subkernel
def phong(s, direction, place, color):
    """Return what a light of this colour at `place` adds where it reaches a surface: the diffuse and the specular term
    (Phong 1975)."""
    towards = minus(place, s.point)
    scale = ONE / np.sqrt(dot(towards, towards))
    cosine = dot(s.normal, towards) * scale
    if not cosine > ZERO:
        return ZERO, ZERO, ZERO
    m, texture, shine = s.material, s.texture, ZERO
    mirrored = dot(towards, direction) * scale - TWO * cosine * dot(s.normal, direction)
    if m[SHINE] > ZERO and mirrored > ZERO:
        shine = one_highlight(mirrored, m[EXPONENT])
    return (
        color[0] * (m[DIFFUSE] * texture[0] * cosine + m[SPECULAR] * shine),
        color[1] * (m[DIFFUSE + 1] * texture[1] * cosine + m[SPECULAR + 1] * shine),
        color[2] * (m[DIFFUSE + 2] * texture[2] * cosine + m[SPECULAR + 2] * shine),
    )


@subkernel
def sent_on(s, d, bounce):
    """Return the directions of the refracted and the reflected ray, and with what weights (3,) they count; what is not
    sent counts 0."""
    m, n = s.material, s.normal
    mirror, through = (m[SPECULAR], m[SPECULAR + 1], m[SPECULAR + 2]), m[TRANSMISSION]
    mirrored, bent = reflected(d, n), d
    if through > ZERO:
        eta = ONE / m[IOR] if s.entering else m[IOR]
        cosine = -dot(d, n)
        k = ONE - eta * eta * (ONE - cosine * cosine)
        if k >= ZERO:
            bend = eta * cosine - np.sqrt(k)
            bent = eta * d[0] + bend * n[0], eta * d[1] + bend * n[1], eta * d[2] + bend * n[2]
        else:  # total internal reflection takes the refracted ray's share
            mirror, through = (mirror[0] + through, mirror[1] + through, mirror[2] + through), ZERO
        if bounce >= SPLITS:  # only the stronger of the two goes on
            if through >= max(mirror[0], max(mirror[1], mirror[2])) and through > ZERO:
                mirror = ZERO, ZERO, ZERO
            else:
                through = ZERO
    return bent, (through, through, through), mirrored, mirror


@inlined
def counts_enough(weight):
    """Say whether a ray of this weight (3,) is traced: adaptive depth control (Hall and Greenberg 1983)."""
    return max(weight[0], max(weight[1], weight[2])) >= MIN_WEIGHT


@inlined
def _triangle_normals(world, row, primitive, u, v):
    """The geometric and the shading normal of a triangle, of any length, in the world."""
    w, k = ONE - u - v, CORNER_NORMALS
    geometric = row[FACE_NORMAL], row[FACE_NORMAL + 1], row[FACE_NORMAL + 2]
    normal = (
        w * row[k] + u * row[k + 3] + v * row[k + 6],
        w * row[k + 1] + u * row[k + 4] + v * row[k + 7],
        w * row[k + 2] + u * row[k + 5] + v * row[k + 8],
    )
    if world.object_of[primitive] != 0:
        m = world.to_object[world.object_of[primitive]]
        geometric, normal = _normal_to_world(m, geometric), _normal_to_world(m, normal)
    return geometric, (geometric if dot(normal, normal) < np.float32(1e-24) else normal)


@inlined
def _quadric_normal(world, primitive, point):
    """The normal of a sphere or a cone, of any length, in the world."""
    m, (x, y, z) = world.to_object[world.object_of[primitive]], point
    inside = (
        m[0] * x + m[1] * y + m[2] * z + m[3],
        m[4] * x + m[5] * y + m[6] * z + m[7],
        m[8] * x + m[9] * y + m[10] * z + m[11],
    )
    normal = quadric_normal(world.quadrics, primitive - len(world.triangles), inside[0], inside[1], inside[2])
    return _normal_to_world(m, normal)


@inlined
def _normal_to_world(m, a):
    """A normal carried out of its object's space, by the transposed map (12,) into that."""
    return (
        m[0] * a[0] + m[4] * a[1] + m[8] * a[2],
        m[1] * a[0] + m[5] * a[1] + m[9] * a[2],
        m[2] * a[0] + m[6] * a[1] + m[10] * a[2],
    )


@inlined
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def _along(origin, t, direction):
    return origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2]


@inlined
def _opposite(a):
    return -a[0], -a[1], -a[2]


@inlined
def _unit(a):
    length = np.sqrt(dot(a, a))
    scale = ONE / length if length > ZERO else ZERO
    return a[0] * scale, a[1] * scale, a[2] * scale

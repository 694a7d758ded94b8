"""Every ray against every leaf of 8-wide trees, one after the other: what their queries must answer, bit for bit.

The arithmetic of a ray and a triangle is the tracer's, which decides what happens at edges; which leaves
a ray comes to see, in which order and in whose company, is left to the queries.  That the arithmetic is
right, test_world.py shows against float64.
"""

from __future__ import annotations

import numpy as np

import tracer
from tests.tracing.brute import Meetings, ray_in
from tests.tracing.trees8 import walk
from tracer.geometry.boxes import inverse
from tracer.geometry.bvh8.layout import BLOCK, BOX, COUNT, PRIMITIVES, Tree
from tracer.geometry.bvh8.packet import FAR
from tracer.geometry.bvh8.placed import triangle_of
from tracer.geometry.intersect import hit_quadric
from tracer.geometry.memory import data_pointer
from tracer.geometry.rays import INFINITY, Ray, Rays
from tracer.geometry.triangle_test import crossing, terms_of
from tracer.runtime.kernels import inlined, kernel
from tracer.simd import address_of, as_f32, as_i32, load_i32


@inlined
def _inside(ray, box):
    """Where a ray enters and leaves a box (6,)."""
    ix, iy, iz = inverse(ray.dx), inverse(ray.dy), inverse(ray.dz)
    x0, x1 = (box[0] - ray.ox) * ix, (box[3] - ray.ox) * ix
    y0, y1 = (box[1] - ray.oy) * iy, (box[4] - ray.oy) * iy
    z0, z1 = (box[2] - ray.oz) * iz, (box[5] - ray.oz) * iz
    return max(min(x0, x1), min(y0, y1), min(z0, z1)), min(max(x0, x1), max(y0, y1), max(z0, z1))


@kernel
def _meet_blocks(blocks, which, rays, t, u, v):
    """Into t, u and v (rays, primitives) float32: where rays meet the triangles of these blocks (k,)."""
    for i in range(len(rays.t_min)):
        ray = ray_in(rays, i)
        for b in which:
            block = address_of(blocks) + BLOCK * b
            enter, leave = _inside(ray, blocks[b, BOX:])
            for k in range(load_i32(block + 4 * COUNT)):
                terms = terms_of(ray.ox, ray.oy, ray.oz, triangle_of(block, k))
                crosses, sign, u_area, v_area, area = crossing(ray.dx, ray.dy, ray.dz, terms)
                scale = np.float32(1) / area
                where = as_f32(as_i32(terms.height) ^ sign) * scale
                if crosses and where >= enter and where <= leave and where > ray.t_min:
                    number = load_i32(block + 4 * (PRIMITIVES + k))
                    t[i, number], u[i, number], v[i, number] = where, u_area * scale, v_area * scale


@kernel
def _meet_quadrics(quadrics, which, boxes, rays, first, t):
    """Into t (rays, primitives) float32, from column `first` on: where rays meet these quadrics, in boxes (k, 6)."""
    for i in range(len(rays.t_min)):
        ray = ray_in(rays, i)
        endless = Ray(ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ray.dz, ray.t_min, FAR)
        for k in range(len(which)):
            enter, leave = _inside(ray, boxes[k])
            where = hit_quadric(endless, data_pointer(quadrics), which[k])
            if where >= enter and where <= leave:
                t[i, first + which[k]] = where


def _meet_tree(tree: Tree, world: tracer.World, rays: Rays) -> Meetings:
    shape = len(rays.t_min), len(world.object_of)
    t, u, v = np.full(shape, INFINITY), np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    leaves = walk(tree).leaves
    _meet_blocks(tree.blocks, np.array([leaf.block for leaf in leaves if leaf.block], np.int64), rays, t, u, v)
    owned = [leaf for leaf in leaves if not leaf.block]
    boxes = np.array([leaf.box for leaf in owned], np.float32).reshape(-1, 6)
    which = np.array([leaf.quadric for leaf in owned], np.int64)
    _meet_quadrics(world.structure.world_quadrics, which, boxes, rays, len(world.placed.triangles), t)
    t[t >= rays.t_max[:, None]] = INFINITY
    return Meetings(t, u, v)


def meet_all8(world: tracer.World, rays: Rays) -> tuple[Meetings, Meetings]:
    """Where rays meet each static, and each dynamic, primitive of a world of 8-wide trees."""
    return _meet_tree(world.structure.static, world, rays), _meet_tree(world.structure.dynamic, world, rays)

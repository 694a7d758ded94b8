"""The names of the acceleration structures; `tracer.geometry.world` holds what they stand for."""

from __future__ import annotations

KD_TREE, LAZY, BVH8 = "kdtree", "kdtree-lazy", "bvh8"
ACCELERATORS = (KD_TREE, LAZY, BVH8)
ABOUT = {  # in words, for menus and help
    KD_TREE: "the paper's kd-tree, whose steps and tests are counted ray by ray",
    LAZY: "one kd-tree over everything, built where rays arrive",
    BVH8: "the fast 8-wide trees, with packets of rays",
}

"""The names of the acceleration structures; `tracer.geometry.world` holds what they stand for."""

from __future__ import annotations

KD_TREE, BVH8 = "kdtree", "bvh8"  # the paper's, whose steps are counted; 8-wide nodes and packets of rays
ACCELERATORS = (KD_TREE, BVH8)
MOST_TOGETHER = 128  # rays that go through a tree side by side

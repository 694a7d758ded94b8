"""The names of the acceleration structures; `tracer.geometry.world` holds what they stand for."""

from __future__ import annotations

# The paper's, whose steps are counted; one tree over everything, built where rays arrive; and 8-wide nodes with packets
# of rays.
KD_TREE, LAZY, BVH8 = "kdtree", "kdtree-lazy", "bvh8"
ACCELERATORS = (KD_TREE, LAZY, BVH8)
MAX_PACKET_SIZE = 128  # rays that go through a tree side by side

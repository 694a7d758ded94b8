"""Voxel occlusion testing: cubes of space that are known to be lit, or in shadow, as a whole (docs/methods.md).

A. Woo and J. Amanatides, "Voxel Occlusion Testing: A Shadow Determination Accelerator for Ray Tracing", Graphics
Interface 1990.

- `grid`: how fine voxels are, and `contents`: which primitives lie in each;
- `classify`: which voxels are in full shadow of a light, and which see it past all that is static, from coarse to fine;
- `walk`: rays that begin in any other voxel go from one to the next towards the light;
- `store`: all of this for the lights of a scene; `tell`: what people are told.

Only the method `voxels` uses it, and what shows voxels.
"""

"""Regions of space, and the lights that shine on nothing in them: what makes thousands of lights bearable.

- `light_tree`: the lights as a tree of boxes;
- `blockers`: the triangles that are large enough to hide lights from a whole region;
- `hidden`: the proof that one of them does;
- `certify`: which lights a region is left with;
- `store`: the regions of a scene, as far as rays have asked about them;
- `lookup`: which lights the points of a wave have to look at.
"""

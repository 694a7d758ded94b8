"""Local illumination environments: cells of an octree that know which lights shine into them, and what blocks each.

S. Fernandez, K. Bala and D. Greenberg, "Local Illumination Environments for Direct Lighting Acceleration", Eurographics
Workshop on Rendering 2002.

- `octree`: the cells, and the way down to that of a point;
- `settle`: what is proved of a cell and a light, from what is known of the cell around it;
- `sample`: what rays to some of a cell's points say of it, as published;
- `ask`: what the points of a wave look at, and what they ask;
- `store`: all of this for the lights of a scene, as far as rays have ended there.

Only the methods `lie` and `lie-exact` use it.
"""

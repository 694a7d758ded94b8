"""Certified cells: shadow answers that are proved for whole pieces of a surface, before they are asked for.

A triangle is cut, virtually and lazily, into a quadtree of cells (`cells`).  Of a cell and a light, against
all static geometry, one of these is found out (`certify`) by rules that leave room for all that rays
may get wrong (`error_bounds`), in a tree that knows how far each triangle can be mistaken (`occluders`):

- FULL: some triangles together hide the light from all of the cell;
- LIT: no triangle comes between;
- CANDIDATES: only these few triangles may;
- else the cell is split, where rays request it, and its children start from what is left.

Rays look up the cells they end in (`lookup`), which costs no step through a tree, and request certificates where they
find none (`requests`).  What is requested most is certified before the next frame is shaded (`store`).
"""

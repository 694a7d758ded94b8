"""Lightcuts: the light of thousands of lights as that of a few hundred clusters (B. Walter et al., "Lightcuts: A
Scalable Approach to Illumination", SIGGRAPH 2005).

- `tree`: the lights as a binary tree of clusters;
- `bounds`: what a cluster can send to points, at most, and what one of its lights does;
- `cut`: clusters that are good enough for a block of points, and what they send;
- `drawn`: the same by lights that are drawn anew for each pixel;
- `hidden`: the tree without the lights that are proved to be hidden from a block.
"""

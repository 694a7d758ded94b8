"""The fast structure: eight boxes or triangles at once, packets of rays, a tree for each dynamic object. `structure` is
what the world knows of it; ARCHITECTURE.md says how it works.
"""

"""The topology of wide trees: a binary tree by the surface area heuristic (`binary`), collapsed to eight children a
node (`collapse`).  `bvh8` writes it into memory.
"""

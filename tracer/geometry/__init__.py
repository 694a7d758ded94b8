"""Where rays meet the world. `world` has the primitives of a moment and one of three structures (`structure`):
`kdtree`, `lazy_tree` or `bvh8`; rays come in batches (`rays`), and are traced by kernels that are called by address
(`queries`). It knows nothing of light; what is above it asks the world alone.
"""

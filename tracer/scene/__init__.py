"""What is in the world, as numpy arrays (`model`), and how files are read (`load`: AFF, meshes). It knows nothing of
rays, and all other packages may use it.
"""

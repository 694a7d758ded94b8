"""What a scene may ask for at most, so that no file ends the program or takes all memory."""

from __future__ import annotations

LARGEST = 1e9
"""No coordinate is larger.  Tracing is done in float32, and the square of a triangle's normal, a product of four
lengths, must not leave its range of 3.4e38."""

SMALLEST = 1e-18
"""No sphere, cone or moving object is scaled by less: rays are brought to its own space, and must be finite there."""

MOST_BYTES = 1 << 29
"""All files of a scene together, without its images; and each image."""

MOST_PIXELS = 1 << 27
"""Of an image, to be decoded at all, which takes half a gigabyte and more; and of all images of a scene as they are
kept.  (Pillow's own limit, at which it warns of a decompression bomb and at twice which it fails, is near.)"""

MOST_NESTED = 256
"""Transforms around each other, and as many files that include each other: each costs time again for all inside it."""

MOST_INCLUDES = 200_000
"""Files that are included, counted each time: ten files of ten includes each would make ten thousand million."""

MOST_PRIMITIVES = 20_000_000
"""Triangles, spheres and cones of a scene, some 400 bytes each while it is read."""

MOST_FRAMES = 1_000_000
"""Frames of an animation."""

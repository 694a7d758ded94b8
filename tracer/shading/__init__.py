"""From primary hits to colours: `primary` finds what each pixel sees, `whitted` shades a tile in waves of rays
(`wave`), with `phong` and `bounce`; `one_ray` is the same for one ray at a time. Which pixels have their turn first is
in `tiles`, `filling` and `teaching`. The renderer calls it; it calls methods by `tracer.culling.stages` only.
"""

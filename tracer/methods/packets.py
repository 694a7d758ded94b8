"""The additions `packets16` and `packets1`: what packets of rays are worth (Wald 2004).

Rays of all kinds go through the fast structure in packets of sixteen instead of 128, or one by one.  The pictures are
the same; the paper's structure traces rays one by one in any case.
"""

from __future__ import annotations

from tracer.methods.interface import ShadowMethod


class Packets16(ShadowMethod):
    """Rays go through a tree sixteen at a time."""

    max_packet_size = 16


class Packets1(ShadowMethod):
    """Rays go through a tree one by one."""

    max_packet_size = 1

"""Two tiny scenes that reproduce figures of the paper: the occlusion test, and a shadow found by zooming in.

Both are written so that the mode of every primitive is known beforehand; the files say it in comments.
"""

from __future__ import annotations

from generate.aff import numbers

NEAR, FAR = 2.5, 3.0


def card(corners: tuple[tuple[float, float], ...], distance: float) -> str:
    """A triangle parallel to the screen, its corners in (column, row) of a 9 x 9 picture 90 degrees high."""
    pixel = 2 * distance / 9
    points = [((column - 4) * pixel, (4 - row) * pixel, -distance) for column, row in corners]
    return "\n".join(["p 3", *("  " + numbers(point, 5) for point in points)])


FIGURE_3 = f"""\
# Figure 3 of the paper: the occlusion test on a grid of 3 x 3 pixels, and more of it on 9 x 9.
#
# Each pixel's primary ray is compared with its left and its upper neighbour's.  Where they hit different
# primitives, the ray is tested against the neighbour's primitive; a hit means that this primitive goes on
# behind what the ray saw, so it becomes PARTIALLY_OCCLUDED.  A primitive at the screen's edge is
# PARTIALLY_OCCLUDED anyway.  What is still INIT at the end of the frame becomes FULLY_RENDERED.
#
# Primitives, in order, and their occlusion modes after one frame:
#                                     3 x 3 pixels          9 x 9 pixels
#   0 backdrop                        PARTIALLY_OCCLUDED    PARTIALLY_OCCLUDED
#   1 card in the centre              FULLY_RENDERED        FULLY_RENDERED
#   2 card hidden on its right        not seen (INIT)       PARTIALLY_OCCLUDED
#   3 the card in front of it         not seen (INIT)       FULLY_RENDERED
#   4 card hidden on its left         not seen (INIT)       FULLY_RENDERED as published (it is not),
#                                                           PARTIALLY_OCCLUDED with `symmetric`
#   5 the card in front of it         not seen (INIT)       FULLY_RENDERED
#
# On 3 x 3 pixels, the centre pixel's ray hits card 1 and is tested against the backdrop of its left and
# upper neighbours: two hits.  The rays right of it and below it are tested against card 1: two misses.
# On 9 x 9 pixels, card 3 is met on the way right from card 2, so the test finds that card 2 goes on
# behind it.  Card 5 is met first and card 4 after it; the published test looks only one way and misses
# that card 4 began behind card 5.

b 0.10 0.12 0.16
am 1 1 1
v
from 0 0 0
at 0 0 -1
up 0 1 0
angle 90
hither 0.01
resolution 9 9

l 1.5 2.5 1  0.7 0.68 0.6
l -3 1 0  0.3 0.32 0.4

# 0 backdrop
fm 0.16 0.16 0.17  0.55 0.55 0.58  0 0 0  1 0 1
p 3
  -30 -10 -6
  30 -10 -6
  0 40 -6

# 1 centre
fm 0.25 0.20 0.05  0.85 0.65 0.15  0 0 0  1 0 1
{card(((3.5, 4.5), (4.5, 4.5), (4, 3.4)), FAR)}

# 2 hidden on its right
fm 0.06 0.14 0.25  0.20 0.45 0.80  0 0 0  1 0 1
{card(((4.6, 3.4), (7.4, 3.4), (6, 0.6)), FAR)}

# 3 in front of it
fm 0.25 0.09 0.06  0.80 0.30 0.20  0 0 0  1 0 1
{card(((6.6, 3.6), (7.6, 3.6), (7.1, 2.5)), NEAR)}

# 4 hidden on its left
fm 0.06 0.20 0.12  0.20 0.65 0.40  0 0 0  1 0 1
{card(((0.6, 6.4), (3.4, 6.4), (2, 3.6)), FAR)}

# 5 in front of it
fm 0.20 0.10 0.22  0.65 0.32 0.70  0 0 0  1 0 1
{card(((0.5, 6.45), (1.5, 6.45), (1, 5.4)), NEAR)}
"""

FRAMES, DURATION = 60, 6.0
START, END = 20.0, 4.0


def figure3() -> str:
    return FIGURE_3


def figure4() -> str:
    step = DURATION / (FRAMES - 1)
    keys = [
        f"  {numbers((k * step, 0, 0, START * (END / START) ** (k / (FRAMES - 1))), 5)} 0 0 0"
        for k in range(-1, FRAMES + 1)
    ]
    looks = [f"  {numbers((t, 0, 1, 0, 0))} 0 0 0" for t in (-1, 0, DURATION, DURATION + 1)]
    return "\n".join([FIGURE_4, f"a 0 {numbers([DURATION])} {FRAMES}", "", "k camera {", f"transl {len(keys)}", *keys,
                      f"rot {len(looks)}", *looks, "}", ""])  # fmt: skip


FIGURE_4 = """\
# Figure 4 of the paper: a shadow that only shows after zooming in.
#
# One triangle, primitive 0, in the light of one lamp; a marble outside the picture's middle (primitive 1)
# throws a shadow on it, 4 cm in radius, right where the camera looks.  The camera comes nearer in 60 frames,
# from 20 m to 4 m, so that the triangle's pixels grow by 25.  It never reaches the screen's edge and nothing
# is ever in front of it, so it is FULLY_RENDERED from the first frame on.
#
# At 128 x 128 pixels, method "paper", zoom factor 4, frames rendered one after the other:
#   frames 0 to 11   the shadow lies between the four rays around the middle of the screen; no ray meets it.
#                    The shadow mode of primitive 0 becomes NON_SHADOW in frame 0.
#   frames 12 to 25  rays would meet it by now (they do without culling), but NON_SHADOW asks no static
#                    occluder: the shadow is missing, which is the artefact of the figure.
#   frame 26         the triangle has more than 4 times its highest pixel count: FULLY_RENDERED becomes INIT.
#   frame 27 on      it is examined anew: the shadow appears, the mode is PARTIAL_SHADOW.

b 0.16 0.19 0.24
am 1 1 1
v
from 0 0 20
at 0 0 0
up 0 1 0
angle 30
hither 0.01
resolution 128 128

l 2 3 8  0.8 0.78 0.7

# 0 the receiver
fm 0.2 0.18 0.14  0.8 0.72 0.55  0 0 0  1 0 1
p 3
  -1 -0.9 0
  1 -0.9 0
  0 0.95 0

# 1 the occluder, half way to the lamp
fm 0.2 0.05 0.04  0.7 0.2 0.15  0 0 0  1 0 1
s 1 1.5 4 0.02
"""

"""Rays that were traced, pixel by pixel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.views.saved import Work, recorded


class Cost(Work):
    label = "Rays traced"
    key = "Shift+H"
    help = (
        "Rays traced through the whole scene for each pixel, of all kinds, at all bounces: how many, or which share of "
        "those that are traced without culling."
    )
    shows = "cost"
    name = "rays traced"
    title_of_shares = "Share of the rays without culling that is traced"
    in_all = (
        "of the first sample of each pixel, through the whole scene: shadow rays that were tested against dynamic "
        "objects or a few candidates only do not count; the share is of the rays traced without culling"
    )

    def whole(self, frame: Frame) -> NDArray[np.int32]:
        return recorded(frame.saved) + recorded(frame.cost)


VIEW = Cost()

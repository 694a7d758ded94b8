"""Stochastic lightcuts: clusters of lights by representatives that are drawn anew for each pixel and sample
(`tracer.shading.lightcuts.drawn`)."""

from __future__ import annotations

import zlib

import numpy as np

from tracer.methods.interface import FrameView
from tracer.methods.lightcuts import Lightcuts, new_work
from tracer.scene.lights import COLOR
from tracer.shading.lightcuts.block import POINTS, CutWork
from tracer.shading.lightcuts.drawn import DRAWN_ROWS, Draws


class StochasticLightcuts(Lightcuts):
    """Shades by cuts whose representatives differ from pixel to pixel, and from sample to sample."""

    def _draws(self, frame: FrameView) -> Draws:
        tree, lamps = self._tree, frame.shading.lamps
        assert tree is not None, "there are lights"
        r, g, b = lamps.rows[tree.owners, COLOR : COLOR + 3].T
        shades = (r + g) + b
        before = np.concatenate([[0.0], np.cumsum(shades[tree.order], dtype=np.float64)]).astype(np.float32)
        # The same frame is the same picture, whatever came before it.
        seed = zlib.crc32(np.float64(frame.time).tobytes() + np.int64(frame.sample).tobytes())
        return Draws(tree.spans, tree.order, before, shades, np.zeros((DRAWN_ROWS, POINTS), np.float32), seed >> 1)

    def _new_work(self, limit: int) -> CutWork:
        return new_work(limit, DRAWN_ROWS)

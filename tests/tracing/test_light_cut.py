"""The cut that shades a pixel: its nodes are all lights, and what they send is what the pixel has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.tracing.halls import hall
from tests.tracing.test_lightcuts import SETTINGS
from tracer.light_cut import light_cut


@pytest.mark.parametrize("method", ["lightcuts", "lightcuts-stochastic", "lightcuts-certified"])
def test_what_the_nodes_of_a_cut_send_is_the_light_of_the_pixel(method: str) -> None:
    made = hall(ambient=(0.0, 0.0, 0.0))
    renderer = tracer.Renderer(made, replace(SETTINGS, method=method, depth=0, lightcuts_error=0.1))
    frame = renderer.render()
    samples = renderer.state.lamps(frame.settings).at(made.light_positions(frame.time)).samples
    rng, seen = np.random.default_rng(1), 0
    for y, x in rng.permutation(np.argwhere(frame.primitive >= 0))[:12].tolist():
        cut = light_cut(renderer, frame, x, y)
        assert cut is not None and (cut.x, cut.y, len(cut.nodes)) == (x, y, frame.layers["cut nodes"][y, x])
        assert cut.sent.sum() == pytest.approx(float(frame.color[y, x].astype(np.float64).sum()), rel=1e-4, abs=1e-6)
        assert (cut.errors <= 0.1 + 1e-6).all() and (cut.errors[cut.lights == 1] == 0.0).all()
        if method != "lightcuts-certified":  # it leaves out what is hidden
            assert cut.lights.sum() == len(samples)
        inside = (samples[None] >= cut.boxes[:, None, :3]) & (samples[None] <= cut.boxes[:, None, 3:])
        held = inside.all(2).sum(1)
        assert (held >= (1 if method == "lightcuts-certified" else cut.lights)).all()
        seen += int((cut.lights > 1).sum())
    assert seen, "every light by itself"
    missed = np.argwhere(frame.primitive < 0)
    if len(missed):
        assert light_cut(renderer, frame, int(missed[0][1]), int(missed[0][0])) is None


def test_there_is_none_where_all_lights_are_looked_at() -> None:
    renderer = tracer.Renderer(hall(), replace(SETTINGS, method="none"))
    frame = renderer.render()
    assert light_cut(renderer, frame, frame.width // 2, frame.height // 2) is None
    with pytest.raises(IndexError, match="no pixel"):
        light_cut(renderer, frame, frame.width, 0)
    renderer.render()
    with pytest.raises(LookupError, match="another frame"):
        light_cut(renderer, frame, 1, 1)

"""What a method leaves to tracing is said, and its pictures are right all the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.tracing.shades import shadow_scene
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.method import HELD, Method, bases, line_up
from tracer.methods.method_limits import lights_in_words, remark, too_few, worth
from tracer.scene.model import Scene

SETTINGS = tracer.Settings(width=24, height=18, depth=1, threads=1)


def with_lights(count: int) -> Scene:
    """The same room, where the first light stands in so many places."""
    scene = shadow_scene()
    light, (x, y, z) = scene.lights[0], scene.lights[0].position
    return replace(scene, lights=tuple(replace(light, position=(x + 0.05 * k, y, z)) for k in range(count)))


def test_words_hold_as_many_lights_as_the_table_says():
    assert HELD == MAX_CULLED_LIGHTS


@pytest.mark.parametrize("method", [kind.name for kind in bases()])
def test_what_does_not_fit_is_said(method: str):
    kind = Method.parse(method).kind
    many = tracer.Renderer(with_lights(40), replace(SETTINGS, method=method)).render()
    truth = tracer.Renderer(with_lights(40), replace(SETTINGS, method="none")).render()
    said = many.statistics.decision
    assert not kind.exact or np.array_equal(many.color, truth.color)
    first = f"Of 40 lights, {kind.title} answers for the first 31; rays to the others are traced."
    in_part = f"Of lights after the first 31, {kind.title} only knows which ones a single triangle hides from a cell."
    assert (first in said) == (kind.answers < 40 and not kind.in_part), said
    assert (in_part in said) == kind.in_part, said
    lamps = replace(SETTINGS, method=method, lamp_radius=0.1, lamp_samples=4)
    said = tracer.Renderer(shadow_scene(), lamps).render().statistics.decision
    every = f"All lights are lamps of several samples, of which {kind.title} knows nothing: every shadow ray is traced."
    in_part = f"Of lamps of several samples, {kind.title} only knows which ones a single triangle hides from a cell."
    assert (every in said) == (not kind.lamps and not kind.in_part), said
    assert (in_part in said) == kind.in_part, said


SENTENCES = {
    ("voxels", 9, 3): "Of lamps of several samples, 3 here, Voxels knows nothing; rays to them are traced.",
    ("voxels", 40, 3): "Of lamps of several samples, 3 here, Voxels knows nothing, nor of lights after the first 31; "
    "rays to them are traced.",
    ("voxels", 40, 40): "All lights are lamps of several samples, of which Voxels knows nothing: "
    "every shadow ray is traced.",
    ("certified+voxels", 9, 9): "All lights are lamps of several samples, of which Voxels knows nothing: "
    "it answers no ray.",
    ("certified+voxels", 9, 3): "Of lamps of several samples, 3 here, Voxels knows nothing; it leaves them alone.",
    ("certified+voxels", 40, 0): "Of 40 lights, Voxels answers for the first 31; it leaves the others alone.",
    ("paper", 1000, 3): "Of 1,000 lights, Paper answers for the first 31; rays to the others are traced.",
    ("lie", 40, 3): "Of lamps of several samples and lights after the first 31, Local illumination environments only "
    "knows which ones a single triangle hides from a cell.",
    ("certified", 1000, 3): "",
}


@pytest.mark.parametrize(("method", "lights", "lamps"), SENTENCES)
def test_sentences_say_which_rays_are_traced(method: str, lights: int, lamps: int):
    assert remark(Method.parse(method), lights, lamps) == SENTENCES[method, lights, lamps]


def test_samples_of_lamps_are_not_called_lights():
    assert lights_in_words(256, 256) == "256 lights" and lights_in_words(1, 1) == "1 light"
    assert lights_in_words(256, 4096) == "4,096 samples of 256 lights"
    assert lights_in_words(1, 16) == "16 samples of 1 light"


def test_where_all_fits_nothing_is_said():
    for kind in bases():
        assert remark(Method.parse(kind.name), 20, 0) == "" and worth(kind, 20) == ""
    assert worth(Method.parse("lightcuts").kind, 6) == "It is for 16 lights or more."
    assert worth(Method.parse("lightcuts").kind, 6, 8) == "It is for 16 light samples or more."
    assert worth(Method.parse("lightcuts").kind, 6, 96) == "" and worth(Method.parse("voxels").kind, 6, 96) == ""
    assert worth(Method.parse("voxels").kind, 4096) == "It is for 31 lights or fewer."


def test_clusters_are_worth_it_by_the_samples_of_all_lights():
    method = Method.parse("lightcuts")
    for lights, samples in ((6, 6), (2, 8), (6, 96), (16, 16), (1, 16)):
        few = too_few(method, lights, samples)
        assert bool(few) == bool(worth(method.kind, lights, samples)) == (not method.fits(lights, samples)), few
        assert ("lightcuts" in line_up(lights, samples)) == (not few)
    assert "voxels" not in line_up(40, 640)


def test_what_a_base_and_an_addition_make_is_counted_together():
    settings = replace(SETTINGS, width=96, height=72)
    parts = [
        tracer.Renderer(shadow_scene(), replace(settings, method=method)).render().statistics
        for method in ("certified", "voxels", "certified+voxels", "voxels+lightbuffer")
    ]
    certified, voxels, both, buffered = parts
    assert certified.certificates > 0 and voxels.certificates > 0
    for name in ("certificates", "certificate_steps", "certificate_tests"):
        assert getattr(both, name) == getattr(certified, name) + getattr(voxels, name), name
    assert buffered.certificates == voxels.certificates + len(shadow_scene().lights)
    assert Method.parse("certified+voxels").makes == ("certificates made", "voxels classified")

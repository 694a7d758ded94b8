"""Mirrors and glass that face each other: rays double at ten bounces, and at no further one."""

from __future__ import annotations

import numpy as np

import tracer
from tracer.scene.load import load_scene
from tracer.shading.bounce import SPLITS

PANES = 12
SETTING = "v from 0 0 0.5 at 0 0 -1 up 0 1 0 angle 40 hither 1 resolution 8 8\nl 0 3 4.5\n"
PANE = "p 4 -50 -50 {z} 50 -50 {z} 50 50 {z} -50 50 {z}\n"
SIZE = 4


def panes(tmp_path, specular, transmission):
    """Panes one behind the other, from which a ray is reflected as well as refracted."""
    path = tmp_path / "panes.aff"
    material = f"fm 0 0 0 0.5 0.5 0.5 {specular} {specular} {specular} 10 {transmission} 1\n"
    path.write_text(SETTING + material + "".join(PANE.format(z=z) for z in range(-PANES, 2)))
    return load_scene(path)


def rays(scene, depth):
    """How many reflected and refracted rays a pixel sends out with some depth."""
    settings = tracer.Settings(SIZE, SIZE, depth, "none", threads=1)
    return tracer.Renderer(scene, settings).render().statistics.secondary.rays / SIZE**2


def test_rays_double_up_to_a_bounce_and_not_beyond(tmp_path):
    scene = panes(tmp_path, 1, 1)
    sent = np.diff([rays(scene, depth) for depth in range(SPLITS + 4)])
    assert sent[:2].tolist() == [2.0, 4.0]
    assert (sent[1:SPLITS] > 1.3 * sent[: SPLITS - 1]).all()
    assert (sent[SPLITS:] <= sent[SPLITS - 1]).all()


def test_the_stronger_ray_goes_on(tmp_path):
    """Reflected rays stay between two panes for ever, refracted ones leave them all behind."""
    reflected, refracted = (
        np.diff([rays(panes(tmp_path, *parts), depth) for depth in range(SPLITS, SPLITS + 4)])
        for parts in ((1, 0.9999), (0.9999, 1))
    )
    assert (reflected > 0).all() and (np.diff(reflected) == 0).all()
    assert refracted[-1] < refracted[0]

"""The preview shows what is traced: the same surfaces at the same pixels, as far as a grid of pixels can tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.scenes import loaded, world_of
from tests.viewer.fakes import make_scene
from tracer.scene.lights import Light
from tracer.scene.model import Scene
from viewer.services.preview import BRIGHTNESS, MOST_LIGHTS, PreviewGeometry, preview_geometry
from viewer.util.resources import default_scene

SIZE = (240, 168)
NEAR = 0.01  # of the distance is no difference


def _geometry(scene: Scene, time: float = 0.0) -> PreviewGeometry:
    return preview_geometry(scene, time, lambda what, fraction: None)


@pytest.mark.gui
def test_the_preview_has_the_surfaces_of_the_traced_picture():
    """Also at another time, from the scene's own path, where things have moved; but for glass, which is left out."""
    moderngl = pytest.importorskip("moderngl")
    from tests.viewer.previews import colors_of, depths_of
    from viewer.window.preview import PreviewDisplay

    scene, (width, height) = loaded(default_scene()), SIZE
    settings = tracer.Settings(width=width, height=height, method="none", depth=0)
    renderer = tracer.Renderer(scene, settings, world=world_of(default_scene(), "bvh8"))
    context = moderngl.create_context(standalone=True, require=330)
    with context:
        for time in (scene.time_range[0], 0.4 * scene.time_range[1]):
            geometry = _geometry(scene, time)
            display = PreviewDisplay(context, geometry)
            camera = scene.camera_at(time)
            display.draw(camera, SIZE)
            depth, drawn = depths_of(display), colors_of(display)
            frame = renderer.render(time, camera)
            traced = frame.depth * _cosines(camera, width, height)
            shown, at = np.unique(frame.primitive, return_inverse=True)
            glass = np.array([p >= 0 and scene.material_of(int(p)).transmission > 0 for p in shown])
            opaque = ~glass[at].reshape(frame.primitive.shape)
            seen = np.isfinite(traced)
            assert (seen == np.isfinite(depth))[opaque].mean() > 0.999
            both = opaque & seen & np.isfinite(depth)
            off = np.abs(depth - traced) > NEAR * traced
            assert off[both].mean() < 0.02, "only pixels on silhouettes differ"
            parts = np.array([hash(scene.name_of(int(p)) if p >= 0 else "") for p in shown])
            inside = both & ~_on_edges(parts[at].reshape(frame.primitive.shape))
            assert off[inside].mean() < 0.004
            light = frame.color.clip(0, 1).mean(axis=2), drawn.mean(axis=2) / 255.0
            assert np.corrcoef(light[0].ravel(), light[1].ravel())[0, 1] > 0.5, "much the same colours"
    context.release()


def _cosines(camera, width: int, height: int) -> np.ndarray:
    """(height, width) between each pixel's ray and the camera's view."""
    half = np.tan(np.radians(camera.angle) / 2)
    y, x = np.mgrid[0:height, 0:width] + 0.5
    x, y = (2 * x - width) / height * half, (height - 2 * y) / height * half
    return 1 / np.sqrt(1 + x * x + y * y)


def _on_edges(of: np.ndarray) -> np.ndarray:
    """Pixels beside which another part is seen."""
    edge = np.zeros(of.shape, np.bool_)
    for axis in (0, 1):
        for step in (1, -1):
            edge |= np.roll(of, step, axis) != of
    return edge


def test_the_brightest_of_many_lights_have_the_light_of_all():
    colors = np.random.default_rng(2).random((40, 3))
    lights = tuple(Light(f"light {i}", (float(i), 0.0, 0.0), tuple(colors[i])) for i in range(40))
    rows = _geometry(replace(make_scene(), lights=lights)).lights
    assert len(rows) == MOST_LIGHTS and rows[:, 3:].sum(axis=0).max() == pytest.approx(BRIGHTNESS)
    assert set(rows[:, 0]) == set(np.argsort(-colors.sum(axis=1))[:MOST_LIGHTS])

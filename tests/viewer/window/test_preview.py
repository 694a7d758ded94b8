"""The preview shows what is traced: the same surfaces at the same pixels, as far as a grid of pixels can tell."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tracer
from tests.scenes import loaded, world_of
from tests.viewer.fakes import make_scene
from tracer.scene.lights import Light
from tracer.scene.model import Scene, SceneObject, Triangles, empty_quadrics
from viewer.state.preview_geometry import MOST_LIGHTS, QUADRIC, PreviewGeometry, preview_geometry
from viewer.util.resources import default_scene

SIZE = (240, 168)
NEAR = 0.01  # of the distance is no difference


def _geometry(scene: Scene, time: float | None = None, **most: int) -> PreviewGeometry:
    return preview_geometry(scene, scene.time_range[0] if time is None else time, lambda what, fraction: None, **most)


@pytest.mark.gui
def test_the_preview_has_the_surfaces_of_the_traced_picture():
    """Also at another time, from the scene's own path, where things have moved; but for glass, which is dithered."""
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
            pieces = 1
            while display.bring(1 << 18):
                pieces += 1
            assert display.whole and pieces > len(geometry.images) + 10 and not geometry.left_out
            camera = scene.camera_at(time)
            display.draw(camera, SIZE)
            depth, drawn = depths_of(display), colors_of(display)
            display.release()
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
            assert np.corrcoef(light[0].ravel(), light[1].ravel())[0, 1] > 0.6, "much the same colours"
    context.release()


@pytest.mark.gui
@pytest.mark.parametrize("fails", ["vertex_array", "texture"])
def test_a_preview_that_cannot_be_made_frees_what_it_took_and_is_not_tried_again(fails: str):
    moderngl = pytest.importorskip("moderngl")
    from viewer.window import graphics

    geometry, made = _geometry(make_scene()), []

    class Failing:
        """A context that keeps what it made, and fails at last."""

        def __getattr__(self, name: str):
            def make(*arguments, **options):
                if name == fails:
                    raise moderngl.Error("out of memory")
                made.append(getattr(context, name)(*arguments, **options))
                return made[-1]

            return make

    context = moderngl.create_context(standalone=True, require=330)
    controller = SimpleNamespace(preview=SimpleNamespace(geometry=geometry))
    gl = SimpleNamespace(display=SimpleNamespace(context=Failing()), preview=None, not_previewed=None)
    ui = SimpleNamespace(controller=controller, graphics=gl)
    with context:
        with pytest.raises(moderngl.Error, match="out of memory"):
            graphics.draw_preview(ui)
        count = len(made)
        assert count > 1 and all(isinstance(one.mglo, moderngl.mgl.InvalidObject) for one in made)
        graphics.draw_preview(ui)
        assert len(made) == count and ui.graphics.preview is None, "said once"
        graphics.release_preview(ui)  # another window
        with pytest.raises(moderngl.Error):
            graphics.draw_preview(ui)
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


def _hills(side: int) -> Scene:
    """A surface of 2 side^2 triangles over the unit square, and a floor under it that reaches far."""
    y, x = np.mgrid[0 : side + 1, 0 : side + 1] / side
    points = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)], axis=2)
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, :-1], points[1:, 1:]
    corners = np.concatenate([np.stack([a, b, d], 2).reshape(-1, 3, 3), np.stack([a, d, c], 2).reshape(-1, 3, 3)])
    floor = 500.0 * np.array([[(-1, -1, 0), (1, -1, 0), (0, 1, 0)]]) - (0, 0, 1)
    corners = np.concatenate([corners, floor]).astype(np.float32)
    zero = np.zeros(len(corners), np.int32)
    uvs = np.zeros((len(corners), 3, 2), np.float32)
    triangles = Triangles(corners, np.zeros_like(corners), uvs, zero, zero - 1)
    return replace(make_scene(), path=Path("hills"), objects=(SceneObject("all", triangles, empty_quadrics()),))


def test_too_many_triangles_become_a_surface_of_fewer_without_holes():
    whole, fewer = _geometry(_hills(100)), _geometry(_hills(100), most=6_000)
    kept = len(fewer.vertices) // 3
    assert 2_000 < kept <= 6_000 and fewer.left_out == 20_001 - kept and fewer.of == 20_001
    p = fewer.vertices["position"].reshape(-1, 3, 3).astype(np.float64)
    area = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])[:, 2] / 2
    assert np.abs(fewer.box - whole.box).max() < 0.1, "the floor is there"
    small = np.delete(area, area.argmax())
    assert small.min() > -1e-4 and 0.95 < small.sum() < 1.0, (
        "as seen from above: nothing folds over, nothing is missing"
    )


def test_of_too_many_spheres_the_largest_are_kept():
    scene = loaded(default_scene())
    whole, fewer = _geometry(scene), _geometry(scene, most_quadrics=10)
    assert len(fewer.quadrics) == 10 and fewer.left_out == len(whole.quadrics) - 10
    size = [np.linalg.norm(g.quadrics["to_world"][:, :, :3], axis=(1, 2)) for g in (whole, fewer)]
    assert size[1].min() >= np.sort(size[0])[-10] and fewer.quadrics.dtype == QUADRIC


def test_the_brightest_of_many_lights_have_the_light_of_all():
    rng = np.random.default_rng(2)
    colors, places = rng.random((40, 3)), rng.random((40, 3))
    lights = tuple(
        Light(f"light {i}", tuple(places[i]), tuple(colors[i]), falloff="inverse square" if i < 15 else "none")
        for i in range(40)
    )
    rows = _geometry(replace(make_scene(), lights=lights)).lights
    assert len(rows) == MOST_LIGHTS
    for falls, members in ((1.0, colors[:15]), (0.0, colors[15:])):
        assert rows[rows[:, 7] == falls, 4:7].sum() == pytest.approx(members.sum(), rel=1e-5)
    few = _geometry(replace(make_scene(), lights=lights[:3])).lights
    assert few[:, :3] == pytest.approx(places[:3]) and few[:, 4:7] == pytest.approx(colors[:3])

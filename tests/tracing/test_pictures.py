"""Whole frames: analytic shadows and shading."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.tracing.worlds import affine, quad, quadrics, scene
from tracer.scene.model import SPHERE, Camera, Material, Texture

ABOVE = Camera((0.0, 0.0, 30.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 40.0)
SETTINGS = tracer.Settings(width=128, height=128, depth=0, threads=2, record_lights=True)


def plane(half: float = 20.0, z: float = 0.0) -> list:
    return quad((-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z))


def test_a_spheres_shadow_on_a_plane_has_the_known_radius():
    """Light at height h over a sphere of radius r at height c: the cone it touches meets z = 0 in a circle."""
    h, c, r = 10.0, 4.0, 1.0
    world = scene(plane(), quadrics([(SPHERE, affine(r, (0, 0, c)), (1, 1))]), lights=[(0, 0, h)], camera=ABOVE)
    frame = tracer.Renderer(world, replace(SETTINGS, width=256, height=256)).render()
    on_plane = frame.primitive < 2
    shadowed = on_plane & ~frame.lit[..., 0]
    hidden_by_sphere = frame.primitive == 2
    pixel = 2 * 30.0 * np.tan(np.radians(20.0)) / 256
    radius = np.sqrt((shadowed | hidden_by_sphere).sum() * pixel**2 / np.pi)
    expected = h * np.tan(np.arcsin(r / (h - c)))
    assert radius == pytest.approx(expected, rel=0.01)


def test_depth_is_the_distance_along_the_unit_ray():
    frame = tracer.Renderer(scene(plane(), camera=ABOVE), replace(SETTINGS, width=3, height=3)).render()
    step = 2 * np.tan(np.radians(20.0)) / 3
    slant = np.sqrt(1 + (np.arange(-1, 2)[:, None] * step) ** 2 + (np.arange(-1, 2)[None, :] * step) ** 2)
    assert frame.depth == pytest.approx(30.0 * slant, rel=1e-6)


def test_row_0_is_at_the_top_and_column_0_at_the_left():
    upper_left = quad((-9, 8, 0), (-8, 8, 0), (-8, 9, 0), (-9, 9, 0))
    frame = tracer.Renderer(scene(upper_left, camera=ABOVE), replace(SETTINGS, width=32, height=32)).render()
    rows, columns = np.nonzero(frame.primitive >= 0)
    assert rows.max() < 8
    assert columns.max() < 8


def test_phong_at_normal_incidence_is_the_sum_of_its_terms():
    material = Material(ambient=(0.1, 0.2, 0.3), diffuse=(0.4, 0.3, 0.2), specular=(0.2, 0.1, 0.0), exponent=40.0)
    world = scene(plane(), lights=[(0, 0, 60)], camera=ABOVE, materials=(material,), ambient=(0.5, 0.5, 0.5))
    frame = tracer.Renderer(world, replace(SETTINGS, width=1, height=1)).render()
    assert frame.color[0, 0] == pytest.approx([0.05 + 0.4 + 0.2, 0.1 + 0.3 + 0.1, 0.15 + 0.2], rel=1e-5)


def test_a_light_behind_the_surface_is_not_due():
    frame = tracer.Renderer(scene(plane(), lights=[(0, 0, -5), (0, 0, 5)], camera=ABOVE), SETTINGS).render()
    assert not frame.due[..., 0].any()
    assert frame.due[..., 1].all()


@pytest.mark.parametrize("depth, seen", [(0, 0.0), (1, 1.0)])
def test_a_mirror_shows_what_is_behind_the_viewer_from_depth_one_on(depth, seen):
    mirror, glow = Material(ambient=(0, 0, 0), specular=(1, 1, 1)), Material(ambient=(1, 0, 0))
    world = scene(plane(), quadrics([(SPHERE, affine(30.0, (0, 0, 80)), (1, 1))], material=1), camera=ABOVE)
    world = replace(world, materials=(mirror, glow))
    frame = tracer.Renderer(world, replace(SETTINGS, width=1, height=1, depth=depth)).render()
    assert frame.color[0, 0].tolist() == [seen, 0.0, 0.0]


def test_parallel_mirrors_stop_at_the_depth_asked_for():
    mirror = Material(ambient=(0.5, 0, 0), diffuse=(0, 0, 0), specular=(1, 1, 1))
    world = scene(plane() + plane(z=40.0), camera=ABOVE, materials=(mirror,))
    for depth in (0, 1, 5, 10):
        frame = tracer.Renderer(world, replace(SETTINGS, width=1, height=1, depth=depth)).render()
        assert frame.color[0, 0, 0] == pytest.approx(0.5 * (depth + 1))


def test_rays_whose_weight_falls_below_a_256th_are_not_traced():
    dull = Material(ambient=(1, 0, 0), diffuse=(0, 0, 0), specular=(1 / 15, 0, 0))
    narrow = replace(ABOVE, angle=2.0)  # so that no reflection escapes between the planes
    world = scene(plane() + plane(z=40.0), camera=narrow, materials=(dull,))
    frame = tracer.Renderer(world, replace(SETTINGS, width=8, height=8, depth=10)).render()
    assert frame.statistics.secondary.rays == 2 * 64  # 1/15 and 1/225, but not 1/3375


def test_glass_bends_rays_by_snells_law():
    """Down at 30 degrees onto glass of ior 1.5: the ray meets the plane below where sin' = sin / 1.5."""
    glass = Material(ambient=(0, 0, 0), diffuse=(0, 0, 0), transmission=1.0, ior=1.5)
    ruler = Texture("ruler", np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 3, axis=2))
    world = scene(plane() + plane(z=-10.0), camera=Camera((0, 0, 10), (0.5, 0, -np.sqrt(0.75)), (0, 1, 0), 1.0))
    triangles = world.objects[0].triangles
    triangles.material[2:], triangles.texture[2:] = 1, 0
    triangles.uvs[:] = triangles.corners[..., :2] / 40 + 0.5
    paper = Material(ambient=(1, 1, 1))
    world = replace(world, materials=(glass, paper), textures=(ruler,))
    frame = tracer.Renderer(world, replace(SETTINGS, width=1, height=1, depth=1)).render()
    x = 10 * np.tan(np.radians(30)) + 10 * np.tan(np.arcsin(0.5 / 1.5))
    assert frame.color[0, 0, 0] * 255 == pytest.approx((x / 40 + 0.5) * 256 - 0.5, abs=0.05)


def test_textures_repeat_and_stand_upright():
    """v = 0 is the bottom row: red below, green above, and the same again one period on."""
    two_rows = Texture("rows", np.array([[[0, 255, 0]], [[255, 0, 0]]], np.uint8))
    world = scene(plane(half=2.0), camera=Camera((0, 0, 10), (0, 0, -1), (0, 1, 0), 2 * np.degrees(np.arctan(0.2))))
    triangles = world.objects[0].triangles
    triangles.texture[:] = 0
    triangles.uvs[:] = triangles.corners[..., :2] / 2  # v from -1 to 1: two periods
    world = replace(world, materials=(Material(ambient=(1, 1, 1)),), textures=(two_rows,))
    column = tracer.Renderer(world, replace(SETTINGS, width=1, height=8)).render().color[:, 0]
    assert column[:4] == pytest.approx(column[4:], abs=1e-5)
    assert column[1, 1] > 0.7 > 0.3 > column[1, 0]
    assert column[2, 0] > 0.7 > 0.3 > column[2, 1]


def test_a_distant_texture_shows_its_mean_instead_of_flickering():
    """Black and white texels far smaller than a pixel are grey; seen closely they are black and white."""
    checks = Texture(
        "checks", np.kron([[0, 1], [1, 0]], np.full((32, 32), 255))[..., None].repeat(3, 2).astype(np.uint8)
    )
    world = scene(plane(), camera=ABOVE, materials=(Material(ambient=(1, 1, 1)),), textures=(checks,))
    triangles = world.objects[0].triangles
    triangles.texture[:] = 0
    triangles.uvs[:] = triangles.corners[..., :2] * 20
    renderer = tracer.Renderer(world, replace(SETTINGS, width=32, height=32))
    far, near = renderer.render(), renderer.render(camera=Camera((0, 0, 0.1), (0, 0, -1), (0, 1, 0), 40.0))
    assert far.color == pytest.approx(0.5, abs=0.02)
    assert (np.isin(near.color, (0.0, 1.0))).mean() > 0.5


@pytest.mark.parametrize("huge", [1e8, 1e20, 3e38, np.inf, np.nan])
def test_texture_coordinates_beyond_all_measure_still_give_a_colour(huge):
    texture = Texture("grey", np.full((4, 4, 3), 128, np.uint8))
    world = scene(plane(), camera=ABOVE, materials=(Material(ambient=(1, 1, 1)),), textures=(texture,))
    triangles = world.objects[0].triangles
    triangles.texture[:] = 0
    triangles.uvs[:, 1:] = huge
    frame = tracer.Renderer(world, replace(SETTINGS, width=8, height=8)).render()
    assert frame.color == pytest.approx(128 / 255)


def test_more_samples_smooth_an_edge_and_change_no_modes():
    half = [[[-20, -20, 0], [20, -20, 0], [20, 20, 0]]]
    world = scene(half, camera=ABOVE, background=(1, 1, 1), lights=[(0, 0, 20)])
    one, many = (tracer.Renderer(world, replace(SETTINGS, samples=n)).render() for n in (1, 16))
    assert len(np.unique(one.color[..., 0] == 1.0)) == 2
    blended = (many.color[..., 0] < 0.99) & (many.color[..., 0] > one.color[..., 0].min() + 0.05)
    assert blended.sum() > 64
    assert np.array_equal(one.modes, many.modes)
    assert one.statistics.shadow == many.statistics.shadow


@pytest.mark.parametrize(
    "change",
    [{"width": 0}, {"height": 99999}, {"depth": -1}, {"method": "magic"}, {"zoom_factor": 0.5}, {"samples": 0}],
)
def test_settings_out_of_range_are_refused_in_one_line(change):
    with pytest.raises(ValueError) as error:
        replace(SETTINGS, **change).validated()
    assert "\n" not in str(error.value)

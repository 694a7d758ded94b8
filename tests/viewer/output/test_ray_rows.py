"""Rows of a tree of rays: each ray once, what is alike together, and filters that leave out the rest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.commands import ROOM
from tracer.frame import Settings
from tracer.ray_tree import ray_tree
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Scene
from tracer.told_rays import AWAY, TRACED, RayTree
from viewer.output.ray_rows import MOST_LIGHTS, Filter, RayRows, Row, Shown, totals, unfolded
from viewer.window.panels.rays import MOST_DRAWN, Part, ray_lines

PIXEL = 24, 26  # on the square that mirrors the sphere


def tree_of(path: Path, more: str = "", **settings) -> tuple[Scene, RayTree]:
    path.write_text(ROOM + more)
    scene = load_scene(path)
    renderer = Renderer(scene, Settings(48, 32, threads=1, **settings))
    for time in (3.0, 4.0):
        frame = renderer.render(time)
    return scene, ray_tree(renderer, frame, *PIXEL)


def every_row(rows: RayRows) -> list[Row]:
    return [row for _, row in unfolded(rows.top, lambda row: True)]


def singles(rows: RayRows) -> list[tuple[int, int]]:
    return [(row.ray, int(row.places[0])) for row in every_row(rows) if len(row.places) == 1]


def test_each_ray_has_one_row(tmp_path: Path) -> None:
    scene, tree = tree_of(tmp_path / "a.aff", method="paper")
    rows = RayRows(tree, scene, Filter())
    told = every_row(rows)
    assert [row.ray for row in told if not len(row.places)] == sorted(ray.number for ray in tree.rays)
    expected = [(r.number, p) for r in tree.rays if r.shadows is not None for p in range(len(r.shadows.light))]
    assert sorted(singles(rows)) == expected
    assert len({row.key for row in told}) == len(told)
    assert totals(tree).startswith(f"{len(tree.rays)} rays and {tree.due} shadow rays that are due")


@pytest.mark.parametrize("shown", [Shown.TRACED, Shown.UNTRACED, Shown.BLOCKED, Shown.WRONG])
def test_filters_keep_what_they_name(tmp_path: Path, shown: Shown) -> None:
    scene, tree = tree_of(tmp_path / "a.aff", method="certified", lamp_radius=0.3, lamp_samples=8)
    kept = set(singles(RayRows(tree, scene, Filter(shown, 1))))
    for ray in tree.rays:
        s = ray.shadows
        for place in range(16) if s is not None else ():
            traced, away = s.verdict[place] == TRACED, s.verdict[place] == AWAY
            says = {
                Shown.TRACED: traced,
                Shown.UNTRACED: not traced and not away,
                Shown.BLOCKED: not away and not s.lit[place],
                Shown.WRONG: bool(s.wrong[place]),
            }[shown] and s.light[place] == 1
            assert ((ray.number, place) in kept) == says


def test_samples_of_a_lamp_with_the_same_fate_are_together(tmp_path: Path) -> None:
    scene, tree = tree_of(tmp_path / "a.aff", method="none", lamp_radius=0.5, lamp_samples=32)
    rows = RayRows(tree, scene, Filter())
    lamps = [row for row in rows.top[0].rows if row.key[-2] == "light"]
    assert [len(row.places) for row in lamps] == [32, 32]
    for lamp in lamps:
        below = lamp.rows
        assert sum(len(row.places) for row in below) == len(lamp.places) or len(below) == 0
        if len(below) > 1 and any(len(row.places) > 1 for row in below):
            assert all(len(row.places) < 2 or row.text.split(" ")[1] == "samples" for row in below)


def test_many_lights_with_the_same_fate_are_together(tmp_path: Path) -> None:
    bulbs = "".join(f"l {x / 10} 3 {z} 0.1 0.1 0.1\n" for x in range(-20, 20) for z in (1, 2))
    scene, tree = tree_of(tmp_path / "a.aff", bulbs, method="none")
    rows = RayRows(tree, scene, Filter())
    first = [row for row in rows.top[0].rows if len(row.places)]
    assert len(first) <= MOST_LIGHTS < len(scene.lights)
    assert sum(len(row.places) for row in first) == len(scene.lights)
    assert sorted(place for ray, place in singles(rows) if ray == 0) == list(range(len(scene.lights)))
    lines = ray_lines(tree.frame, tree, Filter())
    drawn = {(line.ray, line.place) for line in lines if line.place >= 0}
    assert len(drawn) == min(MOST_DRAWN, tree.due)


def test_lines_are_dark_behind_what_blocks(tmp_path: Path) -> None:
    _, tree = tree_of(tmp_path / "a.aff", method="paper")
    lines = ray_lines(tree.frame, tree, Filter())
    for ray, place in tree.shadow_rays():
        parts = [line.part for line in lines if (line.ray, line.place) == (ray.number, place)]
        light = Part.ASKED if ray.shadows.verdict[place] == TRACED else Part.SAVED
        assert parts == [light, Part.DARK] if ray.shadows.blocker[place] >= 0 else parts == [light]
    assert [line.ray for line in lines if line.part is Part.PATH] == [ray.number for ray in tree.rays[1:]]
    assert np.isfinite([at for line in lines for s in line.strokes for at in (*s.start, *s.end)]).all()

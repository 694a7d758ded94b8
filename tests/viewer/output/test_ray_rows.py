"""Rows of a tree of rays: each ray once, what is alike together, and filters that leave out the rest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.commands import ROOM
from tracer.frame import Settings
from tracer.inspect.path_records import AWAY, TRACED, RayTree
from tracer.inspect.ray_tree import ray_tree
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.scene.model import Scene
from viewer.output.ray_rows import MOST_LIGHTS, RayFilter, RayRow, RayRows, RaySubset, totals, unfolded
from viewer.window.panels.rays import MOST_DRAWN, Part, ray_lines

PIXEL = 24, 26  # on the square that mirrors the sphere
BULBS = "".join(f"l {x / 10} 3 {z} 0.1 0.1 0.1\n" for x in range(-20, 20) for z in (1, 2))


def tree_of(path: Path, more: str = "", **settings) -> tuple[Scene, RayTree]:
    path.write_text(ROOM + more)
    scene = load_scene(path)
    renderer = Renderer(scene, Settings(48, 32, threads=1, **settings))
    for time in (3.0, 4.0):
        frame = renderer.render(time)
    return scene, ray_tree(renderer, frame, *PIXEL)


def every_row(rows: RayRows) -> list[RayRow]:
    return [row for _, row in unfolded(rows.top, lambda row: True)]


def singles(rows: RayRows) -> list[tuple[int, int]]:
    return [(row.ray, int(row.places[0])) for row in every_row(rows) if len(row.places) == 1]


@pytest.mark.parametrize(
    ("more", "settings"),
    [("", {"method": "paper"}), ("", {"lamp_radius": 0.5, "lamp_samples": 32}), (BULBS, {})],
    ids=["points", "lamps", "many lights"],
)
def test_each_ray_has_one_row_and_those_alike_one_above(tmp_path: Path, more: str, settings: dict) -> None:
    scene, tree = tree_of(tmp_path / "a.aff", more, **{"method": "none", **settings})
    rows = RayRows(tree, scene, RayFilter())
    told = every_row(rows)
    assert [row.ray for row in told if not len(row.places)] == sorted(ray.number for ray in tree.rays)
    due = [(r.number, p) for r in tree.rays for p in range(0 if r.shadows is None else len(r.shadows.light))]
    due = [at for at in due if settings.get("method") or tree.rays[at[0]].shadows.verdict[at[1]] != AWAY]
    assert set(due) <= set(singles(rows)) and len(set(singles(rows))) == len(singles(rows))
    assert len({row.key for row in told}) == len(told)
    first = [row for row in rows.top[0].rows if len(row.places)]
    assert len(first) <= MOST_LIGHTS and sum(len(row.places) for row in first) == len(tree.samples)
    for row in told:
        if len(row.places) and row.below is not None:
            assert np.array_equal(np.sort(np.concatenate([one.places for one in row.rows])), row.places)
    if not more:
        assert [row.text.split(":")[0] for row in first] == ["light 0", "light 1"]
    assert totals(tree).startswith(f"{len(tree.rays)} rays and {tree.due} shadow rays that are due")


@pytest.mark.parametrize("shown", [RaySubset.TRACED, RaySubset.UNTRACED, RaySubset.BLOCKED, RaySubset.WRONG])
def test_filters_keep_what_they_name(tmp_path: Path, shown: RaySubset) -> None:
    scene, tree = tree_of(tmp_path / "a.aff", method="certified", lamp_radius=0.3, lamp_samples=8)
    kept = set(singles(RayRows(tree, scene, RayFilter(shown, 1))))
    for ray in tree.rays:
        s = ray.shadows
        for place in range(16) if s is not None else ():
            traced, away = s.verdict[place] == TRACED, s.verdict[place] == AWAY
            says = {
                RaySubset.TRACED: traced,
                RaySubset.UNTRACED: not traced and not away,
                RaySubset.BLOCKED: not away and not s.lit[place],
                RaySubset.WRONG: bool(s.wrong[place]),
            }[shown] and s.light[place] == 1
            assert ((ray.number, place) in kept) == says


@pytest.mark.parametrize(("more", "method"), [("", "paper"), (BULBS, "none")], ids=["few", "many"])
def test_lines_are_dark_behind_what_blocks(tmp_path: Path, more: str, method: str) -> None:
    _, tree = tree_of(tmp_path / "a.aff", more, method=method)
    lines = ray_lines(tree.frame, tree, RayFilter())
    drawn = {(line.ray, line.place) for line in lines if line.place >= 0}
    assert len(drawn) == min(MOST_DRAWN, tree.due)
    for ray, place in tree.shadow_rays():
        parts = [line.part for line in lines if (line.ray, line.place) == (ray.number, place)]
        light = Part.TRACED if ray.shadows.verdict[place] == TRACED else Part.SAVED
        expected = [light, Part.BLOCKED] if ray.shadows.blocker[place] >= 0 else [light]
        assert parts == (expected if (ray.number, place) in drawn else [])
    assert [line.ray for line in lines if line.part is Part.PATH] == [ray.number for ray in tree.rays[1:]]
    assert np.isfinite([at for line in lines for s in line.strokes for at in (*s.start, *s.end)]).all()

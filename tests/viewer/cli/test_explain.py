"""`shadowcull explain`: the tree of a pixel's rays, as text and as JSON."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.commands import Run
from tracer.method import DEFAULT_METHOD
from viewer.cli.explain import EPILOG

ROOT = Path(__file__).parents[3]
ROOM = ("explain", "room.aff", "--size", "48x32", "--threads", 1)
BY_MODES = (*ROOM, "--method", "paper", "--frame", 4, "--warmup", 3)


def test_the_tree_names_what_became_of_each_ray_and_first_why(run: Run) -> None:
    lines = run.ok(*BY_MODES, "--pixel", "24,26").splitlines()
    assert lines[0].startswith("room.aff, 4.000 s, pixel 24,26 of 48 × 32, method paper")
    first, second, covers, left, above = lines[1:6]
    clipped = "clipped by the screen's edge at pixel (24, 31) (§2.3)"
    assert first == f"light 0: Traced: {clipped}, so its shadow mode is not trusted (§2.4). Lit."
    assert second.startswith(f"light 1: Traced although nothing static has blocked it so far: {clipped}, so its")
    assert covers == f"Covers 282 pixels. Not fully rendered: {clipped}."
    assert left == "The pixel on its left sees the same: no test." and above.startswith("The pixel above it")
    (top,) = (i for i, line in enumerate(lines) if "shadow rays that are due" in line)
    tree = "\n".join(lines[top:])
    assert lines[top + 1].startswith("└── primary ray: triangle ") and "reflected ray: " in tree and "steps" in tree
    assert tree.count("light 0") == tree.count(" ray: ") - tree.count("leaves the scene")
    traced = run.ok(*BY_MODES, "--pixel", "24,26", "--only", "traced", "--light", 1)
    assert "shadow rays shown: traced of light 1" in traced and "light 0" not in traced
    assert all("traced" in line for line in traced.splitlines()[top:] if "light 1:" in line)
    told = json.loads(run.ok(*BY_MODES, "--pixel", "24,26", "--json"))["why"]
    assert [one["light"] for one in told] == list(range(len(told))) and {one["section"] for one in told} - {None}
    whole = run.ok(*BY_MODES, "--pixel", "24,16").splitlines()
    assert whole[1] == "light 0, light 1: Asks the dynamic object only: nothing static has ever blocked it (§2.4). Lit."
    assert "Fully rendered since frame 1 of the 3 frames before this." in whole[2]
    away = run.ok(*ROOM, "--pixel", "0,0")
    assert "primary ray: leaves the scene" in away and "light" not in away.split("leaves")[1]


def test_who_taught_a_shadow_mode_is_named(run: Run) -> None:
    seen = ("default", "--frame", 40, "--warmup", 2, "--method", "paper", "--pixel", "19,50", "--size", "96x64")
    taught = r"PARTIAL_SHADOW since frame 1 of the 2 frames before this, in which some of it (saw|was)"
    assert re.search(taught, run.ok("explain", *seen))


def test_culling_has_seen_a_frame_before_unless_none_is_asked_for(run: Run) -> None:
    """Without frames before it, the frame itself is traced once before, as in the window at rest."""

    def culled(*arguments: object) -> int:
        told = json.loads(run.ok(*ROOM, "--pixel", "24,16", "--json", *arguments))
        assert told["method"] == DEFAULT_METHOD
        return told["due"] - told["traced"]

    assert culled() == culled("--repeat", 1) > 0
    assert culled("--repeat", 0) == 0
    assert culled("--frame", 1, "--warmup", 1) == culled("--frame", 1, "--warmup", 1, "--repeat", 0)


def test_the_first_example_shows_culling_at_work(run: Run) -> None:
    """Of each of the paper's kinds: culled in full shadow, dynamic objects only in non-shadow, traced in between."""
    (example,) = re.findall(r"shadowcull (explain \S+ --pixel \S+)  ", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert example in EPILOG
    out = run.ok(*example.split())
    (rays,) = (line for line in out.splitlines() if "shadow rays that are due" in line)
    assert all(f" {what}" in rays for what in ("culled by FULL_SHADOW", "dynamic only by NON_SHADOW"))
    assert "method paper" in out and "traced (PARTIAL_SHADOW)" in out


def test_json_adds_up(run: Run) -> None:
    told = json.loads(run.ok(*ROOM, "--pixel", "24,26", "--json", "--accelerator", "kdtree", "--method", "none"))
    assert told["pixel"] == [24, 26] and told["size"] == [48, 32] and told["accelerator"] == "kdtree"
    rays = told["rays"]
    shadows = [shadow for ray in rays for shadow in ray["shadow_rays"]]
    assert len(shadows) == told["due"] == told["traced"] > 0
    assert {shadow["verdict"] for shadow in shadows} == {"traced"}
    assert all((shadow["blocker"] is None) == shadow["lit"] and not shadow["wrong"] for shadow in shadows)
    assert all(ray["parent"] is None or rays[ray["parent"]]["bounce"] + 1 == ray["bounce"] for ray in rays)
    assert [sum(ray["light"][i] for ray in rays) for i in range(3)] == pytest.approx(told["color"], rel=1e-6)


def test_steps_print_the_text_as_it_runs_in_each_frame(run: Run) -> None:
    """First all is INIT and every ray is traced; in the second frame modes let a ray ask dynamic objects only."""
    out = run.ok(*ROOM, "--method", "paper", "--pixel", "24,16", "--steps")
    first, second = out.split("frame 2 of 2")
    assert first.startswith("room.aff, 0.000 s, pixel 24,16 of 48 × 32, method paper, frame 1 of 2")
    assert [n for n in ("2.3", "2.4", "2.5", "2.6") if f"§{n} " in first] == ["2.3", "2.4", "2.5", "2.6"]
    assert re.search(r"modes.occlusion\[\d+\]: 00 INIT → 10 FULLY_RENDERED", first)
    assert re.search(r"modes.shadow\[\d+, 0\]: 00 INIT → 10 NON_SHADOW", first) and "other pixels" in first
    assert re.search(r"leaves:\n(  .*\n)*  .*: 10 FULLY_RENDERED; light 0 .*10 NON_SHADOW; light 1", second)
    assert "counts[DYNAMIC_ONLY]: 0 → 1" in second and "in_shadow = _blocked" not in second
    one = run.ok(*ROOM, "--method", "paper", "--pixel", "24,16", "--steps", "--light", 1, "--repeat", 0)
    assert "light 1, primary ray" in one and "light 0, primary ray" not in one and "frame 1 of 1" in one
    beside = run.ok(*ROOM, "--pixel", "24,16", "--steps", "--method", "none")
    assert "these are the steps that Paper would take" in beside
    said = run.fails(*ROOM, "--method", "cells", "--pixel", "24,16", "--steps")
    assert "keeps modes of cells, and the text speaks of primitives" in said

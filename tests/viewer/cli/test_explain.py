"""`shadowcull explain`: the tree of a pixel's rays, as text and as JSON, and one line for every mistake."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.commands import complaint, run
from tracer.method import DEFAULT_METHOD
from viewer.cli.explain import EPILOG

ROOT = Path(__file__).parents[3]


def explained(capfd: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    return run(capfd, "explain", *arguments, "--size", "48x32", "--threads", 1)


def test_the_tree_names_what_became_of_each_ray(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    seen = (room, "--pixel", "24,26", "--method", "paper", "--frame", 4, "--warmup", 3)
    code, out, _ = explained(capfd, *seen)
    lines = out.splitlines()
    assert code == 0 and lines[0].startswith("room.aff, 4.000 s, pixel 24,26 of 48 × 32, method paper")
    (top,) = (i for i, line in enumerate(lines) if "shadow rays that are due" in line)
    assert lines[top + 1].startswith("└── primary ray: triangle ") and "reflected ray: " in out
    tree = "\n".join(lines[top:])
    assert tree.count("light 0") == tree.count(" ray: ") - tree.count("leaves the scene")
    assert "steps" in tree
    _, traced, _ = explained(capfd, *seen, "--only", "traced", "--light", 1)
    assert "shadow rays shown: traced of light 1" in traced and "light 0" not in traced
    assert all("traced" in line for line in traced.splitlines()[top:] if "light 1:" in line)
    code, out, _ = explained(capfd, room, "--pixel", "0,0")
    assert code == 0 and "primary ray: leaves the scene" in out and "light" not in out.split("leaves")[1]


def test_the_reasons_come_first(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    seen = (room, "--frame", 4, "--warmup", 3, "--method", "paper")
    _, out, _ = explained(capfd, *seen, "--pixel", "24,26")
    first, second, covers, left, above = out.splitlines()[1:6]
    clipped = "clipped by the screen's edge at pixel (24, 31) (§2.3)"
    assert first == f"light 0: Traced: {clipped}, so its shadow mode is not trusted (§2.4). Lit."
    assert second.startswith(f"light 1: Traced although nothing static has blocked it so far: {clipped}, so its")
    assert covers == f"Covers 282 pixels. Not fully rendered: {clipped}."
    assert left == "The pixel on its left sees the same: no test." and above.startswith("The pixel above it")
    _, out, _ = explained(capfd, *seen, "--pixel", "24,16")
    both = "light 0, light 1: Asks the dynamic object only: nothing static has ever blocked it (§2.4). Lit."
    assert out.splitlines()[1] == both
    assert "Fully rendered since frame 1 of the 3 frames before this." in out.splitlines()[2]
    _, out, _ = explained(capfd, *seen, "--pixel", "24,26", "--json")
    told = json.loads(out)["why"]
    assert [one["light"] for one in told] == list(range(len(told))) and {one["section"] for one in told} - {None}


def test_who_taught_a_shadow_mode_is_named(capfd: pytest.CaptureFixture[str]) -> None:
    seen = ("default", "--frame", 40, "--warmup", 2, "--method", "paper", "--pixel", "19,50", "--size", "96x64")
    code, out, _ = run(capfd, "explain", *seen)
    assert code == 0
    assert re.search(r"PARTIAL_SHADOW since frame 1 of the 2 frames before this, in which some of it (saw|was)", out)


def test_culling_has_seen_a_frame_before_unless_none_is_asked_for(
    capfd: pytest.CaptureFixture[str], room: Path
) -> None:
    """Without frames before it, the frame itself is traced once before, as in the window at rest."""
    seen = (room, "--pixel", "24,16", "--json")

    def culled(*arguments: object) -> int:
        told = json.loads(explained(capfd, *seen, *arguments)[1])
        assert told["method"] == DEFAULT_METHOD
        return told["due"] - told["traced"]

    assert culled() == culled("--repeat", 1) > 0
    assert culled("--repeat", 0) == 0
    assert culled("--frame", 1, "--warmup", 1) == culled("--frame", 1, "--warmup", 1, "--repeat", 0)


def test_the_first_example_shows_culling_at_work(capfd: pytest.CaptureFixture[str]) -> None:
    """Of each of the paper's kinds: culled in full shadow, dynamic objects only in non-shadow, traced in between."""
    (example,) = re.findall(r"shadowcull (explain \S+ --pixel \S+)  ", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert example in EPILOG
    code, out, _ = run(capfd, *example.split())
    assert code == 0 and "method paper" in out
    (rays,) = (line for line in out.splitlines() if "shadow rays that are due" in line)
    assert all(f" {what}" in rays for what in ("culled by FULL_SHADOW", "dynamic only by NON_SHADOW"))
    assert "traced (PARTIAL_SHADOW)" in out


def test_json_adds_up(capfd: pytest.CaptureFixture[str], room: Path) -> None:
    code, out, _ = explained(capfd, room, "--pixel", "24,26", "--json", "--accelerator", "kdtree", "--method", "none")
    told = json.loads(out)
    assert code == 0 and told["pixel"] == [24, 26] and told["size"] == [48, 32] and told["accelerator"] == "kdtree"
    shadows = [shadow for ray in told["rays"] for shadow in ray["shadow_rays"]]
    assert len(shadows) == told["due"] == told["traced"] > 0
    assert {shadow["verdict"] for shadow in shadows} == {"traced"}
    assert all((shadow["blocker"] is None) == shadow["lit"] and not shadow["wrong"] for shadow in shadows)
    assert all(
        ray["parent"] is None or told["rays"][ray["parent"]]["bounce"] + 1 == ray["bounce"] for ray in told["rays"]
    )
    summed = [sum(ray["light"][channel] for ray in told["rays"]) for channel in range(3)]
    assert summed == pytest.approx(told["color"], rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--pixel", "48,0"), "--pixel 48,0: the picture is 48 x 32"),
        (("--pixel", "1"), "is not a pixel"),
        ((), "the following arguments are required: --pixel"),
        (("--pixel", "1,1", "--light", "9"), "--light 9: "),
        (("--pixel", "1,1", "--method", "no"), "invalid choice"),
        (("--pixel", "1,1", "--frame", "99"), "frame numbers are 0 to 9"),
    ],
)
def test_mistakes_end_in_one_line(
    capfd: pytest.CaptureFixture[str], room: Path, arguments: tuple[str, ...], said: str
) -> None:
    assert said in complaint(explained(capfd, room, *arguments))

"""What counters cost: the counters are really out, of nothing else but them, and the comparison is watched."""

from __future__ import annotations

import difflib
from collections import Counter
from pathlib import Path

import pytest

from tests.bench.counters import ROOT, WITH, WITHOUT, copy_without_counters, faults, measure
from tracer.frame import Settings
from tracer.runtime.kernel_cache import cache_root
from viewer.util.resources import embedded_scenes


def test_the_lines_that_count_are_taken_out_and_nothing_else(tmp_path: Path) -> None:
    copy, counting = copy_without_counters(ROOT, tmp_path), Counter[str]()
    for path in sorted((ROOT / "tracer").rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        before, after = path.read_text().splitlines(), (copy / name).read_text().splitlines()
        compile("\n".join(after), name, "exec")
        if before != after:
            changed = [line for line in difflib.ndiff(before, after) if line[:2] in ("- ", "+ ")]
            assert all("steps" in line or "STEPS" in line or "TESTS" in line for line in changed if line[0] == "-"), (
                name
            )
            assert name == "tracer/geometry/kdtree/tree.py" or not any(line[0] == "+" for line in changed), name
            counting[name.split("/")[1]] += len(changed)
    assert set(counting) == {"geometry", "culling", "visibility", "neighbours", "methods"} and counting.total() > 40


@pytest.mark.parametrize("line", ["    counts[TESTS] = 2", "    steps = 1\n    steps = 1"])
def test_sources_that_count_otherwise_are_refused(tmp_path: Path, line: str) -> None:
    tree = tmp_path / "sources" / "tracer" / "geometry" / "kdtree" / "tree.py"
    tree.parent.mkdir(parents=True)
    tree.write_text((ROOT / "tracer/geometry/kdtree/tree.py").read_text() + f"\n\ndef f(counts):\n{line}\n")
    with pytest.raises(ValueError, match="tree.py"):
        copy_without_counters(tmp_path / "sources", tmp_path / "copy")


def test_two_equal_tracers_render_the_same_and_are_found_out() -> None:
    """Both with counters, as if nothing had been taken out."""
    trees = {name: (ROOT, cache_root()) for name in (WITH, WITHOUT)}
    result = measure(trees, embedded_scenes()["figure4"], Settings(32, 32, 2, threads=1), frames=3, start=30)
    counted, uncounted = (result["results"][name] for name in (WITH, WITHOUT))
    assert result["frames"] == [30, 33]
    assert len(counted) == len(uncounted) == 3
    assert [r["digest"] for r in counted] == [r["digest"] for r in uncounted]
    assert len({r["digest"] for r in counted}) == 3
    assert all(0 < r["statistics"]["seconds"] <= r["seconds"] for r in counted)
    assert len(result["faults"]) == 3 and all("were counted" in fault for fault in result["faults"])


def test_another_picture_is_a_fault() -> None:
    work = {"traversal_steps": 1, "intersection_tests": 1}
    none = dict.fromkeys(work, 0)
    counted = {"digest": "a", "statistics": {"primary": work, "secondary": none, "shadow": none}}
    uncounted = {"digest": "a", "statistics": dict.fromkeys(("primary", "secondary", "shadow"), none)}
    assert faults({WITH: [counted], WITHOUT: [uncounted]}, 7) == []
    (fault,) = faults({WITH: [counted], WITHOUT: [uncounted | {"digest": "b"}]}, 7)
    assert fault.startswith("frame 7:")
    assert faults({WITH: [uncounted], WITHOUT: [uncounted]}, 7)
    assert faults({WITH: [], WITHOUT: []}, 7)

"""What counters cost: the counters are really out, of nothing else but them, and the comparison is watched."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest

from tests.bench.counters import EDITS, ROOT, WITH, WITHOUT, copy_without_counters, faults, measure
from tracer.frame import Settings
from tracer.runtime.kernel_cache import cache_root
from viewer.util.resources import embedded_scenes

TRAVERSE, TREE = "tracer/geometry/kdtree/traverse.py", "tracer/geometry/kdtree/tree.py"
PACKET, SINGLE = "tracer/geometry/bvh8/packet_tree.py", "tracer/geometry/bvh8/single_ray.py"
STREAM = "tracer/geometry/bvh8/stream.py"
CACHE, LOOKUP = "tracer/culling/occluder_cache.py", "tracer/neighbours/certified/lookup.py"
CERTIFY = "tracer/visibility/search.py"
WALKED, LAMPS = "tracer/visibility/tree_walk.py", "tracer/neighbours/area_lights/area_light_query.py"
HIDERS, REGIONS = "tracer/neighbours/area_lights/recent_occluders.py", "tracer/visibility/hidden_lights.py"
ASKED, BUFFERS = "tracer/neighbours/lightbuffer/candidates.py", "tracer/neighbours/lightbuffer/lookup.py"
LAZY, GRID = "tracer/geometry/lazy_tree/traverse.py", "tracer/methods/voxels.py"
WALK, CLASSIFY = "tracer/neighbours/voxels/walk.py", "tracer/visibility/box_candidates.py"
CELLS, ASK_LIST = "tracer/neighbours/environments/ask.py", "tracer/visibility/ask_list.py"
SOURCES = (
    *(TRAVERSE, TREE, PACKET, SINGLE, STREAM, CACHE, LOOKUP, CERTIFY, WALKED, LAMPS, HIDERS, REGIONS),
    *(ASKED, BUFFERS, LAZY, GRID, WALK, CLASSIFY, CELLS, ASK_LIST),
)


def test_the_lines_that_count_are_taken_out_and_nothing_else(tmp_path: Path) -> None:
    copy = copy_without_counters(ROOT, tmp_path)
    changed = {}
    for path in sorted((ROOT / "tracer").rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        before, after = path.read_text().splitlines(), (copy / name).read_text().splitlines()
        compile("\n".join(after), name, "exec")
        if before != after:
            changed[name] = [line for line in difflib.ndiff(before, after) if line[:2] in ("- ", "+ ")]
    assert set(changed) == set(SOURCES)
    for file, lines in ((TRAVERSE, 1), (LAZY, 3)):
        assert len(changed[file]) == lines and all("s.counts[" in line for line in changed[file])
    assert len(changed[GRID]) == 1 and "counted[STEPS]" in changed[GRID][0]
    assert len(changed[TREE]) == 7 and all(
        "steps" in line or "s.counts[" in line for line in changed[TREE] if line[0] == "-"
    )
    counted = {
        PACKET: 5,
        SINGLE: 4,
        STREAM: 5,
        CACHE: 1,
        LOOKUP: 1,
        CERTIFY: 1,
        WALKED: 2,
        LAMPS: 2,
        HIDERS: 1,
        REGIONS: 2,
        ASKED: 1,
        BUFFERS: 3,
        WALK: 1,
        ASK_LIST: 2,
        CLASSIFY: 1,
        CELLS: 1,
    }
    for file, lines in counted.items():
        assert len(changed[file]) == lines and all(line[2:].lstrip().startswith("counts[") for line in changed[file])


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit.text.strip())
def test_sources_that_count_otherwise_are_refused(tmp_path: Path, edit) -> None:
    for file in SOURCES:
        (tmp_path / "sources" / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "sources" / file).write_text((ROOT / file).read_text())
    altered = tmp_path / "sources" / edit.file
    altered.write_text(altered.read_text().replace(edit.text, edit.text.replace("s", "z"), 1))
    with pytest.raises(ValueError, match=Path(edit.file).name):
        copy_without_counters(tmp_path / "sources", tmp_path / "copy")


def test_another_way_of_counting_is_refused(tmp_path: Path) -> None:
    for file in SOURCES:
        (tmp_path / "sources" / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "sources" / file).write_text((ROOT / file).read_text())
    (tmp_path / "sources" / "tracer" / "more.py").write_text("def f(counts):\n    counts[TESTS] += 2\n")
    with pytest.raises(ValueError, match="more.py"):
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

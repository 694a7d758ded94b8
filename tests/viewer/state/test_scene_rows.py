"""The tables of objects and primitives hold what a loop over pixels and primitives finds."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.fakes import in_cells, make_frame, make_scene, triangles
from tracer.editing.edits import Edited, Edits, edited
from tracer.frame import Settings
from tracer.scene.model import CONE, Quadrics, SceneObject, Texture, empty_quadrics
from viewer.state.parts import KINDS, parts_of
from viewer.state.row_filter import FilterError, Order, listed, matching
from viewer.state.scene_rows import NOTHING, Level, Table, Values, tables_of

RECORDED = Settings(width=16, height=8, verify=True, record_work=True)


@pytest.fixture(scope="module")
def now() -> Edited:
    """Static parts that are not in the order of their primitives, a cone, a texture, and two objects that move."""
    scene = make_scene()
    static, train = scene.objects
    t, q = static.triangles, static.quadrics
    textured = replace(t, texture=np.array([0, -1, 0, -1], np.int32))
    cone = Quadrics(np.array([CONE], np.int32), q.to_object, q.radii, q.inside, q.material)
    parts = np.array([1, 0, 1, 0, 2], np.int32)
    first = replace(static, triangles=textured, quadrics=cone, parts=("Wall", "floor", "left lamp"), part_of=parts)
    last = SceneObject("train", triangles(0), empty_quadrics(), train.chain)
    oak = Texture("oak", np.zeros((1, 1, 3), np.uint8))
    return edited(replace(scene, objects=(first, train, last), textures=(oak,)), Edits())


@pytest.fixture(scope="module")
def tables(now: Edited) -> dict[Level, Table]:
    return tables_of(now, make_frame(RECORDED), 0)


def column(table: Table, name: str) -> list[str]:
    return [table.cell(name, row) for row in range(table.rows)]


def test_parts_are_those_that_hold_the_primitives(now: Edited) -> None:
    parts = parts_of(now.original)
    assert parts.names == ("Wall", "floor", "left lamp", "train")
    assert [parts.names[part] for part in parts.part_of] == [now.thing_of(p).name for p in range(7)]
    assert [KINDS[kind] for kind in parts.kind] == ["triangle"] * 6 + ["cone"]
    assert parts.sizes.tolist() == [2, 2, 1, 2] and parts.moving.tolist() == [False, False, False, True]
    assert parts_of(now.original) is parts


def test_rays_of_pixels_that_are_not_shaded_yet_are_nobodys(now: Edited) -> None:
    frame = make_frame(RECORDED)
    shaded = np.indices(frame.primitive.shape)[1] % 2 == 0
    none = {name: np.where(shaded, getattr(frame, name), 0) for name in ("due_rays", "saved", "wrong")}
    partly, counted = (tables_of(now, one, 0) for one in (replace(frame, shaded=shaded), replace(frame, **none)))
    for level in Level:
        for name in ("due", "saved", "wrong"):
            assert column(partly[level], name) == column(counted[level], name), (level, name)


def test_rows_count_what_each_pixel_says(now: Edited, tables: dict[Level, Table]) -> None:
    frame, total = make_frame(RECORDED), now.original.primitive_count
    counted: dict[str, Counter] = {name: Counter() for name in ("pixels", "due", "saved", "wrong")}
    for y, x in np.ndindex(frame.primitive.shape):
        primitive = int(frame.primitive[y, x])
        for name, buffer in (("due", frame.due_rays), ("saved", frame.saved), ("wrong", frame.wrong)):
            counted[name][primitive] += int(buffer[y, x])
        counted["pixels"][primitive] += 1
    parts = parts_of(now.original)
    for name, counts in counted.items():
        found = tables[Level.PRIMITIVES].columns[name].numbers
        assert found.tolist() == [counts[p] for p in range(total)], name
        by_part = [sum(counts[p] for p in parts.primitives_of(part).tolist()) for part in range(4)]
        assert tables[Level.OBJECTS].columns[name].numbers.tolist() == by_part, name
    assert sum(counted["wrong"].values()) == 3
    assert sorted(column(tables[Level.PRIMITIVES], "share")) == [NOTHING] * 5 + ["50.0 %"] * 2
    nothing = tables_of(now, replace(frame, primitive=np.full_like(frame.primitive, -1)), 0)[Level.PRIMITIVES]
    assert set(column(nothing, "pixels")) == {"0"} and set(column(nothing, "share")) == {NOTHING}


def test_modes_are_those_of_the_chosen_light(now: Edited, tables: dict[Level, Table]) -> None:
    primitives, objects = tables[Level.PRIMITIVES], tables[Level.OBJECTS]
    assert column(primitives, "occlusion")[:4] == ["init", "partially occluded"] + ["fully rendered"] * 2
    assert column(primitives, "shadow")[2:4] == ["full shadow", "non-shadow"]
    other = column(tables_of(now, make_frame(RECORDED), 1)[Level.PRIMITIVES], "shadow")
    assert other[2:4] == ["non-shadow", "partial shadow"]
    assert column(objects, "full_shadow") == ["0", "1", "0", "0"]
    assert column(objects, "rendered") == ["1", "1", "1", "0"]
    none = tables_of(now, make_frame(replace(RECORDED, modes=False, method="none")), 0)[Level.PRIMITIVES]
    assert none.columns["occlusion"] is None and column(none, "occlusion") == [NOTHING] * 7


def test_modes_of_cells_are_those_of_all_that_are_seen(now: Edited) -> None:
    frame = in_cells(make_frame(RECORDED))
    only_even = replace(frame, primitive=np.where(frame.cells % 2 == 0, frame.primitive, -1))
    unseen = replace(frame, primitive=np.where(frame.primitive == 2, -1, frame.primitive))
    frames = frame, only_even, unseen
    all_cells, even, without = (column(tables_of(now, one, 0)[Level.PRIMITIVES], "shadow") for one in frames)
    assert all_cells == ["several"] * 7, "each has cells of two kinds"
    assert even[2:4] == ["full shadow", "non-shadow"] and without[2] == NOTHING


def test_rows_keep_their_numbers_where_things_are_hidden(now: Edited) -> None:
    """A frame of the edited scene has other numbers."""
    edits = Edits(hidden=frozenset({"Wall"}), hidden_primitives=frozenset({4}))
    other = edited(now.original, edits)
    frame = make_frame(RECORDED)
    left = other.primitives.tolist()
    assert left == [0, 2, 5, 6]
    few = replace(frame, primitive=np.where(frame.primitive < 4, frame.primitive, -1), modes=frame.modes[[3, 3, 3, 3]])
    table = tables_of(other, few, 0)[Level.PRIMITIVES]
    assert table.rows == 7
    pixels = Counter(left[p] for p in few.primitive.ravel().tolist() if p >= 0)
    assert table.columns["pixels"].numbers.tolist() == [pixels[p] for p in range(7)]
    assert column(table, "hidden") == ["shown", "hidden", "shown", "hidden", "hidden", "shown", "shown"]
    assert [said == NOTHING for said in column(table, "shadow")] == [p not in left for p in range(7)]
    assert np.flatnonzero(matching(table, "is:hidden")).tolist() == [1, 3, 4]


def test_rows_are_sorted_both_ways_and_what_is_not_known_comes_last() -> None:
    names = Values(np.arange(4, dtype=np.int32), tuple("dCaB"))
    table = Table(Level.PRIMITIVES, 4, {"pixels": Values(np.array([3, 1, 2, 1])), "object": names})
    assert listed(table, Order(column="pixels")).tolist() == [1, 3, 2, 0]
    assert listed(table, Order(column="pixels", descending=True)).tolist() == [0, 2, 1, 3]
    assert listed(table, Order(column="object")).tolist() == [2, 3, 1, 0], "capitals come where their letters do"
    words = Values(np.array([-1, 1, 0]), ("a", "b"))
    with_none = Table(table.level, 3, {"share": Values(np.array([np.nan, 5.0, 7.0])), "texture": words})
    for name, descending in itertools.product(("share", "texture"), (False, True)):
        assert listed(with_none, Order(column=name, descending=descending))[-1] == 0, name


# --- what is typed above them ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("objects L", [0, 1, 2]), ('objects object="left lamp"', [2]), ("objects primitives>1 -is:dynamic", [0, 1]),
        ("", [0, 1, 2, 3, 4, 5, 6]), ("WALL", [1, 3]), ("4", [4]), ("wall floor", []), ('"left lamp"', [6]),
        ('object="left lamp"', [6]), ("object=lamp", []), ("-object:wall -train", [0, 2, 6]), ("cone", [6]),
        ("kind:triangle number>=4", [4, 5]), ("number:1-3", [1, 2, 3]), ("-number:3 number<5", [0, 1, 2, 4]),
        ("oak", [0, 2]), ("texture:oak number>0", [2]), ("shadow:full_shadow", [2]), ("occlusion:fully", [2, 3, 6]),
        ("shadow:non", [3]), ("occlusion:dynamic", [4, 5]), ("is:dynamic", [4, 5]), ("share>=50%", [1, 2]),
        ("is:wrong", [1, 2]), ("wrong>1", [2]), ("-is:seen", []), ("is:hidden", []),
        ("material:brick pixels>15", [0, 1, 2, 3, 4, 5, 6]),
    ],
)  # fmt: skip
def test_filters_find_rows(tables: dict[Level, Table], text: str, rows: list[int]) -> None:
    level = Level.OBJECTS if text.startswith("objects ") else Level.PRIMITIVES
    assert np.flatnonzero(matching(tables[level], text.removeprefix("objects "))).tolist() == rows


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("pixel>3", "do you mean pixels?"),
        ("weight>3", "there are number, object"),
        ("pixels>many", "many is no number"),
        ("pixels>", "needs a value"),
        ("object>3", "object:3"),
        ("shadow:lit", "full shadow"),
        ("shadow:fully", "no mode is called fully"),
        ("is:green", "is:green is not known"),
        ("is:wrong", "known while frames are verified"),
        ("saved>1", "not counted yet"),
    ],
)
def test_what_is_not_understood_or_not_known_is_told_in_one_line(now: Edited, text: str, said: str) -> None:
    with pytest.raises(FilterError, match=said.replace("?", r"\?")) as told:
        matching(tables_of(now, make_frame(), 0)[Level.PRIMITIVES], text)
    assert "\n" not in str(told.value)

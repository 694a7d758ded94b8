"""Studies: what a file asks for, and what is said of one that is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.commands import ROOM
from tracer.experiments.study import Study, StudyError, differences, read_study
from tracer.scene.load import load_scene
from viewer.util.resources import embedded_scenes

GOOD = """\
# A comment, with methods = [3] in it
scenes = ["room.aff", "default"]
methods = [
    "none",
    "paper",
    "certified",
]
sizes = ["64x48"]
seeds = [1, 2]

[path]
frames = 8
last = 5

[settings]
depth = [2, 10]
verify = true
"""


def read(tmp_path: Path, text: str) -> Study:
    (tmp_path / "room.aff").write_text(ROOM)
    (tmp_path / "study.toml").write_text(text)
    return read_study(tmp_path / "study.toml", embedded_scenes())


def test_a_study_becomes_tasks(tmp_path: Path) -> None:
    study = read(tmp_path, GOOD)
    assert [s.depth for s in study.settings] == [2, 10] and all(s.verify for s in study.settings)
    assert study.settings[0].accelerator == "kdtree", "as in bench"
    tasks = study.tasks("room.aff", load_scene(tmp_path / "room.aff"), "code")
    alone = [task for task in tasks if task.settings.method == "none"]
    assert len(alone) == 2 * 2 * 6 and all(len(task.frames) == 1 for task in alone)
    paths = [task for task in tasks if task.settings.method != "none"]
    assert len(paths) == 2 * 2 * 2 and all(len(task.frames) == 6 for task in paths)
    assert len({task.key for task in tasks}) == len(tasks)
    assert all(task.settings.threads == 1 and task.path_frames == 8 for task in tasks)
    assert study.label("room.aff") == "room"


def test_settings_of_single_methods_vary_too(tmp_path: Path) -> None:
    more = (
        "lightcuts_error = [0.01, 0.1]\nlightcuts_nodes = 50\nlight_buffer_side = 64\nlight_buffer_memory = [2, 8.5]\n"
    )
    study = read(tmp_path, GOOD.replace("depth = [2, 10]", more).replace('"certified"', '"lightcuts"'))
    found = [(s.lightcuts_error, s.lightcuts_nodes, s.light_buffer_side, s.light_buffer_memory) for s in study.settings]
    assert found == [(0.01, 50, 64, 2.0), (0.01, 50, 64, 8.5), (0.1, 50, 64, 2.0), (0.1, 50, 64, 8.5)]
    (task, *_) = study.tasks("room.aff", load_scene(tmp_path / "room.aff"), "code")
    assert task.settings.lightcuts_error == 0.01


def test_changes_are_said(tmp_path: Path) -> None:
    one = read(tmp_path, GOOD).to_json()
    other = read(tmp_path, GOOD.replace('"paper",', '"cells",').replace("frames = 8", "frames = 9")).to_json()
    assert differences(one, other) == ["methods: + cells, - paper", "frames of the path: 8 → 9"]
    assert differences(one, one) == []
    many, others = list(range(100_000)), list(range(1, 100_001))
    assert differences({"seeds": many}, {"seeds": others}) == ["seeds: + 100000, - 0"], "and at once"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"paper"', '"papper"', "line 3: methods: no method 'papper': did you mean 'paper'?"),
        ('"paper"', '"telepathy"', "line 3: methods: no method 'telepathy'; it is one of none"),
        ("depth = [2, 10]", 'accelerator = "grid"', "line 16: settings.accelerator: accelerator is one of bvh8"),
        ("methods = [\n", "method = [\n", "line 3: method: no such key: did you mean 'methods'?"),
        ('"64x48"', '"64*48"', "line 8: sizes: '64*48' is no size; give one such as \"640x480\""),
        ('"64x48"', '"64x0"', "line 8: sizes: height is a whole number from 1"),
        ("frames = 8", 'frames = "8"', "expected a whole number, got text; give a whole number from 1 to"),
        ("last = 5", "lats = 5", "line 13: path.lats: no such key: did you mean 'last'?"),
        ("depth = [2, 10]", "depth = [2, 200]", "line 16: settings.depth: depth is a whole number from 0"),
        ("depth = [2, 10]", "zoom_factor = 0.5", "line 16: settings.zoom_factor: zoom_factor is a number"),
        ("depth = [2, 10]", "depth = []", "a list of length >= 1; give a whole number from 0 to 100, or"),
        ("verify = true", "lightcut_error = 0.1", "settings.lightcut_error: no such key: did you mean 'lightcuts_err"),
        ("verify = true", "verify = 1", "line 17: settings.verify: expected true or false or a list, got a whole"),
        ('"default"', '"defautl"', "line 2: scenes: no file"),
        ('"default"', '"room.aff"', "line 2: scenes: 'room.aff' is given twice"),
        ("seeds = [1, 2]", "seeds = 1", "line 9: seeds: expected a list, got a whole number"),
        ("seeds = [1, 2]", "seeds = [1, 2", "not TOML: "),
        ("seeds = [1, 2]", f"seeds = {'[' * 5000}{']' * 5000}", "its values are nested too deeply"),
        ("seeds = [1, 2]", f"a{'.a' * 50_000} = 1", "its values are nested too deeply"),
        ('"default"', f'"{"x" * 5000}"', "line 2: scenes: no file "),
        ("[path]\nframes = 8\nlast = 5", "path = 3", "line 11: path: expected a table, got a whole number"),
        ("sizes =", 'sizes = ["1x1"]\nsizes =', "line 9, column"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in GOOD
    with pytest.raises(StudyError) as caught:
        read(tmp_path, GOOD.replace(old, new, 1))
    assert message in str(caught.value) and str(tmp_path / "study.toml") in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_keys_and_frames(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="no scenes; give a list"):
        read(tmp_path, 'methods = ["none"]\n')
    with pytest.raises(OSError, match=r"elsewhere\.toml: no such file; check the path"):
        read_study(tmp_path / "elsewhere.toml", embedded_scenes())
    with pytest.raises(OSError, match=r"studdy\.toml: no such file: did you mean '.*study\.toml'\?"):
        read_study(tmp_path / "studdy.toml", embedded_scenes())
    study = read(tmp_path, GOOD.replace("last = 5", "last = 8"))
    with pytest.raises(ValueError, match="the frames 0 to 8 are not all of room.aff, whose path has 8"):
        study.tasks("room.aff", load_scene(tmp_path / "room.aff"), "code")


def test_what_would_fill_the_memory_is_refused_in_one_line(tmp_path: Path) -> None:
    """Of 100,000 seeds it is found at once which is given twice, and 300 times a million frames make no tasks."""
    seeds = [*range(100_000), 7]
    with pytest.raises(StudyError, match="line 9: seeds: 7 is given twice"):
        read(tmp_path, GOOD.replace("seeds = [1, 2]", f"seeds = {seeds}"))
    long = GOOD.replace("seeds = [1, 2]", f"seeds = {seeds[:300]}").replace("frames = 8\nlast = 5", "frames = 1000000")
    study = read(tmp_path, long)
    with pytest.raises(ValueError, match=r"frames of room.aff, by methods, settings and 300 seeds; at most 1,000,000"):
        study.tasks("room.aff", load_scene(tmp_path / "room.aff"), "code")

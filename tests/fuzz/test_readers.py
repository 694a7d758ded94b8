"""A short run of the fuzzer: `make fuzz` goes on for longer."""

from __future__ import annotations

import pytest

from tests.fuzz.readers import attempt, attempt_fields, case
from tests.fuzz.seeds import seeds, write_beside
from tests.sweeps import examples


@pytest.fixture(scope="module")
def files():
    return seeds()


@pytest.mark.parametrize("name", ["a.aff", "a.obj", "a.ply", "b.ply", "c.ply", "a.stl", "b.stl", "a.gltf", "a.glb"])
def test_whole_files_are_read(tmp_path, files, name):
    write_beside(tmp_path)
    (tmp_path / name).write_bytes(files[name])
    scene = attempt(tmp_path / name)
    assert scene is not None
    assert scene.primitive_count > 0


@pytest.mark.parametrize("start", range(0, examples(80), 16))
def test_damaged_files_give_a_scene_or_one_line(tmp_path, files, start):
    write_beside(tmp_path)
    for number in range(start, start + 16):
        name, data = case(number, files)
        (tmp_path / name).write_bytes(data)
        attempt(tmp_path / name)


def test_pictures_and_studies_with_changed_fields_give_what_they_hold_or_one_line(tmp_path):
    write_beside(tmp_path)
    kept = [attempt_fields(tmp_path, number) for number in range(examples(60))]
    assert 0 < sum(kept) < len(kept) / 2

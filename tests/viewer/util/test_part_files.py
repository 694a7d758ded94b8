"""Files on their way: those of the living stay, those of the dead go; names are claimed by one at a time."""

from __future__ import annotations

import os
from pathlib import Path
from threading import Timer
from typing import BinaryIO

import pytest

from tests.platforms import posix_only
from viewer.util import part_files
from viewer.util.files import reserved, write_text
from viewer.util.part_files import claimed, part_file, part_name


@posix_only
def test_what_the_dead_have_left_is_removed_and_nothing_else(tmp_path: Path) -> None:
    dead = part_name(tmp_path / "a.png", "0123456789abcdef")
    dead.write_bytes(b"half")
    others = [tmp_path / name for name in (".a.png.part", "a.0123456789abcdef.part", ".a.0123456789abcdeg.part")]
    for other in others:
        other.touch()
    part_files._cleared.discard(str(tmp_path))
    with part_file(tmp_path / "b.png") as (living, _):
        part_files._cleared.discard(str(tmp_path))
        write_text(tmp_path / "c.txt", "whole")
        assert living.exists() and not dead.exists()
    assert sorted(tmp_path.iterdir()) == sorted([*others, tmp_path / "c.txt"])


def test_a_name_is_claimed_by_one_at_a_time(tmp_path: Path) -> None:
    with reserved(tmp_path, "room", ".png") as first, reserved(tmp_path, "room", ".png") as second:
        assert (first.name, second.name) == ("room.png", "room-2.png")
        assert not first.exists() and not second.exists(), "nobody sees a file before it is whole"
        write_text(second, "")
    assert [path.name for path in tmp_path.iterdir()] == ["room-2.png"]
    with claimed(first) as mine, claimed(first, patience=0.05) as others:
        assert mine and not others


@posix_only
def test_what_the_dead_have_claimed_is_free(tmp_path: Path) -> None:
    read, told = os.pipe()
    child = os.fork()
    if child == 0:
        with claimed(tmp_path / "room.png"):
            os.write(told, b"x")
            os.close(read)
            os._exit(9)
    os.close(told)
    assert os.read(read, 1) == b"x"
    os.waitpid(child, 0)
    os.close(read)
    assert len(list(tmp_path.iterdir())) == 1
    with reserved(tmp_path, "room", ".png") as path:
        assert path.name == "room.png"


@posix_only
def test_a_name_that_somebody_only_looks_at_is_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who clears the folder meets a claim that is not locked yet, and takes it for one of the dead."""
    fcntl, looked = part_files.fcntl, list[Path]()
    lock = fcntl.flock

    def remove(other: BinaryIO) -> None:
        looked[0].unlink()
        other.close()

    def flock(file: BinaryIO, how: int) -> None:
        if not looked:
            looked.append(Path(file.name))
            other = looked[0].open("rb")
            lock(other, fcntl.LOCK_EX)
            Timer(0.05, remove, [other]).start()
        lock(file, how)

    monkeypatch.setattr(fcntl, "flock", flock)
    with reserved(tmp_path, "room", ".png") as path:
        assert looked and path.name == "room.png"


@pytest.mark.parametrize("name", ["é" * 120 + ".png", "室" * 80 + ".png"])
def test_long_names_have_room_for_what_hides_them(tmp_path: Path, name: str) -> None:
    write_text(tmp_path / name, "whole")
    assert (tmp_path / name).read_text() == "whole"

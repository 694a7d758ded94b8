"""Files that commands and the window write, several at once too."""

from __future__ import annotations

import os
import threading
from argparse import Namespace
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime
from pathlib import Path

import pytest

from tests.platforms import linux_only, posix_only
from viewer.output import exports
from viewer.util import files
from viewer.util.files import check_writable, file_lock, whole_file, write_new, write_text, write_whole


def test_a_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    write_text(path, "old")

    def fail(file) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match=r"out\.txt: not written: No space left on device"):
        write_whole(path, fail)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_others_may_read_what_was_written_as_any_file(tmp_path: Path) -> None:
    (tmp_path / "any").touch()
    write_text(tmp_path / "written", "")
    assert (tmp_path / "written").stat().st_mode == (tmp_path / "any").stat().st_mode


def test_files_saved_in_one_second_each_have_a_name(tmp_path: Path) -> None:
    """All are being written before the first has its name."""
    now, many = datetime(2024, 5, 31, 14, 5, 9), 4
    begun = threading.Barrier(many, timeout=30.0)

    def save(number: int) -> Path:
        def write(path: Path) -> None:
            begun.wait()
            assert not [found for found in tmp_path.iterdir() if not found.name.startswith(".")], "none is seen half"
            begun.wait()
            write_text(path, str(number))

        return exports.save(tmp_path, "room", ".csv", write, now)

    with ThreadPoolExecutor(many) as threads:
        paths = list(threads.map(save, range(many)))
    assert [path.read_text() for path in paths] == [str(number) for number in range(many)]
    assert sorted(tmp_path.iterdir()) == sorted(paths)


@pytest.mark.parametrize("error", [OSError, ValueError, RuntimeError])
def test_a_failure_names_the_file_that_was_wanted_and_leaves_none(tmp_path: Path, error: type[Exception]) -> None:
    def fail(path: Path) -> None:
        raise error(f"{path}: the disk is full" if error is OSError else "nothing to plot")

    with pytest.raises(error, match=r"/room-.*\d\.csv: the disk is full$|^nothing to plot$"):
        exports.save(tmp_path, "room", ".csv", fail)
    assert list(tmp_path.iterdir()) == []


def test_no_file_takes_the_others_along(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []

    def write(results: object, path: Path, kind: str) -> None:
        if kind != "plot":
            raise {"json": ValueError("nothing"), "csv": OSError("full")}[kind]
        done.append(kind)

    monkeypatch.setattr(exports, "write", write)
    wanted = {kind: tmp_path / kind for kind in ("json", "csv", "plot")}
    assert exports.write_files(None, wanted) == ["nothing", "full"] and done == ["plot"]


def test_a_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    target, link, dangling = tmp_path / "results" / "a.json", tmp_path / "link.json", tmp_path / "dangling.json"
    target.write_text("old")
    link.symlink_to(target)
    dangling.symlink_to("results/b.json")
    for path in (link, dangling):
        check_writable(path)
        write_text(path, "new")
        assert path.is_symlink() and path.resolve().parent == target.parent
    assert sorted(p.name for p in target.parent.iterdir()) == ["a.json", "b.json"]
    assert target.read_text() == (target.parent / "b.json").read_text() == "new"


def test_two_names_of_one_file_are_not_two_files(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("file")
    with pytest.raises(ValueError, match="--json, --csv: give each a file of its own"):
        exports.wanted_files(Namespace(json=tmp_path / "file", csv=tmp_path / "link", plot=None))


@posix_only
@pytest.mark.parametrize("linked", [False, True])
def test_what_is_no_regular_file_is_refused_and_stays(tmp_path: Path, linked: bool) -> None:
    path = pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    if linked:
        path = tmp_path / "link"
        path.symlink_to(pipe)
    for write in (check_writable, lambda path: write_text(path, "new")):
        with pytest.raises(OSError, match="a device, a pipe or a socket"):
            write(path)
    assert pipe.is_fifo() and path.is_symlink() == linked


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("-", "not written to standard output"),
        pytest.param("/dev/full", "a device", marks=linux_only),
        pytest.param("/proc/x", "/proc cannot be written to", marks=linux_only),
        ("loop", "cannot be written: "),
        ("away", "there is no folder .*gone"),
        pytest.param("a" * 300, "cannot be written: File name too long", marks=posix_only),
    ],
)
def test_what_cannot_be_written_is_said_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("loop").symlink_to("loop")
    Path("away").symlink_to("gone/file")
    with pytest.raises(OSError, match=said) as error:
        check_writable(Path(path))
    assert "\n" not in str(error.value)


# --- files on their way ------------------------------------------------------------------------------


@posix_only
def test_what_killed_writers_have_left_is_removed_and_nothing_else(tmp_path: Path) -> None:
    child = os.fork()
    if child == 0:
        files._part_name(tmp_path / "a.png").write_bytes(b"half")
        os._exit(9)
    os.waitpid(child, 0)
    (dead,) = tmp_path.iterdir()
    others = [tmp_path / name for name in (".a.png.part", "a.00000000-1-00000000.part", ".a.00000000-1-00000000.part")]
    for other in others:
        other.touch()
    with whole_file(tmp_path / "b.png") as (living, _):
        files._cleared.discard(str(tmp_path))
        write_text(tmp_path / "c.txt", "whole")
        assert living.exists() and not dead.exists()
    assert sorted(tmp_path.iterdir()) == sorted([*others, tmp_path / "b.png", tmp_path / "c.txt"])


def test_a_folder_without_links_takes_files_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", refused)
    names = [write_new(tmp_path, "room", ".png", lambda path: write_text(path, "")).name for _ in range(2)]
    assert names == ["room.png", "room-2.png"] and len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("name", ["é" * 120 + ".png", "室" * 80 + ".png"])
def test_long_names_have_room_for_what_hides_them(tmp_path: Path, name: str) -> None:
    write_text(tmp_path / name, "whole")
    assert (tmp_path / name).read_text() == "whole"


def test_a_lock_is_had_by_one_at_a_time(tmp_path: Path) -> None:
    with file_lock(tmp_path / "a.json", 0.0) as mine, file_lock(tmp_path / "a.json", 0.05) as others:
        assert mine and not others
    with file_lock(tmp_path / "a.json", 0.0) as again:
        assert again

"""Injects what machines do to programs: kills, full disks, folders that may only be read, several programs at once.

    python -m tests.fuzz.faults --kills 300 --seed 0

Prints what was tried and what failed, and returns 1 if anything did.  File systems are mounted where that is allowed,
as for root; without that, the lines about disks say so.
"""

from __future__ import annotations

import argparse
import errno
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np

from tests.fuzz import kernel_kills
from tests.fuzz.kills import Written, forked, kill_often
from tests.fuzz.written import WRITTEN
from viewer.services.settings_controller import SettingsController
from viewer.state.notices import Notices
from viewer.state.preferences import SETTINGS_FILE, load_preferences
from viewer.state.session import Session

SCENE = "/scenes/room.aff"
NO_ROOM = (os.strerror(errno.ENOSPC), "is the disk full?")
READ_ONLY = os.strerror(errno.EROFS)


@dataclass
class Line:
    """A row of the table: what was tried how often, how many failed, and the first failure."""

    what: str
    tried: int
    failed: int
    first: str = ""


class NotAllowed(Exception):
    """This user may not mount file systems."""


@contextmanager
def small_disk(megabytes: float) -> Iterator[Path]:
    """A file system of its own.  Raises NotAllowed."""
    folder = Path(tempfile.mkdtemp(prefix="shadowcull-disk-"))
    command = ["mount", "-t", "tmpfs", "-o", f"size={int(megabytes * 1024)}k", "tmpfs", str(folder)]
    try:
        if not shutil.which("mount") or subprocess.run(command, capture_output=True).returncode:
            raise NotAllowed
        try:
            yield folder
        finally:
            subprocess.run(["umount", "-l", str(folder)], check=True)  # what PyAV leaves open ends with the process
    finally:
        folder.rmdir()


def kills(written: Written, number: int, rng: np.random.Generator) -> Line:
    with tempfile.TemporaryDirectory() as folder:
        outcome = kill_often(written, Path(folder), number, rng)
    return Line(f"killed: {written.name}", outcome.kills, outcome.broken + outcome.litter, outcome.first)


def full_disk(written: Written, rng: np.random.Generator, times: int = 12) -> Line:
    """Write over something on a disk that has room for a part of it at most: the old file stays whole, one line
    says why, and nothing is left."""
    line = Line(f"disk full: {written.name}", 0, 0)
    with small_disk(8) as disk:
        for _ in range(times):
            written.write(disk, 1)
            size = sum(path.stat().st_size for path in disk.iterdir())
            room = int(rng.uniform(0.0, 0.9) * size)
            filling = disk / "filling"
            _fill(filling, shutil.disk_usage(disk).free - room)
            line.tried += 1
            try:
                written.write(disk, 2)
                wrong = "nothing was said"
            except Exception as error:
                said = str(error)
                wrong = "" if any(word in said for word in NO_ROOM) and "\n" not in said else repr(error)
            wrong = wrong if written.tells else ""
            filling.unlink()
            try:
                written.check(disk)
            except Exception as error:
                wrong = repr(error)
            if left := [path.name for path in disk.iterdir() if path.name.startswith(".")]:
                wrong = f"left behind: {left[0]}"
            line.failed += bool(wrong)
            line.first = line.first or wrong
            for path in disk.iterdir():
                path.unlink()
    return line


def _fill(path: Path, size: int) -> None:
    with path.open("wb") as file:
        file.write(bytes(max(size, 0)))


def read_only(written: Written) -> Line:
    """Write where nothing may be written: one line says so."""
    line = Line(f"read-only: {written.name}", 1, 0)
    wrong = ""
    with small_disk(8) as disk:
        written.write(disk, 1)
        subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
        try:
            written.write(disk, 2)
            wrong = "nothing was said" if written.tells else ""
        except AssertionError as error:
            wrong = "" if READ_ONLY in str(error) else repr(error)
        except Exception as error:
            wrong = (
                "" if READ_ONLY in str(error) and "\n" not in str(error) and ".part" not in str(error) else repr(error)
            )
    line.failed, line.first = int(bool(wrong)), wrong
    return line


def bookmarks_at_once(writers: int = 4, marks: int = 40) -> Line:
    """Let several windows add bookmarks to one scene at once: all are kept."""
    with tempfile.TemporaryDirectory() as folder:
        children = [forked(lambda who=who: _add_bookmarks(Path(folder), who, marks)) for who in range(writers)]  # type: ignore[misc]
        failed = [child for child in children if os.waitpid(child, 0)[1]]
        stored = json.loads((Path(folder) / SETTINGS_FILE).read_text())["bookmarks"][SCENE]
    lost = {f"{who}-{mark}" for who in range(writers) for mark in range(marks)} - {mark["name"] for mark in stored}
    said = f"{len(failed)} windows failed" if failed else f"lost: {sorted(lost)[0]}" if lost else ""
    return Line(f"bookmarks of {writers} windows at once", writers * marks, len(lost) + len(failed), said)


def _add_bookmarks(folder: Path, who: int, marks: int) -> None:
    os.environ["SHADOWCULL_CONFIG_DIR"] = str(folder)
    preferences, problem = load_preferences()
    assert problem is None, problem
    notices = Notices()
    settings = SettingsController(Session(), preferences, notices, lambda: False)
    rng = np.random.default_rng(who)
    for mark in range(marks):
        preferences.bookmarks.setdefault(SCENE, []).append({"name": f"{who}-{mark}", "state": {}})
        settings.finish()
        assert notices.message is None, notices.message
        time.sleep(float(rng.uniform(0.0, 0.01)))


def kernel_cache_kills(number: int, rng: np.random.Generator) -> Line:
    tried, failed, first = kernel_kills.kill_often(number, rng)
    return Line("killed: the cache of kernels", tried, failed, first)


def attacks(number: int, seed: int) -> dict[str, Callable[[], Line]]:
    """By name; each has a generator of its own, so that one is the same without the others."""

    def rng(which: int) -> np.random.Generator:
        return np.random.default_rng([seed, which])

    found: dict[str, Callable[[], Line]] = {}
    for which, written in enumerate(WRITTEN):
        found[f"killed: {written.name}"] = partial(kills, written, number, rng(which))
    found["killed: kernels"] = partial(kernel_cache_kills, max(number // 5, 10), rng(100))
    found["windows at once"] = bookmarks_at_once
    for which, written in enumerate(WRITTEN):
        found[f"disk full: {written.name}"] = partial(full_disk, written, rng(200 + which))
        found[f"read-only: {written.name}"] = partial(read_only, written)
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description="kill programs that write, and fill their disks")
    parser.add_argument("--kills", type=int, default=200, help="of each kind of file")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="what the name of an attack must contain")
    given = parser.parse_args()
    lines: list[Line] = []
    for name, attack in attacks(given.kills, given.seed).items():
        if given.only not in name:
            continue
        try:
            lines.append(attack())
        except NotAllowed:
            print("not tried, as this user may not mount file systems: full and read-only disks")
            break
        line = lines[-1]
        print(f"{line.what:42} {line.tried:5} tried {line.failed:5} failed  {line.first[:120]}", flush=True)
    kept = Path("build") / "faults"
    kept.mkdir(parents=True, exist_ok=True)
    (kept / "faults.json").write_text(json.dumps([asdict(line) for line in lines], indent=1))
    return 1 if any(line.failed for line in lines) else 0


if __name__ == "__main__":
    sys.exit(main())

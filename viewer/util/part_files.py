"""Files that are still being written: hidden, beside what they become, and locked for as long as their writer lives.

So the files of writers that were killed are told apart from those of writers at work, and whoever writes in a folder
next removes them.  Where there are no locks, as on Windows and on some network folders, they stay.
"""

from __future__ import annotations

import hashlib
import os
import re
import secrets
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

_PART = re.compile(r"\..+\.[0-9a-f]{16}\.part", re.DOTALL)
_LONGEST = 200  # bytes of a name that are kept; most systems allow 255 in all
_TRIES = 8  # to claim a name that others remove, or that a network says is there and is not
_POLL = 0.02  # seconds from one look at a lock to the next

_cleared: set[str] = set()


@contextmanager
def part_file(target: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """A new, empty file beside `target`, open for writing; it is removed at the end unless it has taken another name.

    Raises OSError."""
    _clear(target.parent)
    path, file = _created(target)
    try:
        yield path, file
    finally:
        with suppress(OSError):  # who wanted it on the disk has flushed it
            file.close()
        with suppress(OSError):
            path.unlink(missing_ok=True)


@contextmanager
def claimed(target: Path, patience: float = 0.0) -> Iterator[bool]:
    """Whether nobody else has claimed this name until the end of the block, in any process; waits for others for
    so many seconds.  Raises OSError."""
    path, end = part_name(target, hashlib.blake2b(os.fsencode(target.name), digest_size=8).hexdigest()), 0.0
    while (file := _claim(path)) is None:
        end = end or time.monotonic() + patience
        if time.monotonic() >= end:
            yield False
            return
        time.sleep(_POLL)
    try:
        yield True
    finally:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        file.close()


def part_name(target: Path, token: str) -> Path:
    """A hidden name beside `target`, with 16 hexadecimal digits."""
    return target.with_name(f".{os.fsencode(target.name)[:_LONGEST].decode(errors='ignore')}.{token}.part")


def _created(target: Path) -> tuple[Path, BinaryIO]:
    """A file of a name that nobody else has, locked; tempfile's files would stay the user's own."""
    while True:
        path = part_name(target, secrets.token_hex(8))
        file = path.open("xb")
        if _is_kept(path, file):
            return path, file


def _claim(path: Path) -> BinaryIO | None:
    """The file that claims a name, locked; None if somebody at work has it."""
    for _ in range(_TRIES):
        try:
            file = path.open("xb")
        except FileExistsError:
            with suppress(OSError):
                _remove_if_dead(path)
            if os.path.lexists(path):
                return None
        else:
            if _is_kept(path, file):
                return file
    return None


def _clear(folder: Path) -> None:
    """Remove what killed writers have left in a folder; once for each folder, as it may be a large one."""
    if fcntl is None or str(folder) in _cleared:
        return
    _cleared.add(str(folder))
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(".part") and _PART.fullmatch(entry.name):
                with suppress(OSError):
                    if entry.is_file(follow_symlinks=False):
                        _remove_if_dead(Path(entry.path))


def _remove_if_dead(path: Path) -> None:
    """Raises OSError where its writer lives, or nobody can say."""
    if fcntl is not None:
        with path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(path, file):
                path.unlink()


def _is_kept(path: Path, file: BinaryIO) -> bool:
    """Lock a file that was just made; false, and closed, where somebody took it for one of the dead before.

    Waits for the lock: nobody else keeps one on a new file for longer than it takes to remove it.
    """
    if fcntl is not None:
        with suppress(OSError):  # where there are no locks, nobody asks for them
            fcntl.flock(file, fcntl.LOCK_EX)
    if _is_at(path, file):
        return True
    file.close()
    return False


def _is_at(path: Path, file: BinaryIO) -> bool:
    """Whether an open file still has this name."""
    try:
        return os.path.samestat(path.stat(), os.fstat(file.fileno()))
    except FileNotFoundError:
        return False

"""Files that are whole or absent: checked to be writable before the work, never seen half-written.

A file that is still being written is hidden beside what it becomes.  Its name tells which process writes it, so that
whoever writes in the folder next removes what killed writers have left.
"""

from __future__ import annotations

import os
import re
import secrets
import socket
import stat
import zlib
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

T = TypeVar("T")

MOST_NUMBERS = 100_000
_OF_DEVICES = "/dev"


def check_writable(path: Path) -> None:
    """Raise OSError, in one line, if a file of this path could not be written.

    A file is created beside it and removed again: permissions alone say too little of read-only or full disks.
    """
    if str(path) == "-":
        raise OSError("-: results are not written to standard output; give the name of a file")
    target = _target(path)
    if os.path.realpath(target.parent) == _OF_DEVICES:
        raise OSError(f"{path}: a folder of devices; give a folder for files")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no folder {path.parent if target == path else target.parent}")
    try:
        probe = part_name(target)
        probe.touch(exist_ok=False)
        probe.unlink(missing_ok=True)
    except FileNotFoundError:  # of a folder that is there
        raise OSError(f"{path}: no file can be made in the folder {target.parent}") from None
    except OSError as error:
        raise OSError(f"{path}: the folder {target.parent} cannot be written to: {error.strerror or error}") from None


def check_outputs(outputs: dict[str, Path | None]) -> None:
    """Raise ValueError or OSError where the files of these options cannot all be written; None is not wanted."""
    wanted = {option: path for option, path in outputs.items() if path is not None}
    for path in wanted.values():
        check_writable(path)
    if len({os.path.realpath(path) for path in wanted.values()}) < len(wanted):
        raise ValueError(f"{', '.join(outputs)}: give each a file of its own")


def write_each(writers: Iterable[Callable[[], None]]) -> list[str]:
    """Write all files, and return why some could not be: no OSError or ValueError takes the other files along."""
    failures = []
    for write in writers:
        try:
            write()
        except (OSError, ValueError) as error:
            failures.append(str(error))
    return failures


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Let `write` fill a file that takes its name once it is complete and on the disk; several may at once.

    Links are followed.  Raises OSError in one line, also for what is there and no regular file, and what
    `write` raises, leaving what was there before.
    """
    with whole_file(path) as (_, file):
        write(file)


@contextmanager
def whole_file(path: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """The same, as a block: the name and the open file that take the name `path` at the end of it."""
    target = _target(path)
    try:
        with part_file(target) as (part, file):
            yield part, file
            file.flush()
            os.fsync(file.fileno())
            if os.name == "nt":  # where open files keep their names
                file.close()
            os.replace(part, target)
    except OSError as error:
        raise OSError(f"{path}: not written: {error.strerror or error}") from None


def write_text(path: Path, text: str) -> None:
    """As `write_whole`, in UTF-8."""
    write_whole(path, lambda file: file.write(text.encode()))


def write_bytes(path: Path, data: bytes) -> None:
    """As `write_whole`."""
    write_whole(path, lambda file: file.write(data))


def write_new(folder: Path, stem: str, ending: str, write: Callable[[Path], None]) -> Path:
    """Let `write` fill a new file in a folder, which is made if need be, and return the name that it has then.

    That is stem and ending, or with -2, -3, ... between them where the name is taken; nobody sees the file before it is
    whole.  Raises OSError in one line, and what `write` raises, leaving nothing."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OSError(f"cannot write to {folder}: {error.strerror or error}") from None
    wanted = folder / f"{stem}{ending}"
    part = part_name(wanted, ending)
    try:
        write(part)
        for number in range(1, MOST_NUMBERS + 1):
            path = folder / f"{stem}{f'-{number}' if number > 1 else ''}{ending}"
            with suppress(FileExistsError):
                _name(part, path)
                return path
    except OSError as error:
        raise OSError(str(error).replace(str(part), str(wanted))) from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
    raise OSError(f"{wanted} and {MOST_NUMBERS - 1} more exist already")


def _name(part: Path, path: Path) -> None:
    """Give a file a name that is free; raises FileExistsError for one that is taken, by whomever."""
    try:
        os.link(part, path)
    except FileExistsError:
        raise
    except OSError:  # there are no links, as on some sticks and networks
        if os.path.lexists(path):
            raise FileExistsError from None
        os.rename(part, path)


@contextmanager
def file_lock(path: Path, patience: float) -> Iterator[bool]:
    """Keep other processes that ask for it from this file until the end of the block; waits for them so many seconds.

    Gives whether it is ours: False where they take longer.  Raises OSError."""
    from filelock import FileLock, Timeout  # takes a while to import

    lock = FileLock(path.with_name(f"{path.name}.lock"))
    try:
        lock.acquire(timeout=patience)
    except Timeout:
        yield False
        return
    try:
        yield True
    finally:
        lock.release()


class BackgroundWriter:
    """Writes on a thread of its own, so that a window waits for no disk and no lock; the program waits at its end."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "writing")
        self._last: Future[Any] | None = None

    def write(self, save: Callable[[], T]) -> Future[T]:
        """Let `save` run soon, in the place of what was asked before and has not begun."""
        if self._last is not None:
            self._last.cancel()
        found = self._thread.submit(save)
        self._last = found
        return found


# --- files that are still being written --------------------------------------------------------------

_PART = re.compile(r"\..+\.([0-9a-f]{8})-(\d+)-[0-9a-f]{8}\.part(\..*)?", re.DOTALL)
_LONGEST = 190  # bytes of a name that are kept; most systems allow 255 in all
_cleared: set[str] = set()


@contextmanager
def part_file(target: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """Make a new, empty file beside `target`, open for writing; it is removed at the end unless it has another name.

    Raises OSError."""
    _clear(target.parent)
    path = part_name(target)
    with path.open("xb") as file:
        try:
            yield path, file
        finally:
            with suppress(OSError):  # who wanted it on the disk has flushed it
                file.close()
            with suppress(OSError):
                path.unlink(missing_ok=True)


def part_name(target: Path, ending: str = "") -> Path:
    """Return a hidden name beside `target` that tells who writes it, and ends as told."""
    name = os.fsencode(target.name)[:_LONGEST].decode(errors="ignore")
    return target.with_name(f".{name}.{_machine()}-{os.getpid()}-{secrets.token_hex(4)}.part{ending}")


def _machine() -> str:
    return f"{zlib.crc32(socket.gethostname().encode()):08x}"


def _clear(folder: Path) -> None:
    """Remove what killed writers of this machine have left; once for each folder, as it may be large."""
    if os.name == "nt" or str(folder) in _cleared:
        return
    _cleared.add(str(folder))
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            found = _PART.fullmatch(entry.name)
            if found and found[1] == _machine() and not _lives(int(found[2])):
                with suppress(OSError):
                    os.unlink(entry.path)


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # somebody else's, or no number of a process
        return True
    return True


def _target(path: Path) -> Path:
    """The file that a path means, past all links; raises OSError, in one line, for what is there and no regular file.

    Taking the name of a device or a pipe would destroy it.
    """
    try:
        kind = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        kind = stat.S_IFREG
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror or error}") from None
    if stat.S_ISDIR(kind):
        raise IsADirectoryError(f"{path}: a folder; give a file in it")
    if not stat.S_ISREG(kind):
        raise OSError(f"{path}: a device, a pipe or a socket; give a regular file")
    return Path(os.path.realpath(path)) if path.is_symlink() else path

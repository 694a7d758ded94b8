"""Files that are whole or absent: checked to be writable before the work, never seen half-written.

A file that is still being written is hidden beside what it becomes.  Its name tells which process writes it, so that
whoever writes in the folder next removes what killed writers have left."""

from __future__ import annotations

import os
import re
import secrets
import socket
import stat
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


def check_writable(path: Path) -> None:
    """Raise OSError, in one line, if a file of this path could not be written.

    A file is created beside it and removed again: permissions alone say too little of read-only or full disks."""
    if str(path) == "-":
        raise OSError("-: results are not written to standard output; give the name of a file")
    target = _target(path)
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no folder {path.parent if target == path else target.parent}")
    try:
        probe = _part_name(target)
        probe.touch(exist_ok=False)
        probe.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(f"{path}: the folder {target.parent} cannot be written to: {error.strerror or error}") from None


def take_folder(folder: Path, is_result: Callable[[Path], bool]) -> None:
    """Make a folder for results; raises OSError, in one line, where that cannot be, or where it has results already."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        found = next((path.name for path in folder.iterdir() if is_result(path)), None)
    except OSError as error:
        raise OSError(f"{folder}: cannot write there: {error.strerror or error}") from None
    if found is not None:
        raise OSError(f"{folder}: is in use already ({found}); give another folder")


@contextmanager
def whole_file(path: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """The name and the open file that take the name `path` at the end of the block, complete and on the disk.

    Links are followed; several may write at once.  Raises OSError in one line, also for what is there and no regular
    file, and what the block raises; then what was there before is left."""
    target = _target(path)
    try:
        _clear(target.parent)
        part = _part_name(target)
        with part.open("xb") as file:
            try:
                yield part, file
                file.flush()
                os.fsync(file.fileno())
                if os.name == "nt":  # where open files keep their names
                    file.close()
                os.replace(part, target)
            finally:
                with suppress(OSError):
                    file.close()
                with suppress(OSError):  # what is kept has another name by now
                    part.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(f"{path}: not written: {error.strerror or error}") from None


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Let `write` fill a file, as `whole_file`."""
    with whole_file(path) as (_, file):
        write(file)


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file, as `whole_file`."""
    write_whole(path, lambda file: file.write(data))


def write_text(path: Path, text: str) -> None:
    """Write a file in UTF-8, as `whole_file`."""
    write_bytes(path, text.encode())


def write_new(folder: Path, stem: str, ending: str, write: Callable[[Path], None]) -> Path:
    """Let `write` fill a new file in a folder, which is made if need be, and return the name that it has then.

    That is stem and ending, or with -2, -3, ... between them where the name is taken; nobody sees the file before it is
    whole.  Raises OSError in one line, and what `write` raises, leaving nothing."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OSError(f"cannot write to {folder}: {error.strerror or error}") from None
    path, number = folder / f"{stem}{ending}", 1
    part = _part_name(path, ending)
    try:
        write(part)
        while not _name(part, path):
            number += 1
            path = folder / f"{stem}-{number}{ending}"
        return path
    except OSError as error:
        raise OSError(str(error).replace(str(part), str(path))) from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def _name(part: Path, path: Path) -> bool:
    """Give a file a name if that is free."""
    try:
        os.link(part, path)
    except FileExistsError:
        return False
    except OSError:  # there are no links, as on some sticks and networks
        if os.path.lexists(path):
            return False
        os.rename(part, path)
    return True


@contextmanager
def file_lock(path: Path, patience: float) -> Iterator[bool]:
    """Keep other processes that ask for it from this file until the end of the block; waits for them so many seconds.

    Gives whether it is ours: False where they take longer.  Raises OSError."""
    from filelock import FileLock, Timeout  # takes a while to import

    lock = FileLock(path.with_name(f"{path.name}.lock"))
    with suppress(Timeout):
        lock.acquire(timeout=patience)
    try:
        yield lock.is_locked
    finally:
        lock.release()


# --- files that are still being written --------------------------------------------------------------

_PART = re.compile(r"\..+\.([0-9a-f]{8})-(\d+)-[0-9a-f]{8}\.part(\..*)?", re.DOTALL)
_LONGEST = 190  # bytes of a name that are kept; most systems allow 255 in all
_MACHINE = f"{zlib.crc32(socket.gethostname().encode()):08x}"
_cleared: set[str] = set()


def _part_name(target: Path, ending: str = "") -> Path:
    """A hidden name beside `target` that tells who writes it, and ends as told."""
    name = os.fsencode(target.name)[:_LONGEST].decode(errors="ignore")
    return target.with_name(f".{name}.{_MACHINE}-{os.getpid()}-{secrets.token_hex(4)}.part{ending}")


def _clear(folder: Path) -> None:
    """Remove what killed writers of this machine have left; once for each folder, as it may be large."""
    if os.name == "nt" or str(folder) in _cleared:
        return
    _cleared.add(str(folder))
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            found = _PART.fullmatch(entry.name)
            if found and found[1] == _MACHINE and not _lives(int(found[2])):
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
    kind = stat.S_IFREG
    try:
        with suppress(FileNotFoundError, NotADirectoryError):
            kind = path.stat().st_mode
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror or error}") from None
    if stat.S_ISDIR(kind):
        raise IsADirectoryError(f"{path}: a folder; give a file in it")
    if not stat.S_ISREG(kind):
        raise OSError(f"{path}: a device, a pipe or a socket; give a regular file")
    return Path(os.path.realpath(path)) if path.is_symlink() else path

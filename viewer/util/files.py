"""Files that are whole or absent: checked to be writable before the work, and never seen half-written."""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import BinaryIO

from viewer.util.part_files import claimed, part_file, part_name

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
        probe = part_name(target, secrets.token_hex(8))
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


@contextmanager
def reserved(folder: Path, stem: str, ending: str) -> Iterator[Path]:
    """A name for a new file in a folder, which is made if need be, that nobody has, and nobody else is given until the
    end of the block: stem and ending, or with -2, -3, ... between them.

    Nothing has this name before the block gives it to a whole file.  Raises OSError, in one line, where there is none.
    """
    for number in range(1, MOST_NUMBERS + 1):
        path = folder / f"{stem}{f'-{number}' if number > 1 else ''}{ending}"
        with ExitStack() as stack:
            try:
                folder.mkdir(parents=True, exist_ok=True)
                free = stack.enter_context(claimed(path)) and not os.path.lexists(path)
            except OSError as error:
                raise OSError(f"cannot write to {folder}: {error.strerror or error}") from None
            if free:
                yield path
                return
    raise OSError(f"{stem}{ending} and {MOST_NUMBERS - 1} more exist already")


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

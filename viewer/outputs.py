"""Files that a command writes: known to be writable before the work, whole or absent after it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import BinaryIO


def check_writable(path: Path) -> None:
    """Raise OSError, whose message is one line, where a file of this path could not be written.

    A file is created beside it and removed again: permissions alone say too little of read-only or full disks.
    """
    if path.is_dir():
        raise IsADirectoryError(f"{path}: a folder; give a file in it")
    folder = path.parent
    if not folder.is_dir():
        raise FileNotFoundError(f"{path}: there is no folder {folder}")
    probe = _temporary(path)
    try:
        probe.touch(exist_ok=False)
        probe.unlink()
    except OSError as error:
        raise OSError(f"{path}: the folder {folder} cannot be written to: {error.strerror or error}") from None


def check_outputs(outputs: dict[str, Path | None]) -> None:
    """Raise ValueError or OSError where the files of these options cannot all be written; None is not wanted."""
    wanted = {option: path for option, path in outputs.items() if path is not None}
    if len({path.resolve() for path in wanted.values()}) < len(wanted):
        raise ValueError(f"{', '.join(outputs)}: give each a file of its own")
    for path in wanted.values():
        check_writable(path)


def write_each(writers: Iterable[Callable[[], None]]) -> list[str]:
    """Write all files, and return why some could not be: no failure takes the other files along."""
    failures = []
    for write in writers:
        try:
            write()
        except OSError as error:
            failures.append(str(error))
    return failures


def write_whole(path: Path, write: Callable[[BinaryIO], None]) -> None:
    """Let `write` fill a file that takes its name once it is complete; raises OSError in one line, leaving nothing."""
    temporary = _temporary(path)
    try:
        with temporary.open("xb") as file:
            write(file)
        os.replace(temporary, path)
    except OSError as error:
        raise OSError(f"{path}: not written: {error.strerror or error}") from None
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """As `write_whole`, in UTF-8."""

    def write(file: BinaryIO) -> None:
        file.write(text.encode())

    write_whole(path, write)


def _temporary(path: Path) -> Path:
    return path.with_name(f".{path.name[:100]}.{os.getpid()}.part")
